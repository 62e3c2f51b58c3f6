//! The camera: checked after rounding, because it is the rounded numbers that must make a matrix.

use super::{
    super::{
        Camera, Far,
        distance::distance_to_triangle,
        error::SceneError,
        file::{CameraEntry, FarEntry},
        source::Source,
    },
    check::Entry,
    meshes::Geometry,
    transform::{Frame, rounded},
};
use glam::DVec3;

const DEFAULT_UP: [f64; 3] = [0.0, 1.0, 0.0];
const DEFAULT_FOV_Y_DEG: f64 = 45.0;

/// Share of the distance to the nearest geometry at which a fitted near plane lies: far enough in front of it.
const NEAR_SHARE: f64 = 1e-3;
/// Smallest fitted near plane as a share of the scene's extent, for eyes on the geometry.
const NEAR_FLOOR_SHARE: f64 = 1e-6;
/// Smallest sine of the angle between `up` and the view: below it, f32 rounding of the eye decides where up is.
const PARALLEL_SINE: f64 = 1e-5;

/// Checks and places the camera.
pub(super) fn build(
    camera: &CameraEntry,
    source: &Source,
    frame: &Frame,
    geometry: &Geometry,
) -> Result<Camera, SceneError> {
    let entry = Entry::new(source, "camera");
    let eye = rounded(entry.point("eye", camera.eye, frame)?);
    let target = rounded(entry.point("target", camera.target, frame)?);
    let up = entry.direction("up", camera.up.unwrap_or(DEFAULT_UP))?;
    let Some(view) = (target.as_dvec3() - eye.as_dvec3()).try_normalize() else {
        let problem = format!("and target are the same point {:?} (in f32): the camera looks nowhere", camera.eye);
        return Err(entry.fault("eye", problem));
    };
    if view.cross(up).length() < PARALLEL_SINE {
        let problem = format!(
            "= {:?} is parallel to the view from eye to target: choose another direction, such as [0, 0, -1]",
            up.to_array()
        );
        return Err(entry.fault("up", problem));
    }
    let fov_y_deg = camera.fov_y_deg.unwrap_or(DEFAULT_FOV_Y_DEG);
    let fov_y_deg = entry.number("fov_y_deg", fov_y_deg, |v| v > 0.0 && v < 180.0, "above 0 and below 180 degrees")?;
    let near_m = match camera.near {
        Some(near) => frame.length(entry.number("near", near, |v| v > 0.0, "above 0 metres")?),
        None => fitted_near_m(eye.as_dvec3(), geometry),
    };
    let far = far(&entry, camera, frame, near_m)?;
    Ok(Camera { eye, target, up: rounded(up), fov_y_rad: fov_y_deg.to_radians(), near_m, far })
}

fn far(entry: &Entry<'_>, camera: &CameraEntry, frame: &Frame, near_m: f64) -> Result<Far, SceneError> {
    match &camera.far {
        None => Ok(Far::Infinite),
        Some(FarEntry::Word(word)) => entry.choice("far", word, &[("infinite", Far::Infinite)]),
        Some(FarEntry::Distance(far)) => {
            let far_m = frame.length(*far);
            entry.number(
                "far",
                *far,
                |_| far_m > near_m,
                &format!("\"infinite\" or a number beyond the near plane at {near_m} m"),
            )?;
            Ok(Far::Finite(far_m))
        }
    }
}

/// In front of the nearest triangle, wherever its mesh's box may reach.
fn fitted_near_m(eye: DVec3, geometry: &Geometry) -> f64 {
    let corners = |triangle: &[u32; 3]| triangle.map(|v| geometry.positions[v as usize].as_dvec3());
    let distances = geometry.triangles.iter().map(|triangle| distance_to_triangle(eye, corners(triangle)));
    let nearest = distances.fold(f64::INFINITY, f64::min);
    let bounds = geometry.bounds();
    let floor = NEAR_FLOOR_SHARE * (bounds.max - bounds.min).max_element();
    (NEAR_SHARE * nearest).max(floor)
}
