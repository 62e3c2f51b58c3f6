// Puts every receiver into the list of its cell. Lists hold indices + 1; 0 ends them.

@group(0) @binding(1) var<storage, read> samples: array<Sample>;
@group(0) @binding(2) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> next: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = thread.x + thread.y * groups.x * 64u;
    if index >= arrayLength(&samples) {
        return;
    }
    let receiver = samples[index];
    let face = view.faces[receiver.face];
    let place = in_face(face, (receiver.point_high - view.anchor) + receiver.point_low);
    let cell = cell_at(position_in_cells(face, place.xy / place.z));
    next[index] = atomicExchange(&heads[head_index(receiver.face, cell)], index + 1u);
}
