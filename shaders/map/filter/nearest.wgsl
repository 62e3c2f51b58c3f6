// Twin of src/technique/map/filter/nearest.rs.

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    return f32(is_lit(reference, vec2i(floor(position_in_texels))));
}
