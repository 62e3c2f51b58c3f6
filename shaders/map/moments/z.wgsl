// Depth as moments take it: 0 at the near plane, 1 at the far one. `numbers[0]` holds the texels that a mean goes over,
// the z of what lies beyond the map's border (negative: of its nearest texel), and the sign of depth.

fn z_of(depth: f32) -> f32 {
    return select(1.0 - depth, depth, numbers[0].z > 0.0);
}
