// Twin of src/technique/map/filter/pcf_edge_masked.rs.

// Nearest and farthest depth of every block of texels.
@group(0) @binding(6) var extremes: texture_2d_array<f32>;

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let n = i32(lookup.kernel);
    var first = vec2i(floor(position_in_texels)) - (n - 1) / 2;
    if n % 2 == 0 {
        first = vec2i(floor(position_in_texels + 0.5)) - n / 2;
    }
    let last = first + n - 1;
    // Beyond the view, and where every texel has a reference of its own, all are compared.
    if is_in_view(first) && is_in_view(last) && all(own.reference_per_texel == vec2f(0.0)) {
        let around = extremes_of(first, last);
        let sign = views[own.view].depth_sign;
        if sign * (reference - around.x) <= 0.0 {
            return 1.0;
        }
        if sign * (reference - around.y) > 0.0 {
            return 0.0;
        }
    }
    var lit = 0u;
    for (var row = first.y; row <= last.y; row++) {
        for (var column = first.x; column <= last.x; column++) {
            lit += u32(is_lit(reference, vec2i(column, row)));
        }
    }
    return f32(lit) / f32(n * n);
}

// The nearest and the farthest depth in the blocks that hold a window.
fn extremes_of(first: vec2i, last: vec2i) -> vec2f {
    let sign = views[own.view].depth_sign;
    let low = first >> vec2u(lookup.mask_level);
    let high = last >> vec2u(lookup.mask_level);
    var around = textureLoad(extremes, low, own.view, 0).xy;
    for (var row = low.y; row <= high.y; row++) {
        for (var column = low.x; column <= high.x; column++) {
            let block = textureLoad(extremes, vec2i(column, row), own.view, 0).xy;
            around = select(vec2f(max(around.x, block.x), min(around.y, block.y)),
                vec2f(min(around.x, block.x), max(around.y, block.y)), sign > 0.0);
        }
    }
    return around;
}
