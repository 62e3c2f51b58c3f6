//! Typed refusals: a technique that does not apply is a row of the report, not an error.

/// Why a technique does not apply.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unsupported {
    /// The technique cannot handle this kind of light.
    #[error("{kind} lights; it handles {handled}")]
    Light {
        /// The light's kind.
        kind: &'static str,
        /// The kinds it handles.
        handled: &'static str,
    },
    /// One frustum cannot hold what it must.
    #[error("the receivers span {asked_deg:.0} degrees as seen from the light, one frustum holds {limit_deg:.0}")]
    FieldOfView {
        /// Full angle needed.
        asked_deg: f64,
        /// Largest full angle.
        limit_deg: f64,
    },
    /// The scene has no receiver plane.
    #[error("the scene has no [[plane]] to throw shadows on")]
    NoPlane,
    /// The light lies in a receiver plane, where shadows have no size.
    #[error("the light lies in plane {plane} of the scene")]
    LightInPlane {
        /// Number of the plane in the scene, from 1.
        plane: usize,
    },
    /// Nothing that receives shadows lies on a plane.
    #[error("no triangle that receives shadows lies on a [[plane]]: the nearest is {max_distance_m:.3e} m off")]
    NonPlanarReceiver {
        /// Largest distance of that triangle's corners from its nearest plane.
        max_distance_m: f64,
    },
    /// The adapter lacks something.
    #[error("this adapter lacks {what}")]
    MissingFeature {
        /// What is missing, with numbers.
        what: String,
    },
    /// Two parameters exclude each other.
    #[error("{why}")]
    Combination {
        /// Which, and what to type instead.
        why: String,
    },
    /// The parameters leave nothing to do.
    #[error("{why}")]
    Degenerate {
        /// In words.
        why: String,
    },
}
