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

impl Segment {
    /// From a receiver to a homogeneous point of a light; where that is a direction it ends `scene_radius_m` × 4 away,
    /// beyond all geometry.
    #[must_use]
    pub fn towards(receiver_in_world: DVec3, light: DVec4, scene_radius_m: f64) -> Self {
        let to = if light.w == 0.0 {
            receiver_in_world + light.truncate() * (4.0 * scene_radius_m)
        } else {
            light.truncate()
        };
        Self { from: receiver_in_world, to }
    }
}

/// A light source.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Unique in its scene.
    pub name: String,
    /// What kind, and where.
    pub kind: LightKind,
    /// Linear RGB. W/sr for point and spot, W/m² (irradiance) for directional and sun, W/(m² sr) (radiance) for rectangle
    /// and sphere.
    pub intensity: Vec3,
    /// Beyond this distance the light is off, metres; infinite if the scene sets none.
    pub range_m: f64,
}

/// The closed list of light kinds. A rectangle, a sphere and a sun have an extent: they are *area lights*, which a point may
/// see in part.
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
    /// Shines from one side of a rectangle, with the same radiance in all directions.
    Rectangle {
        /// Its centre, rebased world.
        position: Vec3,
        /// What it faces, and what a single shadow frustum aims at.
        aim: Vec3,
        /// From the centre to the middle of its right side, as seen from behind the light.
        half_width: Vec3,
        /// From the centre to the middle of its upper side.
        half_height: Vec3,
        /// How many points of it the exact visibility counts.
        samples: u32,
    },
    /// Shines from a sphere's surface, with the same radiance in all directions.
    Sphere {
        /// Its centre, rebased world.
        position: Vec3,
        /// What a single shadow frustum aims at.
        aim: Vec3,
        /// Metres.
        radius_m: f32,
        /// How many points of the disc that a receiver sees of it the exact visibility counts.
        samples: u32,
    },
    /// A disc that is infinitely far away: a directional light that is seen under an angle.
    Sun {
        /// Unit vector towards its centre, rounded to f32.
        towards_light: Vec3,
        /// Half the angle under which it is seen, radians, < π/2.
        angular_radius_rad: f64,
        /// How many points of it the exact visibility counts.
        samples: u32,
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
    /// Homogeneous position: w = 1 for a point, w = 0 with a vector *towards* the light for a direction. An area light's
    /// is its centre, which is what a technique for lights without extent takes it for.
    #[must_use]
    pub fn homogeneous(&self) -> DVec4 {
        match self.kind {
            LightKind::Point { position, .. }
            | LightKind::Spot { position, .. }
            | LightKind::Rectangle { position, .. }
            | LightKind::Sphere { position, .. } => position.as_dvec3().extend(1.0),
            LightKind::Directional { towards_light } | LightKind::Sun { towards_light, .. } => {
                towards_light.as_dvec3().extend(0.0)
            }
        }
    }

    /// The shadow ray of a receiver as a segment between two f64 points, which is what every oracle and replay
    /// casts; of an area light the one to its centre ([`super::Emitter`] has them all).
    #[must_use]
    pub fn segment_from(&self, receiver_in_world: DVec3, scene_radius_m: f64) -> Segment {
        Segment::towards(receiver_in_world, self.homogeneous(), scene_radius_m)
    }

    /// Whether it has an extent, so that a point may see part of it.
    #[must_use]
    pub fn is_area(&self) -> bool {
        matches!(self.kind, LightKind::Rectangle { .. } | LightKind::Sphere { .. } | LightKind::Sun { .. })
    }

    /// Whether it shines at a point at all: within its range, a spot's cone, before a rectangle, outside a sphere.
    #[must_use]
    pub fn reaches(&self, point_in_world: DVec3) -> bool {
        let light = self.homogeneous();
        let from_light = point_in_world - light.truncate();
        let in_range = light.w == 0.0 || from_light.length() <= self.range_m;
        let before_it = match self.kind {
            LightKind::Spot { axis, outer_rad, .. } => axis.as_dvec3().angle_between(from_light) <= outer_rad,
            LightKind::Rectangle { half_width, half_height, .. } => {
                emission_normal(half_width, half_height).dot(from_light) > 0.0
            }
            LightKind::Sphere { radius_m, .. } => from_light.length() > f64::from(radius_m),
            LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Sun { .. } => true,
        };
        in_range && before_it
    }

    /// The kind's name as scene files spell it.
    #[must_use]
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            LightKind::Point { .. } => "point",
            LightKind::Directional { .. } => "directional",
            LightKind::Spot { .. } => "spot",
            LightKind::Rectangle { .. } => "rectangle",
            LightKind::Sphere { .. } => "sphere",
            LightKind::Sun { .. } => "sun",
        }
    }
}

/// The unit vector along which a rectangle shines, from its halves.
#[must_use]
pub fn emission_normal(half_width: Vec3, half_height: Vec3) -> DVec3 {
    half_height.as_dvec3().cross(half_width.as_dvec3()).normalize_or_zero()
}
