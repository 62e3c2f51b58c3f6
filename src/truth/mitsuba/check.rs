//! Every shadow ray of the exact truth again, by Mitsuba, and each on which the two differ. Rays go from the light to
//! the receiver, because Mitsuba can neither skip a triangle nor start behind its origin; far lights' rays start where
//! they enter the scene, so that f32 keeps its resolution.

use super::blocks::Writer;
use super::reason::{Reason, reason};
use super::{Estimate, Mitsuba, MitsubaError};
use crate::cast::{Casters, Occlusion, brute};
use crate::mask::{Truth, TruthMask, Visibility};
use crate::receiver::{PixelClass, Receiver, Receivers};
use crate::scene::{Bounds, Emitter, Light, Scene, Segment};
use crate::truth::{asked, of_points, of_receiver};
use crate::watch::{Interrupted, Watch};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;
use std::time::Instant;

/// Rays a job: a job of this size is 120 MB and takes Mitsuba a tenth of a second.
const RAYS_PER_JOB: usize = 1 << 21;
/// What Mitsuba says of a ray; the twins of these stand in `oracle/gnomon_oracle/rays.py`.
const BLOCKED: u8 = 0;
const CONTACT: u8 = 2;
const NOTHING: u32 = u32::MAX;

/// What came of asking Mitsuba about one light.
#[derive(Debug, Clone, PartialEq)]
pub struct MitsubaCheck {
    /// Who answered: version and variant.
    pub version: String,
    /// Its answer for every asked pixel.
    pub mask: TruthMask,
    /// Shadow rays that it was asked about.
    pub rays: u64,
    /// Rays on which the exact truth, where it is decided, says otherwise, and all contacts.
    pub listed: Vec<ListedRay>,
    /// For an area light: what came of testing the counted shares against an independent estimate.
    pub estimate: Option<Estimate>,
    /// Wall-clock time, milliseconds.
    pub ms: f64,
}

/// What Mitsuba says of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Another surface than the receiver's comes first.
    Blocked,
    /// The receiver's own surface comes first, or none.
    Clear,
    /// Another surface comes first, but so close to the receiver that f32 cannot tell the two; counted as lit.
    Contact,
}

/// A ray on which Mitsuba and the exact truth differ, or that Mitsuba cannot decide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ListedRay {
    /// `y * width + x`.
    pub pixel: u32,
    /// Which point of the light, counted as [`Emitter`] does.
    pub point: u32,
    /// From the receiver to the light.
    pub segment: Segment,
    /// Whether the exact truth says that it is blocked.
    pub blocked: bool,
    /// What Mitsuba says.
    pub mitsuba: Verdict,
    /// Why.
    pub reason: Reason,
    /// Whether exact arithmetic on every triangle confirms the exact truth. At a contact it need not: what continues the
    /// receiver's triangle in its plane blocks by the definition, and is no other surface by the truth's rule.
    pub confirmed: bool,
}

impl ListedRay {
    /// Whether the two differ. A contact is no disagreement: Mitsuba has no opinion.
    #[must_use]
    pub fn is_disagreement(&self) -> bool {
        !matches!(self.reason, Reason::Contact { .. })
    }
}

impl MitsubaCheck {
    /// The rays on which the two differ.
    pub fn disagreements(&self) -> impl Iterator<Item = &ListedRay> {
        self.listed.iter().filter(|ray| ray.is_disagreement())
    }

    /// How many rays Mitsuba cannot decide.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.listed.len() - self.disagreements().count()
    }
}

/// One shadow ray as Mitsuba gets it.
#[derive(Debug, Clone, Copy)]
struct ShadowRay {
    pixel: u32,
    point: u32,
    segment: Segment,
    own: u32,
    exact: Occlusion,
}

impl Mitsuba {
    /// Asks about every ray of every asked pixel; `scene` and `casters` are those that it holds.
    ///
    /// # Errors
    /// [`MitsubaError`].
    pub fn check(
        &mut self,
        scene: &Scene,
        casters: &Casters,
        light: &Light,
        receivers: &Receivers,
        classes: &[PixelClass],
        watch: &dyn Watch,
    ) -> Result<MitsubaCheck, MitsubaError> {
        let start = Instant::now();
        let emitter = Emitter::new(light);
        let caster = RayCaster { scene, casters, light, emitter: &emitter, bounds: scene.bounds() };
        let pixels: Vec<(u32, Receiver)> =
            (0..receivers.pixels.len()).filter_map(|i| Some((i as u32, asked(receivers, classes, i)?))).collect();
        let mut seen = vec![0_u32; receivers.pixels.len()];
        let (mut rays, mut listed) = (0, Vec::new());
        watch.start("Mitsuba", pixels.len() as u64);
        for batch in pixels.chunks((RAYS_PER_JOB / emitter.count()).max(1)) {
            if watch.interrupted() {
                return Err(Interrupted.into());
            }
            let batch_rays: Vec<ShadowRay> =
                batch.par_iter().flat_map_iter(|(pixel, receiver)| caster.rays(*pixel, receiver)).collect();
            let (verdicts, met) = self.ask_rays(&caster, &batch_rays)?;
            for (ray, verdict) in batch_rays.iter().zip(&verdicts) {
                seen[ray.pixel as usize] += u32::from(*verdict != Verdict::Blocked);
            }
            rays += batch_rays.len() as u64;
            let worth_listing = (0..batch_rays.len()).into_par_iter().filter_map(|i| {
                let met = self.triangles.get(met[i] as usize).copied().filter(|_| met[i] != NOTHING);
                caster.listed(&batch_rays[i], verdicts[i], met, self.unit_m)
            });
            listed.extend(worth_listing.collect::<Vec<_>>());
            watch.advance(batch.len() as u64);
        }
        let share = |pixel: u32| Visibility::new((f64::from(seen[pixel as usize]) / emitter.count() as f64) as f32);
        let mut answers = vec![None; receivers.pixels.len()];
        for (pixel, _) in &pixels {
            answers[*pixel as usize] = share(*pixel).map(Truth::Known);
        }
        let mask = TruthMask { size: receivers.size, pixels: answers };
        let ms = start.elapsed().as_secs_f64() * 1e3;
        Ok(MitsubaCheck { version: self.version().to_owned(), mask, rays, listed, estimate: None, ms })
    }

    /// Verdict and first triangle of each ray.
    fn ask_rays(
        &mut self,
        caster: &RayCaster<'_>,
        rays: &[ShadowRay],
    ) -> Result<(Vec<Verdict>, Vec<u32>), MitsubaError> {
        let starts = rays.iter().flat_map(|ray| entry(&ray.segment, &caster.bounds).to_array());
        let ends = rays.iter().flat_map(|ray| ray.segment.from.to_array());
        let job = Writer::new(json!({"task": "rays"}))
            .f64s("starts", starts, &[3])
            .f64s("receivers", ends, &[3])
            .u32s("own", rays.iter().map(|ray| caster.casters.surface_of(ray.own)));
        let answer = self.process.ask(job)?;
        let verdict = |code: &u8| match *code {
            BLOCKED => Verdict::Blocked,
            CONTACT => Verdict::Contact,
            _ => Verdict::Clear,
        };
        let verdicts = answer.u8s("verdict", rays.len()).map_err(MitsubaError::Answer)?.iter().map(verdict).collect();
        Ok((verdicts, answer.u32s("met", rays.len()).map_err(MitsubaError::Answer)?))
    }
}

/// What the rays of one light share.
struct RayCaster<'a> {
    scene: &'a Scene,
    casters: &'a Casters,
    light: &'a Light,
    emitter: &'a Emitter,
    bounds: Bounds,
}

impl RayCaster<'_> {
    /// The rays of one receiver with the exact verdict on each; none to points behind its surface.
    fn rays(&self, pixel: u32, receiver: &Receiver) -> Vec<ShadowRay> {
        let radius_m = self.bounds.radius();
        let segments = self.emitter.segments_from(receiver.point_in_world, radius_m);
        let ray = |(point, (segment, exact))| ShadowRay { pixel, point, segment, own: receiver.triangle, exact };
        if !self.light.is_area() {
            let eye = self.scene.camera.eye.as_dvec3();
            let exact = match of_receiver(self.casters, self.light, receiver, eye, radius_m) {
                Truth::Known(Visibility::LIT) => Occlusion::Clear,
                Truth::Known(_) => Occlusion::Blocked,
                Truth::Undecided => Occlusion::Doubtful,
            };
            return (0..).zip(segments.map(|segment| (segment, exact))).map(ray).collect();
        }
        let exact = of_points(self.scene, self.casters, self.emitter, receiver, radius_m);
        let is_before =
            |(_, (segment, _)): &(u32, (Segment, _))| receiver.normal_in_world.dot(segment.to - segment.from) > 0.0;
        (0..).zip(segments.zip(exact)).filter(is_before).map(ray).collect()
    }

    /// The ray with its reason, if it is worth listing.
    fn listed(&self, ray: &ShadowRay, mitsuba: Verdict, met: Option<u32>, unit_m: f64) -> Option<ListedRay> {
        let blocked = match ray.exact {
            Occlusion::Clear => false,
            Occlusion::Blocked => true,
            Occlusion::Doubtful => return None,
        };
        let is_contact = mitsuba == Verdict::Contact;
        (is_contact || blocked != (mitsuba == Verdict::Blocked)).then(|| ListedRay {
            pixel: ray.pixel,
            point: ray.point,
            segment: ray.segment,
            blocked,
            mitsuba,
            reason: reason(self.scene, self.casters, &ray.segment, ray.own, met, is_contact, unit_m),
            confirmed: brute::any_hit(self.scene, &ray.segment, Some(ray.own)).is_some() == blocked,
        })
    }
}

/// Where a ray from the light enters the ball around the scene's box; the light itself if it is inside.
fn entry(segment: &Segment, bounds: &Bounds) -> DVec3 {
    // A little larger than the box's own, so that a light on it stays where it is.
    const SLACK: f64 = 1.01;
    let radius = SLACK * bounds.radius();
    let (from_centre, travel) = (segment.to - bounds.centre(), segment.from - segment.to);
    // By way of the point nearest to the centre: from a far light, differences of squares would leave nothing of the ball.
    let nearest = from_centre + travel * (-from_centre.dot(travel) / travel.length_squared());
    let half_chord = (radius * radius - nearest.length_squared()).sqrt();
    if from_centre.length() <= radius || !half_chord.is_finite() {
        return segment.to;
    }
    bounds.centre() + nearest - travel.normalize() * half_chord
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_of_far_lights_start_where_they_enter_the_scene() {
        let bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let radius = 1.01 * bounds.radius();
        let from_far = Segment { from: DVec3::ZERO, to: DVec3::X * 1e6 };
        assert!((entry(&from_far, &bounds) - DVec3::X * radius).length() < 1e-9);
        let inside = Segment { from: DVec3::ZERO, to: DVec3::ONE };
        assert_eq!(entry(&inside, &bounds), DVec3::ONE);
    }
}
