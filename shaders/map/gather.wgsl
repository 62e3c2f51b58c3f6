// Reads chosen texels of a shadow map, whatever its format: what replays compare with.

// Column, row and layer.
@group(0) @binding(0) var<storage, read> texels: array<vec3u>;
@group(0) @binding(1) var<storage, read_write> depths: array<f32>;
@group(0) @binding(2) var stored_depths: texture_depth_2d_array;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = thread.x + thread.y * groups.x * 64u;
    if index < arrayLength(&texels) {
        depths[index] = textureLoad(stored_depths, texels[index].xy, texels[index].z, 0);
    }
}
