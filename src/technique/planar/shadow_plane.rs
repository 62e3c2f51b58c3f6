//! A plane and a light: the matrix that flattens casters, and which side of what a point is on. All in f64; what goes
//! to the GPU is rounded once, at the end. Formulas: docs/planar.md.
//!
//! J. Blinn, "Me and My (Fake) Shadow", 1988; the clipping form after P. Heckbert, M. Herf, "Simulating Soft Shadows
//! with Graphics Hardware", 1997.

use crate::scene::{Light, Plane};
use glam::{DMat4, DVec3, DVec4};

/// A receiver plane, turned so that its light is above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowPlane {
    /// (a, b, c, e) with a unit normal: its product with a homogeneous point is the signed distance in metres.
    pub plane: DVec4,
    /// The homogeneous light.
    pub light: DVec4,
}

/// Where a point of the line through the light and a point of the plane lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Below the plane, away from the light: s < 0.
    Behind,
    /// Where a caster throws its shadow on the plane: 0 ≤ s < d.
    Between,
    /// Farther from the plane than the light: s ≥ d.
    Beyond,
}

impl ShadowPlane {
    /// Turns the plane's normal to the light's side.
    #[must_use]
    pub fn new(plane: &Plane, light: &Light) -> Self {
        let normal = plane.normal.as_dvec3().normalize();
        let plane = normal.extend(-normal.dot(plane.point.as_dvec3()));
        let light = light.homogeneous();
        Self { plane: if plane.dot(light) < 0.0 { -plane } else { plane }, light }
    }

    /// Unit normal on the light's side.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        self.plane.truncate()
    }

    /// Signed distance s of a point from the plane, metres, positive on the light's side.
    #[must_use]
    pub fn height_m(&self, point: DVec3) -> f64 {
        self.plane.dot(point.extend(1.0))
    }

    /// d: the light's height in metres, or the sine of a directional light's elevation above the plane.
    #[must_use]
    pub fn light_height(&self) -> f64 {
        self.plane.dot(self.light)
    }

    /// The point of the plane below a point.
    #[must_use]
    pub fn foot(&self, point: DVec3) -> DVec3 {
        point - self.height_m(point) * self.normal()
    }

    /// Where a point at that height lies.
    #[must_use]
    pub fn side(&self, height_m: f64) -> Side {
        if height_m < 0.0 {
            Side::Behind
        } else if height_m * self.light.w >= self.light_height() {
            Side::Beyond
        } else {
            Side::Between
        }
    }

    /// M = d I − L plᵀ: takes a homogeneous point to its shadow on the plane, whose w is d − s for a point light.
    #[must_use]
    pub fn flat_from_world(&self) -> DMat4 {
        let outer = self.plane.to_array().map(|coefficient| self.light * coefficient);
        DMat4::from_diagonal(DVec4::splat(self.light_height()))
            - DMat4::from_cols_slice(&outer.map(|c| c.to_array()).concat())
    }

    /// The camera's matrix after M, with the row of depth replaced by `depth_per_m` × the plane: clip space 0 ≤ z ≤ w
    /// then removes s < 0 exactly, and s ≥ d by w.
    #[must_use]
    pub fn clipped(&self, clip_from_world: &DMat4, depth_per_m: f64) -> DMat4 {
        let mut rows = (*clip_from_world * self.flat_from_world()).transpose();
        rows.z_axis = self.plane * depth_per_m;
        rows.transpose()
    }

    /// The shadow of a point; `None` where it has none, at the light's height. Beyond the light it is the image that
    /// lines through the light give, which no shadow is.
    #[must_use]
    pub fn divided(&self, point: DVec3) -> Option<DVec3> {
        let flat = self.flat_from_world() * point.extend(1.0);
        (flat.w != 0.0).then(|| flat.truncate() / flat.w)
    }

    /// The shadow of a point by one slope for its whole object: from the light to the foot of the object's `origin`.
    /// Exact for a directional light. A Slovak thesis that surveys planar shadows, maps and volumes has it for the
    /// planes x = 0, y = 0 and z = 0; by heights and feet it is the same on any plane.
    #[must_use]
    pub fn sheared(&self, point: DVec3, origin: DVec3) -> DVec3 {
        let above = self.light_height() * self.normal();
        let across = if self.light.w == 0.0 {
            above - self.light.truncate()
        } else {
            self.foot(origin) - self.foot(self.light.truncate())
        };
        self.foot(point) + self.height_m(point) / self.light_height() * across
    }

    /// Where a ray meets the plane: the multiple of `direction`; `None` if it is parallel to it.
    #[must_use]
    pub fn along_ray(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let along = -self.height_m(origin) / self.normal().dot(direction);
        along.is_finite().then_some(along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LightKind;
    use glam::{DVec2, Vec3, dcamera::rh};
    use proptest::prelude::*;

    fn light(kind: LightKind) -> Light {
        Light { name: "light".to_owned(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY }
    }

    fn point_light(position: DVec3) -> Light {
        light(LightKind::Point { position: position.as_vec3(), aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] })
    }

    fn floor(light_at: DVec3) -> ShadowPlane {
        ShadowPlane::new(&Plane { point: Vec3::ZERO, normal: Vec3::Y }, &point_light(light_at))
    }

    /// Where the line through light and point meets the plane, by the parameter of the line.
    fn ray_hit(shadow: &ShadowPlane, point: DVec3) -> DVec3 {
        let light = shadow.light;
        let towards = if light.w == 0.0 { -light.truncate() } else { point - light.truncate() };
        point - towards * (shadow.height_m(point) / shadow.normal().dot(towards))
    }

    fn unit() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_filter_map("too short", |v| DVec3::from_array(v).try_normalize())
    }

    fn anywhere(half: f64) -> impl Strategy<Value = DVec3> {
        [-half..half, -half..half, -half..half].prop_map(DVec3::from_array)
    }

    /// Rounding of a few f64 operations on coordinates up to 10, divided by d − s of at least 0.1 twice.
    const F64_ROUNDING: f64 = 1e-10;
    /// The same through a matrix rounded to f32.
    const F32_ROUNDING: f64 = 1e-5;

    proptest! {
        #[test]
        fn the_matrix_maps_every_point_to_the_ray_hit(
            normal in unit(), on_plane in anywhere(3.0), at in anywhere(10.0), point in anywhere(5.0), sun in any::<bool>()
        ) {
            let kind = LightKind::Directional { towards_light: at.normalize_or(DVec3::Y).as_vec3() };
            let light = if sun { light(kind) } else { point_light(at) };
            let shadow = ShadowPlane::new(&Plane { point: on_plane.as_vec3(), normal: normal.as_vec3() }, &light);
            let (d, s) = (shadow.light_height(), shadow.height_m(point));
            prop_assume!(d > 0.1 && (d - s * shadow.light.w).abs() > 0.1);
            let expected = ray_hit(&shadow, point);
            let size = 1.0 + expected.length() + point.length();
            let image = shadow.divided(point).unwrap();
            prop_assert!((image - expected).length() < F64_ROUNDING * size, "{image} {expected}");
            let rounded = shadow.flat_from_world().as_mat4().as_dmat4() * point.extend(1.0);
            prop_assert!((rounded.truncate() / rounded.w - expected).length() < F32_ROUNDING * size * size);
        }

        #[test]
        fn the_matrix_has_the_properties_of_a_projection(normal in unit(), at in anywhere(10.0), point in anywhere(5.0)) {
            let shadow =
                ShadowPlane::new(&Plane { point: Vec3::ZERO, normal: normal.as_vec3() }, &point_light(at));
            let (m, d) = (shadow.flat_from_world(), shadow.light_height());
            let largest = |v: DVec4| v.abs().max_element();
            prop_assert!(largest(m * shadow.light) < F64_ROUNDING * d.max(1.0), "the light has no shadow");
            prop_assert!(largest(m.transpose() * shadow.plane) < F64_ROUNDING, "every shadow is on the plane");
            prop_assert!(m.determinant().abs() < F64_ROUNDING * 10.0_f64.powi(4), "it flattens");
            let (twice, once) = (m * m * point.extend(1.0), d * (m * point.extend(1.0)));
            prop_assert!(largest(twice - once) < F64_ROUNDING * (1.0 + largest(once)));
            let on_plane = shadow.foot(point).extend(1.0);
            prop_assert!(largest(m * on_plane - d * on_plane) < F64_ROUNDING);
        }
    }

    #[test]
    fn a_worked_example() {
        let shadow = floor(DVec3::new(0.0, 4.0, 0.0));
        assert_eq!(shadow.flat_from_world() * DVec4::new(1.0, 2.0, 0.0, 1.0), DVec4::new(4.0, 0.0, 0.0, 2.0));
        assert_eq!(shadow.divided(DVec3::new(1.0, 2.0, 0.0)), Some(DVec3::new(2.0, 0.0, 0.0)));
        assert_eq!(shadow.divided(DVec3::new(1.0, 4.0, 0.0)), None);
        let sides = [-0.1, 0.0, 3.9, 4.0, 5.0].map(|height| shadow.side(height));
        assert_eq!(sides, [Side::Behind, Side::Between, Side::Between, Side::Beyond, Side::Beyond]);
    }

    #[test]
    fn the_normal_turns_to_the_light_whichever_way_it_was_given() {
        let light = point_light(DVec3::new(1.0, 4.0, 0.0));
        let turned = |normal| ShadowPlane::new(&Plane { point: Vec3::ZERO, normal }, &light);
        assert_eq!(turned(Vec3::Y), turned(Vec3::NEG_Y));
        assert_eq!(turned(Vec3::NEG_Y).light_height(), 4.0);
    }

    #[test]
    fn a_point_light_far_away_becomes_directional() {
        let direction = DVec3::new(0.3, 0.9, -0.2).normalize();
        let kind = LightKind::Directional { towards_light: direction.as_vec3() };
        let sun = ShadowPlane::new(&Plane { point: Vec3::ZERO, normal: Vec3::Y }, &light(kind));
        let point = DVec3::new(0.4, 1.3, 0.2);
        let limit = sun.divided(point).unwrap();
        let errors = [1e1, 1e2, 1e3, 1e4].map(|k| {
            let near = ShadowPlane { light: (direction * k).extend(1.0), ..sun };
            (near.divided(point).unwrap() - limit).length()
        });
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((9.0..13.0).contains(&ratio), "falls as 1/k: {errors:?}");
        }
    }

    #[test]
    fn a_caster_is_magnified_by_its_height() {
        let shadow = floor(DVec3::new(0.0, 1.0, 0.0));
        for (height, magnification) in [(0.5, 2.0), (0.9, 10.0), (0.99, 100.0)] {
            let [left, right] = [-0.5, 0.5].map(|x| shadow.divided(DVec3::new(x, height, 0.0)).unwrap());
            assert!(((right - left).length() - magnification).abs() < 1e-12 * magnification);
        }
    }

    #[test]
    fn shear_falls_short_of_the_exact_shadow() {
        let at = DVec3::new(0.0, 10.0, 0.0);
        let point = DVec3::new(1.0, 5.0, 0.0);
        assert_eq!(floor(at).sheared(point, point), DVec3::new(1.5, 0.0, 0.0));
        assert_eq!(floor(at).divided(point), Some(DVec3::new(2.0, 0.0, 0.0)));
    }

    #[test]
    fn a_sheared_shadow_has_a_size_that_does_not_depend_on_the_light() {
        let origin = DVec3::new(2.0, 0.0, 0.0);
        let width = |distance: f64| {
            // The slope (ox − lx)/ly stays; only the distance changes.
            let shadow = floor(DVec3::new(2.0 - 0.5 * distance, distance, 0.0));
            let ends = [-0.5, 0.5].map(|x| shadow.sheared(DVec3::new(2.0 + x, 1.0, 0.0), origin));
            (ends[1] - ends[0]).length()
        };
        assert!((width(3.0) - width(300.0)).abs() < 1e-12);
        assert!((width(3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn shear_becomes_exact_as_the_light_recedes() {
        let (origin, point) = (DVec3::new(0.2, 0.8, 0.1), DVec3::new(0.5, 1.0, 0.3));
        let direction = DVec3::new(0.4, 1.0, -0.3);
        let errors = [1e1, 1e2, 1e3, 1e4].map(|k| {
            let shadow = floor(direction * k);
            // Through f32 the light keeps seven digits, far below the error looked at.
            (shadow.sheared(point, origin) - shadow.divided(point).unwrap()).length()
        });
        assert!(errors.windows(2).all(|pair| pair[1] < 0.2 * pair[0]), "{errors:?}");
        let kind = LightKind::Directional { towards_light: direction.normalize().as_vec3() };
        let sun = ShadowPlane::new(&Plane { point: Vec3::ZERO, normal: Vec3::Y }, &light(kind));
        assert!((sun.sheared(point, origin) - sun.divided(point).unwrap()).length() < 1e-12);
    }

    #[test]
    fn clip_space_keeps_what_is_between_plane_and_light() {
        let shadow = floor(DVec3::new(0.0, 4.0, 0.0));
        let view = rh::view::look_at_mat4(DVec3::new(0.0, 5.0, 9.0), DVec3::ZERO, DVec3::Y);
        let clip_from_world = rh::proj::directx::perspective_infinite_reverse(1.0, 4.0 / 3.0, 0.1) * view;
        let clipped = shadow.clipped(&clip_from_world, 1e-7);
        let is_kept = |matrix: &DMat4, point: DVec3| {
            let clip = *matrix * point.extend(1.0);
            clip.w > 0.0 && clip.z >= 0.0 && clip.z <= clip.w
        };
        let naive = clip_from_world * shadow.flat_from_world();
        let (valid, behind, beyond) =
            (DVec3::new(0.1, 1.0, 0.0), DVec3::new(0.1, -1.0, 0.0), DVec3::new(0.1, 4.5, 0.0));
        assert_eq!([valid, behind, beyond].map(|p| is_kept(&clipped, p)), [true, false, false]);
        assert_eq!([valid, behind, beyond].map(|p| is_kept(&naive, p)), [true, true, false]);
        // The picture's place of a kept point is that of its shadow.
        let clip = clipped * valid.extend(1.0);
        let image = clip_from_world * shadow.divided(valid).unwrap().extend(1.0);
        let ndc = |v: DVec4| DVec2::new(v.x, v.y) / v.w;
        assert!((ndc(clip) - ndc(image)).length() < 1e-12);
        // Turned to the wrong side, the plane loses every valid caster.
        let flipped = ShadowPlane { plane: -shadow.plane, ..shadow }.clipped(&clip_from_world, 1e-7);
        for height in [0.01, 0.5, 2.0, 3.9] {
            let point = DVec3::new(0.1, height, 0.0);
            assert!(is_kept(&clipped, point) && !is_kept(&flipped, point), "{height}");
        }
    }
}
