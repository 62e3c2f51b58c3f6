// One shadow ray per receiver, walked through an acceleration structure by the device. This file comes first in its
// module, because directives do.
enable wgpu_ray_query;

struct Light {
    // Homogeneous: w = 0 with a vector towards a directional light.
    light: vec4f,
    // Where a ray towards a directional light ends, in lengths of that vector.
    reach: f32,
    padding: f32,
    more_padding: vec2f,
}
@group(0) @binding(2) var<uniform> light: Light;
@group(0) @binding(3) var casters: acceleration_structure;
// Per primitive, and per triangle of the scene, the triangle that stands for all in its place.
@group(0) @binding(4) var<storage, read> surface_of_primitive: array<u32>;
@group(0) @binding(5) var<storage, read> surface_of_triangle: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = receiver_index(thread, groups);
    if index >= arrayLength(&receivers) {
        return;
    }
    let start = receivers[index].point_in_world;
    let towards = light.light.xyz - light.light.w * start;
    let end = select(light.reach, 1.0, light.light.w != 0.0);
    let own = surface_of_triangle[receivers[index].triangle];
    var query: ray_query;
    rayQueryInitialize(&query, casters, RayDesc(RAY_FLAG_NONE, 0xffu, 0.0, end, start, towards));
    // Triangles are not opaque to the device, so each that the ray meets is asked about.
    while rayQueryProceed(&query) {
        let candidate = rayQueryGetCandidateIntersection(&query);
        if surface_of_primitive[candidate.primitive_index] != own {
            rayQueryConfirmIntersection(&query);
            rayQueryTerminate(&query);
        }
    }
    let found = rayQueryGetCommittedIntersection(&query);
    visibilities[index] = select(0.0, 1.0, found.kind == RAY_QUERY_INTERSECTION_NONE);
}
