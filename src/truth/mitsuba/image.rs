//! Whole images by Mitsuba's own camera, emitters and integrator: one light of a scene over diffuse surfaces.

use super::blocks::Writer;
use super::{Mitsuba, MitsubaError};
use crate::scene::{Falloff, Light, LightKind, Scene};
use glam::{DVec3, UVec2, Vec3};
use image::ImageReader;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Samples of an area light in each pixel; a light without extent needs one.
const DRAWS: u32 = 256;

/// Radiance per pixel, linear RGB, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendering {
    /// Width and height in pixels.
    pub size: UVec2,
    /// The estimate; NaN where the camera looks into the light.
    pub mean: Vec<Vec3>,
    /// The estimate's variance; 0 for a light without extent.
    pub variance: Vec<Vec3>,
}

/// How good two images look side by side (P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images",
/// 2020), for information: a mean hides what counts show.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Flip {
    /// Mean over the picture.
    pub mean: f64,
    /// Largest value of a pixel.
    pub max: f64,
    /// Pixels above 0.1.
    pub above_a_tenth: u64,
}

impl Mitsuba {
    /// Renders the scene, all of whose meshes cast and whose surfaces are taken for matt, lit by one light.
    ///
    /// # Errors
    /// [`MitsubaError`]; a falloff that Mitsuba does not have is [`MitsubaError::Answer`].
    pub fn render(&mut self, scene: &Scene, light: &Light) -> Result<Rendering, MitsubaError> {
        let camera = &scene.camera;
        let view = json!({
            "eye": vector(camera.eye), "target": vector(camera.target), "up": vector(camera.up),
            "fov_y_deg": camera.fov_y_rad.to_degrees(), "near_m": camera.near_m, "size": scene.image_size.to_array(),
        });
        let draws = if light.is_area() { DRAWS } else { 1 };
        let about = json!({
            "task": "render", "unit_m": self.unit_m, "view": view, "light": described(scene, light)?, "draws": draws, "seed": 1,
        });
        let corners = scene.triangles.iter().flatten().flat_map(|v| scene.positions[*v as usize].to_array());
        let job = Writer::new(about)
            .f32s("corners", corners, &[3, 3])
            .u32s("material", scene.triangle_material.iter().copied())
            .f32s("diffuse", scene.materials.iter().flat_map(|material| material.diffuse.to_array()), &[3]);
        let answer = self.process.ask(job)?;
        let image = |name: &str| {
            let path: PathBuf = answer.about(name).map_err(MitsubaError::Answer)?;
            let pixels = ImageReader::open(&path)?.decode().map_err(|error| MitsubaError::Answer(error.to_string()))?;
            std::fs::remove_file(&path)?;
            if UVec2::new(pixels.width(), pixels.height()) != scene.image_size {
                return Err(MitsubaError::Answer("an image of another size".to_owned()));
            }
            Ok(pixels.to_rgb32f().pixels().map(|pixel| Vec3::from_array(pixel.0)).collect())
        };
        Ok(Rendering { size: scene.image_size, mean: image("mean")?, variance: image("variance")? })
    }

    /// Compares two pictures of one size, both scaled so that `white` is white.
    ///
    /// # Errors
    /// [`MitsubaError`].
    pub fn flip(&mut self, size: UVec2, ours: &[Vec3], theirs: &[Vec3], white: f32) -> Result<Flip, MitsubaError> {
        let row = [size.x as usize, 3];
        let scaled = |pixels: &[Vec3]| -> Vec<f32> {
            let known = pixels.iter().map(|pixel| if pixel.is_finite() { *pixel / white } else { Vec3::ZERO });
            known.flat_map(|pixel| pixel.to_array()).collect()
        };
        let job =
            Writer::new(json!({"task": "flip"})).f32s("ours", scaled(ours), &row).f32s("theirs", scaled(theirs), &row);
        let answer = self.process.ask(job)?;
        let flip = || {
            Ok(Flip {
                mean: answer.about("mean")?,
                max: answer.about("max")?,
                above_a_tenth: answer.about("above_a_tenth")?,
            })
        };
        flip().map_err(MitsubaError::Answer)
    }
}

fn vector(of: Vec3) -> [f64; 3] {
    of.as_dvec3().to_array()
}

/// How far a sun stands from the scene, radii of the scene: directions to it differ by no more than that.
const SUN_RADII: f64 = 1e5;

/// A light as the job tells it; `oracle/gnomon_oracle/render.py` makes Mitsuba's of it.
fn described(scene: &Scene, light: &Light) -> Result<Value, MitsubaError> {
    let mut described = match light.kind {
        LightKind::Point { position, .. } => json!({"position": vector(position)}),
        LightKind::Directional { towards_light } => json!({"direction": vector(-towards_light)}),
        LightKind::Spot { position, axis, outer_rad, falloff, .. } => {
            let inner_rad = match falloff {
                Falloff::Linear { inner_rad } => inner_rad,
                Falloff::Hard => outer_rad,
                Falloff::Warn { .. } => {
                    return Err(MitsubaError::Answer("its spot lights have no falloff `warn`".to_owned()));
                }
            };
            json!({
                "position": vector(position), "axis": axis.as_dvec3().try_normalize().unwrap_or(DVec3::NEG_Y).to_array(),
                "outer_deg": outer_rad.to_degrees(), "inner_deg": inner_rad.to_degrees(),
            })
        }
        LightKind::Rectangle { position, half_width, half_height, .. } => json!({
            "position": vector(position), "half_width": vector(half_width), "half_height": vector(half_height),
        }),
        LightKind::Sphere { position, radius_m, .. } => {
            json!({"position": vector(position), "radius_m": f64::from(radius_m)})
        }
        LightKind::Sun { towards_light, angular_radius_rad, .. } => {
            let bounds = scene.bounds();
            let position = bounds.centre() + towards_light.as_dvec3() * (SUN_RADII * bounds.radius());
            let radius_m = angular_radius_rad.tan() * SUN_RADII * bounds.radius();
            json!({
                "position": position.to_array(), "radius_m": radius_m, "direction": vector(-towards_light),
                "sine": angular_radius_rad.sin(),
            })
        }
    };
    described["kind"] = json!(light.kind_name());
    described["intensity"] = json!(vector(light.intensity));
    Ok(described)
}
