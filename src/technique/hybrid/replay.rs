//! A hybrid replayed: every pixel by the ledger of what answered it. The map's stages come first, then the volumes'; a
//! pixel passes through the others' unchanged. Which of the two answers is the GPU's own decision: where a silhouette is
//! missed, the map's `sampling` is to blame. Where the map answers though its texels disagree, the device is.

use super::prepared::PreparedHybrid;
use crate::cause::{Cause, Replay, Stage};
use crate::mask::Mask;
use crate::technique::{Prepared, TechniqueError};

/// The last stage of either.
const GPU: &str = "gpu";

pub(super) fn replay(hybrid: &PreparedHybrid<'_>, answer: &Mask, pixels: &[u32]) -> Result<Replay, TechniqueError> {
    let silhouettes = hybrid.silhouettes()?;
    let (on, off): (Vec<u32>, Vec<u32>) = pixels.iter().partition(|pixel| silhouettes[**pixel as usize]);
    let (by_map, by_volume) = (hybrid.map.replay(answer, &off)?, hybrid.volume.replay(answer, &on)?);
    Ok(joined(pixels, &by_map, &by_volume))
}

/// Two replays of different pixels as one of all.
fn joined(pixels: &[u32], first: &Replay, second: &Replay) -> Replay {
    let slots: Vec<(u32, &Replay, usize)> = pixels
        .iter()
        .filter_map(|pixel| {
            let of = |replay: &Replay| replay.pixels.binary_search(pixel).ok();
            of(first).map(|slot| (*pixel, first, slot)).or_else(|| of(second).map(|slot| (*pixel, second, slot)))
        })
        .collect();
    let before_gpu = |replay: &'_ Replay| replay.stages.iter().filter(|stage| stage.name != GPU).count();
    let stage = |of: &Replay, index: usize| {
        let at = |(_, replay, slot): &(u32, &Replay, usize)| {
            if std::ptr::eq(*replay, of) {
                (of.stages[index].values[*slot], of.stages[index].causes[*slot])
            } else if std::ptr::eq(of, first) {
                // Not begun yet.
                (replay.exact[*slot], Cause::Precision)
            } else {
                let told = replay.stages[before_gpu(replay) - 1].values[*slot];
                // Texels that disagree should have called for the exact answer, not for their mean.
                (if told > 0.0 && told < 1.0 { replay.exact[*slot] } else { told }, Cause::Precision)
            }
        };
        let (values, causes) = slots.iter().map(at).unzip();
        Stage { name: of.stages[index].name, values, causes }
    };
    let mut stages: Vec<Stage> = (0..before_gpu(first)).map(|index| stage(first, index)).collect();
    stages.extend((0..before_gpu(second)).map(|index| stage(second, index)));
    let last = |(_, replay, slot): &(u32, &Replay, usize)| replay.stages[before_gpu(replay)].values[*slot];
    let causes = vec![Cause::Precision; slots.len()];
    stages.push(Stage { name: GPU, values: slots.iter().map(last).collect(), causes });
    Replay {
        pixels: slots.iter().map(|(pixel, ..)| *pixel).collect(),
        exact: slots.iter().map(|(_, replay, slot)| replay.exact[*slot]).collect(),
        stages,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(pixel: u32, exact: f64, stages: &[(&'static str, f64)]) -> Replay {
        let stage = |(name, value): &(&'static str, f64)| Stage {
            name,
            values: vec![*value],
            causes: vec![Cause::EdgeAliasing],
        };
        Replay { pixels: vec![pixel], exact: vec![exact], stages: stages.iter().map(stage).collect() }
    }

    #[test]
    fn each_pixel_keeps_its_own_stages_and_passes_through_the_others() {
        let by_map = one(7, 1.0, &[("sampling", 0.0), ("filter", 0.5), (GPU, 0.25)]);
        let by_volume = one(3, 0.0, &[("near plane", 1.0), (GPU, 1.0)]);
        let both = joined(&[3, 7], &by_map, &by_volume);
        let told: Vec<(&str, Vec<f64>)> = both.stages.iter().map(|s| (s.name, s.values.clone())).collect();
        let expected = [
            ("sampling", vec![0.0, 0.0]),
            ("filter", vec![0.0, 0.5]),
            ("near plane", vec![1.0, 1.0]),
            (GPU, vec![1.0, 0.25]),
        ];
        assert_eq!(told, expected);
        assert_eq!((both.pixels, both.exact), (vec![3, 7], vec![0.0, 1.0]));
    }
}
