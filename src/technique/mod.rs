//! Shadow techniques: one trait, one registry. A technique answers, on the GPU, the same question as the truth (what
//! fraction of this light does this receiver see?), and replays itself on the CPU in f64 so that every wrong pixel can
//! be explained.
//!
//! Adding one: a Rust file (or folder) here, at most one WGSL file of the same stem in `shaders/`, one line in
//! [`registry`]. Tests, CLI and reports pick it up from there.

mod ascending;
mod cost;
mod effective_bias;
pub mod footprint;
pub mod hybrid;
pub mod irregular;
pub mod lighting;
pub mod map;
mod matrix;
pub mod param;
pub mod planar;
mod preset;
pub mod projective_texture;
pub mod ray_query;
mod receiver_buffer;
pub mod silhouette;
pub mod soft;
mod spec;
mod unsupported;
pub mod volume;

pub use ascending::Ascending;
pub use cost::{Cost, GpuTime, PassTime};
pub use effective_bias::{BiasAt, EffectiveBias, Lengths, Range};
pub use matrix::{MatrixRow, light_kinds, matrix};
pub use preset::{PRESETS, Preset};
pub use receiver_buffer::ReceiverBuffer;
pub use spec::{Spec, SpecError};
pub use unsupported::Unsupported;

use crate::cast::Casters;
use crate::cause::{Cause, Replay};
use crate::gpu::shader::Wgsl;
use crate::gpu::{Geometry, Gpu, GpuError, PassRecord};
use crate::inspect::Adjacency;
use crate::mask::Mask;
use crate::receiver::{Asked, PixelClass, Receivers};
use crate::scene::{Light, Scene};
use crate::watch::Interrupted;
use footprint::Footprint;
use glam::{DMat4, UVec2};
use param::Param;

/// Every technique, in the order in which lists show them.
#[must_use]
pub fn registry() -> &'static [&'static dyn Technique] {
    &[
        &map::Map,
        &volume::Volume,
        &planar::Planar,
        &projective_texture::ProjectiveTexture,
        &silhouette::Silhouette,
        &hybrid::Hybrid,
        &irregular::Irregular,
        &ray_query::RayQuery,
        &soft::Soft,
    ]
}

/// Every shader module that any technique can build, as label and files.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    [
        map::shader_modules(),
        volume::shader_modules(),
        planar::shader_modules(),
        projective_texture::shader_modules(),
        hybrid::shader_modules(),
        irregular::shader_modules(),
        ray_query::shader_modules(),
    ]
    .concat()
}

/// A shadow technique.
pub trait Technique: Sync {
    /// The family's name in specifications.
    fn id(&self) -> &'static str;
    /// One line: the idea.
    fn about(&self) -> &'static str;
    /// Authors, title, year.
    fn citation(&self) -> &'static str;
    /// Its parameters, declared once.
    fn params(&self) -> &'static [Param];
    /// What an adapter must have for it, in words, where not every adapter does.
    fn needs_of_adapter(&self) -> &'static [&'static str] {
        &[]
    }
    /// What it needs, in words, that [`Technique::supports`] cannot tell: it shows only once the picture is known, and
    /// preparing is refused then.
    fn needs_of_picture(&self, _spec: &Spec) -> &'static [&'static str] {
        &[]
    }
    /// Whether it can answer for this light in this scene on this adapter.
    ///
    /// # Errors
    /// The typed reason why not, which becomes a report row.
    fn supports(&self, spec: &Spec, scene: &Scene, light: &Light, gpu: &Gpu) -> Result<(), Unsupported>;
    /// Specifications that would lessen errors of this cause, the most promising first: one knob changed in each.
    fn remedies(&self, spec: &Spec, cause: Cause) -> Vec<Spec>;
    /// Whether it finds its answers by drawing the camera's picture, and so has none for points that this does not show.
    fn draws_the_picture(&self, _spec: &Spec) -> bool {
        false
    }
    /// The cause that owns what is lost by taking an area light for its centre, where replays of this specification start;
    /// `None` if they start from the light's own exact answer.
    fn blamed_for_centre(&self, _spec: &Spec) -> Option<Cause> {
        Some(Cause::TechniqueModel)
    }
    /// Builds everything the runs need.
    ///
    /// # Errors
    /// [`TechniqueError`], [`TechniqueError::Unsupported`] included.
    fn prepare<'j>(&self, spec: &Spec, job: Job<'j>) -> Result<Box<dyn Prepared + 'j>, TechniqueError>;
}

/// What a technique is asked, and everything it may use to answer.
#[derive(Clone, Copy, Debug)]
pub struct Job<'j> {
    /// The device.
    pub gpu: &'j Gpu,
    /// The scene.
    pub scene: &'j Scene,
    /// Its triangles on the device.
    pub geometry: &'j Geometry,
    /// The exact ray core over the scene's casters, for replays.
    pub casters: &'j Casters,
    /// Which triangles touch, for telling a surface's own texels from others.
    pub adjacency: &'j Adjacency,
    /// The light asked about.
    pub light: &'j Light,
    /// The point behind every pixel.
    pub receivers: &'j Receivers,
    /// Which pixels are asked.
    pub classes: &'j [PixelClass],
    /// What fits follow: what is asked in the picture of the scene's camera. That is `receivers` and `classes` unless the
    /// camera has moved on from them.
    pub fitted_to: Asked<'j>,
}

/// A technique ready to run for one job.
pub trait Prepared: Sync {
    /// Renders once, on the GPU.
    ///
    /// # Errors
    /// What the device reported, or an asked pixel left unanswered.
    fn run(&self) -> Result<Answer, TechniqueError>;
    /// Bytes of maps and buffers on the GPU.
    fn bytes(&self) -> u64;
    /// What the technique settled on (fit, effective bias …) as label and value, for people.
    fn facts(&self) -> Vec<(String, String)>;
    /// Replays the given pixels (ascending indices of asked pixels) from the exact answer to `answer`.
    ///
    /// # Errors
    /// What the device reported while stored values were read back.
    fn replay(&self, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError>;
    /// How one pixel's lookup went, for `explain`: label and value.
    ///
    /// # Errors
    /// As [`Prepared::replay`].
    fn lookup_facts(&self, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError>;
    /// The projected size of the technique's samples at a receiver; `None` for techniques without samples, and outside
    /// the map.
    fn footprint(&self, pixel: u32) -> Option<Footprint>;
    /// What people call the views of the light that answer for different pixels; none for techniques without views.
    fn view_names(&self) -> Vec<String> {
        Vec::new()
    }
    /// Which of them answers for a pixel; `None` for techniques without views.
    fn in_view(&self, _pixel: u32) -> Option<InView> {
        None
    }
    /// How far comparisons are really moved, view by view; none for techniques that compare no depths.
    fn bias(&self) -> Vec<EffectiveBias> {
        Vec::new()
    }
    /// World to light clip space for each frustum the light looks through; none for techniques without.
    fn light_frusta(&self) -> Vec<DMat4> {
        Vec::new()
    }
    /// The first depth map of the last run; `None` for techniques without.
    ///
    /// # Errors
    /// As [`Prepared::replay`].
    fn light_depths(&self) -> Result<Option<LightDepths>, TechniqueError> {
        Ok(None)
    }
}

/// Which of a light's views answers for a pixel, and where in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InView {
    /// The view's index.
    pub view: usize,
    /// How far it is to where another view answers, texels of this view; `None` where none does.
    pub seam_texels: Option<f64>,
}

/// What a light's depth map holds.
#[derive(Debug, Clone, PartialEq)]
pub struct LightDepths {
    /// Width and height in texels.
    pub size: UVec2,
    /// Stored depths, row by row; `None` where nothing was drawn.
    pub depths: Vec<Option<f64>>,
}

/// What one run gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Visibility of every asked pixel.
    pub mask: Mask,
    /// What each pass cost.
    pub passes: Vec<PassRecord>,
}

/// Why a technique gave no answer.
#[derive(Debug, thiserror::Error)]
pub enum TechniqueError {
    /// The technique does not apply here.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The shader wrote nothing, or something that is no visibility, for an asked pixel: a bug of gnomon or a driver.
    #[error("pixel ({x}, {y}) came back from the GPU as {value}, which is no visibility")]
    NoAnswer {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// What was there.
        value: f32,
    },
    /// The user asked to stop.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}
