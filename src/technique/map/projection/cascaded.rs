//! `cascaded`: the depth range of what is seen is split into slices, and each has an orthographic view of its own.
//!
//! F. Zhang, H. Sun, L. Xu, L. K. Lun, "Parallel-Split Shadow Maps for Large-scale Virtual Environments", 2006; W. Engel,
//! "Cascaded Shadow Maps", 2006. Assumes a light infinitely far away. Known failures: steps of resolution at the splits
//! (`overlap_ratio` and `blend_texels` hide them); a tight fit crawls when the camera moves, a stable one wastes texels around its slice.

use super::fit::{LEAST_WIDTH, Reach, look};
use super::{Knobs, LightFrustum, Projection, Shape, Shares, View, Window, single};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::scene::{Light, LightKind, Scene};
use crate::technique::Unsupported;
use crate::technique::map::settings::{Around, Fit, Settings};
use glam::{DVec2, DVec3, UVec2};

/// One to eight views.
#[derive(Debug)]
pub(super) struct Cascaded;

/// A stable radius is rounded up to this share of itself, so that rounding never changes it.
const RADIUS_STEP: f64 = 1.0 / 64.0;

/// A part of what the camera sees, by distance along its axis, metres.
#[derive(Debug, Clone, Copy)]
struct Slice {
    from_m: f64,
    to_m: f64,
}

impl Projection for Cascaded {
    fn name(&self) -> &'static str {
        "cascaded"
    }

    fn shader(&self) -> Wgsl {
        wgsl!("map/projection/cascaded.wgsl")
    }

    fn has_linear_depth(&self) -> bool {
        true
    }

    fn is_unwarped(&self) -> bool {
        true
    }

    fn supports(&self, _: &Scene, light: &Light, settings: &Settings) -> Result<(), Unsupported> {
        let Knobs { cascades, splits_m, .. } = settings.knobs;
        if let Some(splits_m) = splits_m
            && splits_m.as_slice().len() as u32 + 1 != cascades
        {
            let made = splits_m.as_slice().len() + 1;
            let why = format!("splits_m={splits_m} makes {made} cascades, but cascades={cascades}");
            return Err(Unsupported::Combination { why });
        }
        direction(light).map(|_| ())
    }

    fn fit(
        &self,
        scene: &Scene,
        light: &Light,
        settings: &Settings,
        visible: &[DVec3],
    ) -> Result<Vec<View>, Unsupported> {
        let travel = direction(light)?;
        let knobs = &settings.knobs;
        let eye = scene.camera.eye.as_dvec3();
        let forward = forward(scene);
        let distance = |point: DVec3| forward.dot(point - eye);
        let everything = scene.bounds().corners();
        let seen = if visible.is_empty() { &everything[..] } else { visible };
        let distances = seen.iter().map(|point| distance(*point));
        let nearest_m = distances.clone().fold(f64::INFINITY, f64::min);
        let near_m = knobs.min_distance_m.unwrap_or(nearest_m).max(scene.camera.near_m);
        let farthest_m = distances.fold(near_m, f64::max);
        let far_m = knobs.max_distance_m.unwrap_or(farthest_m).max(near_m * (1.0 + LEAST_WIDTH));
        let ends = ends(knobs, near_m, far_m);
        let mut views: Vec<View> = Vec::new();
        for (i, ends) in ends.windows(2).enumerate() {
            let (from_m, to_m) = (ends[0], ends[1]);
            let band_m = views.last().map_or(0.0, |before| band_m(knobs, before, from_m));
            let slice = Slice { from_m: (from_m - band_m).max(scene.camera.near_m), to_m };
            let frustum = if knobs.is_stable {
                around_sphere(scene, light, settings, travel, slice)?
            } else {
                let is_in = |point: &&DVec3| (slice.from_m..=slice.to_m).contains(&distance(**point));
                let receivers: Vec<DVec3> = seen.iter().filter(is_in).copied().collect();
                let fit = Fit { around: Around::Receivers, ..settings.fit };
                single::frustum(scene, light, &Settings { fit, ..*settings }, &receivers)?
            };
            let view = frustum.view(&format!("cascade {i} ({from_m:.3} m to {to_m:.3} m)"));
            let starts = forward.extend(-forward.dot(eye) - from_m);
            views.push(View {
                selector: if knobs.selects_by_projection { glam::Vec4::ZERO } else { starts.as_vec4() },
                blend_per_m: if band_m > 0.0 { (1.0 / band_m) as f32 } else { 0.0 },
                ..view
            });
        }
        Ok(views)
    }

    fn select(&self, views: &[View], point_in_world: DVec3) -> Shares {
        if views[0].selector == glam::Vec4::ZERO {
            let holds = |view: &View| {
                let at = view.project(point_in_world);
                at.uv.min_element() >= 0.0 && at.uv.max_element() < 1.0 && (0.0..=1.0).contains(&at.depth)
            };
            return Shares::one(views.iter().position(holds).unwrap_or(views.len() - 1));
        }
        let past = |view: &View| view.selector.as_dvec4().dot(point_in_world.extend(1.0));
        let own = views.iter().skip(1).take_while(|view| past(view) >= 0.0).count();
        let next = views.get(own + 1).map_or(0.0, |next| 1.0 + past(next) * f64::from(next.blend_per_m));
        match views.get(own + 1) {
            Some(view) if view.blend_per_m > 0.0 && next > 0.0 => {
                Shares { first: own, second: own + 1, second_weight: next }
            }
            _ => Shares::one(own),
        }
    }

    /// Across a split by depth, as `blend_texels` counts; by projection, along the map to where an earlier view ends, or
    /// this one if there is a later.
    fn seam_texels(&self, views: &[View], view: usize, point_in_world: DVec3) -> Option<f64> {
        let by_projection = |other: usize| {
            let from_border = (views[other].project(point_in_world).uv - 0.5).abs() - 0.5;
            // Beyond the border the nearest of its sides counts, or its corner; within it the nearest of its sides.
            let beyond = from_border.max(DVec2::ZERO).length();
            let distance = if beyond > 0.0 { beyond } else { -from_border.max_element() };
            distance * f64::from(views[other].texels.x) * texel_m(&views[other]) / texel_m(&views[view])
        };
        let by_depth = |split: usize| {
            let past_m = views[split].selector.as_dvec4().dot(point_in_world.extend(1.0));
            past_m.abs() / texel_m(&views[view])
        };
        let last = views.len() - 1;
        if views[0].selector == glam::Vec4::ZERO {
            (0..=view).filter(|other| *other < last).map(by_projection).reduce(f64::min)
        } else {
            [view, view + 1].into_iter().filter(|split| (1..=last).contains(split)).map(by_depth).reduce(f64::min)
        }
    }
}

fn direction(light: &Light) -> Result<DVec3, Unsupported> {
    match light.kind {
        LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
            Ok(-towards_light.as_dvec3().normalize())
        }
        _ => Err(Unsupported::Light { kind: light.kind_name(), handled: "directional and sun lights" }),
    }
}

/// The camera's axis.
pub(super) fn forward(scene: &Scene) -> DVec3 {
    -scene.camera.view_from_world().row(2).truncate()
}

/// Width of a texel of an orthographic view, metres.
fn texel_m(view: &View) -> f64 {
    view.site(DVec3::ZERO).texel_m().max_element()
}

/// How far before a split, at that distance from the eye, the view beyond it is blended in; what selects by projection has
/// no splits.
fn band_m(knobs: &Knobs, before: &View, split_m: f64) -> f64 {
    let band_m = (knobs.blend_texels * texel_m(before)).max(knobs.overlap_ratio * split_m);
    if knobs.selects_by_projection { 0.0 } else { band_m }
}

/// Where slices begin and end; what lies beyond a typed end of the first one is split among the others.
fn ends(knobs: &Knobs, near_m: f64, far_m: f64) -> Vec<f64> {
    let Knobs { cascades, lambda, first_far_m, splits_m, .. } = *knobs;
    if let Some(splits_m) = splits_m {
        // Cascades before the nearest receiver, or beyond the farthest, are empty.
        let within = splits_m.as_slice().iter().map(|split| split.clamp(near_m, far_m));
        return std::iter::once(near_m).chain(within).chain([far_m]).collect();
    }
    match first_far_m.filter(|first| cascades > 1 && (near_m..far_m).contains(first)) {
        Some(first) => std::iter::once(near_m).chain(splits(cascades - 1, lambda, first, far_m)).collect(),
        None => splits(cascades, lambda, near_m, far_m),
    }
}

/// A mean of uniform and logarithmic splits.
fn splits(count: u32, lambda: f64, near_m: f64, far_m: f64) -> Vec<f64> {
    let split = |i: u32| {
        let share = f64::from(i) / f64::from(count);
        lambda * near_m * (far_m / near_m).powf(share) + (1.0 - lambda) * (near_m + (far_m - near_m) * share)
    };
    (0..=count).map(split).collect()
}

/// Distance of the centre and radius of the smallest sphere on the camera's axis around a slice, from its ends and the
/// field of view alone.
fn sphere_around(slice: Slice, tangents: DVec2) -> (f64, f64) {
    let (a, b, k2) = (slice.from_m, slice.to_m, tangents.length_squared());
    let centre = (0.5 * (a + b) * (1.0 + k2)).min(b);
    (centre, ((b - centre).powi(2) + b * b * k2).sqrt())
}

/// The view around a slice's sphere. Its texels lie on a grid that is fixed in the world.
fn around_sphere(
    scene: &Scene,
    light: &Light,
    settings: &Settings,
    travel: DVec3,
    slice: Slice,
) -> Result<LightFrustum, Unsupported> {
    let size = scene.image_size.as_dvec2();
    let tan_y = (0.5 * scene.camera.fov_y_rad).tan();
    let (centre_m, radius_m) = sphere_around(slice, DVec2::new(tan_y * size.x / size.y, tan_y));
    // Up to a power of two times a multiple of the step: the same for every camera.
    let step = RADIUS_STEP * radius_m.log2().floor().exp2();
    let radius_m = (radius_m / step).ceil() * step;
    // From as far back as a single map's, but with the grid of the world's own origin.
    let bounds = scene.bounds();
    let pull_back_m = settings.fit.pull_back_m.unwrap_or(bounds.radius().max(f64::MIN_POSITIVE));
    let from = travel * (travel.dot(bounds.centre()) - pull_back_m);
    let light_view_from_world = look(from, travel);
    let centre = scene.camera.eye.as_dvec3() + centre_m * forward(scene);
    let in_view = light_view_from_world.transform_point3(centre).truncate();
    let texels = UVec2::splat(settings.size);
    let around = Window::square(radius_m).with_rim(texels, settings.rim_texels(), 0.0, DVec2::ZERO);
    let texel = (around.max - around.min) / texels.as_dvec2();
    let moved = (in_view / texel).floor() * texel + settings.fit.phase_texels * texel;
    let window = Window { min: around.min + moved, max: around.max + moved };
    let reach = Reach::within(scene, &light_view_from_world, Shape::Parallel, window).unwrap_or_default();
    // All receivers of the slice lie within its sphere, and that does not depend on which there are.
    let reach = Reach { nearest_receiver_m: travel.dot(centre - from) - radius_m, ..reach };
    let (near_m, far_m) = settings.fit.planes_m(reach.planes(light, Shape::Parallel, settings))?;
    let (shape, reversed, depth_metric) = (Shape::Parallel, settings.reversed, settings.depth_metric);
    Ok(LightFrustum { light_view_from_world, window, near_m, far_m, shape, reversed, depth_metric, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Ascending;

    #[test]
    fn splits_are_those_of_the_formula() {
        let close = |lambda: f64, expected: [f64; 5]| {
            let found = splits(4, lambda, 0.1, 100.0);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-4 * b), "{found:?}");
        };
        close(0.5, [0.1, 12.819, 26.606, 46.404, 100.0]);
        close(1.0, [0.1, 0.5623, 3.162, 17.78, 100.0]);
        close(0.0, [0.1, 25.075, 50.05, 75.025, 100.0]);
    }

    #[test]
    fn a_typed_end_of_the_first_leaves_the_rest_to_the_others() {
        let found = ends(&Knobs { lambda: 1.0, first_far_m: Some(10.0), ..Knobs::default() }, 0.1, 150.0);
        let expected = [0.1, 10.0, 24.66, 60.82, 150.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-4 * b), "{found:?}");
        let beyond = ends(&Knobs { first_far_m: Some(200.0), ..Knobs::default() }, 0.1, 100.0);
        assert_eq!(beyond, splits(4, 0.5, 0.1, 100.0), "beyond the last end it says nothing");
    }

    #[test]
    fn typed_splits_are_the_splits() {
        let typed = |splits: &str| Knobs { splits_m: Ascending::parse(splits, 0.0, 1e3), ..Knobs::default() };
        assert_eq!(ends(&typed("10/20/50"), 0.1, 100.0), [0.1, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(ends(&typed("10/20/50"), 15.0, 30.0), [15.0, 15.0, 20.0, 30.0, 30.0], "two are empty");
    }

    #[test]
    fn the_sphere_holds_its_slice_and_touches_it() {
        let tangents = DVec2::new(0.9, 0.5);
        for (from_m, to_m) in [(0.1, 0.5), (3.0, 18.0), (99.0, 100.0)] {
            let (centre, radius) = sphere_around(Slice { from_m, to_m }, tangents);
            let corner =
                |distance: f64| ((distance - centre).powi(2) + distance * distance * tangents.length_squared()).sqrt();
            let farthest = corner(from_m).max(corner(to_m));
            assert!((farthest - radius).abs() < 1e-12 * radius, "{farthest} {radius}");
        }
    }
}
