// Draws casters flattened onto a plane: each fragment adds one layer of shadow to its pixel.

struct Shadow {
    clip_from_caster: mat4x4f,
}
@group(0) @binding(0) var<uniform> shadow: Shadow;

@vertex
fn vertex(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return shadow.clip_from_caster * vec4f(position, 1.0);
}

// One unit of an 8-bit target.
@fragment
fn fragment() -> @location(0) vec4f {
    return vec4f(1.0 / 255.0, 0.0, 0.0, 0.0);
}
