//! A `planar` specification as typed settings.

use crate::technique::Spec;

/// Everything the user can set about planar shadows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How casters are flattened.
    pub projection: Projection,
    /// Index of the scene's only plane to use; `None` uses all.
    pub only_plane: Option<usize>,
    /// What several layers over one pixel do.
    pub overlap: Overlap,
    /// Share of the light that one blended layer takes away, 0..=1.
    pub darkening: f64,
    /// What keeps the shadow on its plane.
    pub placement: Placement,
    /// Rasteriser's constant offset towards the eye, hardware units.
    pub offset_constant: i32,
    /// Rasteriser's offset per depth slope towards the eye.
    pub offset_slope: f64,
    /// Depth that `clipped` gives a caster point, per near distance and per metre above the plane.
    pub kappa: f64,
    /// Largest distance of a triangle's corners from a plane it lies on, metres; `None` is relative to the scene.
    pub plane_tolerance_m: Option<f64>,
}

/// How casters are flattened onto the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// Homogeneous, with a depth that clips what is behind the plane or beyond the light.
    Clipped,
    /// Homogeneous, with the depth of the plane.
    Homogeneous,
    /// Flattened corners divided by w before they are drawn.
    Divided,
    /// One slope per object.
    Shear,
}

/// What several layers over one pixel do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overlap {
    /// The stencil lets one through: full shadow.
    Stencil,
    /// Each takes its share of what the others left.
    Blend,
}

/// What keeps the shadow on its plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// Only pixels that show a triangle of the plane.
    ReceiverMask,
    /// A depth test against the scene, with an offset against z-fighting.
    DepthOffset,
}

impl Settings {
    /// Reads a `planar` specification, whose parameters are declared in the family's list.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        let (planes, number) = spec.choice("planes");
        Self {
            projection: match spec.choice("projection").0 {
                "homogeneous" => Projection::Homogeneous,
                "divided" => Projection::Divided,
                "shear" => Projection::Shear,
                _ => Projection::Clipped,
            },
            only_plane: (planes == "only").then(|| number as usize - 1),
            overlap: if spec.choice("overlap").0 == "blend" { Overlap::Blend } else { Overlap::Stencil },
            darkening: spec.real("darkening"),
            placement: match spec.choice("placement").0 {
                "depth-offset" => Placement::DepthOffset,
                _ => Placement::ReceiverMask,
            },
            offset_constant: spec.integer("offset_constant") as i32,
            offset_slope: spec.real("offset_slope"),
            kappa: spec.real("kappa"),
            plane_tolerance_m: spec.real_or_auto("plane_tolerance_m"),
        }
    }

    /// Visibility under a number of layers, 0..=1.
    #[must_use]
    pub fn visibility(&self, layers: usize) -> f64 {
        match (self.overlap, layers) {
            (_, 0) => 1.0,
            (Overlap::Stencil, _) => 0.0,
            (Overlap::Blend, layers) => (1.0 - self.darkening).powi(layers.min(MOST_LAYERS) as i32),
        }
    }
}

/// Layers that an 8-bit target counts before it saturates.
const MOST_LAYERS: usize = 255;
