//! The stairs of a shadow's edge, measured in the picture and predicted by the texels' footprints.
//!
//! A `nearest` lookup answers for its texel's centre. Across an edge at an angle to the texels the distance between a
//! pixel and that centre is a x + b y with x and y uniform in ±1/2, a and b being what the texel's two sides measure
//! across the edge; the stairs are a + b wide. Formulas: docs/footprint.md.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use glam::{DQuat, DVec2, DVec3, Vec3};
use gnomon::evaluate::Evaluation;
use gnomon::mask::Truth;
use gnomon::scene::{LightKind, Mesh, Scene};
use support::scenes::{shipped, with_triangles};
use support::shot::Shot;

/// Height of the roof, over every camera of the sweep, metres.
const HEIGHT_M: f64 = 16.0;
/// Between the view and the shadow's edge on the ground, radians: each meets the texels in its own way.
const ASIDE_RAD: [f64; 4] = [-0.6, -0.3, 0.3, 0.6];

/// The ground of `posts` under a roof, in place of the posts: their shadows are narrower than the texels that can be
/// measured.
struct Roofed {
    scene: Scene,
    /// Along the roof's one edge that matters, level.
    edge: DVec3,
    towards_light: DVec3,
}

impl Roofed {
    /// The camera moved by `pose`. The shadow's edge passes before it, at an angle to its view, into the distance.
    fn new(pose: Vec3, aside_rad: f64) -> Self {
        const LENGTHS_M: [f64; 2] = [-60.0, 250.0];
        const BREADTH_M: f64 = 400.0;
        let mut scene = shipped("posts", [640, 480]);
        scene.camera.eye += pose;
        for mesh in &mut scene.meshes {
            mesh.casts &= !is_named(mesh, "posts");
        }
        let LightKind::Directional { towards_light } = scene.light("sun").unwrap().kind else { panic!() };
        let towards_light = towards_light.as_dvec3();
        let level = DVec3::new(1.0, 0.0, 1.0);
        let [eye, target] = [scene.camera.eye, scene.camera.target].map(|point| level * point.as_dvec3());
        let edge = DQuat::from_rotation_y(aside_rad) * (target - eye).normalize();
        let middle = eye.lerp(target, 0.4) + towards_light * (HEIGHT_M / towards_light.y);
        let [a, b] = LENGTHS_M.map(|length| middle + length * edge);
        let aside = BREADTH_M * DVec3::Y.cross(edge);
        let [a, b, c, d] = [a, b, b + aside, a + aside].map(|corner| corner.as_vec3());
        Self { scene: with_triangles(&scene, &[[a, b, c], [a, c, d]]), edge, towards_light }
    }

    /// Unit vector across the edge's shadow in the picture, at a point of the ground.
    fn across_edge(&self, point: DVec3, normal: DVec3) -> DVec2 {
        const STEP_M: f64 = 1e-3;
        let along = STEP_M * self.edge.cross(self.towards_light).cross(normal).normalize();
        let size = self.scene.image_size;
        let clip_from_world = self.scene.camera.clip_from_world(size);
        let in_picture =
            |point| clip_from_world.project_point3(point).truncate() * size.as_dvec2() * DVec2::new(0.5, -0.5);
        (in_picture(point + along) - in_picture(point - along)).perp().normalize()
    }
}

fn is_named(mesh: &Mesh, name: &str) -> bool {
    mesh.name.to_lowercase().contains(name)
}

/// One pixel that the map answers wrongly.
struct Wrong {
    /// Distance to the true edge, pixels.
    distance_px: f64,
    /// What the two sides of its texel measure across the edge, pixels.
    sides_px: [f64; 2],
    /// The longer of these sides' lengths, pixels.
    m: f64,
}

impl Wrong {
    fn width_px(&self) -> f64 {
        self.sides_px[0] + self.sides_px[1]
    }

    /// The mean of |a x + b y|ᵖ.
    fn mean_of_power(&self, p: i32) -> f64 {
        /// Thinner sides are taken as this thin, where the difference below would be all rounding.
        const THINNEST: f64 = 1e-2;
        let [a, b] = self.sides_px;
        let (a, b) = (a.max(b), a.min(b).max(THINNEST * a.max(b)));
        let power = |x: f64| (0.5 * x).powi(p + 2);
        2.0 * (power(a + b) - power(a - b)) / (f64::from((p + 1) * (p + 2)) * a * b)
    }

    /// The mean square distance of wrong pixels from the edge. At distance d a pixel is wrong if its texel's centre is
    /// farther across than d, so that the mean is ∫ d² P(> d) over ∫ P(> d).
    fn expected_square(&self) -> f64 {
        self.mean_of_power(3) / (3.0 * self.mean_of_power(1))
    }
}

/// The places in the picture where the truth changes between two neighbouring pixels of the ground.
fn true_edge(shot: &Shot<'_>) -> Vec<DVec2> {
    let mask = &shot.question.truth.mask;
    let truth = |x: u32, y: u32| {
        let pixel = (y * mask.size.x + x) as usize;
        let is_ground = is_named(shot.view.scene.mesh_of(shot.view.receivers.pixels[pixel]?.triangle), "ground");
        match mask.pixels[pixel] {
            Some(Truth::Known(visibility)) if is_ground => Some(visibility),
            _ => None,
        }
    };
    let mut found = Vec::new();
    for (x, y) in (1..mask.size.y).flat_map(|y| (1..mask.size.x).map(move |x| (x, y))) {
        for (i, j) in [(x - 1, y), (x, y - 1)] {
            if truth(x, y).zip(truth(i, j)).is_some_and(|(a, b)| a != b) {
                found.push(0.5 * (DVec2::new(x.into(), y.into()) + DVec2::new(i.into(), j.into())));
            }
        }
    }
    found
}

/// The wrong pixels at the edge, with their texels as `predicted` has them.
fn wrong_pixels(roofed: &Roofed, shot: &Shot<'_>, answered: &Evaluation<'_>, predicted: &Evaluation<'_>) -> Vec<Wrong> {
    /// Narrower stairs are made of too few pixels, wider ones are cut by the picture's border.
    const WIDTHS_PX: std::ops::Range<f64> = 10.0..120.0;
    let edge = true_edge(shot);
    let scene = &roofed.scene;
    let width = scene.image_size.x;
    let wrong = answered.ledger.wrong.iter().filter_map(|(pixel, _)| {
        let at = DVec2::new((pixel % width).into(), (pixel / width).into());
        let receiver = shot.view.receivers.pixels[*pixel as usize]?;
        let across = roofed.across_edge(receiver.point_in_world, receiver.normal_in_world);
        let footprint = predicted.prepared.footprint(*pixel)?;
        let sides_px = footprint.sides_px.map(|side| side.dot(across).abs());
        let distance_px = edge.iter().map(|place| place.distance(at)).fold(f64::INFINITY, f64::min);
        let is_ground = is_named(scene.mesh_of(receiver.triangle), "ground");
        is_ground.then_some(Wrong { distance_px, sides_px, m: footprint.m })
    });
    // Half the width is the farthest that stairs reach; what is twice as far is wrong for another reason.
    wrong.filter(|wrong| WIDTHS_PX.contains(&wrong.width_px()) && wrong.distance_px < wrong.width_px()).collect()
}

/// The stairs' measured width over the predicted one; every texel counts alike, however many pixels it covers.
fn measured_over_predicted(wrong: &[Wrong]) -> f64 {
    let weight = |wrong: &Wrong| wrong.width_px().powi(-2);
    let sum: f64 = wrong.iter().map(|w| weight(w) * w.distance_px.powi(2) / w.expected_square()).sum();
    (sum / wrong.iter().map(weight).sum::<f64>()).sqrt()
}

/// The middle one of some values.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// At every pose of a sweep; and the prediction for a map of another size is told apart.
#[test]
fn stairs_are_as_wide_in_the_picture_as_predicted() {
    const WITHIN: f64 = 0.10;
    /// A map of this many times the size has stairs that much narrower: twice the tolerance away.
    const OTHER_SIZE: f64 = 1.25;
    for pose in [Vec3::ZERO, Vec3::new(4.0, 3.0, 2.0), Vec3::new(-6.0, 1.5, -4.0), Vec3::new(2.0, 9.0, 5.0)] {
        let roofs = ASIDE_RAD.map(|aside_rad| Roofed::new(pose, aside_rad));
        let shots = roofs.each_ref().map(|roofed| Shot::new(&roofed.scene, "sun"));
        for (size, typed) in [
            (200.0, "fit=receivers"),
            (96.0, "projection=perspective"),
            (96.0, "projection=trapezoidal"),
            (96.0, "projection=light-space-perspective"),
        ] {
            let (mut wrong, mut by_other_size, mut error) = (Vec::new(), Vec::new(), 0.0);
            for (roofed, shot) in roofs.iter().zip(&shots) {
                let of_size = |size: f64| shot.evaluate(&format!("map:size={size},filter=nearest,{typed}"));
                let (answered, other) = (of_size(size), of_size(OTHER_SIZE * size));
                wrong.extend(wrong_pixels(roofed, shot, &answered, &answered));
                by_other_size.extend(wrong_pixels(roofed, shot, &answered, &other));
                error += answered.verdict.error.mean_abs.unwrap() / roofs.len() as f64;
            }
            let (ratio, control) = (measured_over_predicted(&wrong), measured_over_predicted(&by_other_size));
            let (m, predicted) = (median(wrong.iter().map(|w| w.m)), median(wrong.iter().map(Wrong::width_px)));
            println!(
                "{pose} {size} {typed}: {} pixels, m {m:.1}, stairs of {predicted:.1} px predicted, {:.1} measured, \
                 ratio {ratio:.3}, control {control:.3}, error {error:.4}",
                wrong.len(),
                ratio * predicted
            );
            assert!((ratio - 1.0).abs() < WITHIN, "{pose} {typed}: {ratio}");
            assert!((control - 1.0).abs() > WITHIN, "{pose} {typed}: {control}");
        }
    }
}
