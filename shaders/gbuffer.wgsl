// Which triangle each pixel centre shows: triangle id + 1, 0 for background.

struct Camera {
    clip_from_world: mat4x4f,
}
@group(0) @binding(0) var<uniform> camera: Camera;

struct Corner {
    @builtin(position) position_in_clip: vec4f,
    @location(0) @interpolate(flat, either) triangle: u32,
}

@vertex
fn vertex(@location(0) position_in_world: vec3f, @builtin(vertex_index) corner: u32) -> Corner {
    return Corner(camera.clip_from_world * vec4f(position_in_world, 1.0), corner / 3u);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4u {
    return vec4u(corner.triangle + 1u, 0u, 0u, 0u);
}
