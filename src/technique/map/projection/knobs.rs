//! The parameters that only some projections read, declared and read in one place.

use crate::technique::param::{Choice, Kind, Param, Value};
use crate::technique::{Ascending, Spec};

/// What the projections' own parameters are set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knobs {
    /// `cascaded`: how many.
    pub cascades: u32,
    /// `cascaded`: 0 uniform splits, 1 logarithmic ones.
    pub lambda: f64,
    /// `cascaded`: start of the first one, metres before the eye; `None`: the nearest receiver.
    pub min_distance_m: Option<f64>,
    /// `cascaded`: end of the first one, metres before the eye; `None`: by the formula.
    pub first_far_m: Option<f64>,
    /// `cascaded`: ends of all but the last, metres before the eye; `None`: by the formula.
    pub splits_m: Option<Ascending>,
    /// `cascaded`: end of the last one, metres before the eye; `None`: the farthest receiver.
    pub max_distance_m: Option<f64>,
    /// `cascaded`: whether each encloses its slice in a sphere and keeps to the texel grid, so that it is stable.
    pub is_stable: bool,
    /// `cascaded`: whether a receiver reads the first one that contains it, not the one of its depth.
    pub selects_by_projection: bool,
    /// `cascaded`: width of the band before a split in which two are blended, texels.
    pub blend_texels: f64,
    /// `cascaded`: the same as a share of the split's distance from the eye; the wider band counts.
    pub overlap_ratio: f64,
    /// `perspective`: how far the virtual eye stands behind the eye, metres; `None`: as far as needed.
    pub virtual_back_m: Option<f64>,
    /// `trapezoidal`: share of the trapezoid's height that is in focus.
    pub focus_fraction: f64,
    /// `trapezoidal`: where the focus ends in the map, −1 the far side, 1 the near one.
    pub focus_at: f64,
    /// `light-space-perspective`: factor on the optimal near distance of the warp.
    pub n_opt_scale: f64,
    /// `light-space-perspective`: smallest angle between view and light that is warped, radians.
    pub min_angle_rad: f64,
    /// `dual-paraboloid`: largest angle that an edge of a drawn caster spans, radians; 0: as large as it is.
    pub max_edge_rad: f64,
    /// `dual-paraboloid`: whether the front half looks straight down, not where the light aims.
    pub looks_down: bool,
    /// `adaptive`: side of a tile.
    pub tile_texels: u32,
    /// `adaptive`: how often a tile may be halved.
    pub max_level: u32,
    /// `adaptive`: how many tiles there may be.
    pub max_tiles: u32,
    /// `adaptive`: texels up to this size in the picture are fine enough, pixels.
    pub m_target: f64,
    /// `adaptive`: whether only tiles split in which depth jumps.
    pub edges_only: bool,
}

impl Default for Knobs {
    fn default() -> Self {
        Self {
            cascades: 4,
            lambda: 0.5,
            min_distance_m: None,
            first_far_m: None,
            splits_m: None,
            max_distance_m: None,
            is_stable: true,
            selects_by_projection: false,
            blend_texels: 0.0,
            overlap_ratio: 0.0,
            virtual_back_m: None,
            focus_fraction: 0.3,
            focus_at: -0.6,
            n_opt_scale: 1.0,
            min_angle_rad: 1.0_f64.to_radians(),
            max_edge_rad: 2.0_f64.to_radians(),
            looks_down: false,
            tile_texels: 64,
            max_level: 6,
            max_tiles: MOST_TILES,
            m_target: 1.0,
            edges_only: true,
        }
    }
}

impl Knobs {
    /// Reads them from a `map` specification.
    #[must_use]
    pub fn of(spec: &Spec) -> Self {
        Self {
            cascades: spec.integer("cascades") as u32,
            lambda: spec.real("lambda"),
            min_distance_m: spec.real_or_auto("min_distance_m"),
            first_far_m: spec.real_or_auto("first_far_m"),
            splits_m: spec.ascending_or_auto("splits_m"),
            max_distance_m: spec.real_or_auto("max_distance_m"),
            is_stable: spec.choice("cascade_fit").0 == "sphere",
            selects_by_projection: spec.choice("selection").0 == "by-projection",
            blend_texels: spec.real("blend_texels"),
            overlap_ratio: spec.real("overlap_ratio"),
            virtual_back_m: spec.real_or_auto("virtual_back_m"),
            focus_fraction: spec.real("focus_fraction"),
            focus_at: spec.real("focus_at"),
            n_opt_scale: spec.real("n_opt_scale"),
            min_angle_rad: spec.real("min_angle_deg").to_radians(),
            max_edge_rad: spec.real("max_edge_deg").to_radians(),
            looks_down: spec.choice("orientation").0 == "down",
            tile_texels: spec.integer("tile_texels") as u32,
            max_level: spec.integer("max_level") as u32,
            max_tiles: spec.integer("max_tiles") as u32,
            m_target: spec.real("m_target"),
            edges_only: spec.choice("edges_only").0 == "on",
        }
    }
}

/// Each tile is a layer and a pass of its own; one pass more looks up.
const MOST_TILES: u32 = 511;

/// Far beyond any scene f32 can hold with useful precision.
const MAX_M: f64 = 1e12;

/// Their declarations.
#[must_use]
pub fn params() -> Vec<Param> {
    let param = |name, unit, kind, default, help| Param { name, unit, kind, default, help };
    let real = |min, max| Kind::Real { min, max, auto: false };
    let auto = |min, max| Kind::Real { min, max, auto: true };
    let whole = |min: i64, max: u32| Kind::Integer { min, max: max.into() };
    let plain = |names: [&'static str; 2]| Kind::Choice(names.into_iter().map(Choice::plain).collect());
    vec![
        param("cascades", "", Kind::Integer { min: 1, max: 8 }, Value::Integer(4), "cascaded: how many"),
        param("lambda", "", real(0.0, 1.0), Value::Real(0.5), "cascaded: 0 uniform splits, 1 logarithmic ones"),
        param(
            "min_distance_m",
            "m",
            auto(1e-12, MAX_M),
            Value::Auto,
            "cascaded: where the first one starts; auto: at the nearest receiver",
        ),
        param(
            "first_far_m",
            "m",
            auto(1e-12, MAX_M),
            Value::Auto,
            "cascaded: where the first one ends, the others being split from there; auto: by lambda, as they are",
        ),
        param(
            "splits_m",
            "m",
            Kind::Ascending { min: 1e-12, max: MAX_M },
            Value::Auto,
            "cascaded: where all but the last one end, whatever lambda and first_far_m say; auto: by these",
        ),
        param(
            "max_distance_m",
            "m",
            auto(1e-12, MAX_M),
            Value::Auto,
            "cascaded: where the last one ends; auto: at the farthest receiver",
        ),
        param(
            "cascade_fit",
            "",
            plain(["sphere", "box"]),
            Value::Choice("sphere", None),
            "cascaded: sphere around the slice, snapped to whole texels (stable), or box around its receivers (tight)",
        ),
        param(
            "selection",
            "",
            plain(["by-depth", "by-projection"]),
            Value::Choice("by-depth", None),
            "cascaded: the one of the receiver's depth, or the first that contains it",
        ),
        param(
            "blend_texels",
            "texels",
            real(0.0, 64.0),
            Value::Real(0.0),
            "cascaded: band before a split in which two are blended",
        ),
        param(
            "overlap_ratio",
            "",
            real(0.0, 0.9),
            Value::Real(0.0),
            "cascaded: the same as a share of the split's distance; the wider band counts",
        ),
        param(
            "virtual_back_m",
            "m",
            auto(0.0, MAX_M),
            Value::Auto,
            "perspective: how far the virtual eye stands behind the eye; auto: until every caster is before it",
        ),
        param(
            "focus_fraction",
            "",
            real(0.01, 0.79),
            Value::Real(0.3),
            "trapezoidal: share of the trapezoid's height that is in focus",
        ),
        param(
            "focus_at",
            "",
            real(-0.9, 0.0),
            Value::Real(-0.6),
            "trapezoidal: where the focus ends in the map, -1 at its far side",
        ),
        param(
            "n_opt_scale",
            "",
            real(0.1, 1e6),
            Value::Real(1.0),
            "light-space-perspective: factor on the optimal distance of the warp's centre",
        ),
        param(
            "min_angle_deg",
            "degrees",
            real(0.0, 90.0),
            Value::Real(1.0),
            "light-space-perspective: below this angle between view and light the map is not warped",
        ),
        param(
            "max_edge_deg",
            "degrees",
            real(0.0, 90.0),
            Value::Real(2.0),
            "dual-paraboloid: casters are cut until no edge spans more as seen from the light; 0: not at all",
        ),
        param(
            "orientation",
            "",
            plain(["aim", "down"]),
            Value::Choice("aim", None),
            "dual-paraboloid: where the front half looks, as the light aims or straight down",
        ),
        param("tile_texels", "texels", whole(8, 1024), Value::Integer(64), "adaptive: side of a tile"),
        param("max_level", "", whole(0, 12), Value::Integer(6), "adaptive: how often the map may be halved into tiles"),
        param(
            "max_tiles",
            "",
            whole(1, MOST_TILES),
            Value::Integer(MOST_TILES.into()),
            "adaptive: how many tiles there may be, besides no more texels than a map of that size has",
        ),
        param(
            "m_target",
            "pixels",
            real(0.25, 16.0),
            Value::Real(1.0),
            "adaptive: texels up to this size in the picture are fine enough",
        ),
        param(
            "edges_only",
            "",
            plain(["on", "off"]),
            Value::Choice("on", None),
            "adaptive: whether only tiles in which depth jumps are refined",
        ),
    ]
}
