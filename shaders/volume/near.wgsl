// Casters projected from the light onto the camera's near plane. Twin: src/technique/volume/near_projection.rs.

struct Projection {
    clip_from_caster: mat4x4f,
}
@group(0) @binding(0) var<uniform> projection: Projection;

@vertex
fn vertex(@location(0) position_in_world: vec4f) -> @builtin(position) vec4f {
    return projection.clip_from_caster * position_in_world;
}
