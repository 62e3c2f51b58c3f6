//! How much of a light arrives at a point: distance, range and cone. Formulas: docs/lighting.md.

use crate::scene::{Emitter, Falloff, Light, LightKind, LightingMode, emission_normal};
use glam::{DVec3, DVec4};
use std::f64::consts::PI;

/// Unblocked light as it arrives at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incident {
    /// Unit vector to the light.
    pub towards_light: DVec3,
    /// f_att · g_spot · I, linear RGB: in physical mode the irradiance of a surface that faces the light, W/m².
    pub strength: DVec3,
}

/// The light of `light` at a point of the rebased world, as if nothing were in between; an area light's as if all of it
/// came from its centre. `None` where the light does not shine: beyond its range, outside its cone, behind a rectangle,
/// or at the light itself, where it has no direction.
#[must_use]
pub fn incident(light: &Light, mode: LightingMode, point_in_world: DVec3) -> Option<Incident> {
    incident_from(light, light.homogeneous(), mode, point_in_world).filter(|_| light.reaches(point_in_world))
}

/// The light of each point of `emitter`, which are those of `light`, with the point's place among them: together the
/// light's own. Empty where the light does not shine.
pub fn incidents<'a>(
    light: &'a Light,
    emitter: &'a Emitter,
    mode: LightingMode,
    point_in_world: DVec3,
) -> impl Iterator<Item = (usize, Incident)> + 'a {
    let points = light.reaches(point_in_world).then(|| emitter.points_for(point_in_world));
    let share = 1.0 / emitter.count() as f64;
    points.into_iter().flatten().enumerate().filter_map(move |(index, point)| {
        let incident = incident_from(light, point, mode, point_in_world)?;
        Some((index, Incident { strength: share * incident.strength, ..incident }))
    })
}

/// The whole light as if it came from one of its points.
fn incident_from(light: &Light, from: DVec4, mode: LightingMode, point_in_world: DVec3) -> Option<Incident> {
    let intensity = light.intensity.as_dvec3();
    let to_light = from.truncate() - point_in_world * from.w;
    let distance_m = to_light.length();
    let towards_light = to_light.try_normalize()?;
    let factor = match light.kind {
        LightKind::Directional { .. } => 1.0,
        LightKind::Point { attenuation, .. } => distance_factor(mode, attenuation, distance_m),
        LightKind::Spot { axis, outer_rad, falloff, attenuation, .. } => {
            let angle_rad = axis.as_dvec3().angle_between(-towards_light);
            distance_factor(mode, attenuation, distance_m) * cone_factor(falloff, outer_rad, angle_rad)?
        }
        LightKind::Rectangle { .. } | LightKind::Sphere { .. } | LightKind::Sun { .. }
            if mode == LightingMode::Classic =>
        {
            1.0
        }
        LightKind::Sun { towards_light: centre, angular_radius_rad, .. } => {
            // The solid angle of each of the points, over the irradiance of the whole disc.
            centre.as_dvec3().dot(towards_light).powi(3) / angular_radius_rad.cos().powi(2)
        }
        LightKind::Rectangle { half_width, half_height, .. } => {
            let area_m2 = 4.0 * half_width.as_dvec3().length() * half_height.as_dvec3().length();
            let cosine = emission_normal(half_width, half_height).dot(-towards_light);
            area_m2 * cosine.max(0.0) / (distance_m * distance_m)
        }
        LightKind::Sphere { position, radius_m, .. } => {
            let radius_m = f64::from(radius_m);
            let to_centre = position.as_dvec3() - point_in_world;
            sphere_factor(to_centre, radius_m, towards_light, distance_m)
        }
    };
    Some(Incident { towards_light, strength: intensity * factor })
}

/// Solid angle of a sphere's facing disc as one of its points shows it, times what the sphere's own cone is wider:
/// the irradiance of the whole is then the sphere's, π L (R/d)².
fn sphere_factor(to_centre: DVec3, radius_m: f64, towards_light: DVec3, distance_m: f64) -> f64 {
    let centre_m = to_centre.length();
    let cosine = to_centre.dot(towards_light) / centre_m;
    let widening = 1.0 + (radius_m / centre_m).powi(2);
    PI * radius_m * radius_m * cosine / (distance_m * distance_m) * widening
}

/// Inverse-square falloff, or the classic min(1, 1/(c1 + c2 d + c3 d²)), which is 1 where the denominator is not positive.
fn distance_factor(mode: LightingMode, attenuation: [f32; 3], distance_m: f64) -> f64 {
    let [constant, linear, quadratic] = attenuation.map(f64::from);
    match mode {
        LightingMode::Physical => 1.0 / (distance_m * distance_m),
        LightingMode::Classic => {
            let denominator = constant + distance_m * (linear + distance_m * quadratic);
            if denominator <= 0.0 { 1.0 } else { (1.0 / denominator).min(1.0) }
        }
    }
}

/// Falloff at an angle from the axis; `None` outside the cone. The power of the cosine is D. Warn's ("Lighting
/// Controls for Synthetic Images", 1983), as is cutting it off at a cone.
fn cone_factor(falloff: Falloff, outer_rad: f64, angle_rad: f64) -> Option<f64> {
    let factor = match falloff {
        Falloff::Hard => 1.0,
        Falloff::Linear { inner_rad } if angle_rad <= inner_rad => 1.0,
        Falloff::Linear { inner_rad } => (outer_rad - angle_rad) / (outer_rad - inner_rad),
        Falloff::Warn { power } => angle_rad.cos().powf(power),
    };
    (angle_rad <= outer_rad).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A few roundings of numbers near one.
    const ROUNDING: f64 = 1e-12;

    fn classic(distance_m: f64) -> f64 {
        distance_factor(LightingMode::Classic, [0.0, 0.0, 1.0], distance_m)
    }

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() <= ROUNDING * expected.abs().max(1.0), "{actual} is not {expected}");
    }

    fn spot(falloff: Falloff) -> Light {
        let (axis, outer_rad, attenuation) = (Vec3::NEG_Y, 0.5, [1.0, 0.0, 0.0]);
        let kind = LightKind::Spot { position: Vec3::Y * 2.0, axis, outer_rad, falloff, attenuation };
        Light { name: "spot".into(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY }
    }

    /// The falloff of a spot at an angle from its axis, by way of a point on the unit sphere around it.
    fn at_angle(falloff: Falloff, angle_rad: f64) -> Option<f64> {
        let point = DVec3::new(angle_rad.sin(), 2.0 - angle_rad.cos(), 0.0);
        incident(&spot(falloff), LightingMode::Physical, point).map(|incident| incident.strength.x)
    }

    #[test]
    fn classic_attenuation_never_amplifies() {
        let distances = [0.0, 0.5, 1.0, 2.0];
        assert_eq!(distances.map(classic), [1.0, 1.0, 1.0, 0.25]);
        assert_eq!(distance_factor(LightingMode::Classic, [-1.0, 0.0, 0.0], 3.0), 1.0);
        assert_eq!(distance_factor(LightingMode::Classic, [2.0, 1.0, 0.0], 2.0), 0.25);
    }

    #[test]
    fn physical_energy_falls_with_the_square_of_the_radius() {
        let physical = |distance_m| distance_factor(LightingMode::Physical, [0.0; 3], distance_m);
        assert_near(physical(5.0) / physical(2.0), (2.0_f64 / 5.0).powi(2));
        assert_near(physical(0.5), 4.0);
    }

    #[test]
    fn the_range_ends_the_light() {
        let mut lamp = spot(Falloff::Hard);
        lamp.range_m = 1.5;
        assert!(incident(&lamp, LightingMode::Physical, DVec3::Y * 0.5).is_some());
        assert!(incident(&lamp, LightingMode::Physical, DVec3::Y * 0.499).is_none());
    }

    #[test]
    fn at_the_light_itself_there_is_no_direction() {
        assert_eq!(incident(&spot(Falloff::Hard), LightingMode::Classic, DVec3::Y * 2.0), None);
    }

    /// Irradiance of a surface at the origin with normal +Y.
    fn irradiance(light: &Light) -> f64 {
        let emitter = Emitter::new(light);
        let incidents = incidents(light, &emitter, LightingMode::Physical, DVec3::ZERO);
        incidents.map(|(_, incident)| incident.strength.x * incident.towards_light.y).sum()
    }

    #[test]
    fn a_sphere_irradiates_by_its_solid_angle() {
        let position = Vec3::new(1.0, 2.0, -0.5);
        let kind = LightKind::Sphere { position, aim: Vec3::ZERO, radius_m: 0.5, samples: 1024 };
        let sphere = Light { name: "bulb".into(), kind, intensity: Vec3::splat(3.0), range_m: f64::INFINITY };
        let (d2, cosine) = (f64::from(position.length_squared()), f64::from(position.normalize().y));
        let expected = PI * 3.0 * 0.25 / d2 * cosine;
        assert!((irradiance(&sphere) / expected - 1.0).abs() < 1e-3, "{} is not {expected}", irradiance(&sphere));
    }

    #[test]
    fn a_sun_straight_above_irradiates_by_its_intensity_however_wide() {
        for angular_radius_rad in [1e-6, 0.00465, 0.3, 1.2] {
            let kind = LightKind::Sun { towards_light: Vec3::Y, angular_radius_rad, samples: 4096 };
            let sun = Light { name: "sun".into(), kind, intensity: Vec3::splat(3.0), range_m: f64::INFINITY };
            assert!((irradiance(&sun) / 3.0 - 1.0).abs() < 1e-3, "{} at {angular_radius_rad}", irradiance(&sun));
        }
    }

    #[test]
    fn a_square_straight_above_irradiates_by_its_form_factor() {
        let (half_width, half_height) = (Vec3::X, Vec3::NEG_Z);
        let kind =
            LightKind::Rectangle { position: Vec3::Y * 2.0, aim: Vec3::ZERO, half_width, half_height, samples: 1024 };
        let panel = Light { name: "panel".into(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY };
        // Four times the form factor of a quarter seen from below its corner, both sides half the height.
        let side = 0.5_f64;
        let term = side / (1.0 + side * side).sqrt() * (side / (1.0 + side * side).sqrt()).atan();
        let expected = 4.0 * term;
        assert!((irradiance(&panel) / expected - 1.0).abs() < 1e-3, "{} is not {expected}", irradiance(&panel));
        let mut turned = panel.clone();
        turned.kind = LightKind::Rectangle {
            position: Vec3::Y * 2.0,
            aim: Vec3::Y * 4.0,
            half_width,
            half_height: -half_height,
            samples: 4,
        };
        assert_eq!(incident(&turned, LightingMode::Physical, DVec3::ZERO), None, "it shines upwards");
    }

    #[test]
    fn a_directional_light_is_the_same_everywhere() {
        let kind = LightKind::Directional { towards_light: Vec3::Y };
        let sun = Light { name: "sun".into(), kind, intensity: Vec3::splat(3.0), range_m: f64::INFINITY };
        let expected = Some(Incident { towards_light: DVec3::Y, strength: DVec3::splat(3.0) });
        assert_eq!(incident(&sun, LightingMode::Physical, DVec3::ZERO), expected);
        assert_eq!(incident(&sun, LightingMode::Classic, DVec3::splat(1e6)), expected);
    }

    #[test]
    fn linear_falls_from_the_inner_to_the_outer_angle() {
        let linear = Falloff::Linear { inner_rad: 0.3 };
        assert_near(at_angle(linear, 0.2).unwrap(), 1.0);
        assert_near(at_angle(linear, 0.4).unwrap(), 0.5);
        assert_eq!(at_angle(linear, 0.501), None);
        let without_ramp = Falloff::Linear { inner_rad: 0.5 };
        assert_near(at_angle(without_ramp, 0.499).unwrap(), 1.0);
        assert_eq!(at_angle(without_ramp, 0.501), None);
    }

    #[test]
    fn hard_is_all_or_nothing() {
        assert_near(at_angle(Falloff::Hard, 0.499).unwrap(), 1.0);
        assert_eq!(at_angle(Falloff::Hard, 0.501), None);
    }

    #[test]
    fn warn_falls_with_the_power_and_is_even_at_power_zero() {
        let at = |power| at_angle(Falloff::Warn { power }, 0.4).unwrap();
        assert_near(at(0.0), 1.0);
        assert_near(at(2.0), 0.4_f64.cos().powi(2));
        assert!([0.5, 1.0, 4.0, 64.0].windows(2).all(|pair| at(pair[0]) > at(pair[1])));
        assert_eq!(at_angle(Falloff::Warn { power: 2.0 }, 2.0), None);
    }
}
