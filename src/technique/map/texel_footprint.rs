//! The footprint of a map's texel at a receiver: docs/footprint.md.

use super::projection::LightFrustum;
use crate::receiver::Receiver;
use crate::technique::Job;
use crate::technique::footprint::{Footprint, FootprintInput};

/// For a receiver whose place in the map has the homogeneous `q`. `None` where the light sees its surface edge-on.
pub(in crate::technique) fn texel_footprint(
    job: &Job<'_>,
    frustum: &LightFrustum,
    receiver: &Receiver,
    q: f64,
) -> Option<Footprint> {
    let (camera, image_size) = (&job.scene.camera, job.scene.image_size);
    let to_eye = camera.eye.as_dvec3() - receiver.point_in_world;
    let light = job.light.homogeneous();
    let to_light = light.truncate() - receiver.point_in_world * light.w;
    // q is the distance along the axis; the texel's width across the ray grows with the ray's length.
    let along_ray = if light.w == 0.0 { 1.0 } else { to_light.length() / q };
    let pixel_at_unit_distance = 2.0 * (0.5 * camera.fov_y_rad).tan() / f64::from(image_size.y);
    Footprint::new(&FootprintInput {
        clip_from_world: &camera.clip_from_world(image_size),
        image_size,
        map_from_world: &frustum.map_from_world.as_dmat4(),
        map_size: frustum.texels,
        point_in_world: receiver.point_in_world,
        normal_in_world: receiver.normal_in_world,
        towards_eye: to_eye.normalize_or_zero(),
        towards_light: to_light.normalize_or_zero(),
        texel_m: frustum.texel_m(q).max_element() * along_ray,
        pixel_m: pixel_at_unit_distance * to_eye.length(),
    })
}
