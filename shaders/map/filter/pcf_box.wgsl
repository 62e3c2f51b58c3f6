// Twin of src/technique/map/filter/pcf_box.rs.

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let n = i32(lookup.kernel);
    var first = vec2i(floor(position_in_texels)) - (n - 1) / 2;
    if n % 2 == 0 {
        first = vec2i(floor(position_in_texels + 0.5)) - n / 2;
    }
    // Counted in integers: exact for every kernel.
    var lit = 0u;
    for (var row = 0; row < n; row++) {
        for (var column = 0; column < n; column++) {
            lit += u32(is_lit(reference, first + vec2i(column, row)));
        }
    }
    return f32(lit) / f32(n * n);
}
