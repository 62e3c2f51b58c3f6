// Twin of src/technique/map/projection/adaptive.rs.

// Levels that the curve resolves.
const DEEPEST: u32 = 12u;

// The last tile that begins at or before the point's place on the curve.
fn select_views(point_in_world: vec3f) -> Shares {
    let own = views[0].selector;
    let uv = (own.zw + project(views[0], point_in_world).uv) / own.y;
    let cells = f32(1u << DEEPEST);
    let place = place_on_curve(vec2u(clamp(floor(uv * cells), vec2f(0.0), vec2f(cells - 1.0))));
    var first = 0u;
    var after = arrayLength(&views);
    while first + 1u < after {
        let middle = (first + after) / 2u;
        if u32(views[middle].selector.x) <= place {
            first = middle;
        } else {
            after = middle;
        }
    }
    return one_view(first);
}

fn place_on_curve(cell: vec2u) -> u32 {
    return bits_apart(cell.x) | (bits_apart(cell.y) << 1u);
}

// The bits of a number, each followed by a zero.
fn bits_apart(number: u32) -> u32 {
    var bits = (number | (number << 8u)) & 0x00ff00ffu;
    bits = (bits | (bits << 4u)) & 0x0f0f0f0fu;
    bits = (bits | (bits << 2u)) & 0x33333333u;
    return (bits | (bits << 1u)) & 0x55555555u;
}
