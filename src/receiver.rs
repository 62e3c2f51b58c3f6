//! Receivers: the exact f64 point behind every pixel centre, from the triangle id the G-buffer found there; and what a
//! light means for each of them before anything is cast.

use crate::scene::{Light, Scene};
use glam::{DVec2, DVec3, UVec2};
use rayon::prelude::*;

/// The point of a surface that a pixel centre shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Triangle id.
    pub triangle: u32,
    /// Where the pixel-centre ray meets that triangle, rebased world, f64.
    pub point_in_world: DVec3,
    /// Unit geometric normal, turned towards the eye.
    pub normal_in_world: DVec3,
}

/// The receivers of one picture, row by row from the top; `None` is background.
#[derive(Debug, Clone, PartialEq)]
pub struct Receivers {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` entries.
    pub pixels: Vec<Option<Receiver>>,
}

/// What one light means for a pixel, before anything is cast. Only `Asked` pixels are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PixelClass {
    /// No geometry.
    Background,
    /// The surface is turned away from the light as seen from the eye's side: dark by the lighting model.
    FacingAway,
    /// Outside a spot's cone, behind a rectangle, beyond the light's range, or on a mesh that does not receive.
    NotLit,
    /// The question is put to technique and truth.
    Asked,
}

/// What is asked about one light in one picture.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The receivers of all pixels.
    pub receivers: &'a Receivers,
    /// What the light means for each.
    pub classes: &'a [PixelClass],
}

impl<'a> Asked<'a> {
    /// The receivers whose class is [`PixelClass::Asked`], row by row from the top.
    pub fn iter(self) -> impl Iterator<Item = Receiver> + 'a {
        let with_class = self.receivers.pixels.iter().zip(self.classes);
        with_class.filter(|(_, class)| **class == PixelClass::Asked).filter_map(|(pixel, _)| *pixel)
    }

    /// Where they are.
    #[must_use]
    pub fn points(self) -> Vec<DVec3> {
        self.iter().map(|receiver| receiver.point_in_world).collect()
    }
}

impl Receivers {
    /// Intersects every pixel-centre ray with the triangle that the G-buffer found there (`triangles`: one entry per
    /// pixel of the scene's picture, row by row from the top).
    #[must_use]
    pub fn new(scene: &Scene, triangles: &[Option<u32>]) -> Self {
        let size = scene.image_size;
        let pixel_of = |index: usize| DVec2::new((index as u32 % size.x).into(), (index as u32 / size.x).into());
        let receiver_at = |(index, triangle): (usize, &Option<u32>)| {
            triangle.map(|triangle| receiver(scene, triangle, pixel_of(index) + 0.5))
        };
        Self { size, pixels: triangles.par_iter().enumerate().map(receiver_at).collect() }
    }

    /// The class of every pixel for one light.
    #[must_use]
    pub fn classify(&self, scene: &Scene, light: &Light) -> Vec<PixelClass> {
        let class = |pixel: &Option<Receiver>| match pixel {
            None => PixelClass::Background,
            Some(receiver) => classify(scene, light, receiver),
        };
        self.pixels.par_iter().map(class).collect()
    }
}

fn receiver(scene: &Scene, triangle: u32, pixel_centre: DVec2) -> Receiver {
    let corners = scene.triangle_in_world(triangle);
    let eye = scene.camera.eye.as_dvec3();
    let direction = scene.camera.ray_through(scene.image_size, pixel_centre);
    let normal = scene.triangle_normal(triangle);
    let along = normal.dot(corners[0] - eye) / normal.dot(direction);
    // A ray in the triangle's plane meets it nowhere in particular; the clamp below picks the nearest point.
    let along = if along.is_finite() { along } else { (corners[0] - eye).length() / direction.length() };
    let turned = if scene.facing(triangle, eye.extend(1.0)) < 0.0 { -normal } else { normal };
    Receiver {
        triangle,
        point_in_world: onto_triangle(eye + along * direction, corners),
        normal_in_world: turned.normalize_or_zero(),
    }
}

/// The rasteriser snaps vertices to a sub-pixel grid, so a pixel centre it assigns to a triangle may miss the exact one
/// by a hair; the receiver is then the triangle's nearest point. A point inside comes back unchanged.
fn onto_triangle(point: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let inside = |from: DVec3, to: DVec3| normal.dot((to - from).cross(point - from)) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return point;
    }
    let onto_edge = |from: DVec3, to: DVec3| {
        let edge = to - from;
        let share = (point - from).dot(edge) / edge.length_squared();
        from + edge * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    };
    [onto_edge(a, b), onto_edge(b, c), onto_edge(c, a)]
        .into_iter()
        .min_by(|p, q| p.distance_squared(point).total_cmp(&q.distance_squared(point)))
        .unwrap_or(point)
}

fn classify(scene: &Scene, light: &Light, receiver: &Receiver) -> PixelClass {
    let homogeneous = light.homogeneous();
    let eye_side = scene.facing(receiver.triangle, scene.camera.eye.as_dvec3().extend(1.0));
    let light_side = scene.facing(receiver.triangle, homogeneous);
    if !scene.mesh_of(receiver.triangle).receives {
        return PixelClass::NotLit;
    }
    // Signs only: a product of the two could underflow.
    if light_side == 0.0 || (eye_side > 0.0) != (light_side > 0.0) {
        return PixelClass::FacingAway;
    }
    if light.reaches(receiver.point_in_world) { PixelClass::Asked } else { PixelClass::NotLit }
}

#[cfg(test)]
mod tests {
    use super::onto_triangle;
    use glam::DVec3;

    const TRIANGLE: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_point_inside_stays() {
        let inside = DVec3::new(0.25, 0.5, 0.0);
        assert_eq!(onto_triangle(inside, TRIANGLE), inside);
    }

    #[test]
    fn a_point_outside_comes_to_the_nearest_edge_or_corner() {
        assert_eq!(onto_triangle(DVec3::new(0.25, -1e-3, 0.0), TRIANGLE), DVec3::new(0.25, 0.0, 0.0));
        assert_eq!(onto_triangle(DVec3::new(-1.0, -1.0, 0.0), TRIANGLE), DVec3::ZERO);
        assert!((onto_triangle(DVec3::new(1.0, 1.0, 0.0), TRIANGLE) - DVec3::new(0.5, 0.5, 0.0)).length() < 1e-15);
    }

    #[test]
    fn a_triangle_without_area_is_no_trap() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert!(onto_triangle(DVec3::new(0.5, 1.0, 0.0), flat).is_finite());
    }
}
