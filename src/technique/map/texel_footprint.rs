//! The footprint of a map's texel at a receiver: docs/footprint.md.

use super::projection::Site;
use crate::receiver::Receiver;
use crate::technique::Job;
use crate::technique::footprint::{Footprint, FootprintInput};

/// For a receiver as its view sees it. `None` where the light sees its surface edge-on.
pub(in crate::technique) fn texel_footprint(job: &Job<'_>, site: &Site<'_>, receiver: &Receiver) -> Option<Footprint> {
    let (camera, image_size) = (&job.scene.camera, job.scene.image_size);
    let to_eye = camera.eye.as_dvec3() - receiver.point_in_world;
    let light = job.light.homogeneous();
    let to_light = light.truncate() - receiver.point_in_world * light.w;
    let pixel_at_unit_distance = 2.0 * (0.5 * camera.fov_y_rad).tan() / f64::from(image_size.y);
    Footprint::new(&FootprintInput {
        clip_from_world: &camera.clip_from_world(image_size),
        image_size,
        position_in_texels: site.position_in_texels(),
        texel_steps_m: site.texel_steps_m(receiver.normal_in_world),
        point_in_world: receiver.point_in_world,
        normal_in_world: receiver.normal_in_world,
        towards_eye: to_eye.normalize_or_zero(),
        towards_light: to_light.normalize_or_zero(),
        texel_m: site.texel_m().max_element(),
        pixel_m: pixel_at_unit_distance * to_eye.length(),
    })
}
