// Draws casters whose corners before the near plane are moved to it, along the light's rays. Twin of
// src/technique/map/projection/pancaked.rs.

struct Caster {
    clip_from_world: mat4x4f,
    depth_row: vec4f,
    depth_q_row: vec4f,
    bias_constant: f32,
    bias_constant_ulps: f32,
    bias_slope: f32,
    bias_clamp: f32,
    depth_sign: f32,
}
@group(0) @binding(0) var<uniform> caster: Caster;

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> @builtin(position) vec4f {
    let clip = caster.clip_from_world * vec4f(position_in_world, 1.0);
    // The near plane is at depth 0 or, reversed, at 1.
    return vec4f(clip.xy, select(min(clip.z, clip.w), max(clip.z, 0.0), caster.depth_sign > 0.0), clip.w);
}
