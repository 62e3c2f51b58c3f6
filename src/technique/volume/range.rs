//! The depths that a light's range can reach, as a flag in the stencil: what other interfaces do by a depth bounds test.
//!
//! E. Lengyel, "The Mechanics of Robust Stencil Shadows", 2002. The test is about the depth that is *seen* at a pixel,
//! so two triangles over the whole picture, one at either bound, set and clear the stencil's highest bit by their own
//! depth test; volumes are then drawn only where it is set. Formulas: docs/volume.md#range-mask.

use super::eye::Eye;
use crate::scene::Light;

/// The stencil's bit that says "in range".
pub(super) const FLAG: u8 = 0x80;

/// The bounds give way by this share, far more than depth is rounded by.
const SLACK: f64 = 1e-3;

/// View distances from which to which a light's range may reach, metres; from 0 to infinity for a directional light and
/// one without a range.
pub(super) fn distances_m(light: &Light, eye: &Eye) -> [f64; 2] {
    let homogeneous = light.homogeneous();
    if homogeneous.w == 0.0 || light.range_m.is_infinite() {
        return [0.0, f64::INFINITY];
    }
    let centre_m = eye.distance_m(homogeneous.truncate());
    let slack_m = SLACK * (centre_m.abs() + light.range_m);
    [centre_m - light.range_m - slack_m, centre_m + light.range_m + slack_m]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{cube, point_light, scene_of};
    use crate::technique::Spec;
    use crate::technique::volume::settings::Settings;
    use glam::{DVec3, Vec3};

    #[test]
    fn a_range_reaches_before_and_behind_its_light() {
        let scene = scene_of(&[cube(DVec3::ZERO)]);
        let eye = Eye::new(&scene, &Settings::of(&Spec::parse("volume").unwrap())).unwrap();
        let light = Light { range_m: 1.0, ..point_light(Vec3::ZERO) };
        let centre_m = eye.distance_m(DVec3::ZERO);
        let [from, to] = distances_m(&light, &eye);
        assert!(from < centre_m - 1.0 && to > centre_m + 1.0 && to - from < 2.1, "{from} {to}");
        let endless = Light { range_m: f64::INFINITY, ..light };
        assert_eq!(distances_m(&endless, &eye), [0.0, f64::INFINITY]);
    }
}
