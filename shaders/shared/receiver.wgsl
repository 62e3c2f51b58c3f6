// The receivers a lookup answers for, and where its answers go. Twin of `GpuReceiver` in src/technique/receiver_buffer.rs.

struct Receiver {
    point_in_world: vec3f,
    triangle: u32,
    normal_in_world: vec3f,
    pixel: u32,
}
@group(0) @binding(0) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(1) var<storage, read_write> visibilities: array<f32>;

// Index of this thread's receiver; at or beyond `arrayLength(&receivers)` for the threads that fill the last group.
fn receiver_index(thread: vec3u, groups: vec3u) -> u32 {
    return thread.x + thread.y * groups.x * 64u;
}
