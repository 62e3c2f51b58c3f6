//! Where one pixel's lookup went, for people.

use super::prepared::PreparedMap;
use super::replay::{Replayer, each_tap, place};
use crate::technique::TechniqueError;

/// More taps than this are not listed one by one.
const LISTED_TAPS: usize = 25;

/// Label and value: the place in the map, the bias, and what every texel that is read says.
pub(super) fn lookup_facts(map: &PreparedMap<'_>, pixel: u32) -> Result<Vec<(String, String)>, TechniqueError> {
    let Some(receiver) = map.receiver(pixel) else { return Ok(Vec::new()) };
    let fact = |label: &str, value: String| (label.to_owned(), value);
    let placed = match place(&map.lookup, &receiver) {
        Err(outside) => return Ok(vec![fact("place in the map", format!("outside ({outside:?}): lit"))]),
        Ok(placed) => placed,
    };
    let at = placed.position_in_texels;
    let mut facts = vec![
        fact("position in the map", format!("({:.4}, {:.4}) texels", at.x, at.y)),
        fact("depth, reference", format!("{:.9}, {:.9}", placed.depth, placed.reference)),
    ];
    facts.extend(map.bias_at(&receiver, &placed).facts());

    let replayer = Replayer::new(map, &[pixel])?;
    let mut taps = Vec::new();
    each_tap(map, &placed, &mut |texel, _| taps.push(texel));
    for &texel in taps.iter().take(LISTED_TAPS) {
        let says = match (replayer.stored(texel), replayer.exact(texel)) {
            (Some(stored), Some(exact)) => {
                let lit = if map.lookup.is_lit(placed.reference, stored) { "lit" } else { "shadow" };
                let holds = exact.triangle.map_or_else(
                    || "nothing".to_owned(),
                    |triangle| format!("triangle {triangle} of {}", map.job.scene.mesh_of(triangle).name),
                );
                format!("stores {stored:.9} → {lit}; the exact map holds {holds}")
            }
            _ => "outside the map → lit".to_owned(),
        };
        facts.push(fact(&format!("texel ({}, {})", texel.x, texel.y), says));
    }
    if taps.len() > LISTED_TAPS {
        facts.push(fact("further texels", format!("{}", taps.len() - LISTED_TAPS)));
    }
    Ok(facts)
}
