//! Meshes: which objects of which files, where they stand, and the triangles they become.

use super::{
    super::{
        Bounds, Material, Mesh,
        error::SceneError,
        file::{MeshEntry, ScaleEntry, SceneFile},
        folder::Folder,
        load::Placement,
        obj::{self, RawObj, RawObject, RawTriangle},
        source::Source,
    },
    check::Entry,
    transform::{Affine, Frame, MAX_COORDINATE_M, MIN_EXTENT_M, rounded, unit},
};
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, HashSet};

/// The files read and what is taken from them.
pub(super) struct Parts {
    files: Vec<RawObj>,
    parts: Vec<Part>,
}

/// One object to be placed.
struct Part {
    file: usize,
    object: usize,
    /// Index of its `[[mesh]]`.
    entry: usize,
    world_from_object: Affine,
    casts: bool,
    receives: bool,
}

/// The meshes of a scene, rebased and rounded; the fields are those of [`super::Scene`].
pub(super) struct Geometry {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) corner_normals: Vec<[Vec3; 3]>,
    pub(super) triangle_material: Vec<u32>,
    pub(super) meshes: Vec<Mesh>,
    /// One box per mesh.
    pub(super) boxes: Vec<Bounds>,
}

/// Reads every OBJ file once and picks the objects each `[[mesh]]` asks for.
pub(super) fn read(file: &SceneFile, source: &Source, folder: &Folder) -> Result<Parts, SceneError> {
    let mut files = Vec::new();
    let mut file_index = BTreeMap::new();
    let mut parts = Vec::new();
    for (i, mesh) in file.mesh.iter().enumerate() {
        let entry = Entry::new(source, format!("mesh[{i}]"));
        let file = match file_index.get(&mesh.file) {
            Some(&index) => index,
            None => {
                let (path, bytes) = folder.read(folder.path(), &mesh.file, &entry.place("file"))?;
                files.push(obj::read(&path, &bytes, folder)?);
                file_index.insert(mesh.file.clone(), files.len() - 1);
                files.len() - 1
            }
        };
        let world_from_object = world_from_object(&entry, mesh)?;
        let (casts, receives) = (mesh.casts.unwrap_or(true), mesh.receives.unwrap_or(true));
        let chosen = chosen_objects(&entry, mesh, &files[file])?;
        parts.extend(chosen.into_iter().map(|object| Part {
            file,
            object,
            entry: i,
            world_from_object,
            casts,
            receives,
        }));
    }
    Ok(Parts { files, parts })
}

fn world_from_object(entry: &Entry<'_>, mesh: &MeshEntry) -> Result<Affine, SceneError> {
    let scale = match mesh.scale {
        None => DVec3::ONE,
        Some(ScaleEntry::Uniform(scale)) => DVec3::splat(entry.number("scale", scale, |_| true, "finite")?),
        Some(ScaleEntry::PerAxis(scale)) => entry.vector("scale", scale)?,
    };
    if scale.abs().min_element() == 0.0 {
        return Err(entry.fault("scale", "is 0 along an axis, which would flatten the mesh: must not be 0"));
    }
    let rotate_deg = entry.vector("rotate_deg", mesh.rotate_deg.unwrap_or_default())?;
    let translate = entry.vector("translate", mesh.translate.unwrap_or_default())?;
    Ok(Affine::new(scale, rotate_deg, translate))
}

/// Indices of the objects named in `objects`, in file order; all of them without that key.
fn chosen_objects(entry: &Entry<'_>, mesh: &MeshEntry, file: &RawObj) -> Result<Vec<usize>, SceneError> {
    let Some(names) = &mesh.objects else { return Ok((0..file.objects.len()).collect()) };
    if names.is_empty() {
        return Err(entry.fault("objects", "= []: name at least one object, or leave the key out to take all"));
    }
    let known: Vec<&str> = file.objects.iter().map(|object| object.name.as_str()).collect();
    for name in names {
        entry.known("objects", "OBJ object", name, &known)?;
    }
    Ok((0..known.len()).filter(|&i| names.iter().any(|name| name == known[i])).collect())
}

impl Parts {
    fn object(&self, part: &Part) -> &RawObject {
        &self.files[part.file].objects[part.object]
    }

    /// Chooses the scene's own origin, and checks that f32 can hold the meshes around it.
    pub(super) fn frame(&self, source: &Source, placement: &Placement) -> Result<Frame, SceneError> {
        let fault = |problem| Err(Entry::root(source).fault("mesh", problem));
        let vertices: usize = self.parts.iter().map(|part| self.object(part).positions.len()).sum();
        let triangles: usize = self.parts.iter().map(|part| self.object(part).triangles.len()).sum();
        if vertices.max(triangles) >= u32::MAX as usize {
            return fault(format!("holds {vertices} vertices and {triangles} triangles: must be below 2^32"));
        }
        let placed = Frame::placed(placement.scale, placement.translate);
        let boxes =
            self.parts.iter().map(|part| self.placed_box(source, part, &placed)).collect::<Result<Vec<_>, _>>()?;
        let whole = union(boxes.into_iter().flatten()).unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ZERO });
        let extent = (whole.max - whole.min).max_element();
        if extent < MIN_EXTENT_M {
            return fault(format!("spans {extent:e} m in all: must span at least {MIN_EXTENT_M:e} m, scale it up"));
        }
        Ok(placed.rebased(&whole))
    }

    fn placed_box(&self, source: &Source, part: &Part, placed: &Frame) -> Result<Option<Bounds>, SceneError> {
        let world_from_object = placed.after(&part.world_from_object);
        let points = || self.object(part).positions.iter().map(|&p| world_from_object.point(p));
        if points().any(|p| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE_M) {
            let problem = format!("is placed over {MAX_COORDINATE_M:e} m from the origin: scale it down or move it");
            return Err(Entry::new(source, format!("mesh[{}]", part.entry)).fault("file", problem));
        }
        Ok(Bounds::of(points()))
    }

    /// Of all files.
    pub(super) fn warnings(&self) -> Vec<String> {
        self.files.iter().flat_map(|file| file.warnings.iter().cloned()).collect()
    }

    /// The default material, then those of all files.
    pub(super) fn materials(&self) -> Vec<Material> {
        let own = self.files.iter().flat_map(|file| file.materials.iter().cloned());
        std::iter::once(Material::default()).chain(own).collect()
    }

    /// Moves all objects into the rebased world and rounds them.
    pub(super) fn bake(&self, frame: &Frame, warnings: &mut Vec<String>) -> Geometry {
        let mut geometry = Geometry {
            positions: Vec::new(),
            triangles: Vec::new(),
            corner_normals: Vec::new(),
            triangle_material: Vec::new(),
            meshes: Vec::new(),
            boxes: Vec::new(),
        };
        let mut material_bases = Vec::new();
        let mut next_base = 1;
        for file in &self.files {
            material_bases.push(next_base);
            next_base += file.materials.len() as u32;
        }
        for part in &self.parts {
            let rebased_from_object = frame.after(&part.world_from_object);
            geometry.append(self.object(part), &rebased_from_object, material_bases[part.file], part);
        }
        geometry.warn_of_useless_triangles(warnings);
        geometry
    }
}

impl Geometry {
    fn append(&mut self, object: &RawObject, rebased_from_object: &Affine, material_base: u32, part: &Part) {
        let vertex_base = self.positions.len() as u32;
        let first_triangle = self.triangles.len() as u32;
        self.positions.extend(object.positions.iter().map(|&p| rounded(rebased_from_object.point(p))));
        let normals: Vec<Option<DVec3>> = object.normals.iter().map(|&n| rebased_from_object.normal(n)).collect();
        let outward = |[a, b, c]: [u32; 3]| if rebased_from_object.mirrors { [a, c, b] } else { [a, b, c] };
        for &RawTriangle { corners, normals: corner_normals, material } in &object.triangles {
            let corners = outward(corners).map(|i| i + vertex_base);
            let face_normal = unit(self.doubled_area(corners)).unwrap_or(DVec3::ZERO);
            self.corner_normals.push(match corner_normals {
                Some(indices) => outward(indices).map(|i| rounded(normals[i as usize].unwrap_or(face_normal))),
                None => [rounded(face_normal); 3],
            });
            self.triangles.push(corners);
            self.triangle_material.push(material.map_or(0, |index| index + material_base));
        }
        let own_positions = self.positions[vertex_base as usize..].iter().map(|p| p.as_dvec3());
        self.boxes.extend(Bounds::of(own_positions));
        self.meshes.push(Mesh {
            name: object.name.clone(),
            triangles: first_triangle..self.triangles.len() as u32,
            casts: part.casts,
            receives: part.receives,
        });
    }

    fn corner_positions(&self, corners: [u32; 3]) -> [Vec3; 3] {
        corners.map(|i| self.positions[i as usize])
    }

    fn doubled_area(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.corner_positions(corners).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    }

    /// Triangles without area, and triangles that repeat another: legal, but seldom meant.
    fn warn_of_useless_triangles(&self, warnings: &mut Vec<String>) {
        let without_area = self.triangles.iter().filter(|&&corners| self.doubled_area(corners) == DVec3::ZERO).count();
        if without_area > 0 {
            warnings
                .push(format!("{without_area} triangles have no area; they are kept, but cast and receive nothing"));
        }
        let mut seen = HashSet::with_capacity(self.triangles.len());
        let repeated = self.triangles.iter().filter(|&&corners| {
            let mut key = self.corner_positions(corners).map(|p| p.to_array().map(f32::to_bits));
            key.sort_unstable();
            !seen.insert(key)
        });
        let repeated = repeated.count();
        if repeated > 0 {
            warnings.push(format!("{repeated} triangles have the same three corners as another; they are kept"));
        }
    }

    /// Box of the meshes that receive; of all meshes if none does.
    pub(super) fn receivers_centre(&self) -> DVec3 {
        let receiving = self.meshes.iter().zip(&self.boxes).filter(|(mesh, _)| mesh.receives).map(|(_, b)| *b);
        union(receiving).map_or_else(|| self.bounds().centre(), |bounds| bounds.centre())
    }

    /// Box of all meshes.
    pub(super) fn bounds(&self) -> Bounds {
        union(self.boxes.iter().copied()).unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ZERO })
    }
}

fn union(boxes: impl Iterator<Item = Bounds>) -> Option<Bounds> {
    Bounds::of(boxes.flat_map(|b| [b.min, b.max]))
}
