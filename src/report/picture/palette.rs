//! The colours of sheets, pixel classes and errors.
//!
//! Errors are blue for false shadow and vermilion-orange for false light, which every common kind of colour blindness
//! tells apart (M. Okabe, K. Ito, "Color Universal Design", 2008). They glow on a dark, dimmed truth, so that a single
//! wrong pixel among a million is seen.

use super::colour::{blend, rgb};
use crate::mask::Truth;
use crate::receiver::PixelClass;
use embedded_graphics::pixelcolor::Rgb888;

/// Behind everything.
pub(super) const SHEET: Rgb888 = rgb(0x16_18_1C);
/// Headings and figures.
pub(super) const TEXT: Rgb888 = rgb(0xF2_F3_F5);
/// Everything said in passing.
pub(super) const FAINT_TEXT: Rgb888 = rgb(0xA4_AA_B4);
/// Around panels, swatches and scales.
pub(super) const FRAME: Rgb888 = rgb(0x5C_62_6C);

/// Visibility 0 and 1 where visibility itself is shown.
pub(super) const SHADOW: Rgb888 = rgb(0x00_00_00);
/// See [`SHADOW`].
pub(super) const LIT: Rgb888 = rgb(0xFF_FF_FF);

/// The truth's shadow and light behind something more important.
pub(super) const DIM_SHADOW: Rgb888 = rgb(0x1E_1F_22);
/// See [`DIM_SHADOW`].
pub(super) const DIM_LIT: Rgb888 = rgb(0x54_58_5F);

/// Too dark: Okabe and Ito's sky blue.
pub(super) const FALSE_SHADOW: Rgb888 = rgb(0x56_B4_E9);
/// Too bright: between Okabe and Ito's orange and vermilion.
pub(super) const FALSE_LIGHT: Rgb888 = rgb(0xFF_8C_1A);

const BACKGROUND: Rgb888 = rgb(0x24_36_4C);
const FACING_AWAY: Rgb888 = rgb(0x4E_3A_66);
const NOT_LIT: Rgb888 = rgb(0x4A_44_22);
/// As quiet as the other classes: an undecided pixel is no error and must not look like one among the causes.
const UNDECIDED: Rgb888 = rgb(0x1C_5C_50);

/// A pixel that is not compared, with its name in legends.
pub(super) struct Uncompared {
    /// Its name.
    pub(super) name: &'static str,
    /// Its colour.
    pub(super) colour: Rgb888,
}

/// The kinds of pixels that are not compared, in the order of legends and of [`uncompared`].
pub(super) const UNCOMPARED: [Uncompared; 4] = [
    Uncompared { name: "background", colour: BACKGROUND },
    Uncompared { name: "facing away", colour: FACING_AWAY },
    Uncompared { name: "not lit", colour: NOT_LIT },
    Uncompared { name: "undecided", colour: UNDECIDED },
];

/// The colour of a pixel that is not compared; for a compared one its exact visibility.
pub(super) fn uncompared(class: PixelClass, truth: Option<Truth>) -> Result<f32, Rgb888> {
    match (class, truth) {
        (PixelClass::Background, _) => Err(BACKGROUND),
        (PixelClass::FacingAway, _) => Err(FACING_AWAY),
        (PixelClass::NotLit, _) => Err(NOT_LIT),
        (PixelClass::Asked, Some(Truth::Known(visibility))) => Ok(visibility.get()),
        (PixelClass::Asked, _) => Err(UNDECIDED),
    }
}

/// A visibility as grey.
pub(super) fn grey(visibility: f32) -> Rgb888 {
    blend(SHADOW, LIT, visibility)
}

/// A visibility as grey that stays behind.
pub(super) fn dim(visibility: f32) -> Rgb888 {
    blend(DIM_SHADOW, DIM_LIT, visibility)
}

/// A signed error (technique − truth, −1..=1) over the dimmed truth it was made at.
pub(super) fn signed_error(error: f32, truth: f32) -> Rgb888 {
    blend(dim(truth), if error < 0.0 { FALSE_SHADOW } else { FALSE_LIGHT }, error.abs())
}

#[cfg(test)]
mod tests {
    use super::super::colour::difference::{for_everybody, for_the_colour_blind};
    use super::*;

    /// CIE 1976 ΔE at which flat areas side by side look clearly different.
    const CLEARLY_DIFFERENT: f64 = 10.0;

    #[test]
    fn errors_stand_out_for_everybody() {
        let quiet = [DIM_SHADOW, DIM_LIT, BACKGROUND, FACING_AWAY, NOT_LIT, UNDECIDED];
        for loud in [FALSE_SHADOW, FALSE_LIGHT] {
            assert!(quiet.iter().all(|&quiet| for_the_colour_blind(loud, quiet) > 3.0 * CLEARLY_DIFFERENT));
        }
        assert!(for_the_colour_blind(FALSE_SHADOW, FALSE_LIGHT) > 6.0 * CLEARLY_DIFFERENT);
        // Control: pure red over pure green, the usual choice, would not do.
        let (red, green) = (rgb(0xC8_64_00), rgb(0x96_8C_00));
        assert!(for_the_colour_blind(red, green) < 6.0 * CLEARLY_DIFFERENT);
    }

    #[test]
    fn classes_differ_from_one_another_and_from_visibilities() {
        let mut colours = vec![SHADOW, LIT, DIM_SHADOW, DIM_LIT];
        colours.extend(UNCOMPARED.iter().map(|class| class.colour));
        for (i, &class) in colours.iter().enumerate().skip(4) {
            for &other in &colours[..i] {
                assert!(for_everybody(class, other) > CLEARLY_DIFFERENT, "{class:?} {other:?}");
                assert!(for_the_colour_blind(class, other) > 0.5 * CLEARLY_DIFFERENT, "{class:?} {other:?}");
            }
        }
    }

    #[test]
    fn no_error_leaves_the_dimmed_truth() {
        assert_eq!(signed_error(0.0, 1.0), DIM_LIT);
        assert_eq!(signed_error(-1.0, 1.0), FALSE_SHADOW);
        assert_eq!(signed_error(1.0, 0.0), FALSE_LIGHT);
    }
}
