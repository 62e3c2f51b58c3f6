//! Shimmering: what changes from frame to frame although the truth does not. The camera, then the light, moves on by small
//! steps; at each step the answers of two frames are compared where both asked, and so are the exact answers.

use super::{Effort, EvaluateError, View, evaluate};
use crate::gpu::Gpu;
use crate::mask::{Mask, Truth, TruthMask};
use crate::scene::{Light, LightKind, Scene};
use crate::technique::Spec;
use crate::verdict::wrong_above;
use crate::watch::Watch;
use glam::{DQuat, DVec3, Vec3};

/// How far the picture moves with each step of the camera, pixels at the distance of what it looks at. A step of the
/// light turns it about the scene as far as that.
pub const STEP_PX: f64 = 0.25;

/// Pixels that flip at each step although the truth does not, or the truth does and they do not.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Flips {
    /// While the camera moves sideways.
    pub of_camera: Vec<u64>,
    /// While the light turns about the middle of the scene.
    pub of_light: Vec<u64>,
}

/// One frame: the exact answer and the technique's.
struct Frame {
    truth: TruthMask,
    mask: Mask,
}

/// Moves camera and light by `steps` each and counts the flips of every step.
///
/// # Errors
/// Those of [`evaluate`].
pub fn flips(
    gpu: &Gpu,
    scene: &Scene,
    light: &Light,
    spec: &Spec,
    steps: u32,
    watch: &dyn Watch,
) -> Result<Flips, EvaluateError> {
    if steps == 0 {
        return Ok(Flips::default());
    }
    let along = |moved: fn(&Scene, &str, f64) -> Scene| -> Result<Vec<u64>, EvaluateError> {
        let threshold = wrong_above(light);
        let mut before = frame(gpu, scene, &light.name, spec, watch)?;
        let mut counts = Vec::new();
        for step in 1..=steps {
            let after = frame(gpu, &moved(scene, &light.name, f64::from(step)), &light.name, spec, watch)?;
            counts.push(flipped(&before, &after, threshold));
            before = after;
        }
        Ok(counts)
    };
    Ok(Flips { of_camera: along(with_camera_moved)?, of_light: along(with_light_turned)? })
}

fn frame(gpu: &Gpu, scene: &Scene, light: &str, spec: &Spec, watch: &dyn Watch) -> Result<Frame, EvaluateError> {
    let view = View::new(gpu, scene).map_err(crate::technique::TechniqueError::from)?;
    // A moved scene has the same lights by the same names.
    let light = scene.light(light).unwrap_or(&scene.lights[0]);
    let question = view.ask(light, watch)?;
    let mask = evaluate(&view, &question, spec, Effort::VERDICT, watch)?.mask;
    Ok(Frame { truth: question.truth.mask, mask })
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

fn with_camera_moved(scene: &Scene, _light: &str, steps: f64) -> Scene {
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
            LightKind::Directional { towards_light } => *towards_light = direction(*towards_light),
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
