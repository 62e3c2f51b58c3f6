//! Colours and their blends. Colours are display colours (sRGB), and so are the blends: legends show the same ones.

use embedded_graphics::pixelcolor::{Rgb888, RgbColor};

/// A colour from its usual spelling, e.g. `0x56B4E9`.
pub(super) const fn rgb(hex: u32) -> Rgb888 {
    Rgb888::new((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// From `a` (0) to `b` (1).
pub(super) fn blend(a: Rgb888, b: Rgb888, share: f32) -> Rgb888 {
    let channel = |a: u8, b: u8| (f32::from(a) + share * (f32::from(b) - f32::from(a)) + 0.5) as u8;
    Rgb888::new(channel(a.r(), b.r()), channel(a.g(), b.g()), channel(a.b(), b.b()))
}

/// The colour at a position in a list of evenly spaced ones, from the first (0) to the last (1).
pub(super) fn along(colours: &[Rgb888], position: f32) -> Rgb888 {
    let at = position.clamp(0.0, 1.0) * (colours.len() - 1) as f32;
    let left = (at as usize).min(colours.len().saturating_sub(2));
    blend(colours[left], colours[(left + 1).min(colours.len() - 1)], at - left as f32)
}

/// How far colours look apart, to everybody and to people who see red or green less: the test of every palette.
#[cfg(test)]
pub(super) mod difference {
    use super::*;

    /// Deuteranopia and protanopia in linear RGB (G. Machado, M. Oliveira, L. Fernandes, "A Physiologically-based Model
    /// for Simulation of Color Vision Deficiency", 2009, severity 1).
    const DEUTERANOPIA: [[f64; 3]; 3] =
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]];
    const PROTANOPIA: [[f64; 3]; 3] =
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]];
    const LINEAR_RGB_TO_XYZ_OVER_WHITE: [[f64; 3]; 3] =
        [[0.433953, 0.376219, 0.189828], [0.212673, 0.715152, 0.072175], [0.017758, 0.109477, 0.872765]];

    fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(m, x)| m * x).sum::<f64>().clamp(0.0, 1.0))
    }

    fn linear(colour: Rgb888) -> [f64; 3] {
        [colour.r(), colour.g(), colour.b()].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        })
    }

    fn lab(linear: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = times(LINEAR_RGB_TO_XYZ_OVER_WHITE, linear)
            .map(|t| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    fn delta(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// CIE 1976 ΔE between two colours.
    pub(crate) fn for_everybody(a: Rgb888, b: Rgb888) -> f64 {
        delta(lab(linear(a)), lab(linear(b)))
    }

    /// The smaller ΔE of those that deuteranopes and protanopes see.
    pub(crate) fn for_the_colour_blind(a: Rgb888, b: Rgb888) -> f64 {
        let seen = |matrix| delta(lab(times(matrix, linear(a))), lab(times(matrix, linear(b))));
        f64::min(seen(DEUTERANOPIA), seen(PROTANOPIA))
    }

    #[test]
    fn the_measure_sees_what_it_should() {
        assert!((for_everybody(Rgb888::BLACK, Rgb888::WHITE) - 100.0).abs() < 0.1);
        assert!(for_everybody(Rgb888::RED, Rgb888::RED) < f64::EPSILON);
        // A red and a green that many people confuse, and a blue and an orange that nobody does.
        let (red, green) = (rgb(0xB0_4A_30), rgb(0x7A_72_30));
        assert!(for_the_colour_blind(red, green) < 0.6 * for_everybody(red, green));
        assert!(for_the_colour_blind(rgb(0x56_B4_E9), rgb(0xE6_9F_00)) > 60.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blends_end_at_their_colours() {
        let (a, b) = (rgb(0x10_20_30), rgb(0xFF_00_80));
        assert_eq!((blend(a, b, 0.0), blend(a, b, 1.0)), (a, b));
        let colours = [Rgb888::BLACK, Rgb888::WHITE, a];
        assert_eq!([0.0, 0.5, 1.0].map(|x| along(&colours, x)), colours);
        assert_eq!((along(&colours, -3.0), along(&colours, 7.0)), (Rgb888::BLACK, a));
        assert_eq!(along(&colours[..1], 0.7), Rgb888::BLACK);
    }
}
