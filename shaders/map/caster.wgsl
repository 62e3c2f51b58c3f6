// Draws casters into the shadow map: depth only.

struct Caster {
    clip_from_world: mat4x4f,
}
@group(0) @binding(0) var<uniform> caster: Caster;

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> @builtin(position) vec4f {
    return caster.clip_from_world * vec4f(position_in_world, 1.0);
}
