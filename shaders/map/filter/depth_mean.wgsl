// Twin of src/technique/map/filter/depth_mean.rs.

fn moments_of(z: f32) -> vec4f {
    return vec4f(z, 0.0, 0.0, 0.0);
}

fn bound(z: f32, mean: vec4f) -> f32 {
    return select(0.0, 1.0, z <= mean.x);
}
