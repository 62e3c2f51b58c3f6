// Answers every receiver by the counts.

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index < arrayLength(&receivers) {
        visibilities[index] = visibility_at(receivers[index].pixel);
    }
}
