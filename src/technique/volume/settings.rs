//! A `volume` specification as typed settings.

use crate::technique::Spec;

/// Everything the user can set about stencil shadow volumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Which faces are counted.
    pub count: Count,
    /// True for one volume per triangle, false for one per object.
    pub per_triangle: bool,
    /// Which triangles cast.
    pub caster_sides: CasterSides,
    /// How far volumes reach, metres; `None` is infinitely far.
    pub reach: Option<Length>,
    /// The camera's far plane as far as volumes are concerned.
    pub far: FarPlane,
    /// True where the stencil stops at 0 and 255 instead of wrapping.
    pub clamps_stencil: bool,
    /// True where front and back faces are drawn one after the other.
    pub two_pass: bool,
    /// Caps to draw.
    pub caps: Caps,
    /// True to count faces at exactly the surface's depth as in front of it, which is wrong.
    pub inclusive_compare: bool,
    /// True to close volumes with the triangles turned away from the light, which is wrong around a light inside.
    pub away_facing_back_cap: bool,
    /// Where vertices are moved away from the light.
    pub extrude: Extrude,
    /// True to draw only where the light's range reaches.
    pub scissor: bool,
    /// True to draw only where what is seen is as deep as the light's range reaches.
    pub range_mask: bool,
    /// True to draw only at the pixels of a mask, which no specification of this family says: see [`Settings::masked`].
    pub is_masked: bool,
    /// True to start counting before the surface with the volumes around the near plane's middle.
    pub starts_at_eye_count: bool,
    /// True where depth 1 is near.
    pub reversed: bool,
    /// The depth buffer's format.
    pub format: Format,
}

/// Which volume faces are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// Those behind the surface.
    ZFail,
    /// Those before the surface.
    ZPass,
    /// Before it for objects whose volume cannot touch the near rectangle, behind it for the others.
    Mixed,
    /// Before it, on top of an exact count at the near plane.
    ZpPlus,
}

/// Which triangles of an object cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CasterSides {
    /// Decided per object so that the count is exact.
    Auto,
    /// Those that face the light.
    LightFacing,
    /// Every one that the light does not see edge-on.
    All,
}

/// Where vertices are moved away from the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extrude {
    /// Before they are uploaded.
    Cpu,
    /// In the vertex shader.
    Gpu,
    /// In the vertex shader, which is given every edge and decides which of them are silhouettes.
    DegenerateQuads,
}

/// A length that may be left to gnomon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// Found by gnomon.
    Auto,
    /// Typed, metres.
    Metres(f64),
}

/// The far plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FarPlane {
    /// None.
    Infinite,
    /// Volumes beyond it are flattened onto it.
    Clamp(Length),
    /// Volumes beyond it are cut off.
    Finite(Length),
}

/// Which caps are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Caps {
    /// Those the count needs.
    Auto,
    /// These, needed or not.
    Only {
        /// The casting triangles themselves.
        front: bool,
        /// Their images at the volume's far end.
        back: bool,
    },
}

/// Format of the camera's depth and stencil buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// 32-bit float depth.
    Depth32FloatStencil8,
    /// 24-bit fixed-point depth, or what the driver puts in its place.
    Depth24PlusStencil8,
}

impl Settings {
    /// Reads a `volume` specification, whose parameters are declared in the family's list.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        let is = |name: &str, value: &str| spec.choice(name).0 == value;
        let length = |name: &str| spec.real_or_auto(name).map_or(Length::Auto, Length::Metres);
        Self {
            count: match spec.choice("count").0 {
                "z-pass" => Count::ZPass,
                "mixed" => Count::Mixed,
                "zp-plus" => Count::ZpPlus,
                _ => Count::ZFail,
            },
            per_triangle: is("shape", "per-triangle"),
            caster_sides: match spec.choice("caster_sides").0 {
                "light-facing" => CasterSides::LightFacing,
                "all" => CasterSides::All,
                _ => CasterSides::Auto,
            },
            reach: is("extrusion", "finite").then(|| length("length_m")),
            far: match spec.choice("far").0 {
                "clamp" => FarPlane::Clamp(length("far_m")),
                "finite" => FarPlane::Finite(length("far_m")),
                _ => FarPlane::Infinite,
            },
            clamps_stencil: is("stencil_ops", "clamp"),
            two_pass: is("faces", "two-pass"),
            caps: match spec.choice("caps").0 {
                "none" => Caps::Only { front: false, back: false },
                "front" => Caps::Only { front: true, back: false },
                "back" => Caps::Only { front: false, back: true },
                "both" => Caps::Only { front: true, back: true },
                _ => Caps::Auto,
            },
            inclusive_compare: is("cap_compare", "inclusive"),
            away_facing_back_cap: is("back_cap", "away-facing"),
            extrude: match spec.choice("extrude").0 {
                "gpu" => Extrude::Gpu,
                "degenerate-quads" => Extrude::DegenerateQuads,
                _ => Extrude::Cpu,
            },
            scissor: is("scissor", "on"),
            range_mask: is("range_mask", "on"),
            is_masked: false,
            starts_at_eye_count: is("stencil_init", "eye-count"),
            reversed: is("depth_convention", "reversed"),
            format: match spec.choice("format").0 {
                "depth24plus-stencil8" => Format::Depth24PlusStencil8,
                _ => Format::Depth32FloatStencil8,
            },
        }
    }
}

impl Settings {
    /// The same volumes closed and compared as they must be; `None` if they already are.
    #[must_use]
    pub fn with_sound_caps(&self) -> Option<Self> {
        let sound = Self { caps: Caps::Auto, inclusive_compare: false, away_facing_back_cap: false, ..*self };
        (sound != *self).then_some(sound)
    }

    /// Bits of the stencil that count; a range mask and any other takes the highest.
    #[must_use]
    pub fn counting_bits(&self) -> u32 {
        u8::BITS - u32::from(self.has_flag())
    }

    /// Whether the stencil's highest bit says where to count.
    #[must_use]
    pub fn has_flag(&self) -> bool {
        self.range_mask || self.is_masked
    }

    /// The same volumes, counted only at the pixels of a mask.
    #[must_use]
    pub fn masked(self) -> Self {
        Self { is_masked: true, ..self }
    }

    /// The same volumes counted by a stencil that wraps; `None` if it does.
    #[must_use]
    pub fn with_wrapping_stencil(&self) -> Option<Self> {
        self.clamps_stencil.then_some(Self { clamps_stencil: false, ..*self })
    }
}

impl Length {
    /// The typed length, or `auto_m`.
    #[must_use]
    pub fn or(self, auto_m: f64) -> f64 {
        match self {
            Self::Auto => auto_m,
            Self::Metres(metres) => metres,
        }
    }
}
