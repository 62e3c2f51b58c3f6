// One view of a map, and what follows from the gradients of its coordinates. Twin of
// src/technique/map/projection/{view,site}.rs; a layout file defines project, gradients,
// point_beside, slack, bend_per_texel and nearest_texel.

struct View {
    u_row: vec4f,
    v_row: vec4f,
    q_row: vec4f,
    depth_row: vec4f,
    depth_q_row: vec4f,
    // What the projection selects views by.
    selector: vec4f,
    // +1 where depth grows away from the light, -1 where it shrinks.
    depth_sign: f32,
    // How fast it is blended in before the projection would select it, per metre; 0 where it is not.
    blend_per_m: f32,
    // Largest angle that a drawn edge spans as seen from the light; 0 where edges are drawn as they are.
    edge_rad: f32,
    padding: u32,
}

// Where a world point lies in a view.
struct InMap {
    uv: vec2f,
    depth: f32,
    q: f32,
}

// How that changes with the world position, per metre.
struct Gradients {
    u: vec3f,
    v: vec3f,
    depth: vec3f,
}

// The views that answer for a point: one, or two that are blended.
struct Shares {
    first: u32,
    second: u32,
    second_weight: f32,
}

// Change per texel beyond which every bias is at its cap.
const STEEPEST: f32 = 1e3;
const POSITION_ROUNDING: f32 = 1.1920929e-7; // 2^-23

fn one_view(view: u32) -> Shares {
    return Shares(view, view, 0.0);
}

// Width and height of a texel in metres, across the light's ray.
fn texel_m(at: Gradients, texels: vec2f) -> vec2f {
    return vec2f(length(at.v), length(at.u)) / (length(cross(at.u, at.v)) * texels);
}

// Metres along the light's ray per unit of depth.
fn metres_per_depth(at: Gradients) -> f32 {
    let ray = cross(at.u, at.v);
    return length(ray) / abs(dot(at.depth, ray));
}

// Change of depth from one texel to the next along u and along v on a plane.
fn depth_per_texel(at: Gradients, normal_in_world: vec3f, texels: vec2f) -> vec2f {
    return change_per_texel(at, at.depth, normal_in_world, texels);
}

// The same of anything with a gradient, per metre.
fn change_per_texel(at: Gradients, gradient: vec3f, normal_in_world: vec3f, texels: vec2f) -> vec2f {
    let volume = dot(normal_in_world, cross(at.u, at.v)) * texels;
    let change = vec2f(dot(gradient, cross(at.v, normal_in_world)), dot(gradient, cross(normal_in_world, at.u)));
    // A plane that the light sees edge-on has no volume.
    let edge_on = abs(volume) * STEEPEST <= abs(change);
    return select(change / volume, vec2f(STEEPEST), edge_on);
}

// What is left of a place's divisor, at least; with less its plane is seen edge-on there.
const LEAST_SHARE: f32 = 1e-3;

// How much depth changes over some texels, given how fast it changes and bends per texel.
fn bent(change_per_texel: vec2f, bend_per_texel: vec2f, texels: vec2f) -> f32 {
    return dot(change_per_texel, texels) / max(1.0 - dot(bend_per_texel, texels), LEAST_SHARE);
}

// How far along its normal a plane must move for its depth to change by what it changes from one texel to the next.
fn normal_offset_per_texel_m(at: Gradients, normal_in_world: vec3f, texels: vec2f) -> vec2f {
    let change = vec2f(dot(normal_in_world, cross(at.depth, at.v)), dot(normal_in_world, cross(at.u, at.depth)));
    return abs(change) / (abs(dot(at.depth, cross(at.u, at.v))) * texels);
}
