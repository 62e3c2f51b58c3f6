// The counts of volumes, and what they say.

struct Counting {
    // The stencil's bits that count.
    mask: u32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(2) var counts: texture_2d<u32>;
@group(0) @binding(3) var<uniform> counting: Counting;

// A pixel is lit where no volume was counted.
fn visibility_at(pixel: u32) -> f32 {
    let width = textureDimensions(counts).x;
    let count = textureLoad(counts, vec2u(pixel % width, pixel / width), 0).r & counting.mask;
    return select(0.0, 1.0, count == 0u);
}
