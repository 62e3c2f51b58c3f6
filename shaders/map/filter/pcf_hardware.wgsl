// Bilinear lookups by a comparing sampler. Twin of src/technique/map/filter/pcf_hardware.rs.

@group(0) @binding(7) var comparing: sampler_comparison;

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let n = i32(lookup.kernel);
    let start = position_in_texels - 0.5 * f32(n);
    var lit = 0.0;
    for (var row = 0; row < n; row++) {
        for (var column = 0; column < n; column++) {
            lit += sampled(start + vec2f(vec2i(column, row)), reference);
        }
    }
    return lit / f32(n * n);
}

// The four texels from the one that holds `corner` onwards, by how far within it that lies.
fn sampled(corner: vec2f, reference: f32) -> f32 {
    let texel = vec2i(floor(corner));
    if is_in_view(texel) && is_in_view(texel + 1) {
        let uv = (corner + 0.5) / lookup.texels;
        return textureSampleCompareLevel(stored_depths, comparing, uv, own.view, reference);
    }
    let part = fract(corner);
    let upper = mix(answer(reference, texel), answer(reference, texel + vec2i(1, 0)), part.x);
    let lower = mix(answer(reference, texel + vec2i(0, 1)), answer(reference, texel + vec2i(1, 1)), part.x);
    return mix(upper, lower, part.y);
}

fn answer(reference: f32, texel: vec2i) -> f32 {
    return f32(is_lit(reference, texel));
}
