//! Faults planted in every shader file: each must be noticed, as pixels whose answer the f64 twin cannot explain. A
//! check that a broken shader passes proves nothing, so a shader file without a fault here is a failure too.

use super::{Effort, View, evaluate};
use crate::cause::Cause;
use crate::gpu::Gpu;
use crate::scene::{LoadOptions, Scene, load};
use crate::technique::{Spec, Unsupported, shader_modules};
use crate::watch::Unwatched;
use glam::UVec2;
use std::collections::BTreeSet;
use std::path::Path;

/// A shader file, text in it, what stands there instead, and a technique that the change must break.
type Fault = (&'static str, &'static str, &'static str, &'static str);

const FAULTS: &[Fault] = &[
    ("gbuffer.wgsl", "vec4f(position_in_world, 1.0)", "vec4f(position_in_world.yxz, 1.0)", "planar"),
    ("shared/receiver.wgsl", "return thread.x +", "return thread.x / 2u +", "map"),
    ("map/caster.wgsl", "vec4f(position_in_world, 1.0)", "vec4f(position_in_world, 1.01)", "map"),
    ("map/caster_pancaked.wgsl", "min(clip.z, clip.w)", "min(clip.z, 0.5 * clip.w)", PANCAKED),
    ("map/caster_depth.wgsl", "corner.depth.x / corner.depth.y", "corner.depth.y - corner.depth.x", IN_FRAGMENTS),
    ("map/caster_rows.wgsl", "vec4f(clip.xy, ", "vec4f(clip.yx, ", IN_FRAGMENTS),
    ("map/caster_paraboloid.wgsl", "seen.xy / (RIM", "seen.yx / (RIM", PARABOLOID),
    ("map/paraboloid.wgsl", "q = distance + seen.z", "q = distance - seen.z", PARABOLOID),
    (
        "map/projection/dual_paraboloid.wgsl",
        "one_view(select(0u, 1u, before < 0.0 && arrayLength(&views) > 1u))",
        "Shares(0u, 0u, sqrt(-1.0 - before * before))",
        PARABOLOID,
    ),
    ("map/gather.wgsl", "texels[index].xy", "texels[index].xy + 1u", "map"),
    ("map/view.wgsl", "change / volume", "0.9 * change / volume", "map"),
    ("map/homogeneous.wgsl", "vec2f(dot(view.u_row, point), dot(view.v_row, point))", "vec2f(q)", "map"),
    (
        "map/homogeneous.wgsl",
        "move_uv.x * cross(around.v, normal)",
        "move_uv.y * cross(around.v, normal)",
        ACROSS_FACES,
    ),
    ("map/homogeneous.wgsl", "let rounding = POSITION_ROUNDING", "let rounding = -1e5 * POSITION_ROUNDING", "map"),
    (
        "map/projection/one_view.wgsl",
        "one_view(0u)",
        "Shares(0u, 0u, sqrt(-1.0 - dot(point_in_world, point_in_world)))",
        "map",
    ),
    ("map/projection/cube.wgsl", "> dot(", "< dot(", "map:projection=cube"),
    ("map/projection/adaptive.wgsl", "<= place", "< place - 9000u", "map:projection=adaptive"),
    (
        "map/projection/cascaded.wgsl",
        ">= 0.0 {\n        own++",
        "<= 0.0 {\n        own++",
        "map:projection=cascaded,size=64",
    ),
    ("map/lookup.wgsl", "views[view].depth_sign * bias", "-views[view].depth_sign * bias", "map"),
    ("map/lookup.wgsl", "normal_in_world), shares.second_weight)", "normal_in_world), 1.0)", BLENDED),
    ("map/lookup.wgsl", "floor(found.uv * lookup.texels)", "floor(found.uv.yx * lookup.texels)", ACROSS_FACES),
    ("map/lookup.wgsl", "clamp(at.depth, 0.0, 1.0)", "at.depth", "map:border=clamp-edge,far_m=5"),
    ("map/lookup.wgsl", "nearest_texel(texel, lookup.texels);", "nearest_texel(texel.yx, lookup.texels);", STRETCHED),
    ("map/lookup.wgsl", "|| lookup.border == BORDER_CLAMP_EDGE) {", ") {", STRETCHED),
    ("map/paraboloid.wgsl", "length(seen) * direction - seen", "length(seen) * direction.yxz - seen", ACROSS_DISCS),
    ("map/paraboloid.wgsl", "return rounding + bent_m / range_m", "return rounding", PARABOLOID_KERNEL),
    ("map/nearest_layer.wgsl", "drawn_depth(corner)", "1.0 - drawn_depth(corner)", IN_FRAGMENTS),
    ("map/second_layer.wgsl", "<= SAME_LAYER", ">= SAME_LAYER", "map:bias=midpoint"),
    ("map/midpoint.wgsl", "0.5 * (", "0.9 * (", "map:bias=midpoint"),
    ("map/offset.wgsl", "offset.x + offset.y", "0.0", "map:size=300,bias=normal"),
    ("map/lookup.wgsl", "vec2f(texel) + 0.5 - placed", "vec2f(texel) - 0.5 - placed", "map:bias=receiver-plane"),
    ("map/filter/nearest.wgsl", "floor(position_in_texels)", "floor(position_in_texels + 0.25)", "map"),
    ("map/filter/pcf_box.wgsl", "- (n - 1) / 2", "- (n + 1) / 2", "map:filter=pcf-box3"),
    ("map/filter/pcf_bilinear.wgsl", "0.5 * f32(n)", "0.6 * f32(n)", "map:filter=pcf-bilinear"),
    ("map/filter/pcf_poisson.wgsl", "/ 1024.0", "/ 900.0", "map:filter=pcf-poisson"),
    ("map/filter/pcf_hardware.wgsl", "corner + 0.5", "corner + 0.75", "map:filter=pcf-hardware2"),
    ("map/filter/pcf_edge_masked.wgsl", "max(around.y, block.y)", "min(around.y, block.y)", MASKED),
    ("map/extremes.wgsl", "low = min(low, depth)", "low = max(low, depth)", MASKED),
    ("map/filter/pcss.wgsl", "numbers[0].w", "0.5 * numbers[0].w", SOFTENED),
    ("map/filter/pcss.wgsl", "shares_depth != 0u", "shares_depth == 2u", "map:filter=pcss,projection=adaptive"),
    ("map/filter/vsm.wgsl", "mean.y - mean.x * mean.x", "mean.y - mean.x", "map:filter=vsm"),
    ("map/filter/esm.wgsl", "mean.x * exp(-numbers[1].x * z)", "mean.x * exp(-numbers[1].x)", "map:filter=esm"),
    ("map/filter/evsm.wgsl", "-exp(-numbers[1].y", "exp(-numbers[1].y", "map:filter=evsm"),
    ("map/filter/msm.wgsl", "c1 / c3", "c1 * c3", "map:filter=msm,msm_bias=0.01"),
    ("map/filter/depth_mean.wgsl", "z <= mean.x", "z <= 0.9 * mean.x", "map:filter=depth-mean"),
    ("map/moments/z.wgsl", "1.0 - depth", "depth", "map:filter=vsm"),
    ("map/moments/lookup.wgsl", "(n + 1) / 2", "n / 2", "map:filter=vsm"),
    ("map/moments/rows.wgsl", "/ f32(n)", "/ 2.0", "map:filter=vsm"),
    ("map/moments/columns.wgsl", "/ f32(n)", "/ 2.0", "map:filter=vsm"),
    ("map/moments/gather.wgsl", "texels[index].xy", "texels[index].yx", "map:filter=vsm"),
    ("map/moments/chebyshev.wgsl", "variance / (variance", "variance / (2.0 * variance", "map:filter=vsm"),
    ("map/moments/r32float.wgsl", "<r32float, write>", "<rgba32float, write>", "map:filter=esm"),
    ("map/moments/rg32float.wgsl", "<rg32float, write>", "<rgba32float, write>", "map:filter=vsm"),
    ("map/moments/rgba32float.wgsl", "<rgba32float, write>", "<rg32float, write>", "map:filter=evsm"),
    (
        "map/moments/rgba16float.wgsl",
        "<rgba16float, write>",
        "<rg32float, write>",
        "map:filter=vsm,moment_format=float16",
    ),
    ("map/numbers.wgsl", "array<vec4f>", "array<vec3f>", SOFTENED),
    ("map/turn.wgsl", "747796405u", "747796407u", SOFTENED),
    ("irregular/view.wgsl", "ROUNDING: f32 = ", "ROUNDING: f32 = -1e4 * ", "irregular"),
    ("irregular/clear.wgsl", "blocked[index] = 0u", "blocked[index] = 1u", "irregular"),
    ("irregular/insert.wgsl", "index + 1u", "index", "irregular"),
    ("irregular/rectangles.wgsl", "low - pad", "high - pad", "irregular"),
    ("irregular/casters.wgsl", "light_side >= 0.0", "light_side <= 0.0", "irregular"),
    ("irregular/resolve.wgsl", "f32(1u - ", "f32(0u + ", "irregular"),
    ("planar/shadow.wgsl", "vec4f(position, 1.0)", "vec4f(position, 1.01)", "planar"),
    ("projective_texture/caster.wgsl", "vec4f(position_in_world, 1.0)", "vec4f(position_in_world, 1.01)", PROJECTED),
    ("projective_texture/lookup.wgsl", "uv * lookup.texels", "uv.yx * lookup.texels", PROJECTED),
    ("silhouette/points.wgsl", "b.uv * texels - 0.5", "b.uv * texels + 0.5", "silhouette:size=64"),
    ("silhouette/wedges.wgsl", "position_in_texels - 0.5", "position_in_texels", "silhouette:size=64"),
    ("ray_query/shadow.wgsl", "0.0, end, start", "0.0, 0.1 * end, start", "ray-query"),
    (
        "volume/clip.wgsl",
        "eye.clip_from_world * position_in_world",
        "eye.clip_from_world * position_in_world.yxzw",
        "volume",
    ),
    ("volume/extrusion.wgsl", "- extrusion.light.xyz;", "+ extrusion.light.xyz;", "volume:extrude=gpu"),
    ("volume/extruded.wgsl", "extruded(position_in_world)", "extruded(position_in_world.yxzw)", "volume:extrude=gpu"),
    ("volume/quads.wgsl", "abs(weight) <= face.copy", "abs(weight) < face.copy", "volume:extrude=degenerate-quads"),
    ("volume/range.wgsl", "bound.depth, 1.0", "1.0 - bound.depth, 1.0", "volume:range_mask=on"),
    ("volume/given.wgsl", "clipped(position_in_world)", "clipped(position_in_world.yxzw)", "volume:extrude=cpu"),
    (
        "volume/near.wgsl",
        "projection.clip_from_caster * position_in_world",
        "vec4f(position_in_world.xz, 0.5, 1.0)",
        ZP_PLUS,
    ),
    ("volume/count.wgsl", "count == 0u", "count <= 1u", "volume"),
    ("volume/resolve.wgsl", "receivers[index].pixel", "receivers[index].pixel / 2u", "volume"),
    ("volume/mask.wgsl", "pixel.y * picture.width", "(pixel.y / 2u) * picture.width", "hybrid"),
    ("volume/resolve_masked.wgsl", "!= 0u", "== 0u", "hybrid"),
    ("hybrid/classify.wgsl", "> 0.0 &&", "> 1.0 &&", "hybrid"),
];
const MASKED: &str = "map:filter=pcf-edge-masked,depth_convention=forward";
const SOFTENED: &str = "map:filter=pcss,turn=per-pixel,max_texels=20";
const IN_FRAGMENTS: &str = "map:near_mode=fragment-clamp";
const PANCAKED: &str = "map:near_mode=vertex-clamp";
const PARABOLOID: &str = "map:projection=dual-paraboloid";
const PARABOLOID_KERNEL: &str = "map:projection=dual-paraboloid,size=64,filter=pcf-box5";
const BLENDED: &str = "map:projection=cascaded,size=64,overlap_ratio=0.3";
const ACROSS_FACES: &str = "map:projection=cube,size=64,filter=pcf-box5";
const ACROSS_DISCS: &str = "map:projection=dual-paraboloid,orientation=down,size=16,filter=pcf-box7";
const STRETCHED: &str = "map:border=clamp-edge,fov_deg=20,filter=pcf-box5";
const PROJECTED: &str = "projective-texture";
const ZP_PLUS: &str = "volume:count=zp-plus";

/// Large enough for shadows of some thousand pixels.
const SIZE: UVec2 = UVec2::new(200, 150);
/// Pixels that rasterisers and rounding may put on the other side of an edge in such a picture.
const MOST_BY_PRECISION: u64 = 8;

/// A torus, a room for what needs seams in shadows, or area lights for what answers for their extent.
fn scene(typed: &str) -> Scene {
    let spec = Spec::parse(typed).unwrap();
    let is_hard = spec.technique().blamed_for_centre(&spec) == Some(Cause::TechniqueModel);
    let name = match (is_hard, [ACROSS_FACES, ACROSS_DISCS].contains(&typed)) {
        (false, _) => "area",
        (true, true) => "room",
        (true, false) => "torus",
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    load(&folder, &LoadOptions { size: Some(SIZE), ..LoadOptions::default() }).unwrap()
}

/// Whether anything notices: an error, or more pixels than rounding explains. The view is that of a sound device.
fn is_noticed(gpu: &Gpu, scene: &Scene, typed: &str) -> bool {
    let sound = Gpu::open().unwrap();
    let sound_view = View::new(&sound, scene).unwrap();
    let view = View::new(gpu, scene).unwrap();
    let view = View { receivers: sound_view.receivers, ..view };
    let spec = Spec::parse(typed).unwrap();
    let handled = scene.lights.iter().filter(|light| spec.technique().supports(&spec, scene, light, gpu).is_ok());
    handled.into_iter().any(|light| {
        let question = view.ask(light, &Unwatched).unwrap();
        let evaluated = evaluate(&view, &question, &spec, Effort::CAUSES, &Unwatched);
        match evaluated {
            Ok(evaluation) => {
                let by_precision = evaluation.ledger.causes.get(&Cause::Precision);
                by_precision.is_some_and(|share| share.pixels + share.merely_differing > MOST_BY_PRECISION)
            }
            Err(_) => true,
        }
    })
}

/// Whether the adapter cannot run a technique at all; told, because nothing is tried then.
fn lacks_feature(gpu: &Gpu, scene: &Scene, typed: &str) -> bool {
    let spec = Spec::parse(typed).unwrap();
    let refused = spec.technique().supports(&spec, scene, &scene.lights[0], gpu).err();
    let lacks = matches!(refused, Some(Unsupported::MissingFeature { .. }));
    if lacks {
        eprintln!("skipped: {typed}: {}", refused.unwrap());
    }
    lacks
}

#[test]
fn sound_shaders_are_explained_and_every_fault_is_noticed() {
    let mut gpu = Gpu::open().unwrap();
    for (file, from, to, typed) in FAULTS {
        let scene = scene(typed);
        gpu.fault = None;
        if lacks_feature(&gpu, &scene, typed) {
            continue;
        }
        assert!(!is_noticed(&gpu, &scene, typed), "{typed} is not explained");
        gpu.fault = Some((from, to));
        assert!(is_noticed(&gpu, &scene, typed), "{file}: {from:?} -> {to:?} goes unnoticed in {typed}");
    }
}

#[test]
fn every_shader_file_has_a_fault_in_its_text() {
    let modules = shader_modules();
    let files = modules.iter().flat_map(|(_, files)| files);
    let there: BTreeSet<_> = files.clone().map(|file| file.path).collect();
    let broken: BTreeSet<_> = FAULTS.iter().map(|(file, ..)| *file).collect();
    assert_eq!(broken, there);
    for (path, from, ..) in FAULTS {
        assert!(files.clone().any(|file| file.path == *path && file.text.contains(from)), "{path} lacks {from:?}");
    }
}
