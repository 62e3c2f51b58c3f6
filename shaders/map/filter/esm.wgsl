// Twin of src/technique/map/filter/esm.rs.

fn moments_of(z: f32) -> vec4f {
    return vec4f(exp(numbers[1].x * z), 0.0, 0.0, 0.0);
}

fn bound(z: f32, mean: vec4f) -> f32 {
    return mean.x * exp(-numbers[1].x * z);
}
