// A receiver is lit where no volume was counted.

struct Counting {
    // The stencil's bits that count.
    mask: u32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(2) var counts: texture_2d<u32>;
@group(0) @binding(3) var<uniform> counting: Counting;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index >= arrayLength(&receivers) {
        return;
    }
    let width = textureDimensions(counts).x;
    let pixel = receivers[index].pixel;
    let count = textureLoad(counts, vec2u(pixel % width, pixel / width), 0).r & counting.mask;
    visibilities[index] = select(0.0, 1.0, count == 0u);
}
