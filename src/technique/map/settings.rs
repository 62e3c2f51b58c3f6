//! A `map` specification as typed settings.

use super::{DepthFormat, bias, filter, projection};
use crate::technique::Spec;

/// Everything the user can set about a map.
#[derive(Clone, Copy)]
pub struct Settings {
    /// Texels a side.
    pub size: u32,
    /// Projection axis.
    pub projection: &'static dyn projection::Projection,
    /// Filter axis.
    pub filter: &'static dyn filter::Filter,
    /// What is typed about the filter.
    pub kernel: filter::Kernel,
    /// Bias axis.
    pub bias: &'static dyn bias::Bias,
    /// What a texel stores.
    pub format: DepthFormat,
    /// True where 1 is near the light.
    pub reversed: bool,
    /// What depth measures.
    pub depth_metric: DepthMetric,
    /// The numeric bias parameters as typed.
    pub bias_numbers: bias::Numbers,
    /// How the frustum is fitted.
    pub fit: Fit,
    /// What happens to casters before the near plane.
    pub near_mode: NearMode,
    /// How far before what it is fitted to the near plane lies that casters are clamped to, metres.
    pub near_margin_m: f64,
    /// Which sides of casters are drawn.
    pub caster_sides: CasterSides,
    /// What taps beyond the side of their view read.
    pub seam: Seam,
    /// What stands for the map beyond its border.
    pub border: Border,
    /// What only some projections read.
    pub knobs: projection::Knobs,
}

/// What happens to casters before the near plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NearMode {
    /// The near plane is fitted before them; those before a typed one are cut away.
    Extend,
    /// They are drawn at the near plane, which is fitted to the receivers.
    DepthClamp,
    /// The same, but fragments clamp their depth: for devices that cannot.
    FragmentClamp,
    /// Corners are moved to the near plane, which is fitted to the receivers: bends triangles that reach through it.
    VertexClamp,
}

/// What depth measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthMetric {
    /// What the rasteriser gives: hyperbolic in the distance for a perspective map.
    Projected,
    /// Distance along the view's axis, 0 at the near plane and 1 at the far one.
    Linear,
}

/// Which sides of casters are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CasterSides {
    /// Both.
    All,
    /// Those that the light reaches.
    LightFacing,
    /// Back faces: no acne on what the light reaches.
    AwayFacing,
}

/// What taps beyond the side of their view read; the numbers are the shader's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seam {
    /// The texel of the view they fall in.
    PerTap = 0,
    /// The nearest texel of their own view.
    Clamp = 1,
}

/// What stands for the map beyond its border; the numbers are the shader's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// Light.
    Lit = 0,
    /// Shadow.
    Shadow = 1,
    /// The nearest texel.
    ClampEdge = 2,
}

/// How the light frustum is fitted; `None` is `auto`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// What it encloses.
    pub around: Around,
    /// Rim beyond the kernel's radius and one texel.
    pub margin_texels: f64,
    /// Near plane, metres from the light's view point.
    pub near_m: Option<f64>,
    /// Far plane.
    pub far_m: Option<f64>,
    /// Width of a parallel map.
    pub width_m: Option<f64>,
    /// How far behind the scene's centre a parallel view starts.
    pub pull_back_m: Option<f64>,
    /// Full angle of a perspective map, radians.
    pub fov_rad: Option<f64>,
    /// Shift of the map in texels, for jitter.
    pub phase_texels: glam::DVec2,
}

/// What a fit encloses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Around {
    /// All geometry: the map does not depend on the camera.
    Scene,
    /// What the camera sees.
    Receivers,
    /// The numbers typed, with the defaults of R. Ploszajczak's master's thesis (2008).
    Manual,
}

impl Fit {
    /// Reads the fit parameters, which every technique with a fitted light frustum declares alike.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        Self {
            around: match spec.choice("fit").0 {
                "receivers" => Around::Receivers,
                "manual" => Around::Manual,
                _ => Around::Scene,
            },
            margin_texels: spec.real("fit_margin_texels"),
            near_m: spec.real_or_auto("near_m"),
            far_m: spec.real_or_auto("far_m"),
            width_m: spec.real_or_auto("width_m"),
            pull_back_m: spec.real_or_auto("pull_back_m"),
            fov_rad: spec.real_or_auto("fov_deg").map(f64::to_radians),
            phase_texels: glam::DVec2::new(spec.real("phase_u_texels"), spec.real("phase_v_texels")),
        }
    }
}

impl Settings {
    /// Reads a `map` specification, whose parameters are declared in the family's list.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        let filter = filter::by_name(spec.choice("filter").0);
        Self {
            size: spec.integer("size") as u32,
            projection: projection::by_name(spec.choice("projection").0),
            filter,
            kernel: filter::Kernel::of(spec),
            bias: bias::by_name(spec.choice("bias").0),
            format: format_of(spec),
            reversed: spec.choice("depth_convention").0 == "reversed",
            depth_metric: match spec.choice("depth_metric").0 {
                "linear" => DepthMetric::Linear,
                "auto" if filter.needs_linear_depth() => DepthMetric::Linear,
                _ => DepthMetric::Projected,
            },
            bias_numbers: bias_numbers_of(spec),
            fit: Fit::of(spec),
            near_mode: match spec.choice("near_mode").0 {
                "depth-clamp" => NearMode::DepthClamp,
                "fragment-clamp" => NearMode::FragmentClamp,
                "vertex-clamp" => NearMode::VertexClamp,
                _ => NearMode::Extend,
            },
            near_margin_m: spec.real("near_margin_m"),
            caster_sides: match spec.choice("caster_sides").0 {
                "light-facing" => CasterSides::LightFacing,
                "away-facing" => CasterSides::AwayFacing,
                _ => CasterSides::All,
            },
            seam: if spec.choice("seam").0 == "clamp" { Seam::Clamp } else { Seam::PerTap },
            border: match spec.choice("border").0 {
                "shadow" => Border::Shadow,
                "clamp-edge" => Border::ClampEdge,
                _ => Border::Lit,
            },
            knobs: projection::Knobs::of(spec),
        }
    }

    /// Reads a `silhouette` specification. Depth has one texel more than outlines, which lie between texel centres, and
    /// a receiver reads centres up to a texel away along each axis, as a bilinear lookup does.
    #[must_use]
    pub fn with_silhouettes(spec: &Spec) -> Self {
        Self {
            size: spec.integer("size") as u32 + 1,
            projection: projection::by_name("single"),
            filter: filter::by_name("pcf-bilinear"),
            kernel: filter::Kernel::wide(1),
            bias: bias::by_name(spec.choice("bias").0),
            format: format_of(spec),
            reversed: spec.choice("depth_convention").0 == "reversed",
            depth_metric: DepthMetric::Projected,
            bias_numbers: bias_numbers_of(spec),
            fit: Fit::of(spec),
            near_mode: NearMode::Extend,
            near_margin_m: 0.0,
            caster_sides: CasterSides::All,
            seam: Seam::PerTap,
            border: Border::Lit,
            knobs: projection::Knobs::default(),
        }
    }

    /// Texels between the fit and the map's rim, so that kernels stay inside.
    #[must_use]
    pub fn rim_texels(&self) -> f64 {
        self.filter.radius_texels(&self.kernel) + 1.0 + self.fit.margin_texels
    }

    /// Whether texels store the middle between two surfaces.
    #[must_use]
    pub fn stores_midpoint(&self) -> bool {
        self.bias_amounts().clearance == bias::Clearance::Midpoint
    }

    /// What lies beyond the border as moments take it: 0 at the near plane, 1 at the far one; `None`: the nearest texel.
    #[must_use]
    pub fn z_beyond(&self) -> Option<f64> {
        match (self.seam, self.border) {
            (Seam::Clamp, _) | (_, Border::ClampEdge) => None,
            (Seam::PerTap, Border::Lit) => Some(1.0),
            (Seam::PerTap, Border::Shadow) => Some(0.0),
        }
    }

    /// The bias axis's amounts for this filter.
    #[must_use]
    pub fn bias_amounts(&self) -> bias::Amounts {
        self.bias.amounts(&self.bias_numbers, self.filter.bias_kernel(&self.kernel))
    }
}

fn format_of(spec: &Spec) -> DepthFormat {
    match spec.choice("format").0 {
        "depth16unorm" => DepthFormat::Depth16Unorm,
        "depth24plus" => DepthFormat::Depth24Plus,
        _ => DepthFormat::Depth32Float,
    }
}

fn bias_numbers_of(spec: &Spec) -> bias::Numbers {
    bias::Numbers {
        constant_units: spec.real_or_auto("bias_constant_ulps"),
        slope: spec.real_or_auto("bias_slope"),
        clamp: spec.real("bias_clamp"),
        depth_m: spec.real("bias_depth_m"),
        depth_texels: spec.real("bias_depth_texels"),
        normal_texels: spec.real("bias_normal_texels"),
        cap_texels: spec.real("bias_cap_texels"),
    }
}
