// Marks the pixels whose receivers the texels around them disagree about: the map's answer is neither 0 nor 1 there.
// Twin of src/technique/hybrid/prepared.rs.

@group(0) @binding(2) var<storage, read_write> pixel_mask: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index < arrayLength(&receivers) {
        pixel_mask[receivers[index].pixel] = u32(visibilities[index] > 0.0 && visibilities[index] < 1.0);
    }
}
