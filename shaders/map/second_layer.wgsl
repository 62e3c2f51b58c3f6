// Keeps what lies behind the nearest layer: the depth test finds the second nearest. Twin of
// src/technique/map/exact_texels.rs.

@group(0) @binding(1) var nearest_depths: texture_depth_2d;

// What is no farther behind the nearest surface is that surface: four units of the last place.
const SAME_LAYER: f32 = 4.7683716e-7; // 2^-21

@fragment
fn fragment(corner: Corner) -> @builtin(frag_depth) f32 {
    let depth = drawn_depth(corner);
    let nearest = textureLoad(nearest_depths, vec2u(corner.position.xy), 0);
    if caster.depth_sign * (depth - nearest) <= SAME_LAYER * abs(nearest) {
        discard;
    }
    return depth;
}
