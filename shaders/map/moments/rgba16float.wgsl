// Moments as 16-bit floats: the texture that is written and the largest number it holds.

@group(0) @binding(1) var written: texture_storage_2d_array<rgba16float, write>;
const LARGEST: f32 = 65504.0;
