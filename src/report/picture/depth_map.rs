//! A light's depth map as a picture: what the light sees, by stored depth.

use super::colour::{along, rgb};
use super::legend::{ColourScale, Swatch};
use super::palette::UNCOMPARED;
use super::sheet::{Panel, Sheet};
use super::{Caption, PictureError, check_sizes};
use crate::report::format::significant;
use embedded_graphics::pixelcolor::Rgb888;
use glam::UVec2;

/// From the least stored depth to the greatest.
const DEPTHS: [Rgb888; 5] = [rgb(0x1A_0C_3B), rgb(0x6A_1E_6E), rgb(0xC9_40_5A), rgb(0xF6_8F_46), rgb(0xFC_F0_B5)];
/// A map larger than this is shown by every other texel, or fewer.
const LARGEST_SIDE: u32 = 1024;

/// What a picture of a depth map is made from.
#[derive(Debug, Clone, Copy)]
pub struct DepthMap<'a> {
    /// For the heading.
    pub caption: Caption<'a>,
    /// Width and height in texels.
    pub size: UVec2,
    /// Stored depths, row by row from the top; cleared texels are `None`.
    pub depths: &'a [Option<f64>],
}

/// The picture as PNG; colours run from the least depth in the map to the greatest.
///
/// # Errors
/// Inputs of different sizes, and a map without texels or too large.
pub fn depth_map(map: &DepthMap) -> Result<Vec<u8>, PictureError> {
    check_sizes(map.size, &[("list of depths", map.depths.len())])?;
    let stride = map.size.max_element().div_ceil(LARGEST_SIDE);
    let shown = map.size / stride;
    let least = map.depths.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let most = map.depths.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let share = |depth: f64| ((depth - least) / (most - least).max(f64::MIN_POSITIVE)) as f32;
    let paint = |y: usize, row: &mut [Rgb888]| {
        let start = y * stride as usize * map.size.x as usize;
        for (x, pixel) in row.iter_mut().enumerate() {
            let depth = map.depths[start + x * stride as usize];
            *pixel = depth.map_or(UNCOMPARED[0].colour, |depth| along(&DEPTHS, share(depth)));
        }
    };
    let mut sheet = Sheet::new(shown, 1);
    let thinned = if stride > 1 { format!(", one of {stride} shown each way") } else { String::new() };
    sheet.heading(&map.caption, &format!("{} x {} texels{thinned}", map.size.x, map.size.y));
    let marks = vec![(0.0, significant(least)), (1.0, significant(most))];
    let scale = ColourScale { colour: Box::new(|position| along(&DEPTHS, position)), marks };
    sheet.panels(vec![Panel { title: "depth map: stored depth", paint: Box::new(paint), scale: Some(scale) }]);
    sheet.swatches([Swatch { colour: UNCOMPARED[0].colour, label: "nothing drawn".to_owned() }]);
    sheet.into_png()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_maps_are_thinned_and_wrong_lists_refused() {
        let caption = Caption { scene: "s", light: "l", technique: "map" };
        let depths = vec![Some(0.25); 2048 * 4];
        let map = DepthMap { caption, size: UVec2::new(2048, 4), depths: &depths };
        assert!(depth_map(&map).is_ok());
        assert!(depth_map(&DepthMap { size: UVec2::new(2048, 5), ..map }).is_err());
    }
}
