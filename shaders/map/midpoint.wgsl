// Stores the middle between the two nearest layers, or nothing where there is no second. Twin of
// src/technique/map/exact_texels.rs.

struct Midpoint {
    // What is stored where nothing is.
    cleared: f32,
    padding: f32,
    more_padding: vec2f,
}
@group(0) @binding(0) var<uniform> midpoint: Midpoint;
@group(0) @binding(1) var nearest_depths: texture_depth_2d;
@group(0) @binding(2) var second_depths: texture_depth_2d;

// One triangle that covers the map.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index % 2u) * 4.0 - 1.0, f32(index / 2u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let texel = vec2u(position.xy);
    let second = textureLoad(second_depths, texel, 0);
    return select(0.5 * (textureLoad(nearest_depths, texel, 0) + second), second, second == midpoint.cleared);
}
