//! Where one pixel's lookup went, for people.

use super::prepared::PreparedMap;
use super::reading::{Depths, Looked};
use super::replay::Replayer;
use crate::technique::TechniqueError;

/// More taps than this are not listed one by one.
const LISTED_TAPS: usize = 25;

/// Label and value: the place in the map, the bias, and what every texel that is read says.
pub(super) fn lookup_facts(map: &PreparedMap<'_>, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
    let Some(receiver) = map.receiver(pixel) else { return Ok(Vec::new()) };
    let fact = |label: &str, value: String| (label.to_owned(), value);
    let shares = map.lookup.select(receiver.point_in_world);
    let placed = match map.lookup.place(shares.first, receiver.point_in_world, receiver.normal_in_world) {
        Err(outside) => {
            let answer = if map.lookup.border_visibility() > 0.0 { "lit" } else { "shadow" };
            return Ok(vec![fact("place in the map", format!("outside ({outside:?}): {answer}"))]);
        }
        Ok(placed) => placed,
    };
    let at = placed.position_in_texels;
    let mut facts = Vec::new();
    if map.lookup.views.len() > 1 {
        let named: Vec<String> = shares
            .iter()
            .map(|(view, weight)| format!("{} ({:.0} %)", map.lookup.views[view].name, 100.0 * weight))
            .collect();
        let seam = map.lookup.in_view(receiver.point_in_world).seam_texels;
        let seam = seam.map_or_else(String::new, |texels| format!("; {texels:.1} texels from its seam"));
        facts.push(fact("view", named.join(", ") + &seam));
    }
    facts.extend([
        fact("position in the map", format!("({:.4}, {:.4}) texels", at.x, at.y)),
        fact("depth, reference", format!("{:.9}, {:.9}", placed.depth, placed.reference)),
    ]);
    facts.extend(map.bias_at(&receiver, &placed).facts());

    let replayer = Replayer::new(map, &[pixel])?;
    let mut taps = Vec::new();
    let looked = Looked { lookup: &map.lookup, pixel, receiver, placed };
    let reading = &replayer.reading;
    reading.each_tap(Depths::Exact, &looked, &mut |tap, _| taps.push(tap));
    for tap in taps.iter().take(LISTED_TAPS) {
        let Some(tap) = tap else {
            facts.push(fact("texel", "outside the map".to_owned()));
            continue;
        };
        let (Some(stored), Some(exact)) = (reading.depth(Depths::Stored, tap), reading.exact(tap)) else { continue };
        let lit = if map.lookup.is_lit(tap.placed.view, tap.placed.reference, stored) { "lit" } else { "shadow" };
        let holds = exact.triangle.map_or_else(
            || "nothing".to_owned(),
            |triangle| format!("triangle {triangle} of {}", map.job.scene.mesh_of(triangle).name),
        );
        let across = if tap.placed.view == placed.view {
            String::new()
        } else {
            format!(" of {}", map.lookup.views[tap.placed.view].name)
        };
        let says = format!("stores {stored:.9} → {lit}; the exact map holds {holds}");
        facts.push(fact(&format!("texel ({}, {}){across}", tap.texel.x, tap.texel.y), says));
    }
    if taps.len() > LISTED_TAPS {
        facts.push(fact("further texels", format!("{}", taps.len() - LISTED_TAPS)));
    }
    Ok(facts)
}
