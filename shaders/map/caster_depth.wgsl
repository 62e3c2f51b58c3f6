// Casters with a depth of their own: where u and v are warped but depth is not, where casters before the near plane must
// be drawn at it though the device always clips, and where a shader looks at depths. The rasteriser's bias does not reach
// such depths, so it is added here. Another file puts the corners in their place, a third says which fragments are kept.

struct Caster {
    clip_from_world: mat4x4f,
    depth_row: vec4f,
    depth_q_row: vec4f,
    // In units of a fixed-point depth, and in units of the last place of a float one.
    bias_constant: f32,
    bias_constant_ulps: f32,
    bias_slope: f32,
    // 0: no limit.
    bias_clamp: f32,
    depth_sign: f32,
    // Whether what lies before the near plane is drawn at it.
    clamps: u32,
    padding: vec2u,
    u_row: vec4f,
    v_row: vec4f,
    q_row: vec4f,
}
@group(0) @binding(0) var<uniform> caster: Caster;

struct Corner {
    @builtin(position) position: vec4f,
    // Depth times its divisor, and the divisor.
    @location(0) depth: vec2f,
}

// The depth that is stored.
fn drawn_depth(corner: Corner) -> f32 {
    let depth = corner.depth.x / corner.depth.y;
    let slope = max(abs(dpdx(depth)), abs(dpdy(depth)));
    if caster.clamps == 0u && (depth < 0.0 || depth > 1.0) {
        discard;
    }
    // 2^(exponent - 23) is a unit of a float's last place.
    let unit = ldexp(1.0, frexp(abs(depth)).exp - 24);
    var bias = caster.bias_constant + caster.bias_constant_ulps * unit + caster.bias_slope * slope;
    if caster.bias_clamp > 0.0 {
        bias = min(bias, caster.bias_clamp);
    }
    return clamp(depth + caster.depth_sign * bias, 0.0, 1.0);
}
