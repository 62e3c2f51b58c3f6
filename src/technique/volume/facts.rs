//! What volumes settled on and how one pixel was counted, in words and numbers for people.

use super::assembly::Faces;
use super::casting::OpenEdge;
use super::extrude::Reach;
use super::prepared::PreparedVolume;
use super::range::distances_m;
use crate::technique::TechniqueError;

type Facts = Vec<(String, String)>;

fn fact(label: &str, value: String) -> (String, String) {
    (label.to_owned(), value)
}

/// Numbers of objects, triangles and faces.
pub(super) fn facts(volume: &PreparedVolume<'_>) -> Facts {
    let volumes = &volume.volumes;
    let used: usize = volumes.objects.iter().map(|object| object.used.len()).sum();
    let one_sided = volumes.objects.iter().filter(|object| object.light_facing_only).count();
    let (before, behind) = volume.objects_before_and_behind();
    let sum = |count: fn(&Faces) -> usize| count(&volumes.behind) + count(&volumes.before);
    let mut facts = vec![
        fact("casting triangles in use", format!("{used} of {}", volume.job.casters.triangle_count())),
        fact(
            "objects by casting side",
            format!("{one_sided} light-facing only, {} both sides", volumes.objects.len() - one_sided),
        ),
        fact("objects by count", format!("{before} before the surface, {behind} behind it")),
        fact("silhouette edges", (volumes.behind.silhouette_edges + volumes.before.silhouette_edges).to_string()),
        fact("side triangles", sum(|faces| faces.sides.len() / 3).to_string()),
        fact(
            "cap triangles",
            format!(
                "{} front, {} back",
                sum(|faces| (faces.front_caps.len() + faces.inward_front_caps.len()) / 3),
                sum(|faces| faces.back_caps.len() / 3)
            ),
        ),
        fact(
            "reach",
            match volumes.reach {
                Reach::Infinite => "infinite".to_owned(),
                Reach::Metres(length_m) => format!("{length_m:.6} m"),
            },
        ),
        fact("far plane", volume.eye.far_m.map_or_else(|| "infinite".to_owned(), |far_m| format!("{far_m:.6} m"))),
    ];
    facts.extend(open_objects(volume));
    if volume.settings.starts_at_eye_count {
        facts.push(fact("counts start from", volume.start.to_string()));
    }
    if volume.settings.range_mask {
        let [from_m, to_m] = distances_m(volume.job.light, &volume.eye);
        facts.push(fact("range mask", format!("{from_m:.6} m to {to_m:.6} m along the view")));
    }
    if volumes.fell_back {
        facts.push(fact("zp-plus", "light in the near plane: counted behind the surface instead".to_owned()));
    }
    if volume.settings.scissor {
        let (min, size) = (volume.passes.scissor().min, volume.passes.scissor().size());
        facts.push(fact("scissor", format!("{} x {} pixels from ({}, {})", size.x, size.y, min.x, min.y)));
    }
    facts
}

/// Objects that are not closed although only their light-facing triangles cast.
fn open_objects(volume: &PreparedVolume<'_>) -> Facts {
    /// More objects than this are only counted.
    const NAMED: usize = 8;
    let open: Vec<_> = volume.volumes.objects.iter().filter(|object| object.is_open_and_one_sided()).collect();
    let named = open.iter().take(NAMED).map(|object| {
        let edges = object.open_edges.iter().take(NAMED).map(|&edge| described(volume, edge));
        let more = object.open_edges.len().saturating_sub(NAMED);
        let edges = edges.chain((more > 0).then(|| format!("{more} more"))).collect::<Vec<_>>().join("; ");
        let name = &volume.job.scene.meshes[object.mesh].name;
        fact("open object cast one-sided", format!("{name}: {} open edges: {edges}", object.open_edges.len()))
    });
    let rest = open.len().saturating_sub(NAMED);
    named.chain((rest > 0).then(|| fact("further open objects", rest.to_string()))).collect()
}

/// An edge and its ends in the scene file's coordinates.
fn described(volume: &PreparedVolume<'_>, edge: OpenEdge) -> String {
    let [from, to] = volume.ends_of(edge).map(|end| {
        let end = end + volume.job.scene.origin_in_file;
        format!("({:.6}, {:.6}, {:.6})", end.x, end.y, end.z)
    });
    format!("edge {} from {from} to {to}", edge.id)
}

/// How one pixel was counted.
pub(super) fn lookup_facts(volume: &PreparedVolume<'_>, pixel: u32) -> Result<Facts, TechniqueError> {
    /// More crossings than this are only counted.
    const LISTED: usize = 25;
    let Some((receiver, counts)) = volume.receiver(pixel).zip(volume.counts(pixel)) else { return Ok(Vec::new()) };
    let stencil = volume.stencil()?.get(pixel as usize).copied().unwrap_or_default();
    let crossed = volume.counter.crossed(receiver.point_in_world, Some(receiver.triangle));
    let scene = volume.job.scene;
    let mut facts = vec![
        fact("volumes around the receiver", counts.crossed.to_string()),
        fact("after reach and far plane", counts.reached.to_string()),
        fact("counted from the near plane", counts.from_near.to_string()),
        fact("expected in the stencil", counts.stencil().to_string()),
        fact("in the stencil", stencil.to_string()),
    ];
    if counts.is_tied {
        facts.push(fact("tie", "the shadow ray runs through an edge or a corner".to_owned()));
    }
    if volume.boundary_touches(pixel) {
        let what = "a volume's own surface meets it within 1/256 pixel and the depth's rounding";
        facts.push(fact("count edge", what.to_owned()));
    }
    if let Some((object, edge)) = volume.hole_before(&receiver) {
        let name = &scene.meshes[object.mesh].name;
        let what = format!("{name} is crossed from its back alone; nearest open {}", described(volume, edge));
        facts.push(fact("open mesh", what));
    }
    facts.extend(crossed.iter().take(LISTED).map(|&triangle| {
        fact("inside the volume of", format!("triangle {triangle} of {}", scene.mesh_of(triangle).name))
    }));
    if crossed.len() > LISTED {
        facts.push(fact("further volumes", (crossed.len() - LISTED).to_string()));
    }
    Ok(facts)
}
