//! The bias axis: what keeps a surface from shadowing itself. Every bias comes down to the same amounts, applied in one
//! place each: the rasteriser's constant and slope and the midpoint while the map is drawn, the rest at the receiver.
//!
//! Adding one: a file here and a line in [`registry`]. Units and derivations: docs/map.md#bias.

mod closed_form;
mod constant;
mod midpoint;
mod none;
mod normal;
mod receiver_plane;
mod slope;

/// Every bias.
#[must_use]
pub fn registry() -> &'static [&'static dyn Bias] {
    &[
        &none::None,
        &constant::Constant,
        &slope::Slope,
        &normal::Normal,
        &receiver_plane::ReceiverPlane,
        &closed_form::ClosedForm,
        &midpoint::Midpoint,
    ]
}

/// A way to choose the amounts.
pub trait Bias: Sync {
    /// Its name in specifications.
    fn name(&self) -> &'static str;
    /// The amounts for the numbers typed and a filter that needs `bias_kernel` texel widths of slope.
    fn amounts(&self, numbers: &Numbers, bias_kernel: f64) -> Amounts;
}

/// The numeric bias parameters as typed; `None` is `auto`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// Rasteriser's constant units.
    pub constant_units: Option<f64>,
    /// Rasteriser's slope factor.
    pub slope: Option<f64>,
    /// Largest rasteriser bias in depth, 0 for no limit.
    pub clamp: f64,
    /// Metres along the light.
    pub depth_m: f64,
    /// Texel widths along the light.
    pub depth_texels: f64,
    /// Normal offset in texels at a tilt of 90 degrees.
    pub normal_texels: f64,
    /// Cap of what is derived from the receiver's plane, texels.
    pub cap_texels: f64,
}

/// What keeps a receiver's plane clear of its own samples; the numbers are the shader's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clearance {
    /// Nothing.
    None = 0,
    /// The comparison is moved along the light by what the plane rises within the kernel.
    ClosedForm = 1,
    /// The receiver is moved along its normal until its plane clears the kernel.
    Normal = 2,
    /// Every tap is compared with the plane's own depth at the texel's centre.
    ReceiverPlane = 3,
    /// Every texel stores the middle between the two nearest surfaces.
    Midpoint = 4,
}

/// What is applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amounts {
    /// Rasteriser's constant units, away from the light.
    pub constant_units: i32,
    /// Rasteriser's slope factor, away from the light.
    pub slope: f64,
    /// Largest rasteriser bias in depth, 0 for no limit.
    pub clamp: f64,
    /// What is derived from the receiver's plane.
    pub clearance: Clearance,
    /// How many texel widths of its slope that has to clear.
    pub kernel: f64,
    /// Cap of what is derived from the receiver's plane, texels.
    pub cap_texels: f64,
    /// Metres along the light at the receiver.
    pub depth_m: f64,
    /// Texel widths along the light at the receiver.
    pub depth_texels: f64,
    /// Normal offset of the receiver in texels at a tilt of 90 degrees.
    pub normal_texels: f64,
}

impl Amounts {
    /// No bias at all.
    pub const NONE: Self = Self {
        constant_units: 0,
        slope: 0.0,
        clamp: 0.0,
        clearance: Clearance::None,
        kernel: 0.0,
        cap_texels: 0.0,
        depth_m: 0.0,
        depth_texels: 0.0,
        normal_texels: 0.0,
    };
}

impl Numbers {
    /// The amounts typed, with these in place of `auto` for the rasteriser, and nothing derived.
    fn amounts_with(&self, auto_units: f64, auto_slope: f64) -> Amounts {
        Amounts {
            constant_units: self.constant_units.unwrap_or(auto_units).round() as i32,
            slope: self.slope.unwrap_or(auto_slope),
            clamp: self.clamp,
            clearance: Clearance::None,
            kernel: 0.0,
            cap_texels: self.cap_texels,
            depth_m: self.depth_m,
            depth_texels: self.depth_texels,
            normal_texels: self.normal_texels,
        }
    }

    /// The amounts typed, and what clears a receiver's plane of a filter's kernel.
    fn amounts_that_clear(&self, clearance: Clearance, bias_kernel: f64) -> Amounts {
        Amounts { clearance, kernel: bias_kernel, ..self.amounts_with(0.0, 0.0) }
    }
}

/// A registered bias; the first one for a name that no declared parameter can hold.
#[must_use]
pub fn by_name(name: &str) -> &'static dyn Bias {
    registry().iter().copied().find(|bias| bias.name() == name).unwrap_or(registry()[0])
}

/// What `auto` means for the rasteriser's constant where a bias has one.
const AUTO_UNITS: f64 = 2.0;
/// What `auto` means for the rasteriser's slope where a bias has one: always enough for one tap.
const AUTO_SLOPE: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;

    const UNTYPED: Numbers = Numbers {
        constant_units: None,
        slope: None,
        clamp: 0.0,
        depth_m: 0.0,
        depth_texels: 0.0,
        normal_texels: 0.0,
        cap_texels: 64.0,
    };

    #[test]
    fn auto_amounts_follow_the_axis() {
        let hardware = |name| {
            let amounts = by_name(name).amounts(&UNTYPED, 0.5);
            (amounts.constant_units, amounts.slope, amounts.clearance, amounts.kernel)
        };
        assert_eq!(hardware("none"), (0, 0.0, Clearance::None, 0.0));
        assert_eq!(hardware("constant"), (2, 0.0, Clearance::None, 0.0));
        assert_eq!(hardware("slope"), (2, 1.0, Clearance::None, 0.0));
        assert_eq!(hardware("normal"), (0, 0.0, Clearance::Normal, 0.5));
        assert_eq!(hardware("receiver-plane"), (0, 0.0, Clearance::ReceiverPlane, 0.5));
        assert_eq!(hardware("midpoint"), (0, 0.0, Clearance::Midpoint, 0.5));
        assert_eq!(hardware("closed-form"), (0, 0.0, Clearance::ClosedForm, 0.5));
    }

    #[test]
    fn typed_numbers_add_to_every_axis_and_zero_stays_zero() {
        let typed = Numbers { constant_units: Some(0.0), slope: Some(3.0), ..UNTYPED };
        for bias in registry() {
            let amounts = bias.amounts(&typed, 0.5);
            assert_eq!((amounts.constant_units, amounts.slope), (0, 3.0), "{}", bias.name());
        }
    }
}
