//! Three ways in which renderers apply one mask, on the GPU: ambient light and then each light where it is seen; the same
//! on black; all light and then a dark quad over each shadow. Not a technique: it takes whatever mask one made.
//!
//! The stencil decides where a light is drawn, as in T. Heidmann, "Real Shadows, Real Time", 1991. Colours are halves, so
//! that lights can be added up on any adapter. Point, directional and spot lights. The f64 twin is `shade`; formulas:
//! docs/lighting.md#pipelines.

mod buffers;
mod passes;

use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Geometry, Gpu, GpuError};
use crate::mask::Mask;
use crate::scene::{Light, Scene};
use glam::Vec3;

const SURFACE: Wgsl = wgsl!("lighting/surface.wgsl");
const SHADOW: Wgsl = wgsl!("lighting/shadow.wgsl");

/// Every shader module of the lighting pipelines, as label and files.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    [("lighting surface", vec![SURFACE]), ("lighting shadow", vec![SHADOW])]
        .map(|(label, files)| (label.to_owned(), files))
        .to_vec()
}

/// What a mask is applied to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LightingPipeline {
    /// Ambient light everywhere, then each light where it is seen.
    #[default]
    AmbientLit,
    /// Depth only, then all of the lighting where a light is seen: shadows are black.
    Black,
    /// All of the lighting, then a dark quad blended over each light's shadow.
    Darkening {
        /// How much of the light the quad takes away, 0..=1.
        amount: f64,
    },
}

/// The lit scene in linear RGB, row by row from the top; pixels without geometry show `background`. What a mask leaves
/// out is lit. Area lights are taken for the points at their centres.
///
/// # Errors
/// What the device reported.
pub fn light_up(
    gpu: &Gpu,
    scene: &Scene,
    geometry: &Geometry,
    lights: &[(&Light, &Mask)],
    pipeline: LightingPipeline,
    background: Vec3,
) -> Result<Vec<Vec3>, GpuError> {
    let drawn = passes::Lighting { gpu, scene, geometry, pipeline, background };
    drawn.run(lights)
}
