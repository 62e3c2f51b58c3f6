//! One colour per cause, the same in every picture.
//!
//! The most common causes have the eight colours of M. Okabe and K. Ito, "Color Universal Design", 2008 (white for its
//! black, on dark sheets); the others are the bright colours that a search found to differ most from these, from one
//! another and from the dimmed truth, for normal, deuteranope and protanope eyes alike.

use super::colour::rgb;
use crate::cause::Cause;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};

/// The table, in the order of [`Cause::ALL`].
const COLOURS: [(Cause, Rgb888); 18] = [
    (Cause::EdgeAliasing, rgb(0xE6_9F_00)),
    (Cause::PerspectiveAliasing, rgb(0x08_F8_90)),
    (Cause::ProjectiveAliasing, rgb(0xD5_5E_00)),
    (Cause::Acne, rgb(0x56_B4_E9)),
    (Cause::Curvature, rgb(0x00_72_B2)),
    (Cause::PeterPanning, rgb(0xCC_79_A7)),
    (Cause::ClippingNear, rgb(0x00_9E_73)),
    (Cause::ClippingFar, rgb(0xB8_D8_B0)),
    (Cause::ClippingFrustum, rgb(0xA8_F0_70)),
    (Cause::StencilOverflow, rgb(0xD8_08_28)),
    (Cause::OpenMesh, rgb(0xC8_08_A8)),
    (Cause::PlanarModel, rgb(0x90_28_E0)),
    (Cause::AntiShadow, rgb(0xB0_68_F0)),
    (Cause::FalseShadowBehindPlane, rgb(0xB8_58_50)),
    (Cause::FilterWidth, rgb(0xF0_E4_42)),
    (Cause::LightBleeding, rgb(0x28_D8_E8)),
    (Cause::Precision, rgb(0xF0_F0_F8)),
    (Cause::TechniqueModel, rgb(0xB8_A0_48)),
];

/// The colour of a cause in pictures: red, green and blue of an sRGB display.
#[must_use]
pub fn colour_of_cause(cause: Cause) -> [u8; 3] {
    let colour = colour(cause);
    [colour.r(), colour.g(), colour.b()]
}

/// The colour of a cause.
pub(super) fn colour(cause: Cause) -> Rgb888 {
    COLOURS[cause as usize].1
}

#[cfg(test)]
mod tests {
    use super::super::colour::difference::{for_everybody, for_the_colour_blind};
    use super::super::palette::{DIM_LIT, DIM_SHADOW, UNCOMPARED};
    use super::*;

    /// What the search reached: smallest CIE 1976 ΔE of any two causes, or of a cause and the dimmed truth.
    const APART_FOR_EVERYBODY: f64 = 25.0;
    const APART_FOR_THE_COLOUR_BLIND: f64 = 13.0;

    fn too_close(colours: &[Rgb888]) -> Option<(Rgb888, Rgb888)> {
        let pairs = colours.iter().enumerate().flat_map(|(i, &a)| colours[..i].iter().map(move |&b| (a, b)));
        pairs.into_iter().find(|&(a, b)| {
            for_everybody(a, b) < APART_FOR_EVERYBODY || for_the_colour_blind(a, b) < APART_FOR_THE_COLOUR_BLIND
        })
    }

    #[test]
    fn the_table_is_in_the_order_of_the_causes() {
        assert_eq!(COLOURS.map(|(cause, _)| cause), Cause::ALL);
        assert!(Cause::ALL.iter().all(|&cause| COLOURS[cause as usize].0 == cause));
        assert_eq!(colour_of_cause(Cause::Acne), [0x56, 0xB4, 0xE9]);
    }

    #[test]
    fn no_two_causes_look_alike_nor_like_the_truth_behind_them() {
        let mut colours = COLOURS.map(|(_, colour)| colour).to_vec();
        for truth in [DIM_SHADOW, DIM_LIT] {
            colours.push(truth);
            assert_eq!(too_close(&colours), None);
            colours.pop();
        }
        // A pixel that is not compared must not pass for a wrong one.
        for class in &UNCOMPARED {
            let apart = |colour: &Rgb888| for_everybody(*colour, class.colour) > APART_FOR_EVERYBODY;
            assert!(COLOURS.iter().all(|(_, colour)| apart(colour)), "{}", class.name);
        }
        // Control: a slightly different orange is found.
        colours[17] = rgb(0xE8_A8_08);
        assert_eq!(too_close(&colours), Some((colours[17], colours[0])));
    }
}
