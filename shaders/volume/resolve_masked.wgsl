// Answers the receivers at the pixels of a mask by the counts; the others keep the answers they have.

@group(0) @binding(4) var<storage, read> pixel_mask: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index < arrayLength(&receivers) && pixel_mask[receivers[index].pixel] != 0u {
        visibilities[index] = visibility_at(receivers[index].pixel);
    }
}
