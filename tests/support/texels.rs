//! How large a map's texels are in the picture, measured there.

#![allow(clippy::expect_used, reason = "tests fail by panicking")]

use super::shot::{Shot, parsed};
use glam::{DVec2, DVec3};
use gnomon::evaluate::Evaluation;
use gnomon::receiver::PixelClass;
use gnomon::technique::map::{Lookup, Settings};
use std::collections::BTreeMap;

/// The lookup of a map around the asked receivers of a shot.
pub(crate) fn lookup_of(shot: &Shot<'_>, typed: &str) -> Lookup {
    let settings = Settings::of(&parsed(typed));
    let visible: Vec<DVec3> = (shot.view.receivers.pixels.iter().zip(&shot.question.classes))
        .filter(|(_, class)| **class == PixelClass::Asked)
        .filter_map(|(receiver, _)| receiver.map(|receiver| receiver.point_in_world))
        .collect();
    let views = settings.projection.fit(shot.view.scene, shot.question.light, &settings, &visible).expect("supported");
    Lookup::new(views, &settings, shot.question.light)
}

/// Measured over predicted sizes of texels on the ground, sorted.
pub(crate) fn diagonals_over_predicted(shot: &Shot<'_>, evaluation: &Evaluation<'_>, typed: &str) -> Vec<f64> {
    let measured = measured_diagonals(shot, &lookup_of(shot, typed)).into_iter();
    let mut ratios: Vec<f64> = measured
        .filter_map(|(pixel, measured)| Some(measured / evaluation.prepared.footprint(pixel)?.m_diagonal))
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
}

/// How large texels are in the picture: the longest distance between two pixels that read the same texel, for texels
/// all of whose pixels lie on the ground.
fn measured_diagonals(shot: &Shot<'_>, lookup: &Lookup) -> Vec<(u32, f64)> {
    /// Longer diagonals are cut by hills and by the picture's border, shorter ones are made of too few pixels.
    const PIXELS: std::ops::Range<usize> = 60..4000;
    let scene = shot.view.scene;
    let width = scene.image_size.x;
    let mut of_texel: BTreeMap<(i32, i32), Vec<u32>> = BTreeMap::new();
    for pixel in shot.asked() {
        let receiver = shot.view.receivers.pixels[pixel as usize].expect("asked");
        let Ok(site) = lookup.project(receiver.point_in_world) else { continue };
        let texel = site.position_in_texels().floor().as_ivec2();
        of_texel.entry((texel.x, texel.y)).or_default().push(pixel);
    }
    let at = |pixel: u32| DVec2::new((pixel % width).into(), (pixel / width).into());
    let whole = of_texel.into_values().filter(|pixels| PIXELS.contains(&pixels.len()));
    whole
        .filter_map(|pixels| {
            let middle = pixels.iter().map(|pixel| at(*pixel)).sum::<DVec2>() / pixels.len() as f64;
            let longest = pixels.iter().map(|pixel| 2.0 * (at(*pixel) - middle).length()).fold(0.0, f64::max);
            let own =
                pixels.iter().min_by(|a, b| (at(**a) - middle).length().total_cmp(&(at(**b) - middle).length()))?;
            let receiver = shot.view.receivers.pixels[*own as usize]?;
            let is_ground = scene.mesh_of(receiver.triangle).name.to_lowercase().contains("ground");
            // Between the outermost pixels' centres a diagonal loses about one pixel.
            is_ground.then_some((*own, longest + 1.0))
        })
        .collect()
}
