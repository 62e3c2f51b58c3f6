// A receiver as a sample of the light's view. Twin of `GpuSample` in src/technique/irregular/samples.rs.

struct Sample {
    // The receiver's point is the sum of two, exact to 2^-48 of itself.
    point_high: vec3f,
    // The triangle that stands for its own surface.
    own: u32,
    point_low: vec3f,
    face: u32,
}
