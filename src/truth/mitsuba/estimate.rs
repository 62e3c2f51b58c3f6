//! The counted share of an area light against an estimate that shares nothing with the count but the measure: Mitsuba
//! draws its own points, uniform in area, and tests per pixel whether the two can both be right (docs/oracle.md#area).

use super::blocks::Writer;
use super::{Mitsuba, MitsubaError};
use crate::cast::Casters;
use crate::mask::{Truth, TruthMask};
use crate::receiver::{Receiver, Receivers};
use crate::scene::{Light, LightKind, Scene};
use crate::truth::cross_check::spread;
use glam::DVec3;
use serde_json::json;

/// Points drawn for each receiver: their standard error is at most 1/45.
const DRAWS: u32 = 512;
/// Pixels tested at most, spread evenly over all: with their draws that takes some seconds.
const PIXELS: usize = 1 << 14;
/// The chance that any pixel at all is rejected although everything is right.
const ALPHA: f64 = 0.01;
/// Edges of occluders that may cross the light as seen from one receiver before the count's error bound is exceeded:
/// a post between the light and the receiver has two.
const EDGES: f64 = 2.0;

/// What came of the test.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Points drawn for each pixel.
    pub draws: u32,
    /// The chance of any false rejection.
    pub alpha: f64,
    /// What the fixed points of the count are granted.
    pub discrepancy: f64,
    /// Pixels tested.
    pub tested: u64,
    /// Pixels (`y * width + x`) at which count and estimate cannot both be right, ascending.
    pub rejected: Vec<u32>,
}

/// Error of a share counted over `samples` fixed points: docs/truth.md#area-lights, times `EDGES`.
#[must_use]
pub fn discrepancy(samples: usize) -> f64 {
    EDGES * 0.5 / (samples as f64).sqrt()
}

impl Mitsuba {
    /// Tests the shares that `truth` knows; `None` for a light without extent.
    ///
    /// # Errors
    /// [`MitsubaError`].
    pub fn estimate(
        &mut self,
        scene: &Scene,
        casters: &Casters,
        light: &Light,
        receivers: &Receivers,
        truth: &TruthMask,
    ) -> Result<Option<Estimate>, MitsubaError> {
        let centre = light.homogeneous().truncate();
        let (centre, radius_m, half_sides, samples) = match light.kind {
            LightKind::Rectangle { half_width, half_height, samples, .. } => {
                (centre, 0.0, vec![half_width, half_height], samples)
            }
            LightKind::Sphere { radius_m, samples, .. } => (centre, radius_m.into(), Vec::new(), samples),
            LightKind::Sun { angular_radius_rad, samples, .. } => {
                // Beyond all geometry, from wherever it is seen.
                let far_m = 4.0 * scene.bounds().radius();
                (centre * far_m, angular_radius_rad.tan() * far_m, Vec::new(), samples)
            }
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Spot { .. } => return Ok(None),
        };
        let known: Vec<(u32, Receiver, f64)> = (0..)
            .zip(&receivers.pixels)
            .zip(&truth.pixels)
            .filter_map(|((pixel, receiver), truth)| match truth {
                Some(Truth::Known(share)) => Some((pixel, (*receiver)?, f64::from(share.get()))),
                Some(Truth::Undecided) | None => None,
            })
            .collect();
        let known: Vec<_> = spread(known.len(), PIXELS).into_iter().map(|index| known[index]).collect();
        let discrepancy = discrepancy(samples as usize);
        let vectors = |of: fn(&Receiver) -> DVec3| known.iter().flat_map(move |(_, r, _)| of(r).to_array());
        let about = json!({
            "task": "estimate", "centre": centre.to_array(), "is_from_receiver": light.homogeneous().w == 0.0,
            "radius_m": radius_m, "draws": DRAWS, "seed": 1, "discrepancy": discrepancy, "alpha": ALPHA,
        });
        let job = Writer::new(about)
            .f64s("half_sides", half_sides.iter().flat_map(|half| half.as_dvec3().to_array()), &[3])
            .f64s("receivers", vectors(|receiver| receiver.point_in_world), &[3])
            .f64s("normals", vectors(|receiver| receiver.normal_in_world), &[3])
            .f64s("share", known.iter().map(|(_, _, share)| *share), &[])
            .u32s("own", known.iter().map(|(_, receiver, _)| casters.surface_of(receiver.triangle)));
        let answer = self.process.ask(job)?;
        let flags = answer.u8s("rejected", known.len()).map_err(MitsubaError::Answer)?;
        let rejected = known.iter().zip(flags).filter(|(_, flag)| **flag != 0).map(|((pixel, ..), _)| *pixel).collect();
        Ok(Some(Estimate { draws: DRAWS, alpha: ALPHA, discrepancy, tested: known.len() as u64, rejected }))
    }
}
