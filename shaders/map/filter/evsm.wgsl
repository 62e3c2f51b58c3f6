// Twin of src/technique/map/filter/evsm.rs.

fn moments_of(z: f32) -> vec4f {
    let warped = warps(z);
    return vec4f(warped.x, warped.x * warped.x, warped.y, warped.y * warped.y);
}

fn bound(z: f32, mean: vec4f) -> f32 {
    let warped = warps(z);
    let per_z = 2.0 * numbers[1].xy * abs(warped);
    let least = numbers[1].z * per_z * per_z;
    let variance = max(vec2f(mean.y - mean.x * mean.x, mean.w - mean.z * mean.z), least);
    return min(chebyshev(warped.x, mean.x, variance.x), chebyshev(warped.y, mean.z, variance.y));
}

fn warps(z: f32) -> vec2f {
    let around_zero = 2.0 * z - 1.0;
    return vec2f(exp(numbers[1].x * around_zero), -exp(-numbers[1].y * around_zero));
}
