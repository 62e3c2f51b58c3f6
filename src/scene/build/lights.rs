//! Lights: which keys each kind takes, their defaults, and unique names.

use super::{
    super::{Falloff, Light, LightKind, LightingMode, error::SceneError, file::LightEntry, source::Source},
    check::Entry,
    transform::{Frame, MAX_COORDINATE_M, rounded, unit},
};
use glam::{DVec3, Vec3};
use std::collections::HashSet;

const DEFAULT_INTENSITY: [f64; 3] = [1.0; 3];
const DEFAULT_ATTENUATION: [f64; 3] = [1.0, 0.0, 0.0];
const DEFAULT_CONE_DEG: f64 = 40.0;
/// The default `inner_deg` as a share of `cone_deg`.
const DEFAULT_INNER_SHARE: f64 = 0.75;
const DEFAULT_WARN_POWER: f64 = 1.0;
/// Smaller sides are zero in f32 arithmetic; a light that small is a point.
const MIN_SIZE_M: f64 = 1e-30;
/// The sun's mean one, as seen from the earth.
const DEFAULT_ANGULAR_DIAMETER_DEG: f64 = 0.533;
const DEFAULT_SAMPLES: u32 = 64;
/// More would take minutes a picture and say no more.
const MAX_SAMPLES: u32 = 4096;
/// Characters that some file system refuses: lights' names become parts of file names.
const REFUSED_IN_NAMES: &str = "/\\:*?\"<>|";

#[derive(Clone, Copy)]
enum Kind {
    Point,
    Directional,
    Spot,
    Rectangle,
    Sphere,
    Sun,
}

const KINDS: [(&str, Kind); 6] = [
    ("point", Kind::Point),
    ("directional", Kind::Directional),
    ("spot", Kind::Spot),
    ("rectangle", Kind::Rectangle),
    ("sphere", Kind::Sphere),
    ("sun", Kind::Sun),
];

#[derive(Clone, Copy, Default, PartialEq)]
enum FalloffKind {
    #[default]
    Linear,
    Hard,
    Warn,
}

const FALLOFFS: [(&str, FalloffKind); 3] =
    [("linear", FalloffKind::Linear), ("hard", FalloffKind::Hard), ("warn", FalloffKind::Warn)];

impl Kind {
    /// The keys it takes besides `name`, `kind` and `intensity`.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Point => &["position", "target", "range", "attenuation"],
            Self::Directional => &["direction"],
            Self::Spot => {
                &["position", "target", "range", "attenuation", "cone_deg", "inner_deg", "falloff", "warn_power"]
            }
            Self::Rectangle => &["position", "target", "range", "width", "height", "samples"],
            Self::Sphere => &["position", "target", "range", "radius", "samples"],
            Self::Sun => &["direction", "angular_diameter_deg", "samples"],
        }
    }
}

/// Checks and places all lights. Point and spot lights without a target aim at `receivers_centre`.
pub(super) fn build(
    lights: &[LightEntry],
    source: &Source,
    frame: &Frame,
    receivers_centre: DVec3,
    mode: LightingMode,
    warnings: &mut Vec<String>,
) -> Result<Vec<Light>, SceneError> {
    let names = names(lights, source)?;
    let build_one = |(i, (light, name))| {
        let builder = Builder { entry: Entry::new(source, format!("light[{i}]")), light, frame, receivers_centre };
        builder.warn_of_unused_attenuation(mode, warnings);
        builder.build(name)
    };
    lights.iter().zip(names).enumerate().map(build_one).collect()
}

/// Every light's name: its own, or its kind with the first number that is free.
fn names(lights: &[LightEntry], source: &Source) -> Result<Vec<String>, SceneError> {
    let mut taken = HashSet::new();
    for (i, light) in lights.iter().enumerate() {
        let Some(name) = &light.name else { continue };
        let entry = Entry::new(source, format!("light[{i}]"));
        if name.is_empty() || name.chars().any(|c| c.is_control() || REFUSED_IN_NAMES.contains(c)) {
            let problem = format!("= {name:?}: must not be empty and hold none of {REFUSED_IN_NAMES}");
            return Err(entry.fault("name", problem));
        }
        if !taken.insert(name.clone()) {
            return Err(entry.fault("name", format!("= {name:?} is taken by an earlier light: names must differ")));
        }
    }
    let mut name_of = |light: &LightEntry| match &light.name {
        Some(name) => name.clone(),
        None => {
            let numbered = (2..).map(|n| format!("{}-{n}", light.kind));
            let mut candidates = std::iter::once(light.kind.clone()).chain(numbered);
            candidates.find(|name| taken.insert(name.clone())).unwrap_or_default()
        }
    };
    Ok(lights.iter().map(&mut name_of).collect())
}

struct Builder<'a> {
    entry: Entry<'a>,
    light: &'a LightEntry,
    frame: &'a Frame,
    receivers_centre: DVec3,
}

impl Builder<'_> {
    fn build(&self, name: String) -> Result<Light, SceneError> {
        let kind = self.kind()?;
        self.refuse_foreign_keys(kind)?;
        let kind = match kind {
            Kind::Point => self.point()?,
            Kind::Directional => LightKind::Directional { towards_light: self.towards()? },
            Kind::Sun => self.sun()?,
            Kind::Spot => self.spot()?,
            Kind::Rectangle => self.rectangle()?,
            Kind::Sphere => self.sphere()?,
        };
        let range_m = match self.light.range {
            Some(range) => self.frame.length(self.entry.number("range", range, |v| v > 0.0, "above 0 metres")?),
            None => f64::INFINITY,
        };
        let intensity = self.entry.colour("intensity", self.light.intensity.unwrap_or(DEFAULT_INTENSITY))?;
        Ok(Light { name, kind, intensity, range_m })
    }

    fn kind(&self) -> Result<Kind, SceneError> {
        self.entry.choice("kind", &self.light.kind, &KINDS)
    }

    fn refuse_foreign_keys(&self, kind: Kind) -> Result<(), SceneError> {
        let light = self.light;
        let given = [
            ("position", light.position.is_some()),
            ("direction", light.direction.is_some()),
            ("target", light.target.is_some()),
            ("range", light.range.is_some()),
            ("attenuation", light.attenuation.is_some()),
            ("cone_deg", light.cone_deg.is_some()),
            ("inner_deg", light.inner_deg.is_some()),
            ("falloff", light.falloff.is_some()),
            ("warn_power", light.warn_power.is_some()),
            ("width", light.width.is_some()),
            ("height", light.height.is_some()),
            ("radius", light.radius.is_some()),
            ("angular_diameter_deg", light.angular_diameter_deg.is_some()),
            ("samples", light.samples.is_some()),
        ];
        let foreign = given.iter().find(|(key, is_given)| *is_given && !kind.keys().contains(key));
        foreign.map_or(Ok(()), |(key, _)| {
            let keys = kind.keys().join(", ");
            let problem = format!("means nothing for a {} light, which takes {keys}: remove it", light.kind);
            Err(self.entry.fault(key, problem))
        })
    }

    fn required<T>(&self, key: &'static str, value: Option<T>) -> Result<T, SceneError> {
        value.ok_or_else(|| self.entry.fault(key, format!("is missing: a {} light needs it", self.light.kind)))
    }

    fn position(&self) -> Result<DVec3, SceneError> {
        self.entry.point("position", self.required("position", self.light.position)?, self.frame)
    }

    /// The target, or the receivers' centre, or for a light in that very centre a point straight below.
    fn aim(&self, position: DVec3) -> Result<DVec3, SceneError> {
        let Some(target) = self.light.target else {
            let below = position - DVec3::Y * position.abs().max_element().max(1.0);
            let in_centre = rounded(self.receivers_centre) == rounded(position);
            return Ok(if in_centre { below } else { self.receivers_centre });
        };
        let aim = self.entry.point("target", target, self.frame)?;
        if rounded(aim) == rounded(position) {
            return Err(self.entry.fault("target", "is the light's own position: the light aims nowhere"));
        }
        Ok(aim)
    }

    fn attenuation(&self) -> Result<[f32; 3], SceneError> {
        let coefficients = self.light.attenuation.unwrap_or(DEFAULT_ATTENUATION);
        Ok(self.entry.colour("attenuation", coefficients)?.to_array())
    }

    fn warn_of_unused_attenuation(&self, mode: LightingMode, warnings: &mut Vec<String>) {
        if self.light.attenuation.is_some() && mode == LightingMode::Physical {
            let place = self.entry.place("attenuation");
            warnings.push(format!("{place}: attenuation is used with mode = \"classic\" only"));
        }
    }

    fn point(&self) -> Result<LightKind, SceneError> {
        let position = self.position()?;
        let aim = rounded(self.aim(position)?);
        Ok(LightKind::Point { position: rounded(position), aim, attenuation: self.attenuation()? })
    }

    fn rectangle(&self) -> Result<LightKind, SceneError> {
        let position = self.position()?;
        let aim = self.aim(position)?;
        let forward = unit(aim - position).unwrap_or(DVec3::NEG_Y);
        let across = unit(forward.cross(DVec3::Y)).filter(|_| forward.x != 0.0 || forward.z != 0.0);
        let right = across.unwrap_or(DVec3::X);
        let half = |key, value| Ok::<f64, SceneError>(0.5 * self.length(key, value)?);
        Ok(LightKind::Rectangle {
            position: rounded(position),
            aim: rounded(aim),
            half_width: rounded(right * half("width", self.light.width)?),
            half_height: rounded(right.cross(forward) * half("height", self.light.height)?),
            samples: self.samples()?,
        })
    }

    fn sphere(&self) -> Result<LightKind, SceneError> {
        let position = self.position()?;
        Ok(LightKind::Sphere {
            position: rounded(position),
            aim: rounded(self.aim(position)?),
            radius_m: self.length("radius", self.light.radius)? as f32,
            samples: self.samples()?,
        })
    }

    fn sun(&self) -> Result<LightKind, SceneError> {
        let diameter_deg = self.light.angular_diameter_deg.unwrap_or(DEFAULT_ANGULAR_DIAMETER_DEG);
        let range = "above 0 and below 180 degrees";
        let diameter_deg = self.entry.number("angular_diameter_deg", diameter_deg, |v| v > 0.0 && v < 180.0, range)?;
        Ok(LightKind::Sun {
            towards_light: self.towards()?,
            angular_radius_rad: 0.5 * diameter_deg.to_radians(),
            samples: self.samples()?,
        })
    }

    /// Against the way that the light travels.
    fn towards(&self) -> Result<Vec3, SceneError> {
        let travel = self.entry.direction("direction", self.required("direction", self.light.direction)?)?;
        Ok(rounded(-travel))
    }

    /// A length that the light cannot be without, in metres of the rebased world.
    fn length(&self, key: &'static str, value: Option<f64>) -> Result<f64, SceneError> {
        let metres = self.required(key, value)?;
        let metres =
            self.entry.number(key, metres, |v| (MIN_SIZE_M..=MAX_COORDINATE_M).contains(&v), "1e-30 to 1e12 metres")?;
        Ok(self.frame.length(metres))
    }

    fn samples(&self) -> Result<u32, SceneError> {
        let samples = self.light.samples.unwrap_or(DEFAULT_SAMPLES);
        let range = format!("1 to {MAX_SAMPLES}");
        self.entry.number("samples", samples.into(), |v| v >= 1.0 && v <= MAX_SAMPLES.into(), &range)?;
        Ok(samples)
    }

    fn spot(&self) -> Result<LightKind, SceneError> {
        let position = self.position()?;
        let axis = unit(self.aim(position)? - position).unwrap_or(DVec3::NEG_Y);
        let full_angle = "above 0 and below 180 degrees (the full opening angle)";
        let cone_deg = self.light.cone_deg.unwrap_or(DEFAULT_CONE_DEG);
        let cone_deg = self.entry.number("cone_deg", cone_deg, |v| v > 0.0 && v < 180.0, full_angle)?;
        Ok(LightKind::Spot {
            position: rounded(position),
            axis: rounded(axis),
            outer_rad: 0.5 * cone_deg.to_radians(),
            falloff: self.falloff(cone_deg)?,
            attenuation: self.attenuation()?,
        })
    }

    fn falloff(&self, cone_deg: f64) -> Result<Falloff, SceneError> {
        let kind = self.entry.choice_or_default("falloff", self.light.falloff.as_deref(), &FALLOFFS)?;
        if self.light.inner_deg.is_some() && kind != FalloffKind::Linear {
            return Err(self.entry.fault("inner_deg", "belongs to falloff = \"linear\": remove one of the two"));
        }
        if self.light.warn_power.is_some() && kind != FalloffKind::Warn {
            return Err(self.entry.fault("warn_power", "belongs to falloff = \"warn\": write that too, or remove it"));
        }
        match kind {
            FalloffKind::Linear => {
                let inner_deg = self.light.inner_deg.unwrap_or(DEFAULT_INNER_SHARE * cone_deg);
                let range = format!("from 0 to cone_deg = {cone_deg}");
                let inner_deg = self.entry.number("inner_deg", inner_deg, |v| (0.0..=cone_deg).contains(&v), &range)?;
                // Without a band to fall off in, linear is hard; its formula would divide by zero.
                if inner_deg >= cone_deg {
                    return Ok(Falloff::Hard);
                }
                Ok(Falloff::Linear { inner_rad: 0.5 * inner_deg.to_radians() })
            }
            FalloffKind::Hard => Ok(Falloff::Hard),
            FalloffKind::Warn => {
                let power = self.light.warn_power.unwrap_or(DEFAULT_WARN_POWER);
                Ok(Falloff::Warn { power: self.entry.number("warn_power", power, |v| v >= 0.0, "at least 0")? })
            }
        }
    }
}
