//! What the tests of shadow volumes share: small scenes, and one run with everything that is known about it.

#![allow(dead_code, reason = "every test uses its own share")]
#![allow(clippy::unwrap_used, reason = "a test helper that cannot go on fails its test")]
#![allow(clippy::print_stderr, reason = "a skipped scene is said aloud")]

use glam::{UVec2, Vec3};
use gnomon::cause::Cause;
use gnomon::evaluate::{Effort, Question, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::mask::Mask;
use gnomon::receiver::PixelClass;
use gnomon::scene::{self, Camera, Light, LightKind, LoadOptions, Scene};
use gnomon::technique::volume::{PixelCounts, PreparedVolume, Settings};
use gnomon::technique::{Prepared, Spec};
use gnomon::verdict::{Ledger, Verdict};
use gnomon::watch::Unwatched;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::Path;
use testing::{Shape, scene_of};

#[path = "../../src/cast/testing.rs"]
pub(crate) mod testing;

/// Width and height of most pictures.
pub(crate) const SIZE: UVec2 = UVec2::new(160, 120);

/// The largest share of receivers that may be miscounted where the picture has few count edges.
const MISCOUNTED: f64 = 5e-5;
/// The largest share of receivers next to count edges: rasterisers snap vertices to a grid of 1/256 pixel, which moves
/// an edge by at most 1/512 pixel along each axis, and of the two pixels' breadth next to an edge that is this share.
const MISCOUNTED_AT_EDGES: f64 = 1.0 / 256.0;

pub(crate) fn gpu() -> Gpu {
    Gpu::open().unwrap()
}

/// A shipped scene, small; `None`, and a word about it, if its mesh has not been set up.
pub(crate) fn shipped(name: &str, size: UVec2) -> Option<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    if !folder.join(format!("{name}.obj")).exists() && ["bunny", "kitchen"].contains(&name) {
        eprintln!("skipped: scenes/{name} has no mesh; `make setup` fetches it");
        return None;
    }
    Some(scene::load(&folder, &LoadOptions { size: Some(size), ..LoadOptions::default() }).unwrap())
}

/// Casters over a floor (which only receives), seen from `eye`, under a light.
pub(crate) fn over_floor(casters: &[Shape], light: LightKind, eye: Vec3, target: Vec3) -> Scene {
    let mut shapes = casters.to_vec();
    shapes.push(quad(Vec3::ZERO, Vec3::X * 20.0, Vec3::NEG_Z * 20.0));
    let mut scene = scene_of(&shapes, Vec3::Y);
    scene.meshes[casters.len()].casts = false;
    scene.camera = Camera { eye, target, up: Vec3::Y, near_m: 0.05, fov_y_rad: 0.8, ..scene.camera };
    scene.image_size = SIZE;
    scene.lights[0].kind = light;
    scene
}

/// Two triangles around a centre; counter-clockwise from `side` to `up`.
pub(crate) fn quad(centre: Vec3, side: Vec3, up: Vec3) -> Shape {
    let corner = |s: f32, u: f32| centre + s * side + u * up;
    Shape {
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// A ball, closed and wound outward.
pub(crate) fn ball(centre: Vec3, radius: f32) -> Shape {
    let mut shape = Shape::icosphere(2);
    // The fixture does not promise a winding: turn every face outward.
    for triangle in &mut shape.triangles {
        let [a, b, c] = triangle.map(|v| shape.positions[v as usize]);
        if (b - a).cross(c - a).dot(a) < 0.0 {
            triangle.swap(1, 2);
        }
    }
    shape.positions.iter_mut().for_each(|p| *p = centre + radius * *p);
    shape
}

/// A shape, the last of its triangles cut in two at the middle of an edge whose other face
/// stays whole.
pub(crate) fn with_t_junction(mut shape: Shape) -> Shape {
    let [a, b, c] = shape.triangles.pop().unwrap();
    let middle = shape.positions.len() as u32;
    shape.positions.push(0.5 * (shape.positions[b as usize] + shape.positions[c as usize]));
    shape.triangles.extend([[a, b, middle], [a, middle, c]]);
    shape
}

/// A shape without its last triangles.
pub(crate) fn without_last(mut shape: Shape, count: usize) -> Shape {
    shape.triangles.truncate(shape.triangles.len() - count);
    shape
}

pub(crate) fn lamp(position: Vec3) -> LightKind {
    LightKind::Point { position, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] }
}

pub(crate) fn sun(towards_light: Vec3) -> LightKind {
    LightKind::Directional { towards_light: towards_light.normalize() }
}

/// One technique on one light, with all that is known about it.
pub(crate) struct Run {
    pub(crate) mask: Mask,
    pub(crate) stencil: Vec<u8>,
    pub(crate) counts: Vec<Option<PixelCounts>>,
    pub(crate) verdict: Verdict,
    pub(crate) ledger: Ledger,
    pub(crate) before_and_behind: (usize, usize),
    classes: Vec<PixelClass>,
    /// Miscounted pixels at which a volume's surface meets what is seen.
    touched: HashSet<usize>,
    width: usize,
}

/// Runs a `volume` specification and explains every error.
pub(crate) fn run(view: &View<'_>, question: &Question<'_>, typed: &str) -> Run {
    let spec = Spec::parse(typed).unwrap();
    let evaluation = evaluate(view, question, &spec, Effort::CAUSES, &Unwatched).unwrap();
    let prepared = prepare(view, question.light, &question.classes, typed);
    assert_eq!(prepared.run().unwrap().mask, evaluation.mask, "two runs differ");
    let pixels = evaluation.mask.pixels.len() as u32;
    let mut run = Run {
        stencil: prepared.stencil().unwrap(),
        counts: (0..pixels).into_par_iter().map(|pixel| prepared.counts(pixel)).collect(),
        before_and_behind: prepared.objects_before_and_behind(),
        mask: evaluation.mask,
        verdict: evaluation.verdict,
        ledger: evaluation.ledger,
        classes: question.classes.clone(),
        touched: HashSet::new(),
        width: view.scene.image_size.x as usize,
    };
    // Many misses have other reasons, and looking at every face for each takes long.
    let looked_at = run.miscounted().into_iter().filter(|at| !run.is_next_to_count_edge(*at)).take(100);
    run.touched = looked_at.filter(|at| prepared.boundary_touches(*at as u32)).collect();
    run
}

/// The same as [`run`] for the first light of a scene.
pub(crate) fn run_first(gpu: &Gpu, scene: &Scene, typed: &str) -> Run {
    let view = View::new(gpu, scene).unwrap();
    run(&view, &view.ask(&scene.lights[0], &Unwatched).unwrap(), typed)
}

/// A `volume` specification ready to run.
pub(crate) fn prepare<'j>(
    view: &'j View<'_>,
    light: &'j Light,
    classes: &'j [PixelClass],
    typed: &str,
) -> PreparedVolume<'j> {
    PreparedVolume::new(Settings::of(&Spec::parse(typed).unwrap()), view.job(light, classes)).unwrap()
}

/// A scene scaled about its origin; powers of two lose nothing.
pub(crate) fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scaled = scene.clone();
    let scale = |p: Vec3| (factor * p.as_dvec3()).as_vec3();
    scaled.positions.iter_mut().for_each(|p| *p = scale(*p));
    let camera = &scene.camera;
    scaled.camera =
        Camera { eye: scale(camera.eye), target: scale(camera.target), near_m: factor * camera.near_m, ..*camera };
    for light in &mut scaled.lights {
        if let LightKind::Point { position, aim, .. } = &mut light.kind {
            (*position, *aim) = (scale(*position), scale(*aim));
        }
    }
    scaled
}

impl Run {
    /// Wrong pixels.
    pub(crate) fn wrong(&self) -> u64 {
        self.verdict.pixels.wrong
    }

    /// Wrong pixels named after a cause.
    pub(crate) fn wrong_by(&self, cause: Cause) -> u64 {
        self.ledger.causes.get(&cause).map_or(0, |share| share.pixels)
    }

    /// Asked pixels.
    pub(crate) fn asked(&self) -> usize {
        self.classes.iter().filter(|class| **class == PixelClass::Asked).count()
    }

    fn asked_pixels(&self) -> impl Iterator<Item = usize> {
        (0..self.counts.len()).filter(|&at| self.classes[at] == PixelClass::Asked)
    }

    /// Asked pixels whose stencil is not what the f64 twin counts.
    fn miscounted(&self) -> Vec<usize> {
        let is_off = |at: &usize| self.counts[*at].is_none_or(|counts| counts.stencil() != self.stencil[*at]);
        self.asked_pixels().filter(is_off).collect()
    }

    /// How many pixels are miscounted, and how many of them are next to no count edge.
    pub(crate) fn miscounts(&self) -> (usize, usize) {
        let off = self.miscounted();
        let is_at_edge = |at: &usize| self.is_next_to_count_edge(*at) || self.touched.contains(at);
        (off.len(), off.iter().filter(|at| !is_at_edge(at)).count())
    }

    /// How many asked pixels are next to a count edge.
    pub(crate) fn next_to_count_edges(&self) -> usize {
        self.asked_pixels().filter(|at| self.is_next_to_count_edge(*at)).count()
    }

    fn is_next_to_count_edge(&self, at: usize) -> bool {
        let (x, y) = ((at % self.width) as i64, (at / self.width) as i64);
        let height = (self.counts.len() / self.width) as i64;
        let own = self.counts[at];
        let neighbours = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        own.is_none_or(|counts| counts.is_tied)
            || neighbours
                .filter(|&(x, y)| x >= 0 && y >= 0 && x < self.width as i64 && y < height)
                .any(|(x, y)| self.counts[y as usize * self.width + x as usize] != own)
    }

    /// Whether no more than [`MISCOUNTED`] of the receivers, or [`MISCOUNTED_AT_EDGES`] of those next to count edges,
    /// plus one pixel for pictures too small for a share, are miscounted, all of them at a count edge.
    pub(crate) fn counts_exactly(&self) -> bool {
        let (off, off_edge) = self.miscounts();
        let at_edges = self.next_to_count_edges();
        let allowed = (MISCOUNTED * self.asked() as f64).max(MISCOUNTED_AT_EDGES * at_edges as f64);
        off as f64 <= 1.0 + allowed && off_edge == 0
    }

    /// Panics with numbers unless [`Run::counts_exactly`].
    pub(crate) fn assert_exact(&self, what: &str) {
        assert!(self.counts_exactly(), "{what}: (off, off edge) = {:?} of {}", self.miscounts(), self.asked());
    }
}
