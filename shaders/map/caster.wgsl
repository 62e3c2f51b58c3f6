// Draws casters into the shadow map: depth only.

struct Light {
    light_clip_from_world: mat4x4f,
}
@group(0) @binding(0) var<uniform> light: Light;

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> @builtin(position) vec4f {
    return light.light_clip_from_world * vec4f(position_in_world, 1.0);
}
