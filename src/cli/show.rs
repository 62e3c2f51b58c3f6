//! `gnomon render --show`: what a technique works with, drawn into the picture that it makes.

use super::args::{RenderArgs, Show};
use super::context::prepare;
use super::exit;
use super::output::{ImageFormat, OutFile};
use super::terminal::say;
use crate::evaluate::View;
use crate::report::picture::{Caption, CountMap, DepthMap, count_map, depth_map};
use crate::scene::Light;
use crate::shade::{Overlay, Picture, Stroke};
use crate::technique::volume::{PreparedVolume, Settings};
use crate::technique::{LightDepths, Prepared, Spec};
use anyhow::bail;
use glam::{DMat4, DVec3, DVec4, Vec3};

/// Warm, bright lines: silhouettes and frusta.
const LINE: Vec3 = Vec3::new(1.0, 0.45, 0.02);
/// What shadow volumes are filled with.
const FILL: Vec3 = Vec3::new(0.05, 0.22, 0.75);
/// So many lines are drawn in full; more of them faintly, so that they do not cover the picture.
const DRAWN_IN_FULL: f32 = 600.0;

/// What is shown if no technique is named.
fn default_spec(show: Show) -> &'static str {
    match show {
        Show::Volumes | Show::Silhouette | Show::Stencil => "volume",
        Show::DepthMap | Show::Frustum => "map",
    }
}

/// The technique to show.
pub(super) fn spec(args: &RenderArgs, show: Show) -> anyhow::Result<Spec> {
    let spec = Spec::parse(args.technique.as_deref().unwrap_or(default_spec(show)))?;
    let of_volumes = matches!(show, Show::Volumes | Show::Silhouette | Show::Stencil);
    if of_volumes && spec.technique().id() != "volume" {
        bail!("--show {} needs a volume technique, such as -t volume:count=z-pass", show.name());
    }
    Ok(spec)
}

/// Draws into a lit picture, or writes a picture of its own.
pub(super) fn run(
    out: &OutFile,
    show: Show,
    view: &View<'_>,
    light: &Light,
    spec: &Spec,
    mut picture: Picture,
) -> anyhow::Result<u8> {
    let classes = view.receivers.classify(view.scene, light);
    let typed = spec.short();
    let caption = Caption { scene: &view.scene.name, light: &light.name, technique: &typed };
    let overlay = Overlay::new(view.scene, &view.receivers);
    let bytes = match show {
        Show::Volumes | Show::Silhouette | Show::Stencil => {
            let volume = PreparedVolume::new(Settings::of(spec), view.job(light, &classes))?;
            match show {
                Show::Stencil => Some(stencil(&volume, view, caption)?),
                Show::Volumes => {
                    draw_volumes(&overlay, &volume, &mut picture);
                    None
                }
                _ => {
                    let edges = volume.silhouettes().into_iter().map(|edge| edge.map(|end| end.extend(1.0)));
                    overlay.lines(&mut picture, edges, &stroke(LINE, 2.0, 1.0, 0.22));
                    None
                }
            }
        }
        Show::Frustum => {
            let prepared = prepare(spec, view, light, &classes)?;
            let frusta = prepared.light_frusta();
            if frusta.is_empty() {
                bail!("'{typed}' has no frustum to show");
            }
            for clip_from_world in frusta {
                overlay.lines(&mut picture, edges_of(&clip_from_world).into_iter(), &stroke(LINE, 2.0, 1.0, 0.3));
            }
            None
        }
        Show::DepthMap => {
            let prepared = prepare(spec, view, light, &classes)?;
            prepared.run()?;
            let Some(LightDepths { size, depths }) = prepared.light_depths()? else {
                bail!("'{typed}' has no depth map to show")
            };
            Some(depth_map(&DepthMap { caption, size, depths: &depths })?)
        }
    };
    match (bytes, out.format) {
        (Some(bytes), ImageFormat::Png) => out.write(&bytes)?,
        (Some(_), ImageFormat::Exr) => bail!("--show {} makes a .png: it is a sheet with a legend", show.name()),
        (None, ImageFormat::Png) => out.write(&picture.to_png()?)?,
        (None, ImageFormat::Exr) => out.write(&picture.to_exr()?)?,
    }
    say(&format!("showed the {} of {typed} for light {}", show.name(), light.name));
    Ok(exit::OK)
}

fn stroke(colour: Vec3, width_px: f64, opacity: f32, hidden_opacity: f32) -> Stroke {
    Stroke { colour, width_px, opacity, hidden_opacity }
}

fn stencil(volume: &PreparedVolume<'_>, view: &View<'_>, caption: Caption<'_>) -> anyhow::Result<Vec<u8>> {
    volume.run()?;
    let stencil = volume.stencil()?;
    let counts: Vec<Option<u8>> =
        view.receivers.pixels.iter().zip(stencil).map(|(pixel, count)| pixel.map(|_| count)).collect();
    Ok(count_map(&CountMap { caption, size: view.scene.image_size, counts: &counts })?)
}

/// Volumes filled, their silhouettes as lines, and a line from each end of a silhouette edge along the light's rays.
fn draw_volumes(overlay: &Overlay, volume: &PreparedVolume<'_>, picture: &mut Picture) {
    let edges = volume.silhouettes();
    let faintness = (DRAWN_IN_FULL / edges.len().max(1) as f32).min(1.0);
    overlay.tint(picture, volume.sides(), FILL);
    let rays = edges.iter().map(|[from, _]| [from.extend(1.0), volume.extruded(*from)]);
    overlay.lines(picture, rays, &stroke(Vec3::splat(0.8), 1.0, 0.5 * faintness, 0.05 * faintness));
    let ends = |edge: &[DVec3; 2]| edge.map(|end| end.extend(1.0));
    overlay.lines(picture, edges.iter().map(ends), &stroke(LINE, 1.6, 1.0, 0.3 * faintness));
}

/// The twelve edges of what a matrix takes to the clip volume.
fn edges_of(clip_from_world: &DMat4) -> Vec<[DVec4; 2]> {
    let world_from_clip = clip_from_world.inverse();
    let corner = |bits: usize| {
        let pick = |bit: usize| if bits >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = world_from_clip * DVec4::new(pick(0), pick(1), 0.5 * (1.0 + pick(2)), 1.0);
        // Homogeneous points of either sign are one point; lines between them need the same sign.
        if corner.w < 0.0 { -corner } else { corner }
    };
    let edges = (0..8).flat_map(|from| (0..3).map(move |bit| (from, from | 1 << bit))).filter(|(from, to)| from != to);
    edges.map(|(from, to)| [corner(from), corner(to)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frustum_has_twelve_edges_of_its_own_length() {
        let edges = edges_of(&DMat4::IDENTITY);
        assert_eq!(edges.len(), 12);
        assert!(edges.iter().all(|[from, to]| [1.0, 2.0].contains(&from.distance(*to))));
    }
}
