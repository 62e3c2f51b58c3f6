//! Patterns of taps turned and shifted for each pixel otherwise, without sines: what is noise then would be bands
//! otherwise.
//!
//! The hash is that of M. Jarzynski and M. Olano, "Hash Functions for GPU Rendering", 2020 (`pcg`). An angle is a number
//! of quarter turns and one of ±45 degrees, whose half has a tangent that is uniform in ±tan(π/8). Twin of
//! `shaders/map/turn.wgsl`.

use super::Kernel;
use crate::gpu::shader::{Wgsl, wgsl};
use glam::DVec2;

/// Where filters that turn their taps find how.
pub(super) const TURN: Wgsl = wgsl!("map/turn.wgsl");

/// tan(π/8).
const LARGEST_HALF_TANGENT: f64 = 0.414_213_56;
const OF_24_BITS: f64 = 1.0 / 16_777_216.0;

/// A place of the pattern around zero, turned for a pixel.
pub(super) fn turned(kernel: &Kernel, pixel: u32, place: DVec2) -> DVec2 {
    if !kernel.turns {
        return place;
    }
    let bits = hash(pixel ^ hash(kernel.seed));
    let half = (f64::from(bits >> 8) * OF_24_BITS * 2.0 - 1.0) * LARGEST_HALF_TANGENT;
    let turn = DVec2::new(1.0 - half * half, 2.0 * half) / (1.0 + half * half);
    let within_eighth = turn.rotate(place);
    let quarter = if bits & 1 != 0 { within_eighth.perp() } else { within_eighth };
    if bits & 2 != 0 { -quarter } else { quarter }
}

/// A place of the unit square, shifted for a pixel; what leaves it on one side comes in on the other.
pub(super) fn shifted(kernel: &Kernel, pixel: u32, place: DVec2) -> DVec2 {
    if !kernel.turns {
        return place;
    }
    let bits = hash(pixel ^ hash(kernel.seed));
    let more_bits = hash(bits);
    (place + DVec2::new(f64::from(bits >> 8), f64::from(more_bits >> 8)) * OF_24_BITS).fract()
}

fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_keep_lengths_reach_every_direction_and_repeat_with_their_seed() {
        let kernel = Kernel { turns: true, ..Kernel::wide(1) };
        let mut sectors = [0; 16];
        for pixel in 0..16_000 {
            let place = turned(&kernel, pixel, DVec2::X);
            assert!((place.length() - 1.0).abs() < 1e-12);
            sectors[((place.to_angle() / std::f64::consts::TAU + 0.5) * 16.0) as usize % 16] += 1;
            assert_eq!(place, turned(&kernel, pixel, DVec2::X));
            let shifted = shifted(&kernel, pixel, DVec2::splat(0.9));
            assert!(shifted.min_element() >= 0.0 && shifted.max_element() < 1.0);
        }
        // Uniform but for the tangent of the half angle, which is within 9 % of it.
        assert!(sectors.iter().all(|count| (800..1200).contains(count)), "{sectors:?}");
        let other = Kernel { seed: 1, ..kernel };
        assert_ne!(turned(&kernel, 5, DVec2::X), turned(&other, 5, DVec2::X));
        assert_eq!(turned(&Kernel::wide(1), 5, DVec2::X), DVec2::X);
    }
}
