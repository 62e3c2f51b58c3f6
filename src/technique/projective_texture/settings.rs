//! A `projective-texture` specification as typed settings: those of a map that compares no depth, and who receives.

use crate::scene::Mesh;
use crate::technique::Spec;
use crate::technique::map::{
    Border, CasterSides, DepthFormat, DepthMetric, Fit, NearMode, Seam, Settings as MapSettings, bias, filter,
    projection,
};

/// Everything the user can set about a projective texture.
#[derive(Clone, Copy)]
pub struct Settings {
    /// Frustum, size and filter.
    pub map: MapSettings,
    /// Which meshes the picture is thrown on.
    pub receivers: ReceiverChoice,
}

/// Which meshes the picture is thrown on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceiverChoice {
    /// Those that cast nothing: no caster can darken itself.
    NonCasters,
    /// Every mesh.
    All,
}

/// Nothing is compared, so nothing is biased.
const NO_BIAS: bias::Numbers = bias::Numbers {
    constant_units: Some(0.0),
    slope: Some(0.0),
    clamp: 0.0,
    depth_m: 0.0,
    depth_texels: 0.0,
    normal_texels: 0.0,
    cap_texels: 0.0,
};

impl Settings {
    /// Reads a `projective-texture` specification, whose parameters are declared in the family's list.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        let (filter_name, kernel) = spec.choice("filter");
        let map = MapSettings {
            size: spec.integer("size") as u32,
            projection: projection::by_name("single"),
            filter: filter::by_name(filter_name),
            kernel: filter::Kernel::wide(kernel),
            bias: bias::by_name("none"),
            format: DepthFormat::Depth32Float,
            reversed: true,
            depth_metric: DepthMetric::Projected,
            bias_numbers: NO_BIAS,
            fit: Fit::of(spec),
            near_mode: NearMode::Extend,
            near_margin_m: 0.0,
            caster_sides: CasterSides::All,
            seam: Seam::PerTap,
            border: Border::Lit,
            knobs: projection::Knobs::default(),
        };
        let receivers = match spec.choice("receivers").0 {
            "all" => ReceiverChoice::All,
            _ => ReceiverChoice::NonCasters,
        };
        Self { map, receivers }
    }

    /// Whether the picture is thrown on a mesh.
    #[must_use]
    pub fn takes_shadow(&self, mesh: &Mesh) -> bool {
        self.receivers == ReceiverChoice::All || !mesh.casts
    }
}
