//! Which choices of a map exclude each other, whatever the scene: each refusal says why, and what to type instead.

use super::bias::Clearance;
use super::settings::{Border, CasterSides, DepthMetric, NearMode, Seam, Settings};
use crate::scene::Light;
use crate::technique::Unsupported;

/// Whether the filter, the projection, the measure of depth and what is done to it do.
///
/// # Errors
/// What does not, and what to type instead.
pub(super) fn fits_together(settings: &Settings, light: &Light) -> Result<(), Unsupported> {
    let (filter, projection) = (settings.filter.choice().name, settings.projection.name());
    let refused = |why: String| Err(Unsupported::Combination { why });
    let is_linear = settings.depth_metric == DepthMetric::Linear;
    if settings.filter.needs_linear_depth() && !is_linear {
        return refused(format!("filter={filter} reckons with distances: it needs depth_metric=linear, or auto"));
    }
    if is_linear && !settings.projection.has_linear_depth() {
        return refused(format!(
            "projection={projection} has no depth_metric=linear: warped along the light, its depth is no distance"
        ));
    }
    if settings.filter.moments().is_some() && settings.seam == Seam::PerTap && !settings.projection.has_one_view() {
        return refused(format!(
            "filter={filter} averages within a view, not across its sides: projection={projection} needs seam=clamp"
        ));
    }
    if settings.filter.moments().is_some() && settings.border == Border::ClampEdge {
        return refused(format!(
            "border=clamp-edge stretches texels over receivers beyond the map, where filter={filter} has no means: it \
             needs border=lit or shadow"
        ));
    }
    let compares_texels = settings.filter.moments().is_none() && !settings.filter.samples();
    if !compares_texels && settings.bias_amounts().clearance == Clearance::ReceiverPlane {
        return refused(format!(
            "bias=receiver-plane compares texel by texel, which filter={filter} does not: it needs another bias"
        ));
    }
    if settings.filter.softens() && !settings.projection.is_unwarped() {
        return refused(format!(
            "filter={filter} sees the light's own shape around a receiver, which projection={projection} warps"
        ));
    }
    if settings.stores_midpoint() && settings.caster_sides != CasterSides::All {
        return refused("bias=midpoint lies between two sides of casters: it needs caster_sides=all".to_owned());
    }
    if settings.stores_midpoint() && settings.filter.needs_linear_depth() {
        return refused(format!(
            "filter={filter} reckons with blockers' distances, which bias=midpoint does not store"
        ));
    }
    if settings.near_mode == NearMode::VertexClamp {
        depth_follows_corners(settings, light)?;
    }
    Ok(())
}

/// Whether moving the corners of casters moves the depth that is stored.
fn depth_follows_corners(settings: &Settings, light: &Light) -> Result<(), Unsupported> {
    let projection = settings.projection.name();
    let is_perspective = light.homogeneous().w != 0.0;
    let by_fragments = if !settings.projection.has_rasterised_depth() {
        format!("projection={projection}")
    } else if settings.depth_metric == DepthMetric::Linear && is_perspective {
        format!("depth_metric=linear from a {} light", light.kind_name())
    } else if settings.stores_midpoint() {
        "bias=midpoint".to_owned()
    } else {
        return Ok(());
    };
    let why = format!(
        "near_mode=vertex-clamp moves corners, but with {by_fragments} depth is not the rasteriser's: it needs another \
         near_mode"
    );
    Err(Unsupported::Combination { why })
}
