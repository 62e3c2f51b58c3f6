// Twin of src/technique/map/filter/pcf_bilinear.rs.

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let n = i32(lookup.kernel);
    let start = position_in_texels - 0.5 * f32(n);
    let first = floor(start);
    let part = start - first;
    var lit = 0.0;
    var dark = 0.0;
    for (var row = 0; row <= n; row++) {
        for (var column = 0; column <= n; column++) {
            let weight = rim_weight(column, n, part.x) * rim_weight(row, n, part.y);
            if is_lit(reference, vec2i(first) + vec2i(column, row)) {
                lit += weight;
            } else {
                dark += weight;
            }
        }
    }
    // The weights add up to n², but for rounding, which must not dim a kernel that is lit all over.
    return select(lit / (lit + dark), 1.0, dark == 0.0);
}

fn rim_weight(step: i32, n: i32, part: f32) -> f32 {
    if step == 0 {
        return 1.0 - part;
    }
    return select(1.0, part, step == n);
}
