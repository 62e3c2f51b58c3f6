//! The scene made around an OBJ file that comes without one.
//!
//! Object names carry rules, after the demo scenes of R. Ploszajczak's thesis (2008): a name that ends in `NS` receives
//! but casts nothing; one that starts with `ShadowPlane` is not drawn and gives a receiver plane through its first
//! triangle. The rules are written out as properties, so the scene file says all that the names said.
//!
//! The camera looks down on the whole model from the front right; a sun stands at 50° on the front left, so that
//! shadows fall across the picture and stay visible. Nothing is added that the file does not hold: a model without a
//! floor shows the shadows it casts on itself. Who wants a floor writes the scene out and adds a `[[mesh]]` for one.

use super::{
    Bounds,
    error::{Place, SceneError},
    file::{CameraEntry, LightEntry, MeshEntry, PlaneEntry, SceneFile},
    folder::Folder,
    obj::{self, RawObj, RawObject},
};
use glam::DVec3;
use std::path::Path;

const NOT_CASTING_SUFFIX: &str = "NS";
const PLANE_PREFIX: &str = "ShadowPlane";

/// From the model's centre to the eye: 27° up, 37° to the right of +Z.
const TOWARDS_EYE: DVec3 = DVec3::new(0.6, 0.5, 0.8);
const FOV_Y_DEG: f64 = 45.0;
/// Room around the model's bounding sphere in the picture.
const MARGIN: f64 = 1.05;
/// The way the sun's light travels: from 50° above the horizon, 48° to the left of +Z.
const SUN_DIRECTION: [f64; 3] = [0.6, -0.96, -0.54];
/// W/m²: makes a white surface that faces the sun nearly white (3/π).
const SUN_IRRADIANCE: [f64; 3] = [3.0; 3];

/// The scene file that [`super::load()`] uses for a bare OBJ. Paths in it are relative to the OBJ's folder, which is
/// where to write it.
///
/// # Errors
/// Those of reading the OBJ; also if all its objects are shadow planes.
pub fn scene_file_for_obj(path: &Path) -> Result<SceneFile, SceneError> {
    let bytes = std::fs::read(path).map_err(|source| SceneError::Open { path: path.to_path_buf(), source })?;
    let file = obj::read(path, &bytes, &Folder::around(path)?)?;
    let (planes, drawn): (Vec<_>, Vec<_>) =
        file.objects.iter().partition(|object| object.name.starts_with(PLANE_PREFIX));
    let bounds = Bounds::of(drawn.iter().flat_map(|object| object.positions.iter().copied())).ok_or_else(|| {
        let problem = format!("every object is called {PLANE_PREFIX}…, which is not drawn: nothing is left");
        SceneError::Mesh { place: Place::file(path), problem }
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(SceneFile {
        about: format!("{name} under a sun, as gnomon sees a model that comes without a scene file"),
        size: None,
        shading: None,
        ambient: None,
        mode: None,
        camera: camera(&bounds),
        mesh: meshes(&name, &file, &drawn),
        light: vec![LightEntry {
            name: Some("sun".into()),
            kind: "directional".into(),
            direction: Some(SUN_DIRECTION),
            intensity: Some(SUN_IRRADIANCE),
            ..LightEntry::default()
        }],
        plane: planes.into_iter().filter_map(plane).collect(),
        budget: Vec::new(),
    })
}

/// One entry for all, or one for what casts and one for what does not.
fn meshes(file: &str, obj: &RawObj, drawn: &[&RawObject]) -> Vec<MeshEntry> {
    let (receivers, casters): (Vec<&str>, Vec<&str>) =
        drawn.iter().map(|object| object.name.as_str()).partition(|name| name.ends_with(NOT_CASTING_SUFFIX));
    let takes_all = drawn.len() == obj.objects.len();
    let mut entries = Vec::new();
    for (names, casts, takes_all) in
        [(&casters, true, takes_all && receivers.is_empty()), (&receivers, false, takes_all && casters.is_empty())]
    {
        if names.is_empty() {
            continue;
        }
        let mut objects: Vec<String> = names.iter().map(ToString::to_string).collect();
        objects.sort_unstable();
        objects.dedup();
        entries.push(MeshEntry {
            file: file.to_owned(),
            casts: Some(casts),
            objects: (!takes_all).then_some(objects),
            ..MeshEntry::default()
        });
    }
    entries
}

/// Fits the model's bounding sphere into the picture's height, the shorter side of the default image.
fn camera(bounds: &Bounds) -> CameraEntry {
    // A model without extent is refused with a better reason than a camera that looks nowhere.
    let radius = Some(bounds.radius()).filter(|radius| *radius > 0.0).unwrap_or(1.0);
    let distance = MARGIN * radius / (0.5 * FOV_Y_DEG).to_radians().sin();
    let eye = bounds.centre() + TOWARDS_EYE.normalize() * distance;
    // Four digits are enough for a view, and easier to edit.
    let digits = 10_f64.powi(3 - distance.log10().floor() as i32);
    let short = |v: DVec3| (v * digits).round() / digits;
    CameraEntry {
        eye: short(eye).to_array(),
        target: short(bounds.centre()).to_array(),
        up: None,
        fov_y_deg: Some(FOV_Y_DEG),
        near: None,
        far: None,
    }
}

/// Of the object's first triangle.
fn plane(object: &RawObject) -> Option<PlaneEntry> {
    let [a, b, c] = object.triangles.first()?.corners.map(|i| object.positions[i as usize]);
    let normal = (b - a).cross(c - a).try_normalize()?;
    Some(PlaneEntry { point: a.to_array(), normal: normal.to_array() })
}
