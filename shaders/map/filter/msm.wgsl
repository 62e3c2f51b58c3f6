// Twin of src/technique/map/filter/msm.rs.

fn moments_of(z: f32) -> vec4f {
    let squared = z * z;
    return vec4f(z, squared, squared * z, squared * squared);
}

fn bound(z: f32, mean: vec4f) -> f32 {
    let b = mix(mean, vec4f(0.5), numbers[1].x);
    // [1 b.x b.y; b.x b.y b.z; b.y b.z b.w] c = (1, z, z²), by L D Lᵀ.
    let d2 = b.y - b.x * b.x;
    let l32 = (b.z - b.x * b.y) / d2;
    let d3 = b.w - b.y * b.y - l32 * l32 * d2;
    let hard = select(0.0, 1.0, z <= mean.x);
    if d2 <= 0.0 || d3 <= 0.0 {
        return hard;
    }
    let c2_forward = z - b.x;
    let c3 = (z * z - b.y - l32 * c2_forward) / d3;
    let c2 = c2_forward / d2 - l32 * c3;
    let c1 = 1.0 - b.x * c2 - b.y * c3;
    let middle = -0.5 * c2 / c3;
    let squared = middle * middle - c1 / c3;
    if squared <= 0.0 {
        return hard;
    }
    let z2 = middle - sqrt(squared);
    let z3 = middle + sqrt(squared);
    if z <= z2 {
        return 1.0;
    }
    if z <= z3 {
        return 1.0 - (z * z3 - b.x * (z + z3) + b.y) / ((z3 - z2) * (z - z2));
    }
    return (z2 * z3 - b.x * (z2 + z3) + b.y) / ((z - z2) * (z - z3));
}
