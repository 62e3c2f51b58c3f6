//! Small stages for the planar techniques: casters over receivers that cast nothing, seen by a camera from the front,
//! and evaluations of them whose parts outlive the device.

#![allow(dead_code, reason = "every test uses its own share")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use crate::support::testing::{Shape, scene_of};
use glam::{DVec3, UVec2, Vec3};
use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, EvaluateError, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::{Mask, Truth, TruthMask};
use gnomon::receiver::Receivers;
use gnomon::scene::{LightKind, Plane, Scene};
use gnomon::technique::footprint::Footprint;
use gnomon::technique::{Cost, Spec, TechniqueError, Unsupported};
use gnomon::verdict::{Ledger, Verdict};
use gnomon::watch::Unwatched;
use std::sync::LazyLock;

static GPU: LazyLock<Gpu> = LazyLock::new(|| Gpu::open().unwrap());

/// A picture of 160 × 120 pixels: a floor y = 0 of 12 m × 12 m, these casters, a lamp, and the floor's plane.
pub(crate) fn stage(casters: &[Shape], lamp: Vec3) -> Scene {
    stage_on(casters, &[floor(6.0)], lamp)
}

/// The same with other receivers, which cast nothing.
pub(crate) fn stage_on(casters: &[Shape], receivers: &[Shape], lamp: Vec3) -> Scene {
    let mut scene = scene_of(&[casters, receivers].concat(), lamp);
    for mesh in scene.meshes.iter_mut().skip(casters.len()) {
        mesh.casts = false;
    }
    scene.image_size = UVec2::new(160, 120);
    scene.camera.up = Vec3::Y;
    look(&mut scene, Vec3::new(1.2, 4.5, 6.0), Vec3::new(0.1, 0.3, 0.0));
    scene.camera.near_m = 0.01;
    scene.planes = vec![Plane { point: Vec3::ZERO, normal: Vec3::Y }];
    scene
}

/// Moves the camera.
pub(crate) fn look(scene: &mut Scene, eye: Vec3, target: Vec3) {
    (scene.camera.eye, scene.camera.target) = (eye, target);
}

/// Moves the lamp.
pub(crate) fn light_at(scene: &mut Scene, to: Vec3) {
    scene.lights[0].kind = LightKind::Point { position: to, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] };
}

/// Puts a sun in place of the lamp.
pub(crate) fn sun(scene: &mut Scene, towards_light: Vec3) {
    scene.lights[0].kind = LightKind::Directional { towards_light: towards_light.normalize() };
}

/// A square in y = 0, facing up.
pub(crate) fn floor(half: f32) -> Shape {
    quad(Vec3::new(-half, 0.0, -half), Vec3::new(0.0, 0.0, 2.0 * half), Vec3::new(2.0 * half, 0.0, 0.0))
}

/// A parallelogram from one corner along two sides.
pub(crate) fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Shape {
    Shape { positions: vec![corner, corner + u, corner + u + v, corner + v], triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

/// A closed box, wound outward.
pub(crate) fn cuboid(centre: Vec3, half: Vec3) -> Shape {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Shape {
        positions: (0..8).map(|i| centre + half * corner(i)).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

pub(crate) fn cube(centre: Vec3, half: f32) -> Shape {
    cuboid(centre, Vec3::splat(half))
}

/// The torus of the shared shapes, put somewhere.
pub(crate) fn torus_at(offset: DVec3, scale: f64) -> Shape {
    crate::support::placed(&crate::support::torus(24, 16), scale, offset)
}

/// What came of one technique on one stage.
pub(crate) struct Outcome {
    pub(crate) verdict: Verdict,
    pub(crate) ledger: Ledger,
    pub(crate) mask: Mask,
    pub(crate) truth: TruthMask,
    pub(crate) receivers: Receivers,
    pub(crate) cost: Cost,
}

/// Evaluates a technique for the first light, causes included: that the ledger accepts the replay is part of every test.
pub(crate) fn outcome(scene: &Scene, spec: &str) -> Outcome {
    attempt(scene, spec).unwrap_or_else(|error| panic!("{spec}: {error}"))
}

/// Why a technique refuses the first light.
pub(crate) fn refusal(scene: &Scene, spec: &str) -> Unsupported {
    match attempt(scene, spec) {
        Err(EvaluateError::Technique(TechniqueError::Unsupported(why))) => why,
        Err(error) => panic!("{spec}: {error}"),
        Ok(_) => panic!("{spec} is not refused"),
    }
}

fn attempt(scene: &Scene, spec: &str) -> Result<Outcome, EvaluateError> {
    let spec = Spec::parse(spec).unwrap();
    let view = View::new(&GPU, scene).unwrap();
    let question = view.ask(&scene.lights[0], &Unwatched).unwrap();
    let evaluation = evaluate(&view, &question, &spec, Effort::CAUSES, &Unwatched)?;
    let (verdict, ledger, mask, cost) = (evaluation.verdict, evaluation.ledger, evaluation.mask, evaluation.cost);
    Ok(Outcome { verdict, ledger, mask, truth: question.truth.mask.clone(), receivers: view.receivers.clone(), cost })
}

/// The footprint of a technique's texel at the middle of the picture.
pub(crate) fn footprint_at_centre(scene: &Scene, spec: &str) -> Option<Footprint> {
    let spec = Spec::parse(spec).unwrap();
    let view = View::new(&GPU, scene).unwrap();
    let question = view.ask(&scene.lights[0], &Unwatched).unwrap();
    let prepared = spec.technique().prepare(&spec, view.job(question.light, &question.classes)).unwrap();
    prepared.footprint(scene.image_size.y / 2 * scene.image_size.x + scene.image_size.x / 2)
}

impl Outcome {
    /// Wrong pixels named after a cause.
    pub(crate) fn wrong_by(&self, cause: Cause) -> u64 {
        self.ledger.causes.get(&cause).map_or(0, |share| share.pixels)
    }

    /// Wrong pixels, and those of them that this cause owns.
    pub(crate) fn wrong_and_by(&self, cause: Cause) -> (u64, u64) {
        (self.verdict.pixels.wrong, self.wrong_by(cause))
    }

    /// Wrong pixels with no true shadow edge beside them.
    pub(crate) fn wrong_off_edges(&self) -> usize {
        let is_off = |(pixel, _): &&(u32, Cause)| !at_edge(&self.truth, *pixel);
        self.ledger.wrong.iter().filter(is_off).count()
    }

    /// Decided pixels whose receiver and exact visibility `choose` accepts.
    pub(crate) fn count(&self, choose: impl Fn(u32, DVec3, f32) -> bool) -> u64 {
        let decided = self.truth.pixels.iter().zip(&self.receivers.pixels);
        let chosen = decided.filter(|(truth, receiver)| match (truth, receiver) {
            (Some(Truth::Known(value)), Some(receiver)) => {
                choose(receiver.triangle, receiver.point_in_world, value.get())
            }
            _ => false,
        });
        chosen.count() as u64
    }

    /// The technique's value per answered pixel, with the point that the pixel shows.
    pub(crate) fn answers(&self) -> impl Iterator<Item = (DVec3, f32)> {
        let both = self.mask.pixels.iter().zip(&self.receivers.pixels);
        both.filter_map(|(value, receiver)| Some((receiver.as_ref()?.point_in_world, value.as_ref()?.get())))
    }
}

/// Whether a pixel or one of its eight neighbours sees the other side of a true shadow edge, or is not decided.
pub(crate) fn at_edge(truth: &TruthMask, pixel: u32) -> bool {
    let (width, height) = (i64::from(truth.size.x), i64::from(truth.size.y));
    let (x, y) = (i64::from(pixel) % width, i64::from(pixel) / width);
    let value = |x: i64, y: i64| truth.pixels[(y * width + x) as usize];
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
    let inside = around.filter(|(x, y)| (0..width).contains(x) && (0..height).contains(y));
    let own = value(x, y);
    inside.into_iter().any(|(x, y)| value(x, y) != own)
}

/// A mask moved to the right by some pixels; what comes in is as it was.
pub(crate) fn shifted(mask: &Mask, by: usize) -> Mask {
    let width = mask.size.x as usize;
    let source = |pixel: usize| if pixel % width < by { pixel } else { pixel - by };
    Mask { size: mask.size, pixels: (0..mask.pixels.len()).map(|pixel| mask.pixels[source(pixel)]).collect() }
}

/// Pixels at which a mask and the truth of an outcome are on different sides of one half.
pub(crate) fn wrong_pixels(outcome: &Outcome, mask: &Mask) -> Vec<u32> {
    let is_wrong = |pixel: &u32| match (outcome.truth.pixels[*pixel as usize], mask.pixels[*pixel as usize]) {
        (Some(Truth::Known(truth)), Some(answer)) => (truth.get() - answer.get()).abs() > 0.5,
        _ => false,
    };
    (0..mask.pixels.len() as u32).filter(is_wrong).collect()
}
