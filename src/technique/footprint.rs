//! How large a shadow-map texel appears in the picture.
//!
//! B. Lloyd et al., "Warping and Partitioning for Low Error Shadow Maps", 2006: m is the largest extent of a texel's
//! image in pixels; m > 1 is undersampled. Formulas: docs/footprint.md.

use crate::cause::Cause;
use glam::{DMat4, DVec2, DVec3, UVec2};

/// The footprint of one texel at one receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Texel coordinates of the receiver.
    pub position_in_texels: DVec2,
    /// The texel's sides along u and along v in the picture, pixels, y down.
    pub sides_px: [DVec2; 2],
    /// Largest extent of the texel's sides in the picture, pixels.
    pub m: f64,
    /// Longest diagonal of the texel in the picture, pixels.
    pub m_diagonal: f64,
    /// Texel width over pixel width, distances alone.
    pub perspective_factor: f64,
    /// cos(view angle) / cos(light angle): what the tilt adds.
    pub projective_factor: f64,
}

/// What a footprint is computed from.
#[derive(Debug, Clone, Copy)]
pub struct FootprintInput<'a> {
    /// Camera matrix.
    pub clip_from_world: &'a DMat4,
    /// Picture size in pixels.
    pub image_size: UVec2,
    /// Where the receiver lies in its view of the map.
    pub position_in_texels: DVec2,
    /// World steps on the receiver's plane that move by one texel along u and along v.
    pub texel_steps_m: [DVec3; 2],
    /// Receiver point.
    pub point_in_world: DVec3,
    /// Unit geometric normal.
    pub normal_in_world: DVec3,
    /// Unit vector towards the eye.
    pub towards_eye: DVec3,
    /// Unit vector towards the light.
    pub towards_light: DVec3,
    /// Largest texel width at the receiver, metres, across the light's rays.
    pub texel_m: f64,
    /// Pixel height at the receiver, metres, across the view ray.
    pub pixel_m: f64,
}

impl Footprint {
    /// `None` where the light sees the surface edge-on, so that a texel's image has no bound.
    #[must_use]
    pub fn new(input: &FootprintInput<'_>) -> Option<Self> {
        let half_image = 0.5 * input.image_size.as_dvec2() * DVec2::new(1.0, -1.0);
        let at = *input.clip_from_world * input.point_in_world.extend(1.0);
        let [u, v] = input.texel_steps_m.map(|step| {
            let moved = *input.clip_from_world * step.extend(0.0);
            let change = (moved.truncate().truncate() * at.w - at.truncate().truncate() * moved.w) / (at.w * at.w);
            change * half_image
        });
        if !(u.is_finite() && v.is_finite()) {
            return None;
        }
        let cosine = |direction: DVec3| input.normal_in_world.dot(direction).abs();
        Some(Self {
            position_in_texels: input.position_in_texels,
            sides_px: [u, v],
            m: u.length().max(v.length()),
            m_diagonal: (u + v).length().max((u - v).length()),
            perspective_factor: input.texel_m / input.pixel_m,
            projective_factor: cosine(input.towards_eye) / cosine(input.towards_light),
        })
    }
}

/// Which kind of aliasing a wrong texel with that footprint is.
#[must_use]
pub fn aliasing_cause(footprint: Option<&Footprint>) -> Cause {
    match footprint {
        Some(footprint) if footprint.m > 1.0 => {
            if footprint.perspective_factor >= footprint.projective_factor {
                Cause::PerspectiveAliasing
            } else {
                Cause::ProjectiveAliasing
            }
        }
        Some(_) => Cause::EdgeAliasing,
        // Seen edge-on by the light, a texel's image has no bound: the tilt is to blame.
        None => Cause::ProjectiveAliasing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dcamera::rh;

    const IMAGE: UVec2 = UVec2::new(640, 480);
    const HEIGHT_M: f64 = 10.0;
    const WIDTH_M: f64 = 8.0;

    /// A camera straight above a floor tilted by `tilt` radians, a parallel light straight above too.
    fn footprint(tilt: f64) -> Footprint {
        let eye = DVec3::Y * HEIGHT_M;
        let view = rh::view::look_at_mat4(eye, DVec3::ZERO, DVec3::NEG_Z);
        let aspect = f64::from(IMAGE.x) / f64::from(IMAGE.y);
        let clip_from_world = rh::proj::directx::perspective_infinite_reverse(1.0, aspect, 0.1) * view;
        let texel_m = WIDTH_M / 512.0;
        // Straight down onto the tilted plane: a step along x climbs.
        let texel_steps_m = [DVec3::new(texel_m, -texel_m * tilt.tan(), 0.0), DVec3::new(0.0, 0.0, texel_m)];
        let pixel_m = 2.0 * 0.5_f64.tan() / f64::from(IMAGE.y) * HEIGHT_M;
        Footprint::new(&FootprintInput {
            clip_from_world: &clip_from_world,
            image_size: IMAGE,
            position_in_texels: DVec2::splat(256.0),
            texel_steps_m,
            point_in_world: DVec3::ZERO,
            normal_in_world: DVec3::new(tilt.sin(), tilt.cos(), 0.0),
            towards_eye: DVec3::Y,
            towards_light: DVec3::Y,
            texel_m,
            pixel_m,
        })
        .unwrap()
    }

    #[test]
    fn aligned_light_and_view_give_the_ratio_of_widths_at_any_tilt() {
        for tilt in [0.0, 0.3, 1.2] {
            let footprint = footprint(tilt);
            assert!((footprint.m - footprint.perspective_factor).abs() < 1e-9 * footprint.m, "{footprint:?}");
            assert!((footprint.projective_factor - 1.0).abs() < 1e-12);
        }
    }
}
