// How much can lie at z or beyond, of what has that mean and variance. Twin of src/technique/map/filter/moments.rs.

fn chebyshev(z: f32, mean: f32, variance: f32) -> f32 {
    return select(variance / (variance + (z - mean) * (z - mean)), 1.0, z <= mean);
}
