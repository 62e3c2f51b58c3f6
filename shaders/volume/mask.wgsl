// One triangle over the whole picture, of which the pixels of a mask are kept: there the stencil's flag is set.

struct Picture {
    width: u32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> pixel_mask: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index % 2u) * 4.0 - 1.0, f32(index / 2u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) {
    let pixel = vec2u(position.xy);
    if pixel_mask[pixel.y * picture.width + pixel.x] == 0u {
        discard;
    }
}
