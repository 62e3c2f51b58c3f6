// Volume vertices moved away from the light here.

@vertex
fn vertex(@location(0) position_in_world: vec4f) -> Clipped {
    return clipped(extruded(position_in_world));
}
