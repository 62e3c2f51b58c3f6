// One shadow-map lookup per receiver: place it in the map, guard, bias, filter. Twin of src/technique/map/lookup.rs,
// which is the specification; a filter file defines filter_visibility.

struct Lookup {
    map_from_world: mat4x4f,
    // Transposed inverse of map_from_world: takes planes where that takes points.
    plane_in_map_from_world: mat4x4f,
    // Homogeneous light: w = 0 with a vector towards a directional one.
    light: vec4f,
    texels: vec2f,
    texel_at_q1: vec2f,
    // One unit of depth is x + y q^2 metres.
    metres_per_depth_terms: vec2f,
    kernel: u32,
    // +1 where depth grows away from the light, -1 reversed.
    depth_sign: f32,
    closed_form_kernel: f32,
    raster_slack_texels: f32,
    cap_texels: f32,
    normal_texels: f32,
    depth_m: f32,
    // Step of a fixed-point format, 0 for float.
    fixed_step: f32,
    // Step of a float format relative to the depth, 0 for fixed point.
    float_step: f32,
    padding: u32,
}
@group(0) @binding(2) var<uniform> lookup: Lookup;
@group(0) @binding(3) var stored_depths: texture_depth_2d;

// Depth per texel beyond which every bias is at its cap.
const STEEPEST: f32 = 1e3;
const POSITION_ROUNDING: f32 = 1.1920929e-7; // 2^-23

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index >= arrayLength(&receivers) {
        return;
    }
    visibilities[index] = visibility(receivers[index].point_in_world, receivers[index].normal_in_world);
}

fn visibility(point_in_world: vec3f, normal_in_world: vec3f) -> f32 {
    let moved = moved_along_normal(point_in_world, normal_in_world);
    let in_map = lookup.map_from_world * vec4f(moved, 1.0);
    let q = in_map.w;
    if q <= 0.0 {
        return 1.0;
    }
    let uv = in_map.xy / q;
    let depth = in_map.z / q;
    if any(uv < vec2f(0.0)) || any(uv >= vec2f(1.0)) || depth < 0.0 || depth > 1.0 {
        return 1.0;
    }
    let reference = depth - lookup.depth_sign * bias_depth(moved, normal_in_world, q, depth);
    return filter_visibility(uv * lookup.texels, reference);
}

fn moved_along_normal(point_in_world: vec3f, normal_in_world: vec3f) -> vec3f {
    let q = (lookup.map_from_world * vec4f(point_in_world, 1.0)).w;
    let texel_m = lookup.texel_at_q1 * q;
    let towards_light = normalize(lookup.light.xyz - point_in_world * lookup.light.w);
    let sine = length(cross(normal_in_world, towards_light));
    return point_in_world + normal_in_world * (lookup.normal_texels * max(texel_m.x, texel_m.y) * sine);
}

// How far the comparison is moved towards the light, in units of depth.
fn bias_depth(point_in_world: vec3f, normal_in_world: vec3f, q: f32, depth: f32) -> f32 {
    let metres_per_depth = lookup.metres_per_depth_terms.x + lookup.metres_per_depth_terms.y * q * q;
    let along_light = lookup.depth_m / metres_per_depth;
    if lookup.closed_form_kernel == 0.0 {
        return along_light;
    }
    let texel_m = lookup.texel_at_q1 * q;
    let plane = vec4f(normal_in_world, -dot(normal_in_world, point_in_world));
    let plane_in_map = lookup.plane_in_map_from_world * plane;
    // A plane that the light sees edge-on has z = 0.
    let edge_on = abs(plane_in_map.z) * STEEPEST * lookup.texels <= abs(plane_in_map.xy);
    let slope_per_texel = select(abs(plane_in_map.xy / plane_in_map.z) / lookup.texels, vec2f(STEEPEST), edge_on);
    let kernel = lookup.closed_form_kernel + lookup.raster_slack_texels;
    let slope = kernel * (slope_per_texel.x + slope_per_texel.y);
    let largest = max(max(abs(point_in_world.x), abs(point_in_world.y)), abs(point_in_world.z));
    let position = largest * POSITION_ROUNDING
        * (1.0 / metres_per_depth + slope_per_texel.x / texel_m.x + slope_per_texel.y / texel_m.y);
    let format = 4.0 * (lookup.fixed_step + lookup.float_step * depth);
    let cap = lookup.cap_texels * max(texel_m.x, texel_m.y) / metres_per_depth;
    return along_light + min(slope + position + format, cap);
}

// Whether a reference depth is lit by a texel; texels outside the map light everything. Equality is lit.
fn is_lit(reference: f32, texel: vec2i) -> bool {
    if any(texel < vec2i(0)) || any(texel >= vec2i(lookup.texels)) {
        return true;
    }
    return lookup.depth_sign * (reference - textureLoad(stored_depths, texel, 0)) <= 0.0;
}
