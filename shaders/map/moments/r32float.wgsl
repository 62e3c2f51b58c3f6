// Moments as 32-bit floats: the texture that is written and the largest number it holds.

@group(0) @binding(1) var written: texture_storage_2d_array<r32float, write>;
const LARGEST: f32 = 3.4028234e38;
