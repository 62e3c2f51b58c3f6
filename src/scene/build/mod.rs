//! From raw files to a validated [`Scene`].
//!
//! Everything is checked and moved in f64. Then the scene is rebased to an origin of its own, and only then is each
//! coordinate rounded, once, to f32 ([`transform`]).

mod camera;
mod check;
mod contact;
mod lights;
mod meshes;
mod transform;

use super::{
    Budget, LightingMode, Plane, Scene, Shading,
    error::SceneError,
    file::{BudgetEntry, PlaneEntry, SceneFile},
    folder::Folder,
    load::LoadOptions,
    source::Source,
};
use check::Entry;
use glam::UVec2;
use transform::{Frame, rounded};

/// Largest image side in pixels that is accepted at all; an adapter's own limit is usually lower.
const MAX_IMAGE_SIDE_PX: u32 = 65_536;
const DEFAULT_IMAGE_SIZE: [u32; 2] = [1024, 768];
const DEFAULT_AMBIENT: [f64; 3] = [0.05; 3];
const SHADINGS: [(&str, Shading); 4] = [
    ("phong", Shading::Phong),
    ("gouraud", Shading::Gouraud),
    ("flat", Shading::Flat),
    ("blinn-phong", Shading::BlinnPhong),
];
const MODES: [(&str, LightingMode); 2] = [("physical", LightingMode::Physical), ("classic", LightingMode::Classic)];

/// Checks `file` and everything it names, and builds the scene.
pub(super) fn build(
    name: String,
    file: &SceneFile,
    source: &Source,
    folder: &Folder,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let root = Entry::root(source);
    if file.about.lines().count() != 1 {
        return Err(root.fault("about", "must be one line that says what the scene shows"));
    }
    let image_size = image_size(&root, file, options)?;
    let shading = root.choice_or_default("shading", file.shading.as_deref(), &SHADINGS)?;
    let mode = root.choice_or_default("mode", file.mode.as_deref(), &MODES)?;
    let ambient = root.colour("ambient", file.ambient.unwrap_or(DEFAULT_AMBIENT))?;
    require_some(&root, "mesh", file.mesh.len())?;
    require_some(&root, "light", file.light.len())?;

    let placement = options.placement.checked(source)?;
    let parts = meshes::read(file, source, folder)?;
    let frame = parts.frame(source, placement)?;
    let mut warnings = parts.warnings();
    let geometry = parts.bake(&frame, &mut warnings);
    let camera = camera::build(&file.camera, source, &frame, &geometry)?;
    let receivers_centre = geometry.receivers_centre();
    let lights = lights::build(&file.light, source, &frame, receivers_centre, mode, &mut warnings)?;
    let planes = file.plane.iter().enumerate().map(|(i, plane)| build_plane(plane, source, i, &frame));
    let planes = planes.collect::<Result<_, _>>()?;
    let light_names: Vec<&str> = lights.iter().map(|light| light.name.as_str()).collect();
    let budgets = file.budget.iter().enumerate().map(|(i, budget)| build_budget(budget, source, i, &light_names));
    let budgets = budgets.collect::<Result<_, _>>()?;

    let mut scene = Scene {
        name,
        about: file.about.clone(),
        image_size,
        shading,
        mode,
        ambient,
        origin_in_file: frame.origin,
        positions: geometry.positions,
        triangles: geometry.triangles,
        corner_normals: geometry.corner_normals,
        triangle_material: geometry.triangle_material,
        meshes: geometry.meshes,
        materials: parts.materials(),
        camera,
        lights,
        planes,
        budgets,
        warnings,
    };
    let contacts = contact::warnings(&scene);
    scene.warnings.extend(contacts);
    Ok(scene)
}

fn image_size(root: &Entry<'_>, file: &SceneFile, options: &LoadOptions) -> Result<UVec2, SceneError> {
    let (key, size) = match options.size {
        Some(asked_for) => ("the size asked for", asked_for),
        None => ("size", UVec2::from_array(file.size.unwrap_or(DEFAULT_IMAGE_SIZE))),
    };
    if size.min_element() == 0 || size.max_element() > MAX_IMAGE_SIDE_PX {
        let problem = format!("= {} x {} pixels: each side must be 1 to {MAX_IMAGE_SIDE_PX}", size.x, size.y);
        return Err(root.fault(key, problem));
    }
    Ok(size)
}

fn require_some(root: &Entry<'_>, key: &'static str, count: usize) -> Result<(), SceneError> {
    if count == 0 {
        return Err(root
            .fault(key, format!("is missing: a scene needs at least one [[mesh]] and one [[light]], add [[{key}]]")));
    }
    Ok(())
}

fn build_plane(plane: &PlaneEntry, source: &Source, index: usize, frame: &Frame) -> Result<Plane, SceneError> {
    let entry = Entry::new(source, format!("plane[{index}]"));
    let normal = entry.direction("normal", plane.normal)?;
    Ok(Plane { point: rounded(entry.point("point", plane.point, frame)?), normal: rounded(normal) })
}

fn build_budget(
    budget: &BudgetEntry,
    source: &Source,
    index: usize,
    light_names: &[&str],
) -> Result<Budget, SceneError> {
    let entry = Entry::new(source, format!("budget[{index}]"));
    if budget.technique.trim().is_empty() {
        return Err(entry.fault("technique", "is empty: write one, like \"map:size=2048\""));
    }
    if let Some(light) = &budget.light {
        entry.known("light", "light", light, light_names)?;
    }
    if budget.wrong_fraction.is_none() && budget.mean_abs.is_none() {
        return Err(entry.fault("wrong_fraction", "and mean_abs are both missing: a budget needs at least one"));
    }
    let share = |key, value: Option<f64>| {
        value.map(|v| entry.number(key, v, |v| (0.0..=1.0).contains(&v), "from 0 to 1")).transpose()
    };
    Ok(Budget {
        technique: budget.technique.clone(),
        light: budget.light.clone(),
        wrong_fraction: share("wrong_fraction", budget.wrong_fraction)?,
        mean_abs: share("mean_abs", budget.mean_abs)?,
    })
}
