//! Lights and what they mean for a shadow ray.

use glam::{DVec3, DVec4, Vec3};

/// An open segment between two f64 points; both ends are outside it. The one shape of every ray gnomon casts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where it starts: for a shadow ray the receiver.
    pub from: DVec3,
    /// Where it ends: for a shadow ray the light.
    pub to: DVec3,
}

/// A light source.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Unique in its scene.
    pub name: String,
    /// What kind, and where.
    pub kind: LightKind,
    /// Linear RGB. W/sr for point and spot, W/m² (irradiance) for directional.
    pub intensity: Vec3,
    /// Beyond this distance the light is off, metres; infinite if the scene sets none.
    pub range_m: f64,
}

/// The closed list of light kinds; rectangle and sphere lights join it with the soft-shadow techniques.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines equally in all directions.
    Point {
        /// Rebased world.
        position: Vec3,
        /// What a single shadow frustum aims at: the scene file's `target`, or the receivers' centre.
        aim: Vec3,
        /// c1, c2, c3 of the classic attenuation 1/(c1 + c2 d + c3 d²).
        attenuation: [f32; 3],
    },
    /// Infinitely far away.
    Directional {
        /// Unit vector towards the light (minus the direction in which it travels), rounded to f32.
        towards_light: Vec3,
    },
    /// A cone.
    Spot {
        /// Rebased world.
        position: Vec3,
        /// Unit vector along which the light points, rounded to f32.
        axis: Vec3,
        /// Half angle beyond which the light is off, radians, < π/2.
        outer_rad: f64,
        /// How it falls off towards the outer angle.
        falloff: Falloff,
        /// c1, c2, c3 of the classic attenuation.
        attenuation: [f32; 3],
    },
}

/// How a spot light falls off from its axis to its outer angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Falloff {
    /// Linear in the angle from `inner_rad` (1) to the outer angle (0).
    Linear {
        /// Half angle up to which the light is full, radians.
        inner_rad: f64,
    },
    /// 1 inside the cone, 0 outside.
    Hard,
    /// cos(angle)^power (D. Warn, "Lighting Controls for Synthetic Images", 1983).
    Warn {
        /// The exponent p.
        power: f64,
    },
}

impl Light {
    /// Homogeneous position: w = 1 for a point, w = 0 with a vector *towards* the light for a direction.
    #[must_use]
    pub fn homogeneous(&self) -> DVec4 {
        match self.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => position.as_dvec3().extend(1.0),
            LightKind::Directional { towards_light } => towards_light.as_dvec3().extend(0.0),
        }
    }

    /// The shadow ray of a receiver as a segment between two f64 points, which is what every oracle and replay
    /// casts. A directional light ends it `scene_radius_m` × 4 away, beyond all geometry.
    #[must_use]
    pub fn segment_from(&self, receiver_in_world: DVec3, scene_radius_m: f64) -> Segment {
        let light = self.homogeneous();
        let to = if light.w == 0.0 {
            receiver_in_world + light.truncate() * (4.0 * scene_radius_m)
        } else {
            light.truncate()
        };
        Segment { from: receiver_in_world, to }
    }

    /// The kind's name as scene files spell it.
    #[must_use]
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            LightKind::Point { .. } => "point",
            LightKind::Directional { .. } => "directional",
            LightKind::Spot { .. } => "spot",
        }
    }
}
