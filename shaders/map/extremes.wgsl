// The nearest and the farthest depth of every block of texels of a shadow map. Twin of src/technique/map/mask_pass.rs.

struct Blocks {
    // Texels along a side.
    side: u32,
    // +1 where depth grows away from the light, -1 where it shrinks.
    depth_sign: f32,
    padding: vec2u,
}
@group(0) @binding(0) var<uniform> blocks: Blocks;
@group(0) @binding(1) var stored_depths: texture_depth_2d_array;
@group(0) @binding(2) var extremes: texture_storage_2d_array<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3u) {
    if any(thread.xy >= textureDimensions(extremes)) {
        return;
    }
    let end = min((thread.xy + 1u) * blocks.side, textureDimensions(stored_depths));
    var low = 1.0;
    var high = 0.0;
    for (var row = thread.y * blocks.side; row < end.y; row++) {
        for (var column = thread.x * blocks.side; column < end.x; column++) {
            let depth = textureLoad(stored_depths, vec2u(column, row), thread.z, 0);
            low = min(low, depth);
            high = max(high, depth);
        }
    }
    let nearest_first = select(vec2f(high, low), vec2f(low, high), blocks.depth_sign > 0.0);
    textureStore(extremes, thread.xy, thread.z, vec4f(nearest_first, 0.0, 0.0));
}
