//! Three ways in which renderers apply one mask: light on top of ambient, light on top of nothing, or darkness on top of
//! light. Formulas: docs/lighting.md#pipelines.

pub use crate::technique::lighting::LightingPipeline as Pipeline;
use glam::DVec3;

impl Pipeline {
    /// The colour of a pixel from what no shadow changes and, per light, visibility and direct light.
    pub(super) fn colour(self, own: DVec3, lights: impl Iterator<Item = (f64, DVec3)> + Clone) -> DVec3 {
        let shadowed = || lights.clone().map(|(visibility, direct)| visibility * direct).sum::<DVec3>();
        let brightest = || lights.clone().map(|(visibility, _)| visibility).fold(0.0, f64::max);
        match self {
            Self::AmbientLit => own + shadowed(),
            Self::Black => brightest() * own + shadowed(),
            Self::Darkening { amount } => {
                let full = own + lights.clone().map(|(_, direct)| direct).sum::<DVec3>();
                lights.fold(full, |colour, (visibility, _)| colour * (1.0 - amount * (1.0 - visibility)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OWN: DVec3 = DVec3::new(0.1, 0.2, 0.3);
    const DIRECT: DVec3 = DVec3::new(1.0, 0.5, 0.25);
    const EACH: [Pipeline; 3] = [Pipeline::AmbientLit, Pipeline::Black, Pipeline::Darkening { amount: 0.5 }];

    fn one(pipeline: Pipeline, visibility: f64) -> DVec3 {
        pipeline.colour(OWN, std::iter::once((visibility, DIRECT)))
    }

    #[test]
    fn in_full_light_all_are_alike() {
        assert!(EACH.iter().all(|pipeline| one(*pipeline, 1.0) == OWN + DIRECT));
    }

    #[test]
    fn in_shadow_they_keep_ambient_nothing_or_half() {
        assert_eq!(EACH.map(|pipeline| one(pipeline, 0.0)), [OWN, DVec3::ZERO, 0.5 * (OWN + DIRECT)]);
        assert_eq!(one(Pipeline::Darkening { amount: 1.0 }, 0.0), DVec3::ZERO);
        assert_eq!(one(Pipeline::Darkening { amount: 0.0 }, 0.0), OWN + DIRECT);
    }

    #[test]
    fn a_second_light_lights_the_first_ones_shadow() {
        let second = DVec3::new(0.0, 0.0, 2.0);
        let both = |pipeline: Pipeline| pipeline.colour(OWN, [(0.0, DIRECT), (1.0, second)].into_iter());
        assert_eq!(both(Pipeline::AmbientLit), OWN + second);
        assert_eq!(both(Pipeline::Black), OWN + second, "one light that is seen brings the ambient light along");
        assert_eq!(
            both(Pipeline::Darkening { amount: 0.5 }),
            0.5 * (OWN + DIRECT + second),
            "its light is darkened too"
        );
    }
}
