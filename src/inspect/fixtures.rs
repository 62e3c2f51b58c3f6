//! Small shapes and scenes that unit tests share.

use crate::scene::{Camera, Far, Light, LightKind, LightingMode, Material, Mesh, Scene, Shading};
use glam::{DVec3, UVec2, Vec3};

/// A triangle mesh.
#[derive(Clone)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// The same shape with its inside out.
    pub(crate) fn inverted(mut self) -> Self {
        self.triangles.iter_mut().for_each(|triangle| triangle.reverse());
        self
    }
    /// Both shapes as one mesh, vertices not shared.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        let offset = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|v| v + offset)));
        self
    }
}

/// Height 2 over an equilateral base of circumradius 1 that is a fan of three triangles around its centre.
pub(crate) fn pyramid() -> Shape {
    let rim = |k: f64| {
        let (z, x) = (k * std::f64::consts::TAU / 3.0).sin_cos();
        DVec3::new(x, 0.0, z)
    };
    Shape {
        positions: vec![rim(0.0), rim(1.0), rim(2.0), DVec3::Y * 2.0, DVec3::ZERO],
        triangles: vec![[1, 0, 3], [2, 1, 3], [0, 2, 3], [0, 1, 4], [1, 2, 4], [2, 0, 4]],
    }
}

/// The unit cube from `corner` on; its first two triangles are the face z = 0.
pub(crate) fn cube(corner: DVec3) -> Shape {
    let positions = (0..8).map(|i| corner + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Shape {
        positions: positions.collect(),
        triangles: quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// Radii 1 and 0.3 about the y axis, `around` × `across` quads.
pub(crate) fn torus(around: u32, across: u32) -> Shape {
    let turn = |k: u32, n: u32| (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
    let place = |i: u32| {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (turn(i / across, around), turn(i % across, across));
        let from_axis = 1.0 + 0.3 * cos_v;
        DVec3::new(from_axis * cos_u, 0.3 * sin_v, from_axis * sin_u)
    };
    let index = |u: u32, v: u32| u % around * across + v % across;
    let quad = |i: u32| {
        let (u, v) = (i / across, i % across);
        [index(u, v), index(u, v + 1), index(u + 1, v + 1), index(u + 1, v)]
    };
    Shape {
        positions: (0..around * across).map(place).collect(),
        triangles: (0..around * across).map(quad).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// A point light of 10 W/sr without attenuation in classic mode.
pub(crate) fn point_light(position: Vec3) -> Light {
    let kind = LightKind::Point { position, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] };
    Light { name: "lamp".into(), kind, intensity: Vec3::splat(10.0), range_m: f64::INFINITY }
}

/// A scene of one mesh per shape with face normals, a lamp at (0, 5, 0), and a camera at (0, 0, 5) that looks at the origin.
pub(crate) fn scene_of(shapes: &[Shape]) -> Scene {
    let mut all = Shape { positions: vec![], triangles: vec![] };
    let mut meshes = Vec::new();
    for (k, shape) in shapes.iter().enumerate() {
        let start = all.triangles.len() as u32;
        all = all.and(shape);
        let triangles = start..all.triangles.len() as u32;
        meshes.push(Mesh { name: format!("mesh{k}"), triangles, casts: true, receives: true });
    }
    let mut scene = Scene {
        name: "fixture".into(),
        about: String::new(),
        image_size: UVec2::splat(64),
        shading: Shading::Phong,
        mode: LightingMode::Physical,
        ambient: Vec3::ZERO,
        origin_in_file: DVec3::ZERO,
        positions: all.positions.iter().map(|p| p.as_vec3()).collect(),
        corner_normals: Vec::new(),
        triangle_material: vec![0; all.triangles.len()],
        triangles: all.triangles,
        meshes,
        materials: vec![Material {
            name: "grey".into(),
            ambient: Vec3::splat(0.1),
            diffuse: Vec3::splat(0.5),
            specular: Vec3::ZERO,
            emission: Vec3::ZERO,
            shininess: 10.0,
            opacity: 1.0,
        }],
        camera: Camera {
            eye: Vec3::Z * 5.0,
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_rad: 1.0,
            near_m: 0.1,
            far: Far::Infinite,
        },
        lights: vec![point_light(Vec3::Y * 5.0)],
        planes: vec![],
        budgets: vec![],
        warnings: vec![],
    };
    let normals =
        (0..scene.triangles.len() as u32).map(|t| [scene.triangle_normal(t).normalize_or_zero().as_vec3(); 3]);
    scene.corner_normals = normals.collect();
    scene
}
