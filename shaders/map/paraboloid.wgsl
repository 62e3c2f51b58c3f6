// Twin of src/technique/map/projection/paraboloid.rs.

const RIM: f32 = 1.0 + 1.0 / 65536.0;
const MAP_FROM_DISC = vec2f(0.5 / RIM, -0.5 / RIM);
const HELD_TEXELS: f32 = 1.0;
const LEAST_COSINE: f32 = 1e-3;

// A world point as seen from the light: to the side, up and along the axis.
fn in_light(view: View, point_in_world: vec3f) -> vec3f {
    let point = vec4f(point_in_world, 1.0);
    return vec3f(dot(view.u_row, point), dot(view.v_row, point), dot(view.q_row, point));
}

fn project(view: View, point_in_world: vec3f) -> InMap {
    let seen = in_light(view, point_in_world);
    let distance = length(seen);
    let q = distance + seen.z;
    return InMap(0.5 + MAP_FROM_DISC * seen.xy / q, (distance + view.depth_row.w) / view.depth_q_row.w, q);
}

fn gradients(view: View, point_in_world: vec3f, at: InMap) -> Gradients {
    let seen = in_light(view, point_in_world);
    let away = (view.u_row.xyz * seen.x + view.v_row.xyz * seen.y + view.q_row.xyz * seen.z) / length(seen);
    let of_q = away + view.q_row.xyz;
    return Gradients(
        MAP_FROM_DISC.x * (view.u_row.xyz - seen.x / at.q * of_q) / at.q,
        MAP_FROM_DISC.y * (view.v_row.xyz - seen.y / at.q * of_q) / at.q,
        away / view.depth_q_row.w,
    );
}

// At the same distance from the light. The rows are as orthonormal as f32 holds them.
fn point_beside(view: View, point_in_world: vec3f, at: InMap, uv: vec2f) -> vec3f {
    let seen = in_light(view, point_in_world);
    let on_disc = (uv - 0.5) / MAP_FROM_DISC;
    let squared = dot(on_disc, on_disc);
    let direction = vec3f(2.0 * on_disc, 1.0 - squared) / (1.0 + squared);
    let step = length(seen) * direction - seen;
    return point_in_world + view.u_row.xyz * step.x + view.v_row.xyz * step.y + view.q_row.xyz * step.z;
}

// Rounding; what straight pieces make of a plane's distance, which bends over the disc; and that bend over a kernel.
fn slack(
    view: View, point_in_world: vec3f, normal_in_world: vec3f, in_map: InMap, slope: vec2f, reach_texels: vec2f,
    texels: vec2f,
) -> f32 {
    let distance = length(in_light(view, point_in_world));
    let around = gradients(view, point_in_world, in_map);
    let cosine = abs(dot(normal_in_world, normalize(around.depth)));
    let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    let tangent = sine / max(cosine - view.edge_rad * sine, LEAST_COSINE);
    let bend_m = distance * (1.0 + tangent + 2.0 * tangent * tangent);
    let reach_rad = length(reach_texels * texel_m(around, texels)) / distance;
    let bent_m = bend_m * view.edge_rad * view.edge_rad / 6.0 + 0.5 * distance * tangent * reach_rad * reach_rad;

    let point = abs(vec4f(point_in_world, 1.0));
    let reached_m = dot(abs(view.u_row), point) + dot(abs(view.v_row), point) + dot(abs(view.q_row), point) + distance;
    let range_m = abs(view.depth_q_row.w);
    let rounding = POSITION_ROUNDING * (reached_m / range_m + dot(slope, texels) * reached_m / in_map.q);
    return rounding + bent_m / range_m;
}

// Only its slope is known.
fn bend_per_texel(view: View, point_in_world: vec3f, normal_in_world: vec3f, in_map: InMap, texels: vec2f) -> vec2f {
    return vec2f(0.0);
}

fn nearest_texel(texel: vec2i, texels: vec2f) -> vec2i {
    let in_square = clamp(texel, vec2i(0), vec2i(texels) - 1);
    let off = 2.0 * (vec2f(in_square) + 0.5) / texels - 1.0;
    let radius = length(off) * RIM;
    let beyond = radius > 1.0 + 2.0 * HELD_TEXELS / min(texels.x, texels.y);
    let nearest = select(in_square, vec2i(floor((0.5 + 0.5 * off / radius) * texels)), beyond);
    return clamp(nearest, vec2i(0), vec2i(texels) - 1);
}
