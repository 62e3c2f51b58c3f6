//! Shapes, scenes and random numbers for tests of the ray core. The integration tests compile this file too, so it
//! names nothing but `super::scene`.

use super::scene::{Camera, Far, Light, LightKind, LightingMode, Material, Mesh, Scene, Shading};
use glam::{DVec3, UVec2, Vec3};

/// A triangle mesh.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// Unconnected triangles.
    pub(crate) fn soup(corners: &[[Vec3; 3]]) -> Self {
        let triangles = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { positions: corners.as_flattened().to_vec(), triangles }
    }

    /// An icosahedron's faces, each cut in four `levels` times, on the unit sphere.
    pub(crate) fn icosphere(levels: u32) -> Self {
        const G: f32 = 1.618_034;
        let ring = [[-1.0, G], [1.0, G], [-1.0, -G], [1.0, -G]];
        let positions = (0..3).flat_map(|turn| {
            ring.map(|[a, b]| {
                let corner = Vec3::new(a, b, 0.0).normalize();
                [corner, Vec3::new(corner.z, corner.x, corner.y), Vec3::new(corner.y, corner.z, corner.x)][turn]
            })
        });
        let mut shape = Self { positions: positions.collect(), triangles: Vec::new() };
        let near = |a: u32, b: u32| shape.positions[a as usize].distance(shape.positions[b as usize]) < 1.1;
        let corners = (0..12).flat_map(|a| (a + 1..12).flat_map(move |b| (b + 1..12).map(move |c| [a, b, c])));
        shape.triangles = corners.filter(|&[a, b, c]| near(a, b) && near(b, c) && near(c, a)).collect();
        (0..levels).fold(shape, |shape, _| shape.cut_in_four())
    }

    /// Halves every edge and puts the new corners on the unit sphere.
    fn cut_in_four(self) -> Self {
        let mut positions = self.positions;
        let mut middle = |a: u32, b: u32| {
            let point = (positions[a.min(b) as usize] + positions[a.max(b) as usize]).normalize();
            let known = positions.iter().position(|&p| p == point);
            known.unwrap_or_else(|| {
                positions.push(point);
                positions.len() - 1
            }) as u32
        };
        let parts = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        let triangles = self.triangles.into_iter().flat_map(parts).collect();
        Self { positions, triangles }
    }

    /// An icosphere whose corners are drawn in or out at random: closed, spiky, and all of it seen from the origin.
    pub(crate) fn star(levels: u32, random: &mut Random) -> Self {
        let mut shape = Self::icosphere(levels);
        for position in &mut shape.positions {
            *position *= (0.2 * 20f64.powf(random.unit())) as f32;
        }
        shape
    }

    /// A grid of `columns` × `rows` cells, two triangles each, with its corner (i, j) where `at` says.
    pub(crate) fn grid(columns: u32, rows: u32, at: impl Fn(u32, u32) -> Vec3) -> Self {
        let positions = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
        let cell = |i: u32, j: u32| {
            let a = j * (columns + 1) + i;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            [[a, d, b], [b, d, c]]
        };
        Self { positions, triangles: (0..rows).flat_map(|j| (0..columns).flat_map(move |i| cell(i, j))).collect() }
    }
}

/// A scene of these shapes, one mesh each, all casting and receiving, with a point light at `light` and a camera that
/// looks down from it.
pub(crate) fn scene_of(shapes: &[Shape], light: Vec3) -> Scene {
    let mut scene = Scene {
        name: "test".into(),
        about: "shapes".into(),
        image_size: UVec2::new(8, 8),
        shading: Shading::Phong,
        mode: LightingMode::Physical,
        ambient: Vec3::ZERO,
        origin_in_file: DVec3::ZERO,
        positions: Vec::new(),
        triangles: Vec::new(),
        corner_normals: Vec::new(),
        triangle_material: Vec::new(),
        meshes: Vec::new(),
        materials: vec![Material {
            name: "default".into(),
            ambient: Vec3::ZERO,
            diffuse: Vec3::ONE,
            specular: Vec3::ZERO,
            emission: Vec3::ZERO,
            shininess: 1.0,
            opacity: 1.0,
        }],
        camera: Camera {
            eye: light,
            target: light - Vec3::Y,
            up: Vec3::Z,
            fov_y_rad: 1.0,
            near_m: 1e-3,
            far: Far::Infinite,
        },
        lights: vec![Light {
            name: "lamp".into(),
            kind: LightKind::Point { position: light, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] },
            intensity: Vec3::ONE,
            range_m: f64::INFINITY,
        }],
        planes: Vec::new(),
        budgets: Vec::new(),
        warnings: Vec::new(),
    };
    for shape in shapes {
        add(&mut scene, shape);
    }
    scene
}

fn add(scene: &mut Scene, shape: &Shape) {
    let (first_vertex, first_triangle) = (scene.positions.len() as u32, scene.triangles.len() as u32);
    scene.positions.extend(&shape.positions);
    scene.triangles.extend(shape.triangles.iter().map(|corners| corners.map(|v| v + first_vertex)));
    let triangles = first_triangle..scene.triangles.len() as u32;
    scene.corner_normals.resize(scene.triangles.len(), [Vec3::Y; 3]);
    scene.triangle_material.resize(scene.triangles.len(), 0);
    scene.meshes.push(Mesh { name: format!("shape {first_triangle}"), triangles, casts: true, receives: true });
}

/// A reproducible stream of random numbers: splitmix64 (Steele, Lea and Flood, 2014).
#[derive(Debug, Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 0.5f64.powi(53)
    }
    /// In the cube from −1 to 1.
    pub(crate) fn in_cube(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.unit() - 1.0))
    }
}
