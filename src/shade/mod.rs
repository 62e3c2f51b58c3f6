//! A lit picture from receivers and masks, per pixel on the CPU. Formulas: docs/lighting.md.
//!
//! ```text
//! I = Ke + Ka Ia + Σ V f_att g_spot I_light (Kd/π max(0, n·l) + Ks spec)       over the lights
//! ```
//!
//! The visibility V is all that a shadow technique supplies: it scales one light's diffuse and specular term and
//! touches neither ambient nor emission. Normals are for lighting only and never decide a shadow.

mod attenuation;
mod brdf;
mod encode;
mod interpolate;
mod overlay;
mod pipeline;
mod terminator;

pub use attenuation::{Incident, incident, incidents};
pub use overlay::{Overlay, Stroke};
pub use pipeline::Pipeline;
pub use terminator::terminator;

use crate::mask::{Mask, Visibility};
use crate::receiver::{Receiver, Receivers};
use crate::scene::{Emitter, Light, Material, Scene, Shading};
use brdf::reflected;
use glam::{DVec3, UVec2, Vec3};
use interpolate::Facet;
use rayon::prelude::*;

/// What pixels without geometry show: a neutral grey of 18 % reflectance, darker than most lit surfaces, lighter than shadow.
pub const BACKGROUND: Vec3 = Vec3::splat(0.18);

/// A lit picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: UVec2,
    /// Linear RGB, not clamped, row by row from the top; `size.x * size.y` entries.
    pub linear_rgb: Vec<Vec3>,
}

/// Lights the receivers. Each light comes with the mask that shadows it; lights that are not listed are off.
///
/// Pixels that a mask leaves out, or that show a mesh that does not receive shadows, have V = 1. A mask that is to
/// darken facets turned away from the light, which nobody asks about, holds V = 0 there.
#[must_use]
pub fn shade(scene: &Scene, receivers: &Receivers, lights: &[(&Light, &Mask)], pipeline: Pipeline) -> Picture {
    let emitters: Vec<Emitter> = lights.iter().map(|(light, _)| Emitter::new(light)).collect();
    let pixel_colour = |(pixel, receiver): (usize, &Option<Receiver>)| match receiver {
        None => BACKGROUND,
        Some(receiver) => {
            let takes_shadow = scene.mesh_of(receiver.triangle).receives;
            let lit: Vec<(f64, DVec3)> = (lights.iter().zip(&emitters))
                .map(|((light, mask), emitter)| {
                    let visibility = mask.pixels.get(pixel).copied().flatten().filter(|_| takes_shadow);
                    let visibility = visibility.unwrap_or(Visibility::LIT).get();
                    (visibility.into(), direct_light(scene, receiver, light, emitter))
                })
                .collect();
            pipeline.colour(own_colour(scene, material_of(scene, receiver)), lit.into_iter()).as_vec3()
        }
    };
    let linear_rgb = receivers.pixels.par_iter().enumerate().map(pixel_colour).collect();
    Picture { size: receivers.size, linear_rgb }
}

/// Direct light of one area light, each of whose points is seen or not: the picture that a mask's average over the
/// points can only come near. `seen` says of a pixel what its receiver sees of [`Emitter`]'s points, in order; pixels
/// without an answer are dark. There is neither ambient light nor emission.
#[must_use]
pub fn shade_points(
    scene: &Scene,
    receivers: &Receivers,
    light: &Light,
    seen: impl Fn(usize) -> Option<Vec<bool>> + Sync,
) -> Picture {
    let emitter = Emitter::new(light);
    let pixel_colour = |(pixel, receiver): (usize, &Option<Receiver>)| {
        let (Some(receiver), Some(seen)) = (receiver, seen(pixel)) else { return Vec3::ZERO };
        direct_light_through(scene, receiver, light, &emitter, |point| seen[point]).as_vec3()
    };
    let linear_rgb = receivers.pixels.par_iter().enumerate().map(pixel_colour).collect();
    Picture { size: receivers.size, linear_rgb }
}

fn material_of<'a>(scene: &'a Scene, receiver: &Receiver) -> &'a Material {
    &scene.materials[scene.triangle_material[receiver.triangle as usize] as usize]
}

/// What no shadow changes: emission and ambient light.
fn own_colour(scene: &Scene, material: &Material) -> DVec3 {
    (material.emission + material.ambient * scene.ambient).as_dvec3()
}

/// What one light adds where nothing blocks it. Gouraud shading lights the corners and interpolates their colours (H.
/// Gouraud, "Continuous Shading of Curved Surfaces", 1971), the others light the point itself.
fn direct_light(scene: &Scene, receiver: &Receiver, light: &Light, emitter: &Emitter) -> DVec3 {
    direct_light_through(scene, receiver, light, emitter, |_| true)
}

/// The same from those of the light's points that are seen.
fn direct_light_through(
    scene: &Scene,
    receiver: &Receiver,
    light: &Light,
    emitter: &Emitter,
    is_seen: impl Fn(usize) -> bool,
) -> DVec3 {
    let material = material_of(scene, receiver);
    let lit = |point: DVec3, normal: DVec3| {
        let towards_eye = (scene.camera.eye.as_dvec3() - point).normalize_or_zero();
        incidents(light, emitter, scene.mode, point)
            .filter(|(index, _)| is_seen(*index))
            .map(|(_, incident)| {
                incident.strength * reflected(scene, material, normal, incident.towards_light, towards_eye)
            })
            .sum::<DVec3>()
    };
    match scene.shading {
        Shading::Flat => lit(receiver.point_in_world, receiver.normal_in_world),
        Shading::Phong | Shading::BlinnPhong => {
            lit(receiver.point_in_world, Facet::new(scene, receiver).shading_normal())
        }
        Shading::Gouraud => {
            let facet = Facet::new(scene, receiver);
            facet.interpolate(std::array::from_fn(|k| lit(facet.corners[k], facet.normals[k])))
        }
    }
}

#[cfg(test)]
mod tests;
