//! The exact start of a z-pass count: casters projected from the light onto the camera's near plane.
//!
//! S. Hornus, J. Hoberock, S. Lefebvre, J. Hart, "ZP+: Correct Z-pass Stencil Shadows", 2005. A pixel's near-plane point
//! lies in as many volumes as casting triangles are projected onto it. Formulas: docs/volume.md#zp-plus.

use super::pyramid::{LEAST_SINE, sine_to_plane};
use glam::{DMat4, DVec4, Mat4};

/// Scale of the depth that clips at the plane, per metre of near distance: small, so that the far side of the depth
/// range clips only casters within that share of the light's distance from the light.
const DEPTH_SCALE: f64 = 1e-6;

/// World to clip through the light onto the near plane, rounded; casters behind the plane or beyond the light are
/// clipped. `None` if the light lies in the plane.
pub(super) fn clip_from_caster(clip_from_world: &DMat4, near_m: f64, near_plane: DVec4, light: DVec4) -> Option<Mat4> {
    let sine = sine_to_plane(near_plane, light);
    if sine.abs() <= LEAST_SINE {
        return None;
    }
    let plane = if sine > 0.0 { near_plane } else { -near_plane };
    let onto_plane = plane.dot(light) * DMat4::IDENTITY - outer(light, plane);
    let mut rows = (*clip_from_world * onto_plane).transpose();
    rows.z_axis = DEPTH_SCALE * near_m * plane;
    // Any positive factor is the same projection; this one keeps f32 in range.
    let size = rows.w_axis.abs().max_element().max(f64::MIN_POSITIVE);
    Some((rows.transpose() * size.recip()).as_mat4())
}

/// a bᵀ.
fn outer(a: DVec4, b: DVec4) -> DMat4 {
    DMat4::from_cols(a * b.x, a * b.y, a * b.z, a * b.w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, dcamera::rh};

    const NEAR_M: f64 = 0.1;
    /// At z = −0.1 before an eye at the origin that looks along −z.
    const PLANE: DVec4 = DVec4::new(0.0, 0.0, -1.0, -NEAR_M);

    #[test]
    fn a_caster_lands_where_its_shadow_meets_the_near_plane() {
        let clip_from_world = rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, NEAR_M);
        let light = DVec4::new(0.3, 0.2, 4.0, 1.0);
        let matrix = clip_from_caster(&clip_from_world, NEAR_M, PLANE, light).unwrap();
        let on_plane = DVec3::new(0.02, -0.01, -NEAR_M);
        let caster = light.truncate().lerp(on_plane, 0.6);
        let clip = matrix.as_dmat4() * caster.extend(1.0);
        let wanted = clip_from_world * on_plane.extend(1.0);
        assert!((clip.truncate().truncate() / clip.w - wanted.truncate().truncate() / wanted.w).length() < 1e-5);
        assert!(clip.w > 0.0 && clip.z > 0.0 && clip.z < clip.w);
        let behind = matrix.as_dmat4() * light.truncate().lerp(on_plane, 1.2).extend(1.0);
        assert!(behind.z < 0.0, "behind the plane as seen from the light");
        let beyond = matrix.as_dmat4() * light.truncate().lerp(on_plane, -0.2).extend(1.0);
        assert!(beyond.w < 0.0, "beyond the light");
    }

    #[test]
    fn a_light_in_the_plane_projects_nothing() {
        assert_eq!(clip_from_caster(&DMat4::IDENTITY, NEAR_M, PLANE, DVec4::new(2.0, 1.0, -NEAR_M, 1.0)), None);
    }
}
