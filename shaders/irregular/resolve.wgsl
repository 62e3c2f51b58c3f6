// A receiver that no caster blocks is lit.

@group(0) @binding(2) var<storage, read> blocked: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index < arrayLength(&receivers) {
        visibilities[index] = f32(1u - ((blocked[index / 32u] >> (index % 32u)) & 1u));
    }
}
