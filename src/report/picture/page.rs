//! The colours of pictures for a page that paints them itself: the same ones, from the same constants.

use super::cause_colours::colour_of_cause;
use super::cause_map::MERELY_DIFFERING;
use super::palette::{DIM_LIT, DIM_SHADOW, FALSE_LIGHT, FALSE_SHADOW, UNCOMPARED};
use super::value_map::{COLOURS, LARGEST_M};
use crate::cause::Cause;
use crate::verdict::DIFFERING_ABOVE;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use serde::Serialize;

/// Red, green and blue of an sRGB display.
type Colour = [u8; 3];

/// Everything a page needs to colour a pixel.
#[derive(Debug, Serialize)]
pub(in crate::report) struct PageColours {
    /// In the order of [`UNCOMPARED`].
    classes: Vec<Named>,
    /// In the order of [`Cause::ALL`].
    causes: Vec<NamedCause>,
    dim_shadow: Colour,
    dim_lit: Colour,
    false_shadow: Colour,
    false_light: Colour,
    /// How strong the cause's colour is where a pixel differs without being wrong.
    merely_differing: f32,
    /// The error above which a pixel differs.
    differing_above: f64,
    m: MScale,
}

#[derive(Debug, Serialize)]
struct Named {
    name: &'static str,
    colour: Colour,
}

#[derive(Debug, Serialize)]
struct NamedCause {
    name: &'static str,
    meaning: &'static str,
    colour: Colour,
}

/// From m = 1 to the largest, evenly spaced in log m.
#[derive(Debug, Serialize)]
struct MScale {
    colours: Vec<Colour>,
    largest: f32,
}

/// The colours of every picture.
pub(in crate::report) fn page_colours() -> PageColours {
    let cause =
        |cause: Cause| NamedCause { name: cause.name(), meaning: cause.meaning(), colour: colour_of_cause(cause) };
    PageColours {
        classes: UNCOMPARED.iter().map(|class| Named { name: class.name, colour: channels(class.colour) }).collect(),
        causes: Cause::ALL.map(cause).into(),
        dim_shadow: channels(DIM_SHADOW),
        dim_lit: channels(DIM_LIT),
        false_shadow: channels(FALSE_SHADOW),
        false_light: channels(FALSE_LIGHT),
        merely_differing: MERELY_DIFFERING,
        differing_above: DIFFERING_ABOVE,
        m: MScale { colours: COLOURS.map(channels).into(), largest: LARGEST_M },
    }
}

fn channels(colour: Rgb888) -> Colour {
    [colour.r(), colour.g(), colour.b()]
}
