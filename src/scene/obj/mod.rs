//! Wavefront OBJ files: a line-by-line check, tobj's parser, and faces made into triangles.
//!
//! Three steps. [`scan`] reads every line, refuses with a line number what has no meaning here and writes a canonical
//! text with one face per line. tobj turns that text into numbers and objects (left to itself it would pass NaN, make
//! triangles of lines and lose the place of every error). [`polygon`] splits the faces, which is where concave ones are
//! refused. Coordinates stay in f64 as the file spells them.

mod mtl;
mod polygon;
mod scan;

use super::{
    Material,
    error::{Place, SceneError},
    folder::Folder,
};
use glam::DVec3;
use scan::{Face, Scan};
use std::{collections::HashMap, io::Read, path::Path};

/// An OBJ file as written: nothing moved, nothing rounded.
#[derive(Debug, Default)]
pub(super) struct RawObj {
    /// In file order, each with at least one triangle.
    pub(super) objects: Vec<RawObject>,
    /// The materials of its MTL files.
    pub(super) materials: Vec<Material>,
    /// What was ignored, with file and line.
    pub(super) warnings: Vec<String>,
}

/// One `o` of an OBJ file (one `g` in a file without `o`).
#[derive(Debug, Default)]
pub(super) struct RawObject {
    pub(super) name: String,
    /// Only those a triangle uses.
    pub(super) positions: Vec<DVec3>,
    /// Of any length.
    pub(super) normals: Vec<DVec3>,
    pub(super) triangles: Vec<RawTriangle>,
}

/// One triangle of an object.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawTriangle {
    /// Indices into the object's positions.
    pub(super) corners: [u32; 3],
    /// Indices into the object's normals, if all corners of the face have one.
    pub(super) normals: Option<[u32; 3]>,
    /// Index into the file's materials; `None` is the default material.
    pub(super) material: Option<u32>,
}

/// Reads an OBJ file and the MTL files it names, which must lie inside `folder`.
pub(super) fn read(path: &Path, bytes: &[u8], folder: &Folder) -> Result<RawObj, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut scan = scan::scan(path, &text)?;
    let mut warnings = std::mem::take(&mut scan.warnings);
    let materials = mtl::read_all(path, &scan.material_files, folder, &mut warnings)?;
    let index_by_name: HashMap<String, usize> =
        materials.iter().enumerate().map(|(i, material)| (material.name.clone(), i)).collect();
    for (line, name) in &scan.materials_used {
        if !index_by_name.contains_key(name) {
            let place = Place::line(path, *line);
            warnings.push(format!("{place}: no MTL file defines material `{name}`; the default material is used"));
        }
    }
    let models = parse(path, &scan.canonical, &index_by_name)?;
    let objects = objects(path, &scan, &models)?;
    Ok(RawObj { objects, materials, warnings })
}

/// tobj on a canonical text. Its own errors cannot happen then, but are passed on all the same.
fn parse(path: &Path, text: &str, materials: &HashMap<String, usize>) -> Result<Vec<tobj::Model>, SceneError> {
    let by_name = || materials.iter().map(|(name, index)| (name.clone(), *index)).collect();
    // One `mtllib` stands for all the file names: the materials are read already, tobj needs only their indices.
    let mut reader = b"mtllib all\n".chain(text.as_bytes());
    let options = tobj::LoadOptions::default();
    let (models, _) = tobj::load_obj_buf(&mut reader, &options, |_| Ok((Vec::new(), by_name()))).map_err(|e| {
        SceneError::Mesh { place: Place::file(path), problem: format!("the OBJ reader refuses it: {e}") }
    })?;
    Ok(models)
}

/// Gathers tobj's models (one per object and material) into objects, and their faces into triangles.
fn objects(path: &Path, scan: &Scan, models: &[tobj::Model]) -> Result<Vec<RawObject>, SceneError> {
    let mut objects: Vec<RawObject> =
        scan.objects.iter().map(|name| RawObject { name: name.clone(), ..RawObject::default() }).collect();
    let mut faces = scan.faces.iter();
    for model in models {
        // The canonical text calls objects by their index, so that equal names stay apart.
        let Some(object) = model.name.parse().ok().and_then(|index: usize| objects.get_mut(index)) else { continue };
        append(path, object, &model.mesh, &mut faces)?;
    }
    objects.retain(|object| !object.triangles.is_empty());
    Ok(objects)
}

fn append<'a>(
    path: &Path,
    object: &mut RawObject,
    mesh: &tobj::Mesh,
    faces: &mut impl Iterator<Item = &'a Face>,
) -> Result<(), SceneError> {
    let (position_base, normal_base) = (object.positions.len() as u32, object.normals.len() as u32);
    object.positions.extend(points(&mesh.positions));
    object.normals.extend(points(&mesh.normals));
    let material = mesh.material_id.map(|index| index as u32);
    let mut start = 0;
    while start < mesh.indices.len() {
        let Some(face) = faces.next() else { break };
        let range = start..start + face.corners;
        let corners: Vec<u32> = mesh.indices[range.clone()].iter().map(|i| i + position_base).collect();
        // tobj invents normals for corners without one; `has_normals` says which faces really have them.
        let normals = mesh.normal_indices.get(range.clone()).filter(|_| face.has_normals);
        let normals: Option<Vec<u32>> = normals.map(|indices| indices.iter().map(|i| i + normal_base).collect());
        if face.corners > 3 {
            let polygon: Vec<DVec3> = corners.iter().map(|&i| object.positions[i as usize]).collect();
            polygon::check_flat_and_convex(&polygon).map_err(|fault| SceneError::Mesh {
                place: Place::line(path, face.line),
                problem: fault.to_string(),
            })?;
        }
        object.triangles.extend((1..face.corners - 1).map(|i| RawTriangle {
            corners: [corners[0], corners[i], corners[i + 1]],
            normals: normals.as_ref().map(|n| [n[0], n[i], n[i + 1]]),
            material,
        }));
        start = range.end;
    }
    Ok(())
}

fn points(coordinates: &[f64]) -> impl Iterator<Item = DVec3> + '_ {
    coordinates.chunks_exact(3).map(DVec3::from_slice)
}
