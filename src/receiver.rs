//! Receivers: the exact f64 point behind every pixel centre, from the triangle id the G-buffer found there.

use glam::{DVec3, UVec2};

/// The point of a surface that a pixel centre shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Triangle id.
    pub triangle: u32,
    /// Where the pixel-centre ray meets that triangle, rebased world, f64.
    pub point_in_world: DVec3,
    /// Unit geometric normal, turned towards the eye.
    pub normal_in_world: DVec3,
}

/// The receivers of one picture, row by row from the top; `None` is background.
#[derive(Debug, Clone, PartialEq)]
pub struct Receivers {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` entries.
    pub pixels: Vec<Option<Receiver>>,
}

/// What one light means for a pixel, before anything is cast. Only `Asked` pixels are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PixelClass {
    /// No geometry.
    Background,
    /// The surface is turned away from the light as seen from the eye's side: dark by the lighting model.
    FacingAway,
    /// Outside a spot's cone, beyond the light's range, or on a mesh that does not receive.
    NotLit,
    /// The question is put to technique and truth.
    Asked,
}
