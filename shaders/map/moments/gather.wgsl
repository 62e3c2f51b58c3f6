// Reads chosen means of a map of moments: what replays compare with.

// Column, row and layer.
@group(0) @binding(0) var<storage, read> texels: array<vec3u>;
@group(0) @binding(1) var<storage, read_write> gathered: array<vec4f>;
@group(0) @binding(2) var means: texture_2d_array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = thread.x + thread.y * groups.x * 64u;
    if index < arrayLength(&texels) {
        gathered[index] = textureLoad(means, texels[index].xy, texels[index].z, 0);
    }
}
