//! Why a pixel is wrong: the closed list of causes, and the stages by which a technique's replay books them.

use serde::{Deserialize, Serialize};

/// The closed list of error causes; docs/causes.md has a definition, a picture and the fix for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Right at infinite map resolution, wrong at the decisive texel, which holds another surface; m ≤ 1.
    EdgeAliasing,
    /// Edge aliasing with m > 1 where distance to camera and light stretches the texel more than the tilt does.
    PerspectiveAliasing,
    /// Edge aliasing with m > 1 where the tilt of the surface stretches the texel more than the distances do.
    ProjectiveAliasing,
    /// The stored blocker is the receiver's own surface and a sufficient bias would clear it.
    Acne,
    /// The stored blocker is next to the receiver's triangle and the sufficient bias does not clear it.
    Curvature,
    /// Bias removed a shadow that is there without it.
    PeterPanning,
    /// The deciding surface, or a corner of its triangle, lies before the near plane.
    ClippingNear,
    /// The deciding surface lies behind the far plane, or beyond a volume's reach.
    ClippingFar,
    /// Outside the map, cascade, face, scissor or texel budget.
    ClippingFrustum,
    /// The stencil count wrapped or saturated.
    StencilOverflow,
    /// The deciding caster is open or inconsistent, and the technique needs it closed.
    OpenMesh,
    /// The receiver is not on the projection plane.
    PlanarModel,
    /// The deciding blocker is beyond the light as seen from the plane.
    AntiShadow,
    /// The deciding blocker is behind the plane.
    FalseShadowBehindPlane,
    /// The exact kernel average explains the value: the penumbra is as wide as the kernel, not as the truth.
    FilterWidth,
    /// The moment estimate exceeds the exact filter over the same kernel.
    LightBleeding,
    /// The f64 twin is right; rounding, quantised depth or raster snapping flipped it.
    Precision,
    /// The model itself leaves the effect out.
    TechniqueModel,
}

impl Cause {
    /// Every cause, in the order in which reports list them.
    pub const ALL: [Self; 18] = [
        Self::EdgeAliasing,
        Self::PerspectiveAliasing,
        Self::ProjectiveAliasing,
        Self::Acne,
        Self::Curvature,
        Self::PeterPanning,
        Self::ClippingNear,
        Self::ClippingFar,
        Self::ClippingFrustum,
        Self::StencilOverflow,
        Self::OpenMesh,
        Self::PlanarModel,
        Self::AntiShadow,
        Self::FalseShadowBehindPlane,
        Self::FilterWidth,
        Self::LightBleeding,
        Self::Precision,
        Self::TechniqueModel,
    ];

    /// The name in reports and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::EdgeAliasing => "edge-aliasing",
            Self::PerspectiveAliasing => "perspective-aliasing",
            Self::ProjectiveAliasing => "projective-aliasing",
            Self::Acne => "acne",
            Self::Curvature => "curvature",
            Self::PeterPanning => "peter-panning",
            Self::ClippingNear => "clipping-near",
            Self::ClippingFar => "clipping-far",
            Self::ClippingFrustum => "clipping-frustum",
            Self::StencilOverflow => "stencil-overflow",
            Self::OpenMesh => "open-mesh",
            Self::PlanarModel => "planar-model",
            Self::AntiShadow => "anti-shadow",
            Self::FalseShadowBehindPlane => "false-shadow-behind-plane",
            Self::FilterWidth => "filter-width",
            Self::LightBleeding => "light-bleeding",
            Self::Precision => "precision",
            Self::TechniqueModel => "technique-model",
        }
    }
}

impl Cause {
    /// What happened, in one sentence for the user.
    #[must_use]
    pub fn meaning(self) -> &'static str {
        match self {
            Self::EdgeAliasing => {
                "the texel read holds another surface than the one at this point: the shadow's edge is a staircase of texels"
            }
            Self::PerspectiveAliasing => {
                "the texel read is larger than the pixel because the map spends too few texels near the camera: a coarse staircase"
            }
            Self::ProjectiveAliasing => {
                "the texel read is stretched over this surface because it is tilted away from the light: a long staircase"
            }
            Self::Acne => {
                "the texel read holds the receiver's own surface at another depth: the surface shadows itself because the bias is too small"
            }
            Self::Curvature => {
                "the texel read holds a neighbouring facet that no bias for this facet clears: the surface curves within one texel"
            }
            Self::PeterPanning => {
                "the bias is larger than the distance to the blocker: the shadow is lost where blocker and receiver meet"
            }
            Self::ClippingNear => "the blocker, a part of it, or the receiver lies before the near plane",
            Self::ClippingFar => "the receiver lies behind the far plane",
            Self::ClippingFrustum => "the receiver lies outside the light's frustum, where everything is lit",
            Self::StencilOverflow => "more volumes overlap here than the stencil can count",
            Self::OpenMesh => "the caster is not closed, and the technique needs it closed",
            Self::PlanarModel => "the receiver is not on the plane that the shadow is projected on",
            Self::AntiShadow => "the blocker lies beyond the light as seen from the plane",
            Self::FalseShadowBehindPlane => "the blocker lies behind the plane",
            Self::FilterWidth => {
                "the filter mixes in texels from across the shadow's edge: its penumbra is not the light's"
            }
            Self::LightBleeding => {
                "the moments of two blockers at different depths cannot tell full shadow: light bleeds in"
            }
            Self::Precision => {
                "the exact technique would be right here; rounding, stored precision or rasteriser snapping flipped it"
            }
            Self::TechniqueModel => "the technique's model leaves this effect out",
        }
    }
}

/// One approximation of a technique, replayed for some pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// What was approximated, e.g. `sampling`.
    pub name: &'static str,
    /// Visibility after this approximation, one per replayed pixel, 0..=1.
    pub values: Vec<f64>,
    /// The cause that owns this stage's change, one per replayed pixel.
    pub causes: Vec<Cause>,
}

/// A technique replayed in f64, one approximation at a time, for some pixels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Replay {
    /// Indices of the replayed pixels (`y * width + x`), ascending.
    pub pixels: Vec<u32>,
    /// The exact answer per replayed pixel, as the replay itself found it.
    pub exact: Vec<f64>,
    /// The stages in order; the last one's values are the GPU's answer.
    pub stages: Vec<Stage>,
}

impl Replay {
    /// The same chain with one more stage before it, from the `exact` answer (one per replayed pixel) to where it began.
    #[must_use]
    pub fn led_by(mut self, exact: Vec<f64>, name: &'static str, cause: Cause) -> Self {
        let values = std::mem::replace(&mut self.exact, exact);
        let causes = vec![cause; values.len()];
        self.stages.insert(0, Stage { name, values, causes });
        self
    }
}
