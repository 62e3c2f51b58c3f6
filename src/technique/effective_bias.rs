//! What a bias amounts to, whatever units it was typed in: how far comparisons are really moved, in units of depth, in
//! metres and in texels, over the receivers of each view of a map (docs/map.md#bias).

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The bias at one receiver, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasAt {
    /// Towards the light, at the receiver and by the rasteriser together, in units of the map's depth.
    pub along_light_depth: f64,
    /// The same in metres.
    pub along_light_m: f64,
    /// How far the receiver is moved along its normal.
    pub along_normal_m: f64,
    /// What the receiver's own slope and the filter need towards the light.
    pub acne_free_m: f64,
    /// How far a thin blocker's shadow starts from where it stands, for what is applied towards the light.
    pub contact_gap_m: f64,
    /// Width of a texel there.
    pub texel_m: f64,
}

/// The bias of one view over the receivers that read it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectiveBias {
    /// The view's name.
    pub view: String,
    /// How many receivers read it.
    pub receivers: u64,
    /// Towards the light, in units of the map's depth.
    pub along_light_depth: Range,
    /// Towards the light.
    pub along_light: Lengths,
    /// Along the receivers' normals.
    pub along_normal: Lengths,
    /// What the receivers' slopes and the filter need towards the light.
    pub acne_free: Lengths,
    /// How far a thin blocker's shadow starts from where it stands.
    pub contact_gap: Lengths,
    /// How stored depths are moved besides, in words, where that depends on every texel; null where they are not.
    pub stored: Option<Cow<'static, str>>,
}

/// A length over some receivers, in two units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lengths {
    /// Metres.
    pub m: Range,
    /// Widths of a texel at each receiver.
    pub texels: Range,
}

/// Spread of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Smallest.
    pub min: f64,
    /// Middle one of all in order; the upper of two.
    pub median: f64,
    /// Largest.
    pub max: f64,
}

impl EffectiveBias {
    /// Of one view; `None` if nobody reads it.
    #[must_use]
    pub fn of(view: &str, receivers: &[BiasAt]) -> Option<Self> {
        let lengths = |figure: fn(&BiasAt) -> f64| {
            let m = Range::of(receivers.iter().map(figure))?;
            Some(Lengths { m, texels: Range::of(receivers.iter().map(|bias| figure(bias) / bias.texel_m))? })
        };
        Some(Self {
            view: view.to_owned(),
            receivers: receivers.len() as u64,
            along_light_depth: Range::of(receivers.iter().map(|bias| bias.along_light_depth))?,
            along_light: lengths(|bias| bias.along_light_m)?,
            along_normal: lengths(|bias| bias.along_normal_m)?,
            acne_free: lengths(|bias| bias.acne_free_m)?,
            contact_gap: lengths(|bias| bias.contact_gap_m)?,
            stored: None,
        })
    }

    /// The same where stored depths are moved besides.
    #[must_use]
    pub fn with_stored(self, how: &'static str) -> Self {
        Self { stored: Some(Cow::Borrowed(how)), ..self }
    }

    /// Label and value of each figure, for people.
    #[must_use]
    pub fn facts(&self) -> Vec<(String, String)> {
        let mut figures = vec![("effective bias", self.along_light)];
        if self.along_normal.m.max > 0.0 {
            figures.push(("normal offset", self.along_normal));
        }
        figures.extend([("acne-free bias", self.acne_free), ("contact gap", self.contact_gap)]);
        let stored = self.stored.iter().map(|how| ("stored depths".to_owned(), format!("moved {how}")));
        figures.into_iter().map(|(label, lengths)| (label.to_owned(), lengths.told())).chain(stored).collect()
    }

    /// What is applied, in one line.
    #[must_use]
    pub fn told(&self) -> String {
        let mut told = format!("{} along the light", self.along_light.told());
        if self.along_normal.m.max > 0.0 {
            told += &format!(", {} along the normal", self.along_normal.told());
        }
        if let Some(how) = &self.stored {
            told += &format!("; stored depths moved {how}");
        }
        told
    }
}

impl BiasAt {
    /// Label and value of each figure, for people.
    #[must_use]
    pub fn facts(&self) -> Vec<(String, String)> {
        let alone = EffectiveBias::of("", &[*self]);
        alone.map(|alone| alone.facts()).unwrap_or_default()
    }
}

impl Lengths {
    /// The median, and the ends where they can be told apart.
    fn told(&self) -> String {
        if self.m.max == 0.0 {
            return "none".to_owned();
        }
        let Range { min, median, max } = self.texels;
        let [least, middle, most] = [min, median, max].map(|texels| format!("{texels:.2}"));
        let spread = if least == most { String::new() } else { format!(" ({least} to {most})") };
        format!("{:.2e} m = {middle}{spread} texels", self.m.median)
    }
}

impl Range {
    /// Of some figures; `None` of none.
    #[must_use]
    pub fn of(figures: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = figures.collect();
        sorted.sort_by(f64::total_cmp);
        Some(Self { min: *sorted.first()?, median: *sorted.get(sorted.len() / 2)?, max: *sorted.last()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bias(along_light_m: f64, along_normal_m: f64) -> BiasAt {
        BiasAt {
            along_light_depth: 0.1 * along_light_m,
            along_light_m,
            along_normal_m,
            acne_free_m: 0.02,
            contact_gap_m: 0.5 * along_light_m,
            texel_m: 0.04,
        }
    }

    #[test]
    fn figures_are_spread_over_the_receivers_in_both_units() {
        let found = EffectiveBias::of("cascade 1", &[bias(0.08, 0.0), bias(0.02, 0.0), bias(0.04, 0.0)]).unwrap();
        assert_eq!((found.view.as_str(), found.receivers), ("cascade 1", 3));
        assert_eq!(found.along_light.m, Range { min: 0.02, median: 0.04, max: 0.08 });
        assert_eq!(found.along_light.texels, Range { min: 0.5, median: 1.0, max: 2.0 });
        assert_eq!(found.contact_gap.texels.max, 1.0);
        assert_eq!(EffectiveBias::of("nobody's", &[]), None);
    }

    #[test]
    fn it_is_told_in_one_line() {
        let told = |biases: &[BiasAt]| EffectiveBias::of("map", biases).unwrap().told();
        assert_eq!(told(&[bias(0.0, 0.0)]), "none along the light");
        let moved = EffectiveBias::of("map", &[bias(0.0, 0.0)]).unwrap().with_stored("halfway");
        assert_eq!(moved.told(), "none along the light; stored depths moved halfway");
        assert_eq!(told(&[bias(0.04, 0.0)]), "4.00e-2 m = 1.00 texels along the light");
        assert_eq!(
            told(&[bias(0.04, 0.02), bias(0.02, 0.02)]),
            "4.00e-2 m = 1.00 (0.50 to 1.00) texels along the light, 2.00e-2 m = 0.50 texels along the normal"
        );
    }
}
