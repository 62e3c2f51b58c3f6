// The means of moments along rows of a shadow map. Texel k holds that of n texels from k - (n + 1) / 2 onwards, so that
// every window that a lookup may ask for is there. A filter's file defines `moments_of`, a layout's `nearest_texel`.

@group(0) @binding(0) var stored_depths: texture_depth_2d_array;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3u) {
    if any(thread.xy >= textureDimensions(written)) {
        return;
    }
    let n = i32(numbers[0].x);
    let last = i32(textureDimensions(stored_depths).x) - 1;
    let first = i32(thread.x) - (n + 1) / 2;
    // Divided one by one, so that no part of the mean is larger than the largest of them.
    var mean = vec4f(0.0);
    for (var column = first; column < first + n; column++) {
        if numbers[0].y >= 0.0 && (column < 0 || column > last) {
            mean += moments_of(numbers[0].y) / f32(n);
        } else {
            let texel = nearest_texel(vec2i(column, i32(thread.y)), vec2f(textureDimensions(stored_depths)));
            mean += moments_of(z_of(textureLoad(stored_depths, texel, thread.z, 0))) / f32(n);
        }
    }
    textureStore(written, thread.xy, thread.z, mean);
}
