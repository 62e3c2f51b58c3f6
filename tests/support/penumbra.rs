//! A half plane between a square lamp and a floor: the one penumbra that is easily worked out on paper.

use super::scenes::scene_of_texts;
use super::shot::Shot;
use glam::DVec2;
use gnomon::mask::Mask;
use gnomon::scene::Scene;

pub(crate) const SIDE: f64 = 1.0;
pub(crate) const LAMP_HEIGHT: f64 = 4.0;
pub(crate) const EDGE_HEIGHT: f64 = 1.0;
/// Receivers and corners are rounded to f32, and rasterisers snap to 1/256 pixel: metres on the floor.
pub(crate) const SNAP_M: f64 = 2e-4;

/// A square lamp over a floor, and between them the half plane beyond a line through (0, 0), turned by `tilt_deg` about
/// the vertical. The camera looks under it.
pub(crate) fn half_plane(tilt_deg: f64, side: f64, gap: f64) -> Scene {
    half_plane_of_size(tilt_deg, side, gap, [128, 96])
}

/// A half plane `gap` over a floor, beyond x = 0, under a sun that stands at some elevation over −x. The camera looks under
/// it, at where its shadow ends.
pub(crate) fn half_plane_under_sun(elevation_deg: f64, diameter_deg: f64, gap: f64) -> Scene {
    let (sine, cosine) = elevation_deg.to_radians().sin_cos();
    let middle = gap * cosine / sine;
    let plate = format!("v 0 {gap} -30\nv 0 {gap} 30\nv 30 {gap} 30\nv 30 {gap} -30\n");
    let model = format!("o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\no Plate\n{plate}f 5 6 7 8\n");
    let scene = format!(
        "about = \"a half plane under a sun\"\nsize = [128, 96]\n\
         [camera]\neye = [{}, {}, 0.02]\ntarget = [{middle}, 0, 0.01]\nfov_y_deg = 40\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"sun\"\ndirection = [{cosine}, -{sine}, 0]\n\
         angular_diameter_deg = {diameter_deg}\nsamples = 256\n",
        middle - 1.5,
        0.9 * gap,
    );
    scene_of_texts(&scene, &model)
}

/// A square lamp's in a picture of some pixels.
pub(crate) fn half_plane_of_size(tilt_deg: f64, side: f64, gap: f64, [width, height]: [u32; 2]) -> Scene {
    let (across, along) = (DVec2::from_angle(tilt_deg.to_radians()), DVec2::from_angle(tilt_deg.to_radians()).perp());
    let corner = |at: DVec2| format!("v {} {gap} {}\n", at.x, at.y);
    let far = 30.0;
    let plate = [-far * along, far * along, far * (across + along), far * (across - along)].map(corner).concat();
    let model = format!("o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\no Plate\n{plate}f 5 6 7 8\n");
    let scene = format!(
        "about = \"a half plane under a lamp\"\nsize = [{width}, {height}]\n\
         [camera]\neye = [-1.5, 0.8, 0.02]\ntarget = [0, 0, 0.01]\nfov_y_deg = 40\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"lamp\"\nkind = \"rectangle\"\nposition = [0, {LAMP_HEIGHT}, 0]\ntarget = [0, 0, 0]\n\
         width = {side}\nheight = {side}\nsamples = 64\n"
    );
    scene_of_texts(&scene, &model)
}

/// Each floor point's place across the edge with its visibility.
pub(crate) fn across_edge(shot: &Shot<'_>, mask: &Mask, tilt_deg: f64) -> Vec<(f64, f64)> {
    let direction = DVec2::from_angle(tilt_deg.to_radians());
    let receivers = &shot.view.receivers.pixels;
    let on_floor = receivers.iter().zip(&mask.pixels).filter_map(|(receiver, visibility)| {
        let point = (*receiver)?.point_in_world;
        (point.y.abs() < 1e-6).then_some((DVec2::new(point.x, point.z).dot(direction), f64::from((*visibility)?.get())))
    });
    on_floor.collect()
}
