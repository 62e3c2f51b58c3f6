//! Things drawn into a finished picture: lines and translucent faces, before or behind the surfaces that it shows.

use super::Picture;
use crate::receiver::Receivers;
use crate::scene::{ProjectedTriangle, Scene};
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2, Vec3};
use rayon::prelude::*;

/// Lines this share of a surface's distance behind it still count as on it.
const ON_SURFACE: f64 = 2e-3;

/// So much of a line is left off at either end: far less than a pixel.
const LEAST_SHARE: f64 = 1e-9;

/// How lines are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Linear RGB.
    pub colour: Vec3,
    /// Breadth, pixels.
    pub width_px: f64,
    /// Where nothing is before it, 0..=1.
    pub opacity: f32,
    /// Behind a surface, 0..=1.
    pub hidden_opacity: f32,
}

/// What a picture shows, for drawing into it.
#[derive(Debug)]
pub struct Overlay {
    size: UVec2,
    clip_from_world: DMat4,
    near_m: f64,
    /// Inverse view depth of the surface at every pixel, 1/m; 0 for the background.
    surface: Vec<f64>,
}

impl Overlay {
    /// For pictures of a scene and its receivers.
    #[must_use]
    pub fn new(scene: &Scene, receivers: &Receivers) -> Self {
        let view = scene.camera.view_from_world();
        let inverse_depth = |point: DVec3| (-view.transform_point3(point).z).recip();
        Self {
            size: receivers.size,
            clip_from_world: scene.camera.clip_from_world(receivers.size),
            near_m: scene.camera.near_m,
            surface: receivers
                .pixels
                .iter()
                .map(|pixel| pixel.map_or(0.0, |r| inverse_depth(r.point_in_world)))
                .collect(),
        }
    }

    /// Tints what lies behind faces, more the more of those whose front is seen stand before it. Corners are
    /// homogeneous, rebased world.
    pub fn tint(&self, picture: &mut Picture, faces: impl Iterator<Item = [DVec4; 3]>, colour: Vec3) {
        /// What one face lets through, and what any number of them hides at most.
        const THROUGH: f32 = 0.62;
        const HIDDEN: f32 = 0.7;
        let size = self.size.as_dvec2();
        let seen = faces.filter_map(|corners| ProjectedTriangle::new(corners, &self.clip_from_world, size));
        let fronts: Vec<ProjectedTriangle> = seen.filter(|face| !face.is_back).collect();
        let width = self.size.x as usize;
        let rows = picture.linear_rgb.par_chunks_mut(width).zip(self.surface.par_chunks(width)).enumerate();
        rows.for_each(|(row, (pixels, surface))| {
            let mut before = vec![0_u16; width];
            for face in &fronts {
                count_row(face, row as f64 + 0.5, surface, &mut before);
            }
            for (pixel, &count) in pixels.iter_mut().zip(&before) {
                *pixel = pixel.lerp(colour, HIDDEN * (1.0 - THROUGH.powi(count.into())));
            }
        });
    }

    /// Draws lines between homogeneous points of the rebased world.
    pub fn lines(&self, picture: &mut Picture, lines: impl Iterator<Item = [DVec4; 2]>, stroke: &Stroke) {
        for [from, to] in lines.filter_map(|line| self.in_picture(line)) {
            self.line(picture, from, to, stroke);
        }
    }

    /// Both ends as pixels and inverse depth, cut at the near plane and roughly at the picture.
    fn in_picture(&self, line: [DVec4; 2]) -> Option<[DVec3; 2]> {
        let clip = line.map(|end| (self.clip_from_world * end, end.w));
        // Depth, weight and position are linear along the homogeneous segment.
        let [(a, a_w), (b, b_w)] = clip;
        let ahead = |clip: DVec4, w: f64| clip.w - self.near_m * w.max(f64::EPSILON);
        let (start, end) = (ahead(a, a_w), ahead(b, b_w));
        if start <= 0.0 && end <= 0.0 {
            return None;
        }
        let cut = (start / (start - end)).clamp(0.0, 1.0);
        let (from, to) = if start <= 0.0 {
            (cut, 1.0)
        } else if end <= 0.0 {
            (0.0, cut)
        } else {
            (0.0, 1.0)
        };
        let size = self.size.as_dvec2();
        // An end at infinity beside the eye is nowhere in the picture; just before it the line is.
        let at = |share: f64| {
            let share = share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
            let (clip, w) = (a.lerp(b, share), a_w + share * (b_w - a_w));
            let ndc = DVec2::new(clip.x, clip.y) / clip.w;
            (0.5 * DVec2::new(1.0 + ndc.x, 1.0 - ndc.y) * size).extend(w / clip.w)
        };
        within(at(from), at(to), size)
    }

    fn line(&self, picture: &mut Picture, from: DVec3, to: DVec3, stroke: &Stroke) {
        let along = (to - from).truncate();
        let steep = along.y.abs() > along.x.abs();
        let axis = usize::from(steep);
        let (from, to) = if from[axis] <= to[axis] { (from, to) } else { (to, from) };
        let length = (to[axis] - from[axis]).max(f64::EPSILON);
        let slope = (to[1 - axis] - from[1 - axis]) / length;
        let upright = 1.0 / (1.0 + slope * slope).sqrt();
        let reach = (0.5 * stroke.width_px / upright + 1.0).ceil() as i64;
        for step in from[axis].floor() as i64..=to[axis].floor() as i64 {
            let share = ((step as f64 + 0.5 - from[axis]) / length).clamp(0.0, 1.0);
            let at = from.lerp(to, share);
            let middle = at[1 - axis];
            for other in middle.floor() as i64 - reach..=middle.floor() as i64 + reach {
                let distance = (other as f64 + 0.5 - middle).abs() * upright;
                let coverage = (0.5 * stroke.width_px + 0.5 - distance).clamp(0.0, 1.0) as f32;
                let (x, y) = if steep { (other, step) } else { (step, other) };
                self.blend(picture, x, y, at.z, coverage, stroke);
            }
        }
    }

    fn blend(&self, picture: &mut Picture, x: i64, y: i64, inverse_depth: f64, coverage: f32, stroke: &Stroke) {
        if coverage <= 0.0 || x < 0 || y < 0 || x >= self.size.x.into() || y >= self.size.y.into() {
            return;
        }
        let pixel = y as usize * self.size.x as usize + x as usize;
        let is_hidden = inverse_depth < (1.0 - ON_SURFACE) * self.surface[pixel];
        let opacity = if is_hidden { stroke.hidden_opacity } else { stroke.opacity };
        let shown = &mut picture.linear_rgb[pixel];
        *shown = shown.lerp(stroke.colour, coverage * opacity);
    }
}

/// Counts a face in the pixels of a row that it covers before the surface.
fn count_row(face: &ProjectedTriangle, y: f64, surface: &[f64], before: &mut [u16]) {
    let [from, to] = face.columns(y);
    let first = (from - 0.5).ceil().max(0.0);
    let last = (to - 0.5).floor().min(surface.len() as f64 - 1.0);
    if first > last {
        return;
    }
    let at_start = face.inverse_depth.dot(DVec3::new(0.5, y, 1.0));
    for x in first as usize..=last as usize {
        let inverse_depth = at_start + face.inverse_depth.x * x as f64;
        if inverse_depth >= 0.0 && inverse_depth > surface[x] {
            before[x] = before[x].saturating_add(1);
        }
    }
}

/// A line's part near the picture, so that a line to far outside costs no steps (Y.-D. Liang, B. Barsky, "A New Concept
/// and Method for Line Clipping", 1984).
fn within(from: DVec3, to: DVec3, size: DVec2) -> Option<[DVec3; 2]> {
    const MARGIN_PX: f64 = 8.0;
    let mut range = [0.0_f64, 1.0];
    for axis in 0..2 {
        let step = to[axis] - from[axis];
        let [enter, leave] = [-MARGIN_PX - from[axis], size[axis] + MARGIN_PX - from[axis]];
        if step == 0.0 {
            if enter > 0.0 || leave < 0.0 {
                return None;
            }
            continue;
        }
        let (first, last) = if step > 0.0 { (enter / step, leave / step) } else { (leave / step, enter / step) };
        range = [range[0].max(first), range[1].min(last)];
    }
    (range[0] < range[1]).then(|| range.map(|share| from.lerp(to, share)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::scene_of;
    use crate::receiver::Receiver;

    const INK: Stroke = Stroke { colour: Vec3::X, width_px: 2.0, opacity: 1.0, hidden_opacity: 0.0 };

    /// A picture of 64 × 64 pixels whose right half shows a wall at z = 0, five metres before the eye.
    fn stage() -> (Overlay, Picture) {
        let scene = scene_of(&[]);
        let wall = Receiver { triangle: 0, point_in_world: DVec3::ZERO, normal_in_world: DVec3::Z };
        let pixels = (0..64 * 64).map(|pixel| (pixel % 64 >= 32).then_some(wall)).collect();
        let receivers = Receivers { size: UVec2::splat(64), pixels };
        let picture = Picture { size: receivers.size, linear_rgb: vec![Vec3::ZERO; 64 * 64] };
        (Overlay::new(&scene, &receivers), picture)
    }

    fn inked(picture: &Picture, x: usize, y: usize) -> f32 {
        picture.linear_rgb[y * 64 + x].x
    }

    #[test]
    fn a_line_is_hidden_behind_a_surface_and_shown_before_it() {
        let across = |z: f64| [DVec4::new(-1.0, 0.0, z, 1.0), DVec4::new(1.0, 0.0, z, 1.0)];
        for (z, left, right) in [(-1.0, 1.0, 0.0), (1.0, 1.0, 1.0)] {
            let (overlay, mut picture) = stage();
            overlay.lines(&mut picture, std::iter::once(across(z)), &INK);
            assert_eq!((inked(&picture, 28, 32), inked(&picture, 36, 32)), (left, right), "{z}");
            assert_eq!(inked(&picture, 28, 20), 0.0);
        }
    }

    #[test]
    fn lines_through_the_eye_and_to_infinity_end_at_the_picture() {
        let (overlay, mut picture) = stage();
        let through = [DVec4::new(0.1, -0.1, 9.0, 1.0), DVec4::new(0.0, 0.0, -1.0, 0.0)];
        let beside = [DVec4::new(0.0, 0.0, 4.0, 1.0), DVec4::new(-1.0, 0.0, 0.0, 0.0)];
        overlay.lines(&mut picture, [through, beside].into_iter(), &INK);
        assert!(inked(&picture, 2, 32) > 0.5);
        assert!(picture.linear_rgb.iter().all(|colour| colour.is_finite()));
    }

    #[test]
    fn faces_tint_what_is_behind_them() {
        let corners =
            [DVec4::new(-1.0, -1.0, 1.0, 1.0), DVec4::new(1.0, -1.0, 1.0, 1.0), DVec4::new(0.0, 1.0, 1.0, 1.0)];
        let tinted = |z: f64, turned: bool| {
            let (overlay, mut picture) = stage();
            let mut face = corners.map(|corner| corner - z * DVec4::Z);
            if turned {
                face.swap(0, 1);
            }
            overlay.tint(&mut picture, std::iter::once(face), Vec3::X);
            (inked(&picture, 30, 34) > 0.1, inked(&picture, 34, 34) > 0.1, inked(&picture, 30, 2) > 0.1)
        };
        assert_eq!(tinted(0.0, false), (true, true, false));
        assert_eq!(tinted(2.0, false), (true, false, false));
        assert_eq!(tinted(0.0, true), (false, false, false), "seen from behind");
    }
}
