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
    /// `pcf-poisson`: radius of the pattern.
    pub pattern_radius_texels: f64,
    /// `pcf-edge-masked`: blocks of 2 to this many texels a side are looked at first.
    pub mask_level: u32,
    /// Whether patterns of taps are turned, for each pixel otherwise.
    pub turns: bool,
    /// Of these turns.
    pub seed: u32,
    /// Moments: whether they are stored as 16-bit floats.
    pub is_half: bool,
    /// `vsm`, `evsm`: least variance of z.
    pub min_variance: f64,
    /// Moments: visibility up to here is cut to none.
    pub bleeding_cut: f64,
    /// `esm`, `evsm`: of the exponential; `None`: by the format.
    pub exponent: Option<f64>,
    /// `evsm`: of the other exponential.
    pub negative_exponent: f64,
    /// `msm`: how far moments are drawn to those of a spread-out depth; `None`: by the format.
    pub msm_bias: Option<f64>,
}

impl Kernel {
    /// Only the number, everything else as it is when it is not typed.
    #[must_use]
    pub fn wide(number: u32) -> Self {
        Self {
            number,
            search_taps: 16,
            min_texels: 1.0,
            max_texels: 128.0,
            pattern_radius_texels: 2.0,
            mask_level: 2,
            turns: false,
            seed: 0,
            is_half: false,
            min_variance: 1e-5,
            bleeding_cut: 0.0,
            exponent: None,
            negative_exponent: 5.0,
            msm_bias: None,
        }
    }

    /// Reads the parameters that [`params`] declares.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        Self {
            number: spec.choice("filter").1,
            search_taps: spec.integer("search_taps") as u32,
            min_texels: spec.real("min_texels"),
            max_texels: spec.real("max_texels"),
            pattern_radius_texels: spec.real("poisson_radius_texels"),
            mask_level: spec.integer("mask_level") as u32,
            turns: spec.choice("turn").0 == "per-pixel",
            seed: spec.integer("seed") as u32,
            is_half: spec.choice("moment_format").0 == "float16",
            min_variance: spec.real("min_variance"),
            bleeding_cut: spec.real("bleeding_cut"),
            exponent: spec.real_or_auto("exponent"),
            negative_exponent: spec.real("negative_exponent"),
            msm_bias: spec.real_or_auto("msm_bias"),
        }
    }
}

/// The declarations.
#[must_use]
pub fn params() -> Vec<Param> {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let default = Kernel::wide(1);
    let auto = |min, max| Kind::Real { min, max, auto: true };
    let formats = ["float32", "float16"].into_iter().map(Choice::plain).collect();
    let turns = ["none", "per-pixel"].into_iter().map(Choice::plain).collect();
    vec![
        param(
            "poisson_radius_texels",
            "texels",
            real(0.5, 16.0),
            Value::Real(default.pattern_radius_texels),
            "pcf-poisson: radius of its disc",
        ),
        param(
            "mask_level",
            "",
            Kind::Integer { min: 0, max: 4 },
            Value::Integer(default.mask_level.into()),
            "pcf-edge-masked: blocks of 2 to this many texels a side are looked at first",
        ),
        param(
            "turn",
            "",
            Kind::Choice(turns),
            Value::Choice("none", None),
            "pcf-poisson, pcss: whether the pattern of taps is turned by a hash of the pixel",
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
        param(
            "moment_format",
            "",
            Kind::Choice(formats),
            Value::Choice("float32", None),
            "vsm, esm, evsm, msm, depth-mean: what moments are stored as",
        ),
        param(
            "bleeding_cut",
            "",
            real(0.0, 0.9),
            Value::Real(default.bleeding_cut),
            "moments: visibility up to here is none",
        ),
        param("min_variance", "", real(0.0, 0.01), Value::Real(default.min_variance), "vsm, evsm: least variance of z"),
        param("exponent", "", auto(1.0, 80.0), Value::Auto, "esm, evsm: of e^(c z); auto: 40, with float16 10 and 5"),
        param("negative_exponent", "", real(1.0, 80.0), Value::Real(default.negative_exponent), "evsm: of -e^(-c z)"),
        param(
            "msm_bias",
            "",
            auto(0.0, 0.1),
            Value::Auto,
            "msm: how far moments are drawn towards those of a spread-out depth; auto: 3e-5, with float16 5e-3",
        ),
    ]
}
