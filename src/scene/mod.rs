//! Scenes: from `scene.toml` and OBJ/MTL files to one validated, immutable [`Scene`] that every other module shares.
//!
//! Loading has two steps: the raw files ([`mod@file`] and `obj`) say what somebody wrote, with lines for error messages;
//! `build` checks it and makes the domain type. Transforms are applied in f64, the result is rebased to an
//! origin of the scene's own, and only then is every coordinate rounded, once, to f32. Technique and truth share those
//! rounded numbers, so a scene 10⁶ m from the origin loses nothing.

mod bare;
mod build;
mod camera;
mod distance;
mod emitter;
mod error;
pub mod file;
mod folder;
mod light;
mod load;
mod obj;
mod projected;
mod source;

pub use bare::scene_file_for_obj;
pub use camera::{Camera, Far};
pub use distance::distance_to_triangle;
pub use emitter::{Emitter, sun_direction};
pub use error::{Place, SceneError};
pub use file::SceneFile;
pub use light::{Falloff, Light, LightKind, Segment, emission_normal};
pub use load::{LoadOptions, Placement, load};
pub use projected::ProjectedTriangle;

use glam::{DVec3, DVec4, UVec2, Vec3};
use std::ops::Range;

/// A validated scene. Nothing in it is NaN, infinite or out of range; every index is in bounds. Coordinates are metres,
/// right-handed, Y up, relative to [`Scene::origin_in_file`].
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The folder's name: what reports call the scene.
    pub name: String,
    /// One line: what this scene shows.
    pub about: String,
    /// Width and height of the picture in pixels.
    pub image_size: UVec2,
    /// Where normals are interpolated when shading.
    pub shading: Shading,
    /// Which units and attenuation the lighting model uses.
    pub mode: LightingMode,
    /// Ambient light Ia of the lighting model, linear RGB.
    pub ambient: Vec3,
    /// The point of the scene file's world (after [`LoadOptions::placement`]) that became (0, 0, 0), in f64 metres.
    pub origin_in_file: DVec3,
    /// Vertex positions in the rebased world, rounded once.
    pub positions: Vec<Vec3>,
    /// Triangles of all meshes, one after another: indices into `positions`, counter-clockwise seen from outside.
    /// A *triangle id* everywhere in gnomon is an index into this list.
    pub triangles: Vec<[u32; 3]>,
    /// Unit shading normals of each triangle's corners (the face normal where the file gave none; zero for a triangle
    /// without area).
    pub corner_normals: Vec<[Vec3; 3]>,
    /// Index into `materials` per triangle.
    pub triangle_material: Vec<u32>,
    /// The meshes, in order; their triangle ranges partition `triangles`.
    pub meshes: Vec<Mesh>,
    /// Never empty: index 0 is the default material.
    pub materials: Vec<Material>,
    /// The camera.
    pub camera: Camera,
    /// Never empty; names are unique.
    pub lights: Vec<Light>,
    /// Receiver planes of the planar techniques.
    pub planes: Vec<Plane>,
    /// What `check` enforces.
    pub budgets: Vec<Budget>,
    /// What loading had to say: unknown MTL keys, degenerate triangles, a camera on a triangle.
    pub warnings: Vec<String>,
}

/// One object of an OBJ file, placed in the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// The object's name in its file.
    pub name: String,
    /// Its triangle ids.
    pub triangles: Range<u32>,
    /// Whether it casts shadows, in every technique and oracle alike.
    pub casts: bool,
    /// Whether its pixels are asked about shadows.
    pub receives: bool,
}

/// A Phong material (MTL names).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name in the MTL file.
    pub name: String,
    /// Ambient reflectance Ka, linear RGB.
    pub ambient: Vec3,
    /// Diffuse reflectance Kd, linear RGB.
    pub diffuse: Vec3,
    /// Specular reflectance Ks, linear RGB.
    pub specular: Vec3,
    /// Emission Ke, linear RGB.
    pub emission: Vec3,
    /// Specular exponent Ns, 0..=1000.
    pub shininess: f32,
    /// Opacity d, 0..=1: alpha of composites only; every triangle casts fully.
    pub opacity: f32,
}

impl Default for Material {
    /// A matt light grey, for triangles without a material.
    fn default() -> Self {
        Self {
            name: "default".into(),
            ambient: Vec3::splat(0.8),
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            emission: Vec3::ZERO,
            shininess: 1.0,
            opacity: 1.0,
        }
    }
}

/// A receiver plane of the planar techniques.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point on the plane, rebased world.
    pub point: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

/// A limit on a technique's error that `check` enforces. At least one of the two figures is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The technique as typed, parsed when it is run.
    pub technique: String,
    /// One light's name, or every light.
    pub light: Option<String>,
    /// Largest allowed share of wrong pixels among the asked, 0..=1.
    pub wrong_fraction: Option<f64>,
    /// Largest allowed mean absolute error over the asked pixels, 0..=1.
    pub mean_abs: Option<f64>,
}

/// Where the lighting model gets its normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Shading {
    /// Interpolated normal per pixel, Phong highlights.
    #[default]
    Phong,
    /// Colours at the vertices, interpolated.
    Gouraud,
    /// One face normal.
    Flat,
    /// Interpolated normal per pixel, Blinn-Phong highlights.
    BlinnPhong,
}

/// Units of the lighting model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightingMode {
    /// Kd/π and inverse-square falloff.
    #[default]
    Physical,
    /// No 1/π, attenuation 1/(c1 + c2 d + c3 d²).
    Classic,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The box of some points; `None` without points.
    #[must_use]
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().fold(None, |bounds: Option<Self>, p| {
            Some(bounds.map_or(Self { min: p, max: p }, |b| Self { min: b.min.min(p), max: b.max.max(p) }))
        })
    }
    /// The middle.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
    /// Half the diagonal: radius of the sphere around the centre that holds the box.
    #[must_use]
    pub fn radius(&self) -> f64 {
        0.5 * (self.max - self.min).length()
    }
    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i >> bit & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
        })
    }
}

impl Scene {
    /// A triangle's corners: the rounded f32 positions, exact in f64.
    #[must_use]
    pub fn triangle_in_world(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize].as_dvec3())
    }
    /// Geometric normal of a triangle (counter-clockwise outward), length twice its area; zero if it has none.
    #[must_use]
    pub fn triangle_normal(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.triangle_in_world(triangle);
        (b - a).cross(c - a)
    }
    /// On which side of a triangle's plane a homogeneous point lies: > 0 on the counter-clockwise side. Zero counts as
    /// not facing, for every module alike. Evaluated in f64 on the f32 vertices; only the sign means anything.
    #[must_use]
    pub fn facing(&self, triangle: u32, homogeneous: DVec4) -> f64 {
        let [a, ..] = self.triangle_in_world(triangle);
        self.triangle_normal(triangle).dot(homogeneous.truncate() - a * homogeneous.w)
    }
    /// The index of the mesh a triangle belongs to.
    #[must_use]
    pub fn mesh_index_of(&self, triangle: u32) -> usize {
        self.meshes.partition_point(|mesh| mesh.triangles.end <= triangle)
    }
    /// The mesh a triangle belongs to.
    #[must_use]
    pub fn mesh_of(&self, triangle: u32) -> &Mesh {
        &self.meshes[self.mesh_index_of(triangle)]
    }
    /// Ids of all triangles of meshes that cast shadows.
    pub fn casting_triangles(&self) -> impl Iterator<Item = u32> + '_ {
        self.meshes.iter().filter(|mesh| mesh.casts).flat_map(|mesh| mesh.triangles.clone())
    }
    /// Box of all vertices that a triangle uses; a point at the origin for a scene without triangles.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds_of(|_| true)
    }
    /// Box of the meshes that `choose` accepts; a point at the origin if there are none.
    pub fn bounds_of(&self, choose: impl Fn(&Mesh) -> bool) -> Bounds {
        let vertices = self.meshes.iter().filter(|mesh| choose(mesh)).flat_map(|mesh| mesh.triangles.clone());
        Bounds::of(vertices.flat_map(|t| self.triangle_in_world(t)))
            .unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ZERO })
    }
    /// Largest side of the bounds, metres: what relative tolerances refer to.
    #[must_use]
    pub fn extent_m(&self) -> f64 {
        let bounds = self.bounds();
        (bounds.max - bounds.min).max_element()
    }
    /// The light of that name.
    #[must_use]
    pub fn light(&self, name: &str) -> Option<&Light> {
        self.lights.iter().find(|light| light.name == name)
    }
}
