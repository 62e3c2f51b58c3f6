// The lookup of a moment filter, whose own file defines `bound`: the means of four neighbours, weighed by how near the
// receiver is to their middles. Twin of src/technique/map/means.rs.

@group(0) @binding(6) var means: texture_2d_array<f32>;

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let n = i32(numbers[0].x);
    let start = position_in_texels - 0.5 * f32(n);
    let part = fract(start);
    let first = vec2i(floor(start)) + (n + 1) / 2;
    let upper = mix(mean_at(first), mean_at(first + vec2i(1, 0)), part.x);
    let lower = mix(mean_at(first + vec2i(0, 1)), mean_at(first + vec2i(1, 1)), part.x);
    let mean = mix(upper, lower, part.y);
    let most = bound(z_of(reference), mean);
    if any(is_infinite(mean)) || is_infinite(vec4f(most)).x {
        return 1.0;
    }
    let cut = numbers[1].w;
    return clamp((most - cut) / (1.0 - cut), 0.0, 1.0);
}

// By its bits, since compilers may take every number for finite. Not a number counts, too.
fn is_infinite(value: vec4f) -> vec4<bool> {
    return (bitcast<vec4u>(value) & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
}

fn mean_at(texel: vec2i) -> vec4f {
    return textureLoad(means, texel, own.view, 0);
}
