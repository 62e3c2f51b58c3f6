// Keeps every fragment: the depth test finds the nearest.

@fragment
fn fragment(corner: Corner) -> @builtin(frag_depth) f32 {
    return drawn_depth(corner);
}
