// One lookup in the light's black and white picture per receiver. Twin of src/technique/projective_texture/replay.rs;
// a filter file of the maps defines filter_visibility, which compares nothing here.

struct Lookup {
    map_from_world: mat4x4f,
    texels: vec2f,
    kernel: u32,
    padding: u32,
}
@group(0) @binding(2) var<uniform> lookup: Lookup;
@group(0) @binding(3) var<storage, read> takes_shadow: array<u32>;
@group(0) @binding(4) var picture: texture_2d<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index >= arrayLength(&receivers) {
        return;
    }
    visibilities[index] = visibility(receivers[index]);
}

fn visibility(receiver: Receiver) -> f32 {
    if takes_shadow[receiver.triangle] == 0u {
        return 1.0;
    }
    let in_map = lookup.map_from_world * vec4f(receiver.point_in_world, 1.0);
    let q = in_map.w;
    if q <= 0.0 {
        return 1.0;
    }
    let uv = in_map.xy / q;
    if any(uv < vec2f(0.0)) || any(uv >= vec2f(1.0)) {
        return 1.0;
    }
    return filter_visibility(uv * lookup.texels, NO_DEPTH);
}

// Stands where a map's lookup has a depth to compare: the picture has none.
const NO_DEPTH: f32 = 0.0;

// The pattern of `pcf-poisson`, the same for every pixel.
fn pattern_radius_texels() -> f32 {
    return 2.0;
}
fn turned(place: vec2f) -> vec2f {
    return place;
}

// Whether a texel is white; texels outside the picture are.
fn is_lit(depth: f32, texel: vec2i) -> bool {
    if any(texel < vec2i(0)) || any(texel >= vec2i(lookup.texels)) {
        return true;
    }
    return textureLoad(picture, texel, 0).x > 0.5;
}
