// Draws casters where a matrix puts them, with a depth that has rows of its own.

@vertex
fn vertex(@location(0) position_in_world: vec3f) -> Corner {
    let point = vec4f(position_in_world, 1.0);
    let clip = caster.clip_from_world * point;
    // Any depth that is not clipped.
    let position = vec4f(clip.xy, 0.5 * clip.w, clip.w);
    return Corner(position, vec2f(dot(caster.depth_row, point), dot(caster.depth_q_row, point)));
}
