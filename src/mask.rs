//! Masks: the visibility of one light at every pixel, as a technique answered it and as the truth knows it.

use glam::UVec2;

/// The fraction of a light that a point sees: 0 (shadow) to 1 (lit), never NaN.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Visibility(f32);

impl Visibility {
    /// Fully in shadow.
    pub const SHADOW: Self = Self(0.0);
    /// Fully lit.
    pub const LIT: Self = Self(1.0);

    /// `None` if `value` is NaN or outside 0..=1.
    #[must_use]
    pub fn new(value: f32) -> Option<Self> {
        (0.0..=1.0).contains(&value).then_some(Self(value))
    }
    /// The fraction.
    #[must_use]
    pub fn get(self) -> f32 {
        self.0
    }
}

/// A technique's answer: one entry per pixel, row by row from the top; `None` where it gave none.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` entries.
    pub pixels: Vec<Option<Visibility>>,
}

/// What the truth says of one asked pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truth {
    /// The exact visibility.
    Known(Visibility),
    /// The verdict changes when the receiver moves by its own rounding error: counted and shown, never guessed.
    Undecided,
}

/// The exact answer: one entry per pixel; `None` where nothing was asked.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthMask {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` entries.
    pub pixels: Vec<Option<Truth>>,
}
