// How vertices move away from the light: those with w = 0, by the same formulas as `extrude` in
// src/technique/volume/extrude.rs.

struct Extrusion {
    // Homogeneous: w = 0 for a direction towards the light.
    light: vec4f,
    // 0 for infinite volumes.
    length_m: f32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(1) var<uniform> extrusion: Extrusion;

fn extruded(position_in_world: vec4f) -> vec4f {
    if position_in_world.w == 1.0 {
        return position_in_world;
    }
    let away = position_in_world.xyz * extrusion.light.w - extrusion.light.xyz;
    if extrusion.length_m == 0.0 {
        return vec4f(away, 0.0);
    }
    let distance = max(length(away), 1e-30);
    return vec4f(position_in_world.xyz + extrusion.length_m * (away / distance), 1.0);
}
