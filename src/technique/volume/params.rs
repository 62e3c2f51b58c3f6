//! What the user can set about stencil shadow volumes, declared once.

use crate::technique::param::{Choice, Kind, Param, Value};
use std::sync::LazyLock;

/// Lengths that f32 holds with useful precision.
const MIN_M: f64 = 1e-12;
const MAX_M: f64 = 1e12;

/// A choice among plain names, the first of which is the default.
fn choice(name: &'static str, names: &[&'static str], help: &'static str) -> Param {
    let kind = Kind::Choice(names.iter().copied().map(Choice::plain).collect());
    Param { name, unit: "", kind, default: Value::Choice(names[0], None), help }
}

/// A length that gnomon finds by itself unless it is typed.
fn length(name: &'static str, help: &'static str) -> Param {
    let kind = Kind::Real { min: MIN_M, max: MAX_M, auto: true };
    Param { name, unit: "m", kind, default: Value::Auto, help }
}

pub(super) static PARAMS: LazyLock<Vec<Param>> = LazyLock::new(|| {
    vec![
        choice(
            "count",
            &["z-fail", "z-pass", "mixed", "zp-plus"],
            "which volume faces are counted: behind the surface, before it, whichever is safe per object, or before it from the exact start",
        ),
        choice("shape", &["silhouette", "per-triangle"], "one volume per object, or one per triangle"),
        choice(
            "caster_sides",
            &["auto", "light-facing", "all"],
            "triangles that cast; auto: the light-facing ones of closed objects, all of the others",
        ),
        choice("extrusion", &["infinite", "finite"], "how far volumes reach"),
        length("length_m", "reach of finite volumes; auto: twice the scene's extent"),
        choice("far", &["infinite", "clamp", "finite"], "what happens to volumes at the camera's far plane"),
        length("far_m", "the far plane unless far=infinite; auto: the camera's, else just behind the scene"),
        choice("stencil_ops", &["wrap", "clamp"], "what the stencil does beyond 0 and 255"),
        choice("faces", &["two-sided", "two-pass"], "both faces in one draw, or one draw each"),
        choice("caps", &["auto", "none", "front", "back", "both"], "caps drawn; auto: those the count needs"),
        choice(
            "cap_compare",
            &["strict", "inclusive"],
            "depth comparison of the volumes; inclusive shows why it must be strict",
        ),
        choice(
            "back_cap",
            &["reversed-facing", "away-facing"],
            "which triangles close a volume's far end; away-facing is wrong around a light inside a mesh",
        ),
        choice(
            "extrude",
            &["cpu", "gpu", "degenerate-quads"],
            "where vertices are moved away from the light; degenerate-quads: where silhouettes are found, too",
        ),
        choice("scissor", &["off", "on"], "draw only where the light's range reaches in the picture"),
        choice(
            "range_mask",
            &["off", "on"],
            "draw only where what is seen is as deep as the light's range reaches; the stencil then counts modulo 128",
        ),
        choice(
            "stencil_init",
            &["zero", "eye-count"],
            "where counting before the surface starts; eye-count: with the volumes around the near plane's middle",
        ),
        choice("depth_convention", &["reversed", "forward"], "which end of the depth range is near the camera"),
        choice("format", &["depth32float-stencil8", "depth24plus-stencil8"], "the camera's depth and stencil buffer"),
    ]
});
