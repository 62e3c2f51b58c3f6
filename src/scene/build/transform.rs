//! Transforms in f64, the scene's own origin, and the one rounding to f32.
//!
//! The placement's translation and the rebasing are one offset, added once to coordinates that are still small: a scene
//! moved a million metres away and rebased back loses no more than the sum of its own f64 rounding.

use super::super::Bounds;
use glam::{DMat3, DVec3, Vec3};

/// Beyond this distance from the origin, and for extents beyond its inverse, products of three lengths (volumes,
/// determinants of edge vectors) leave the range of normal f32 numbers, 1.2e-38 to 3.4e38.
pub(super) const MAX_COORDINATE_M: f64 = 1e12;
/// See [`MAX_COORDINATE_M`].
pub(super) const MIN_EXTENT_M: f64 = 1e-12;

/// x ↦ `linear` x + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine {
    pub(super) linear: DMat3,
    pub(super) offset: DVec3,
    /// Whether it turns outward windings inward.
    pub(super) mirrors: bool,
}

impl Affine {
    /// Scale, then rotate about x, then y, then z, then translate.
    pub(super) fn new(scale: DVec3, rotate_deg: DVec3, translate: DVec3) -> Self {
        let rotation = rotation_z(rotate_deg.z) * rotation_y(rotate_deg.y) * rotation_x(rotate_deg.x);
        // Counted, not taken from the determinant, which vanishes for very small scales.
        let mirrors = scale.cmplt(DVec3::ZERO).bitmask().count_ones() % 2 == 1;
        Self { linear: rotation * DMat3::from_diagonal(scale), offset: translate, mirrors }
    }

    pub(super) fn point(&self, point: DVec3) -> DVec3 {
        self.linear * point + self.offset
    }

    /// A unit normal, carried along by the inverse transpose; `None` for a zero normal.
    pub(super) fn normal(&self, normal: DVec3) -> Option<DVec3> {
        // Columns of the cofactor matrix = determinant × inverse transpose: no division by a tiny determinant.
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.linear;
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let outward = if self.mirrors { -1.0 } else { 1.0 };
        unit(cofactors * unit(normal)? * outward)
    }
}

/// From the scene file's world to the rebased world: uniform scale, then an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    scale: f64,
    offset: DVec3,
    /// The point of the placed world that is (0, 0, 0) in the rebased one.
    pub(super) origin: DVec3,
}

impl Frame {
    /// Before rebasing.
    pub(super) fn placed(scale: f64, translate: DVec3) -> Self {
        Self { scale, offset: translate, origin: DVec3::ZERO }
    }

    /// Rebased to the grid point next to the centre of `bounds`, which are those of the placed scene. The grid is a
    /// power of two no smaller than the scene, so a scene around the origin stays where it is.
    pub(super) fn rebased(self, bounds: &Bounds) -> Self {
        let extent = (bounds.max - bounds.min).max_element();
        let grid = 2.0_f64.powi(extent.log2().ceil() as i32);
        // Ties to even: a scene whose lower corner is the origin keeps it as well.
        let origin = (bounds.centre() / grid).map(f64::round_ties_even) * grid;
        Self { offset: self.offset - origin, origin, ..self }
    }

    pub(super) fn point(&self, point: DVec3) -> DVec3 {
        self.scale * point + self.offset
    }

    pub(super) fn length(&self, length: f64) -> f64 {
        self.scale * length
    }

    /// First `inner`, then this.
    pub(super) fn after(&self, inner: &Affine) -> Affine {
        Affine { linear: inner.linear * self.scale, offset: self.point(inner.offset), ..*inner }
    }
}

/// The one rounding. Adding zero turns -0 into 0: a negative zero in a ray direction is an invitation to errors.
pub(super) fn rounded(vector: DVec3) -> Vec3 {
    vector.as_vec3() + Vec3::ZERO
}

/// The vector at length 1; `None` for zero. Safe for any magnitude.
pub(super) fn unit(vector: DVec3) -> Option<DVec3> {
    (vector / vector.abs().max_element()).try_normalize()
}

fn rotation_x(deg: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(deg);
    DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c))
}

fn rotation_y(deg: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(deg);
    DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c))
}

fn rotation_z(deg: f64) -> DMat3 {
    let (s, c) = sin_cos_deg(deg);
    DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z)
}

/// Exact for quarter turns, so that a floor turned by 90° is a wall in one plane.
fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let quarters = (deg / 90.0).round();
    let (s, c) = (deg - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u8 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3Swizzles;

    /// Products and sums of numbers around 1 to 10 in f64, a few roundings each.
    const ROUNDING: f64 = 1e-13;

    /// The slow way, one axis and one coordinate at a time.
    fn slow(scale: DVec3, rotate_deg: DVec3, translate: DVec3, p: DVec3) -> DVec3 {
        let turn = |a: &mut f64, b: &mut f64, deg: f64| {
            let (s, c) = deg.to_radians().sin_cos();
            (*a, *b) = (*a * c - *b * s, *a * s + *b * c);
        };
        let mut p = p * scale;
        turn(&mut p.y, &mut p.z, rotate_deg.x);
        turn(&mut p.z, &mut p.x, rotate_deg.y);
        turn(&mut p.x, &mut p.y, rotate_deg.z);
        p + translate
    }

    const SCALE: DVec3 = DVec3::new(2.0, 0.5, -3.0);
    const ROTATE_DEG: DVec3 = DVec3::new(30.0, -115.0, 200.0);
    const TRANSLATE: DVec3 = DVec3::new(-4.0, 1.0, 7.0);
    const POINT: DVec3 = DVec3::new(0.3, -0.7, 1.1);

    #[test]
    fn scale_then_rotate_x_y_z_then_translate() {
        let fast = Affine::new(SCALE, ROTATE_DEG, TRANSLATE).point(POINT);
        assert!(fast.distance(slow(SCALE, ROTATE_DEG, TRANSLATE, POINT)) < ROUNDING);
        let other_order = Affine::new(SCALE, ROTATE_DEG.zyx(), TRANSLATE).point(POINT);
        assert!(fast.distance(other_order) > 0.1, "the order matters, so the check above can fail");
    }

    #[test]
    fn quarter_turns_are_exact() {
        for (deg, expected) in
            [(90.0, DVec3::Y), (-90.0, -DVec3::Y), (450.0, DVec3::Y), (180.0, -DVec3::X), (1080.0, DVec3::X)]
        {
            let turned = Affine::new(DVec3::ONE, DVec3::new(0.0, 0.0, deg), DVec3::ZERO).point(DVec3::X);
            assert_eq!(turned, expected, "{deg}");
        }
    }

    #[test]
    fn normals_stay_perpendicular_and_outward_under_mirrored_and_uneven_scale() {
        let (a, b) = (DVec3::new(1.0, 0.2, 0.0), DVec3::new(-0.3, 1.0, 0.5));
        let affine = Affine::new(SCALE, ROTATE_DEG, TRANSLATE);
        assert!(affine.mirrors && affine.linear.determinant() < 0.0);
        let normal = affine.normal(a.cross(b)).unwrap();
        // Winding is reversed where the transform mirrors: the face normal is then b × a.
        let face_normal = (affine.linear * b).cross(affine.linear * a).normalize();
        assert!(normal.distance(face_normal) < ROUNDING);
        assert_eq!(affine.normal(DVec3::ZERO), None);
    }

    #[test]
    fn a_scene_around_the_origin_keeps_it_and_a_far_one_gets_its_own() {
        let bounds = |min: [f64; 3], max: [f64; 3]| Bounds { min: min.into(), max: max.into() };
        let frame = Frame::placed(1.0, DVec3::ZERO);
        assert_eq!(frame.rebased(&bounds([-1.0, 0.0, -3.0], [2.0, 4.0, 3.0])).origin, DVec3::ZERO);
        assert_eq!(frame.rebased(&bounds([0.0; 3], [4.0; 3])).origin, DVec3::ZERO);
        let far = frame.rebased(&bounds([1e6, 0.0, -3.0], [1e6 + 2.0, 4.0, 3.0]));
        assert_eq!(far.origin, DVec3::new(1e6, 0.0, 0.0));
        assert_eq!(far.point(DVec3::new(1e6 + 1.0, 2.0, 0.0)), DVec3::new(1.0, 2.0, 0.0));
    }
}
