// Twin of src/technique/map/filter/vsm.rs.

fn moments_of(z: f32) -> vec4f {
    return vec4f(z, z * z, 0.0, 0.0);
}

fn bound(z: f32, mean: vec4f) -> f32 {
    let min_variance = numbers[1].x;
    return chebyshev(z, mean.x, max(mean.y - mean.x * mean.x, min_variance));
}
