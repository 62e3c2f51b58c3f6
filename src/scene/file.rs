//! `scene.toml` as written: plain data, nothing checked. Metres, degrees, right-handed, Y up.
//!
//! A missing key is `None`; the defaults are filled in, and every value is checked, when the scene is built.

use super::error::{Place, SceneError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A whole scene file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// One line: what this scene shows.
    pub about: String,
    /// Width and height in pixels; default 1024 × 768.
    pub size: Option<[u32; 2]>,
    /// phong (default), gouraud, flat or blinn-phong.
    pub shading: Option<String>,
    /// Ambient light, linear RGB; default 0.05 each.
    pub ambient: Option<[f64; 3]>,
    /// physical (default) or classic.
    pub mode: Option<String>,
    /// The camera.
    pub camera: CameraEntry,
    /// The meshes, at least one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<MeshEntry>,
    /// The lights, at least one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub light: Vec<LightEntry>,
    /// Receiver planes of the planar techniques.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plane: Vec<PlaneEntry>,
    /// What `check` enforces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub budget: Vec<BudgetEntry>,
}

/// `[camera]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraEntry {
    /// Where the camera is.
    pub eye: [f64; 3],
    /// What it looks at.
    pub target: [f64; 3],
    /// Which way is up; default +Y.
    pub up: Option<[f64; 3]>,
    /// Vertical field of view, degrees; default 45.
    pub fov_y_deg: Option<f64>,
    /// Distance of the near plane; default: fitted to the scene.
    pub near: Option<f64>,
    /// The far plane; default: infinite.
    pub far: Option<FarEntry>,
}

/// `far = 100.0` or `far = "infinite"`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "far must be a number or \"infinite\"")]
pub enum FarEntry {
    /// A distance.
    Distance(f64),
    /// The word "infinite".
    Word(String),
}

/// `[[mesh]]`
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshEntry {
    /// OBJ file, relative to the scene file's folder.
    pub file: String,
    /// Applied first; default 1.
    pub scale: Option<ScaleEntry>,
    /// Degrees about x, then y, then z; applied second.
    pub rotate_deg: Option<[f64; 3]>,
    /// Applied last.
    pub translate: Option<[f64; 3]>,
    /// Whether it casts shadows; default true.
    pub casts: Option<bool>,
    /// Whether its pixels are asked about shadows; default true.
    pub receives: Option<bool>,
    /// Only these OBJ objects; default all.
    pub objects: Option<Vec<String>>,
}

/// `scale = 2.0` or `scale = [1.0, 2.0, 1.0]`
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "scale must be a number or [x, y, z]")]
pub enum ScaleEntry {
    /// The same along all axes.
    Uniform(f64),
    /// One factor per axis.
    PerAxis([f64; 3]),
}

/// `[[light]]`. Which keys a light takes depends on its kind.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightEntry {
    /// Unique; default: the kind, then kind-2, kind-3 …
    pub name: Option<String>,
    /// point, directional, spot, rectangle, sphere or sun.
    pub kind: String,
    /// Where it is: all kinds but directional and sun.
    pub position: Option<[f64; 3]>,
    /// The way the light of a directional light or a sun travels.
    pub direction: Option<[f64; 3]>,
    /// What a spot or rectangle aims at, and a point's or sphere's single frustum; default: the receivers' centre.
    pub target: Option<[f64; 3]>,
    /// Linear RGB: W/sr for point and spot, W/m² for directional and sun, W/(m² sr) for rectangle and sphere; default 1 each.
    pub intensity: Option<[f64; 3]>,
    /// Beyond this distance the light is off; default: never.
    pub range: Option<f64>,
    /// c1, c2, c3 of the classic attenuation; default 1, 0, 0.
    pub attenuation: Option<[f64; 3]>,
    /// Full opening angle of a spot, degrees; default 40.
    pub cone_deg: Option<f64>,
    /// Full angle up to which a spot of linear falloff is full, degrees; default ¾ of the cone.
    pub inner_deg: Option<f64>,
    /// linear (default), hard or warn.
    pub falloff: Option<String>,
    /// Exponent of the warn falloff; default 1.
    pub warn_power: Option<f64>,
    /// Width of a rectangle light, metres.
    pub width: Option<f64>,
    /// Height of a rectangle light, metres.
    pub height: Option<f64>,
    /// Radius of a sphere light, metres.
    pub radius: Option<f64>,
    /// The angle under which a sun is seen, degrees; default 0.533.
    pub angular_diameter_deg: Option<f64>,
    /// Number of points of a rectangle, sphere or sun light that its exact visibility counts; default 64.
    pub samples: Option<u32>,
}

/// `[[plane]]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneEntry {
    /// A point on the plane.
    pub point: [f64; 3],
    /// Its normal, of any length but zero.
    pub normal: [f64; 3],
}

/// `[[budget]]`
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BudgetEntry {
    /// The technique, as on the command line.
    pub technique: String,
    /// One light; default: every light.
    pub light: Option<String>,
    /// Largest share of wrong pixels, 0 to 1.
    pub wrong_fraction: Option<f64>,
    /// Largest mean absolute error, 0 to 1.
    pub mean_abs: Option<f64>,
}

impl SceneFile {
    /// The file's text. Reading it back gives the same `SceneFile`, every number to the last bit.
    ///
    /// # Errors
    /// If the TOML writer refuses a value.
    pub fn to_toml(&self) -> Result<String, SceneError> {
        toml::to_string(self)
            .map_err(|e| SceneError::Toml { place: Place::file(Path::new("scene.toml")), message: e.to_string() })
    }
}
