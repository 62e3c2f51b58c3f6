// One shadow-map lookup per receiver: select its view, place it there, guard, bias, filter. Twin of
// src/technique/map/lookup.rs, which is the specification; offset.wgsl says how far comparisons are moved, a projection's
// file defines select_views, a filter's file filter_visibility.

struct Lookup {
    // Homogeneous light: w = 0 with a vector towards a directional one.
    light: vec4f,
    texels: vec2f,
    kernel: u32,
    // SEAM_* and BORDER_*.
    seam: u32,
    border: u32,
    // CLEARANCE_*.
    clearance: u32,
    bias_kernel: f32,
    raster_slack_texels: f32,
    cap_texels: f32,
    normal_texels: f32,
    depth_m: f32,
    depth_texels: f32,
    // Step of a fixed-point format, 0 for float.
    fixed_step: f32,
    // Step of a float format relative to the depth, 0 for fixed point.
    float_step: f32,
    // Whether each tap is biased for as far as it is, not for the widest kernel.
    reaches_by_tap: u32,
    // Whether patterns of taps are turned, for each pixel otherwise, and by which seed.
    turns: u32,
    seed: u32,
    pattern_radius_texels: f32,
    // Blocks of 2 to this many texels a side have their extremes known.
    mask_level: u32,
    // Whether all views measure depth alike.
    shares_depth: u32,
}
@group(0) @binding(2) var<uniform> lookup: Lookup;
@group(0) @binding(3) var stored_depths: texture_depth_2d_array;
@group(0) @binding(4) var<storage, read> views: array<View>;

const SEAM_PER_TAP: u32 = 0u;
const BORDER_SHADOW: u32 = 1u;
const BORDER_CLAMP_EDGE: u32 = 2u;

// A receiver placed in a view.
struct Placed {
    view: u32,
    point_in_world: vec3f,
    normal_in_world: vec3f,
    position_in_texels: vec2f,
    reference: f32,
    // By how much the reference changes from one texel to the next, how fast that bends, and by how much at most.
    reference_per_texel: vec2f,
    bend_per_texel: vec2f,
    reference_reach: f32,
}

// The receiver whose lookup is under way: filters hand taps by texel only.
var<private> own: Placed;
var<private> own_pixel: u32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index >= arrayLength(&receivers) {
        return;
    }
    own_pixel = receivers[index].pixel;
    visibilities[index] = visibility(receivers[index].point_in_world, receivers[index].normal_in_world);
}

fn visibility(point_in_world: vec3f, normal_in_world: vec3f) -> f32 {
    let shares = select_views(point_in_world);
    let first = visibility_in(shares.first, point_in_world, normal_in_world);
    if shares.second_weight == 0.0 {
        return first;
    }
    return mix(first, visibility_in(shares.second, point_in_world, normal_in_world), shares.second_weight);
}

fn visibility_in(view: u32, point_in_world: vec3f, normal_in_world: vec3f) -> f32 {
    let moved = moved_along_normal(views[view], point_in_world, normal_in_world);
    let at = project(views[view], moved);
    let is_inside = all(at.uv >= vec2f(0.0)) && all(at.uv < vec2f(1.0)) && at.depth >= 0.0 && at.depth <= 1.0;
    if at.q <= 0.0 || !(is_inside || lookup.border == BORDER_CLAMP_EDGE) {
        return border_visibility();
    }
    own = placed(view, moved, normal_in_world, vec2f(own_reach_texels()));
    return filter_visibility(own.position_in_texels, own.reference);
}

// A moved receiver in any view, with a bias for texels up to `reach_texels` away.
fn placed(view: u32, moved: vec3f, normal_in_world: vec3f, reach_texels: vec2f) -> Placed {
    var at = project(views[view], moved);
    if lookup.border == BORDER_CLAMP_EDGE {
        at.depth = clamp(at.depth, 0.0, 1.0);
    }
    let around = gradients(views[view], moved, at);
    let bias = bias_depth(views[view], moved, normal_in_world, at, reach_texels);
    let reference = at.depth - views[view].depth_sign * bias;
    let follows_plane = lookup.clearance == CLEARANCE_RECEIVER_PLANE;
    let per_texel = select(vec2f(0.0), depth_per_texel(around, normal_in_world, lookup.texels), follows_plane);
    let bend = bend_per_texel(views[view], moved, normal_in_world, at, lookup.texels);
    return Placed(view, moved, normal_in_world, at.uv * lookup.texels, reference, per_texel, bend, cap_depth(around));
}

// The reference of one texel of a receiver's view, given that of the receiver's own place.
fn reference_at(placed: Placed, reference: f32, texel: vec2i) -> f32 {
    if all(placed.reference_per_texel == vec2f(0.0)) {
        return reference;
    }
    let away = vec2f(texel) + 0.5 - placed.position_in_texels;
    let change = clamp(bent(placed.reference_per_texel, placed.bend_per_texel, away), -placed.reference_reach, placed.reference_reach);
    return clamp(reference + change, 0.0, 1.0);
}

// Whether the receiver under way is lit by a texel of its view, whose reference depth is given. Equality is lit.
fn is_lit(reference: f32, texel: vec2i) -> bool {
    if is_in_view(texel) {
        return compares_lit(own.view, reference_for(reference, texel), texel);
    }
    if lookup.seam == SEAM_PER_TAP {
        let across = texel_across(texel);
        if across.is_found {
            let placed = across.placed;
            return compares_lit(placed.view, reference_at(placed, placed.reference, across.texel), across.texel);
        }
    }
    if lookup.seam != SEAM_PER_TAP || lookup.border == BORDER_CLAMP_EDGE {
        let nearest = nearest_texel(texel, lookup.texels);
        return compares_lit(own.view, reference_at(own, reference, nearest), nearest);
    }
    return lookup.border != BORDER_SHADOW;
}

// The reference depth of the receiver under way, with a bias for as far as the texel is where filters ask for that.
fn reference_for(reference: f32, texel: vec2i) -> f32 {
    if lookup.reaches_by_tap == 0u || lookup.clearance != CLEARANCE_CLOSED_FORM {
        return reference_at(own, reference, texel);
    }
    let reach_texels = max(abs(vec2f(texel) + 0.5 - own.position_in_texels), vec2f(0.5));
    return placed(own.view, own.point_in_world, own.normal_in_world, reach_texels).reference;
}

fn pattern_radius_texels() -> f32 {
    return lookup.pattern_radius_texels;
}

// A texel of another view that stands for one beyond the side of the receiver's view.
struct Across {
    is_found: bool,
    placed: Placed,
    texel: vec2i,
}

fn texel_across(texel: vec2i) -> Across {
    let at = project(views[own.view], own.point_in_world);
    let uv = (vec2f(texel) + 0.5) / lookup.texels;
    let beside = point_beside(views[own.view], own.point_in_world, at, uv);
    let view = select_views(beside).first;
    let found = project(views[view], beside);
    let across = vec2i(floor(found.uv * lookup.texels));
    let seen = project(views[view], own.point_in_world);
    if view == own.view || found.q <= 0.0 || seen.q <= 0.0 || !is_in_view(across) {
        return Across(false, own, texel);
    }
    let away = abs(vec2f(across) + 0.5 - seen.uv * lookup.texels);
    let reach_texels = select(away, vec2f(0.0), lookup.clearance == CLEARANCE_RECEIVER_PLANE);
    return Across(true, placed(view, own.point_in_world, own.normal_in_world, reach_texels), across);
}

fn border_visibility() -> f32 {
    return select(1.0, 0.0, lookup.border == BORDER_SHADOW);
}

fn is_in_view(texel: vec2i) -> bool {
    return all(texel == nearest_texel(texel, lookup.texels));
}

fn compares_lit(view: u32, reference: f32, texel: vec2i) -> bool {
    return views[view].depth_sign * (reference - textureLoad(stored_depths, texel, view, 0)) <= 0.0;
}
