// The corner whose wedge holds a receiver: twin of src/technique/map/outline.rs, in place of a filter.

@group(0) @binding(5) var silhouettes: texture_2d<f32>;

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    return f32(is_lit(reference, corner_of_wedge(position_in_texels)));
}

// Lines from the cell's point to those of its neighbours cut it into four wedges, one per corner, which is a texel's
// centre.
fn corner_of_wedge(position_in_texels: vec2f) -> vec2i {
    let in_cells = position_in_texels - 0.5;
    let cell = vec2i(floor(in_cells));
    let own = point_of(cell);
    let left = point_of(cell + vec2i(-1, 0)) + vec2f(-1.0, 0.0) - own;
    let top = point_of(cell + vec2i(0, -1)) + vec2f(0.0, -1.0) - own;
    let right = point_of(cell + vec2i(1, 0)) + vec2f(1.0, 0.0) - own;
    let bottom = point_of(cell + vec2i(0, 1)) + vec2f(0.0, 1.0) - own;
    let place = in_cells - vec2f(cell) - own;
    if is_in_wedge(left, top, place) {
        return cell;
    }
    if is_in_wedge(top, right, place) {
        return cell + vec2i(1, 0);
    }
    if is_in_wedge(right, bottom, place) {
        return cell + vec2i(1, 1);
    }
    return cell + vec2i(0, 1);
}

// The silhouette's point of a cell, within it; its centre where it has none.
fn point_of(cell: vec2i) -> vec2f {
    if any(cell < vec2i(0)) || any(cell >= vec2i(textureDimensions(silhouettes))) {
        return vec2f(0.5);
    }
    let stored = textureLoad(silhouettes, cell, 0).xy;
    return select(stored, vec2f(0.5), stored.x > 1.0);
}

// Whether a direction lies between two others, turning from the first to the second as from x to y.
fn is_in_wedge(first: vec2f, second: vec2f, place: vec2f) -> bool {
    if turn(first, second) >= 0.0 {
        return turn(first, place) >= 0.0 && turn(place, second) >= 0.0;
    }
    return !(turn(second, place) > 0.0 && turn(place, first) > 0.0);
}

fn turn(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}
