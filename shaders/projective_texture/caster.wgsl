// Draws casters black into the light's picture.

struct Light {
    light_clip_from_world: mat4x4f,
}
@group(0) @binding(0) var<uniform> light: Light;

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> @builtin(position) vec4f {
    return light.light_clip_from_world * vec4f(position_in_world, 1.0);
}

@fragment
fn fragment() -> @location(0) vec4f {
    return vec4f(0.0);
}
