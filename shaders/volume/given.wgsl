// Vertices as they are: the scene's corners (w = 1 by the vertex format) and volumes extruded by the CPU.

@vertex
fn vertex(@location(0) position_in_world: vec4f) -> Clipped {
    return clipped(position_in_world);
}
