// The means along columns of what rows.wgsl wrote, row k from row k - (n + 1) / 2 onwards, and a count of those that the
// format cannot hold.

@group(0) @binding(0) var rows: texture_2d_array<f32>;
@group(0) @binding(3) var<storage, read_write> overflowed: atomic<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3u) {
    if any(thread.xy >= textureDimensions(written)) {
        return;
    }
    let n = i32(numbers[0].x);
    let last = i32(textureDimensions(rows).y) - 1;
    let first = i32(thread.y) - (n + 1) / 2;
    var mean = vec4f(0.0);
    for (var row = first; row < first + n; row++) {
        if numbers[0].y >= 0.0 && (row < 0 || row > last) {
            mean += numbers[2] / f32(n);
        } else {
            mean += textureLoad(rows, vec2i(i32(thread.x), clamp(row, 0, last)), thread.z, 0) / f32(n);
        }
    }
    let is_infinite = (bitcast<vec4u>(mean) & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    if any(is_infinite | (abs(mean) > vec4f(LARGEST))) {
        atomicAdd(&overflowed, 1u);
    }
    textureStore(written, thread.xy, thread.z, mean);
}
