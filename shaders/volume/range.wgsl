// One triangle over the whole picture at one depth: the depth test against what is seen tells nearer from farther.

struct Bound {
    depth: f32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(0) var<uniform> bound: Bound;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index % 2u), f32(index / 2u));
    return vec4f(4.0 * corner - 1.0, bound.depth, 1.0);
}
