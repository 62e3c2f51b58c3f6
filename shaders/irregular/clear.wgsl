// Empties every cell's list and takes every receiver's verdict back.

@group(0) @binding(0) var<storage, read_write> heads: array<u32>;
@group(0) @binding(1) var<storage, read_write> blocked: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = thread.x + thread.y * groups.x * 64u;
    if index < arrayLength(&heads) {
        heads[index] = 0u;
    }
    if index < arrayLength(&blocked) {
        blocked[index] = 0u;
    }
}
