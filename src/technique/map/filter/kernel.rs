//! What is typed about a filter: the number behind its name, and the parameters that only some filters read, declared
//! and read in one place.

use crate::technique::Spec;
use crate::technique::param::{Choice, Kind, Param, Value};

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    /// The number behind the filter's name: its width in texels, or its taps.
    pub number: u32,
    /// `pcss`: texels that are searched for blockers.
    pub search_taps: u32,
    /// `pcss`: kernels narrower than this read the receiver's own texel only.
    pub min_texels: f64,
    /// `pcss`: kernels and searches are no wider than this.
    pub max_texels: f64,
    /// Whether patterns of taps are turned, for each pixel otherwise.
    pub turns: bool,
    /// Of these turns.
    pub seed: u32,
}

impl Kernel {
    /// Only the number, everything else as it is when it is not typed.
    #[must_use]
    pub fn wide(number: u32) -> Self {
        Self { number, search_taps: 16, min_texels: 1.0, max_texels: 128.0, turns: false, seed: 0 }
    }

    /// Reads the parameters that [`params`] declares.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        Self {
            number: spec.choice("filter").1,
            search_taps: spec.integer("search_taps") as u32,
            min_texels: spec.real("min_texels"),
            max_texels: spec.real("max_texels"),
            turns: spec.choice("turn").0 == "per-pixel",
            seed: spec.integer("seed") as u32,
        }
    }
}

/// The declarations.
#[must_use]
pub fn params() -> Vec<Param> {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let default = Kernel::wide(1);
    let turns = ["none", "per-pixel"].into_iter().map(Choice::plain).collect();
    vec![
        param(
            "turn",
            "",
            Kind::Choice(turns),
            Value::Choice("none", None),
            "pcss: whether the pattern of taps is turned by a hash of the pixel",
        ),
        param(
            "seed",
            "",
            Kind::Integer { min: 0, max: u32::MAX.into() },
            Value::Integer(default.seed.into()),
            "of that hash",
        ),
        param(
            "search_taps",
            "",
            Kind::Integer { min: 1, max: 128 },
            Value::Integer(default.search_taps.into()),
            "pcss: texels that are searched for blockers",
        ),
        param(
            "min_texels",
            "texels",
            real(0.0, 64.0),
            Value::Real(default.min_texels),
            "pcss: narrower kernels read the receiver's own texel only",
        ),
        param(
            "max_texels",
            "texels",
            real(1.0, 4096.0),
            Value::Real(default.max_texels),
            "pcss: no kernel or search is wider",
        ),
    ]
}
