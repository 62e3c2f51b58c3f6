//! What a map texel stores, and how finely.

/// A depth format of shadow maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthFormat {
    /// 16-bit fixed point.
    Depth16Unorm,
    /// 24-bit fixed point, or what the driver puts in its place.
    Depth24Plus,
    /// 32-bit float.
    Depth32Float,
}

impl DepthFormat {
    /// Distance between two stored depths near `depth`.
    #[must_use]
    pub fn step(self, depth: f64) -> f64 {
        match self {
            Self::Depth16Unorm => 1.0 / f64::from(u16::MAX),
            Self::Depth24Plus => 1.0 / f64::from((1_u32 << 24) - 1),
            // The spacing of f32 below 2^(e+1) is 2^(e-23), at most |depth| 2^-23.
            Self::Depth32Float => depth.abs().max(f64::from(f32::MIN_POSITIVE)) * f64::from(f32::EPSILON),
        }
    }

    /// What one unit of the rasteriser's constant bias adds to a primitive whose largest depth is `max_depth`.
    /// Fixed-point units vary by driver; on the ones measured a 16-bit unit is two steps.
    #[must_use]
    pub fn hardware_unit(self, max_depth: f64) -> f64 {
        match self {
            Self::Depth16Unorm => 2.0_f64.powi(-15),
            Self::Depth24Plus => 2.0_f64.powi(-24),
            Self::Depth32Float => {
                // Exponent of the rounded depth, from its bits: 2^(e-23) exactly.
                let exponent = ((max_depth.abs() as f32).max(f32::MIN_POSITIVE).to_bits() >> 23) as i32 - 127;
                2.0_f64.powi(exponent - 23)
            }
        }
    }

    pub(crate) fn texture_format(self) -> wgpu::TextureFormat {
        match self {
            Self::Depth16Unorm => wgpu::TextureFormat::Depth16Unorm,
            Self::Depth24Plus => wgpu::TextureFormat::Depth24Plus,
            Self::Depth32Float => wgpu::TextureFormat::Depth32Float,
        }
    }

    /// Bytes per texel.
    #[must_use]
    pub fn bytes(self) -> u64 {
        if self == Self::Depth16Unorm { 2 } else { 4 }
    }
}

#[cfg(test)]
mod tests {
    use super::DepthFormat;

    #[test]
    fn float_units_follow_the_exponent() {
        assert_eq!(DepthFormat::Depth32Float.hardware_unit(0.9), 2.0_f64.powi(-24));
        assert_eq!(DepthFormat::Depth32Float.hardware_unit(0.3), 2.0_f64.powi(-25));
    }

    #[test]
    fn a_float_step_is_never_below_the_spacing() {
        for depth in [1e-6_f32, 0.3, 0.5, 0.999] {
            let spacing = f64::from(depth.next_up()) - f64::from(depth);
            assert!(DepthFormat::Depth32Float.step(depth.into()) >= spacing);
        }
    }
}
