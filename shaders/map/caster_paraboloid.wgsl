// Draws pieces of casters on the disc of a paraboloid: corners where the mirror shows them, straight edges between. Depth
// is the distance from the light, and changes linearly. Twin of src/technique/map/projection/{paraboloid,drawn}.rs.

const RIM: f32 = 1.0 + 1.0 / 65536.0;

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> Corner {
    let point = vec4f(position_in_world, 1.0);
    let seen = vec3f(dot(caster.u_row, point), dot(caster.v_row, point), dot(caster.q_row, point));
    let distance = length(seen);
    let depth = (distance + caster.depth_row.w) / caster.depth_q_row.w;
    // What is clamped is not clipped: any depth will do then.
    let position = vec4f(seen.xy / (RIM * (distance + seen.z)), select(depth, 0.5, caster.clamps != 0u), 1.0);
    return Corner(position, vec2f(depth, 1.0));
}
