//! Shimmering: what changes from frame to frame although the truth does not. The camera, then the light, moves on by small
//! steps; at each step the answers of two frames are compared, and so are the exact answers.
//!
//! While the camera moves, points of the world are followed: those that the first picture shows are asked in every frame, of
//! a technique that is fitted to the moved camera. So what flips is the technique's own, not the picture's, and the truth
//! stays as it is. Only techniques that draw the camera's picture have no answer for such points; they are compared pixel
//! by pixel, less what changes in the truth.

use super::{Effort, EvaluateError, Question, View, evaluate};
use crate::cast::{Casters, Occlusion};
use crate::gpu::Gpu;
use crate::mask::{Mask, Truth, TruthMask};
use crate::receiver::{Asked, Receiver};
use crate::scene::{LightKind, Scene, Segment};
use crate::technique::{Job, Spec, TechniqueError};
use crate::verdict::wrong_above;
use crate::watch::{Interrupted, Quiet, Watch};
use glam::{DQuat, DVec2, DVec3, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How far the picture moves with each step of the camera, pixels at the distance of what it looks at. A step of the
/// light turns it about the scene as far as that.
pub const STEP_PX: f64 = 0.25;

/// What is compared from frame to frame while the camera moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Followed {
    /// The points that the first picture shows.
    Points,
    /// The same pixels, whatever they show.
    Pixels,
}

impl Followed {
    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Pixels => "pixels",
        }
    }
}

/// What flips at each step although the truth does not, or the truth does and it does not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flips {
    /// Pixels, or points of them, while the camera moves sideways.
    pub of_camera: Vec<u64>,
    /// Pixels while the light turns about the middle of the scene.
    pub of_light: Vec<u64>,
    /// What was compared while the camera moved.
    pub followed: Followed,
}

/// One frame: the exact answer and the technique's.
struct Frame {
    truth: TruthMask,
    mask: Mask,
}

/// Moves camera and light by `steps` each, from where `view` and `question` have them, and counts the flips of every step.
///
/// # Errors
/// Those of [`evaluate`].
pub fn flips(
    view: &View<'_>,
    question: &Question<'_>,
    spec: &Spec,
    steps: u32,
    watch: &dyn Watch,
) -> Result<Flips, EvaluateError> {
    let followed = if spec.technique().draws_the_picture(spec) { Followed::Pixels } else { Followed::Points };
    let light = question.light.name.as_str();
    let quiet = Quiet(watch);
    let frame_of = |scene: &Scene| frame(view.gpu, scene, light, spec, &quiet);
    let moved_camera = |step: f64| with_camera_moved(view.scene, step);
    let of_camera = along("moving the camera", question, steps, watch, |step| match followed {
        Followed::Points => followed_frame(view, &moved_camera(step), question, spec, &quiet),
        Followed::Pixels => frame_of(&moved_camera(step)),
    })?;
    let of_light = along("turning the light", question, steps, watch, |step| {
        frame_of(&with_light_turned(view.scene, light, step))
    })?;
    Ok(Flips { of_camera, of_light, followed })
}

/// The flips from each frame to the next, for the steps 0 to `steps`.
fn along(
    what: &str,
    question: &Question<'_>,
    steps: u32,
    watch: &dyn Watch,
    frame: impl Fn(f64) -> Result<Frame, EvaluateError>,
) -> Result<Vec<u64>, EvaluateError> {
    let mut counts = Vec::new();
    if steps == 0 {
        return Ok(counts);
    }
    let mut before: Option<Frame> = None;
    watch.start(what, u64::from(steps) + 1);
    for step in 0..=steps {
        let after = frame(step.into())?;
        watch.advance(1);
        counts.extend(before.map(|before| flipped(&before, &after, wrong_above(question.light))));
        before = Some(after);
    }
    Ok(counts)
}

/// What a scene's own picture says.
fn frame(gpu: &Gpu, scene: &Scene, light: &str, spec: &Spec, watch: &dyn Watch) -> Result<Frame, EvaluateError> {
    let view = View::new(gpu, scene).map_err(TechniqueError::from)?;
    // A moved scene has the same lights by the same names.
    let light = scene.light(light).unwrap_or(&scene.lights[0]);
    let question = view.ask(light, watch)?;
    let mask = evaluate(&view, &question, spec, Effort::VERDICT, watch)?.mask;
    Ok(Frame { truth: question.truth.mask, mask })
}

/// What a technique that is fitted to the picture of a moved camera says of the points in the first picture, where the
/// moved camera still sees them.
fn followed_frame(
    first: &View<'_>,
    moved: &Scene,
    question: &Question<'_>,
    spec: &Spec,
    watch: &dyn Watch,
) -> Result<Frame, EvaluateError> {
    let view = View::new(first.gpu, moved).map_err(TechniqueError::from)?;
    let classes = view.receivers.classify(moved, question.light);
    let fitted_to = Asked { receivers: &view.receivers, classes: &classes };
    let job = Job { scene: moved, fitted_to, ..first.job(question.light, &question.classes) };
    let mut mask = spec.technique().prepare(spec, job)?.run()?.mask;
    let mut opaque = moved.clone();
    opaque.meshes.iter_mut().for_each(|mesh| mesh.casts = true);
    let surfaces = Casters::new(&opaque);
    let still_seen =
        |receiver: &Option<Receiver>| receiver.is_some_and(|receiver| is_seen(moved, &surfaces, &receiver));
    let seen: Vec<bool> = first.receivers.pixels.par_iter().map(still_seen).collect();
    for (answer, _) in mask.pixels.iter_mut().zip(seen).filter(|(_, is_seen)| !is_seen) {
        *answer = None;
    }
    if watch.interrupted() {
        return Err(Interrupted.into());
    }
    Ok(Frame { truth: question.truth.mask.clone(), mask })
}

/// Whether the camera shows a point: not beyond its outermost pixel centres, and not behind a surface.
fn is_seen(scene: &Scene, surfaces: &Casters, receiver: &Receiver) -> bool {
    let (camera, size) = (&scene.camera, scene.image_size);
    let clip = camera.clip_from_world(size) * receiver.point_in_world.extend(1.0);
    let from_corner = DVec2::new(clip.x + clip.w, clip.w - clip.y) * 0.5 * size.as_dvec2() / clip.w;
    let is_inside = clip.w >= camera.near_m
        && from_corner.min_element() >= 0.5
        && (size.as_dvec2() - from_corner).min_element() >= 0.5;
    let sight = Segment { from: receiver.point_in_world, to: camera.eye.as_dvec3() };
    is_inside && surfaces.occlusion(&sight, Some(receiver.triangle), 0.0) == Occlusion::Clear
}

/// How many pixels change otherwise than the truth does, by more than `threshold`.
fn flipped(before: &Frame, after: &Frame, threshold: f64) -> u64 {
    let known = |truth: &Option<Truth>| match truth {
        Some(Truth::Known(visibility)) => Some(f64::from(visibility.get())),
        Some(Truth::Undecided) | None => None,
    };
    let change = |pixel: usize| {
        let of_truth = known(&after.truth.pixels[pixel])? - known(&before.truth.pixels[pixel])?;
        let answered = |frame: &Frame| frame.mask.pixels[pixel].map(|visibility| f64::from(visibility.get()));
        Some((answered(after)? - answered(before)? - of_truth).abs())
    };
    (0..before.mask.pixels.len()).filter_map(change).filter(|change| *change > threshold).count() as u64
}

/// What a step amounts to, metres at the distance of what the camera looks at.
fn step_m(scene: &Scene) -> f64 {
    let camera = &scene.camera;
    let distance = (camera.target - camera.eye).as_dvec3().length();
    STEP_PX * 2.0 * (0.5 * camera.fov_y_rad).tan() * distance / f64::from(scene.image_size.y)
}

fn with_camera_moved(scene: &Scene, steps: f64) -> Scene {
    let mut moved = scene.clone();
    let camera = &mut moved.camera;
    let side = (camera.target - camera.eye).as_dvec3().cross(camera.up.as_dvec3()).normalize_or_zero();
    let offset = side * (steps * step_m(scene));
    camera.eye = (camera.eye.as_dvec3() + offset).as_vec3();
    camera.target = (camera.target.as_dvec3() + offset).as_vec3();
    moved
}

fn with_light_turned(scene: &Scene, light: &str, steps: f64) -> Scene {
    let bounds = scene.bounds();
    let (centre, radius_m) = (bounds.centre(), bounds.radius().max(f64::MIN_POSITIVE));
    let mut moved = scene.clone();
    for light in moved.lights.iter_mut().filter(|known| known.name == light) {
        let homogeneous = light.homogeneous();
        let towards = homogeneous.truncate() - centre * homogeneous.w;
        let axis = towards.try_normalize().unwrap_or(DVec3::Y).any_orthonormal_vector();
        let turn = DQuat::from_axis_angle(axis, steps * step_m(scene) / radius_m);
        let direction = |vector: Vec3| (turn * vector.as_dvec3()).as_vec3();
        let place = |point: Vec3| (centre + turn * (point.as_dvec3() - centre)).as_vec3();
        match &mut light.kind {
            LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
                *towards_light = direction(*towards_light);
            }
            LightKind::Point { position, .. } | LightKind::Sphere { position, .. } => *position = place(*position),
            LightKind::Spot { position, axis, .. } => (*position, *axis) = (place(*position), direction(*axis)),
            LightKind::Rectangle { position, half_width, half_height, .. } => {
                *position = place(*position);
                (*half_width, *half_height) = (direction(*half_width), direction(*half_height));
            }
        }
    }
    moved
}
