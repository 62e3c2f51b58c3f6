//! What each technique handles: asked of the techniques themselves, with small scenes that each lack one thing. So the
//! table cannot say anything else than the code does.

use super::param::{Kind, Param};
use super::{Spec, Unsupported, registry};
use crate::gpu::Gpu;
use crate::scene::{Camera, Falloff, Far, Light, LightKind, LightingMode, Material, Mesh, Plane, Scene, Shading};
use glam::{DVec3, UVec2, Vec3};

/// The axes that choose between models rather than tune one.
const MODEL_AXES: [&str; 4] = ["projection", "count", "shape", "method"];

/// One row: a technique, whether it handles each kind of light in a scene that lacks nothing, and what it needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixRow {
    /// The technique, in short.
    pub spec: String,
    /// Whether it handles the kind of light of the same place in [`light_kinds`]; if not, why.
    pub handles: Vec<Result<(), String>>,
    /// What an adapter, a scene and a picture must have for it; each of the scene's was found by taking it away.
    pub needs: Vec<&'static str>,
}

/// Every technique, the choices of its model axes one by one.
#[must_use]
pub fn matrix(gpu: &Gpu) -> Vec<MatrixRow> {
    models().iter().map(|spec| row(spec, gpu)).collect()
}

/// The kinds of light, as scene files name them.
#[must_use]
pub fn light_kinds() -> Vec<&'static str> {
    lights(LIGHT_AT).iter().map(Light::kind_name).collect()
}

/// Each family with its defaults, then with every other choice of each model axis.
fn models() -> Vec<Spec> {
    let mut models = Vec::new();
    for technique in registry() {
        let Ok(plain) = Spec::parse(technique.id()) else { continue };
        let is_model_axis = |param: &&Param| MODEL_AXES.contains(&param.name);
        let variants = technique.params().iter().filter(is_model_axis).flat_map(|param| {
            let choices = match &param.kind {
                Kind::Choice(choices) => choices.iter().map(|choice| choice.name).collect(),
                _ => Vec::new(),
            };
            choices.into_iter().filter_map(|choice| plain.with(param.name, choice).ok()).collect::<Vec<_>>()
        });
        let mut of_family = vec![plain.clone()];
        for variant in variants {
            if !of_family.contains(&variant) {
                of_family.push(variant);
            }
        }
        models.extend(of_family);
    }
    models
}

fn row(spec: &Spec, gpu: &Gpu) -> MatrixRow {
    // What this adapter lacks is no matter of the scene: it stands among the needs, whatever the adapter.
    let is_of_scene = |why: &Unsupported| !matches!(why, Unsupported::MissingFeature { .. });
    let refusal = |probe: &Probe, light: &Light| {
        spec.technique().supports(spec, &probe.scene, light, gpu).err().filter(is_of_scene)
    };
    let complete = Probe::complete();
    let of_kind = |light: &Light| refusal(&complete, light).map_or(Ok(()), |why| Err(why.to_string()));
    let handles: Vec<_> = lights(LIGHT_AT).iter().map(of_kind).collect();
    let is_missed = |(_, lacking): &(&'static str, Probe)| {
        let lights = lights(lacking.light_at);
        let handled = lights.iter().zip(&handles).filter(|(_, handled)| handled.is_ok());
        handled.map(|(light, _)| light).any(|light| refusal(lacking, light).is_some())
    };
    let of_adapter = spec.technique().needs_of_adapter().iter().copied();
    let of_picture = spec.technique().needs_of_picture(spec).iter().copied();
    let of_scene = lacking().into_iter().filter(is_missed).map(|(need, _)| need);
    let needs = of_adapter.chain(of_scene).chain(of_picture).collect();
    MatrixRow { spec: spec.short(), handles, needs }
}

/// A scene and where its lights are.
struct Probe {
    scene: Scene,
    light_at: Vec3,
}

/// Above the caster of every probe.
const LIGHT_AT: Vec3 = Vec3::new(0.3, 4.0, 0.2);

/// Scenes that each lack one thing, with the name of that thing.
fn lacking() -> Vec<(&'static str, Probe)> {
    let with = |change: fn(&mut Probe)| {
        let mut probe = Probe::complete();
        change(&mut probe);
        probe
    };
    vec![
        ("a [[plane]]", with(|probe| probe.scene.planes.clear())),
        ("a receiver on the plane", with(|probe| probe.scene.planes[0].point.y = -1.0)),
        ("the light off the plane", with(|probe| probe.scene.planes.push(Plane { point: LIGHT_AT, normal: Vec3::Y }))),
        ("closed casters", with(Probe::open)),
        ("receivers within one frustum", with(|probe| probe.light_at = Vec3::new(0.3, 0.01, 0.2))),
    ]
}

/// Corners of a floor, then of a tetrahedron above it.
const POSITIONS: [Vec3; 8] = [
    Vec3::new(-3.0, 0.0, -3.0),
    Vec3::new(-3.0, 0.0, 3.0),
    Vec3::new(3.0, 0.0, 3.0),
    Vec3::new(3.0, 0.0, -3.0),
    Vec3::new(0.0, 2.0, 0.0),
    Vec3::new(-0.5, 1.0, -0.5),
    Vec3::new(0.5, 1.0, -0.5),
    Vec3::new(0.0, 1.0, 0.7),
];
const TRIANGLES: [[u32; 3]; 6] = [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6], [4, 5, 7], [5, 6, 7]];
/// How many of them are the floor.
const OF_FLOOR: u32 = 2;

impl Probe {
    /// A closed tetrahedron over a floor that lies on a plane.
    fn complete() -> Self {
        let mesh = |name: &str, triangles, casts| Mesh { name: name.to_owned(), triangles, casts, receives: true };
        let count = TRIANGLES.len();
        let scene = Scene {
            name: "probe".to_owned(),
            about: "a tetrahedron over a floor".to_owned(),
            image_size: UVec2::splat(16),
            shading: Shading::Flat,
            mode: LightingMode::Physical,
            ambient: Vec3::ZERO,
            origin_in_file: DVec3::ZERO,
            positions: POSITIONS.to_vec(),
            triangles: TRIANGLES.to_vec(),
            corner_normals: vec![[Vec3::Y; 3]; count],
            triangle_material: vec![0; count],
            meshes: vec![mesh("floor", 0..OF_FLOOR, false), mesh("caster", OF_FLOOR..count as u32, true)],
            materials: vec![Material::default()],
            camera: Camera {
                eye: Vec3::new(0.0, 3.0, 8.0),
                target: Vec3::Y,
                up: Vec3::Y,
                fov_y_rad: 0.8,
                near_m: 0.1,
                far: Far::Infinite,
            },
            lights: lights(LIGHT_AT),
            planes: vec![Plane { point: Vec3::ZERO, normal: Vec3::Y }],
            budgets: Vec::new(),
            warnings: Vec::new(),
        };
        Self { scene, light_at: LIGHT_AT }
    }

    /// Takes one face off the caster.
    fn open(&mut self) {
        self.scene.triangles.pop();
        self.scene.corner_normals.pop();
        self.scene.triangle_material.pop();
        self.scene.meshes[1].triangles.end -= 1;
    }
}

/// One light of each kind at a point, aimed downwards.
fn lights(at: Vec3) -> Vec<Light> {
    let attenuation = [1.0, 0.0, 0.0];
    let falloff = Falloff::Hard;
    let towards_light = LIGHT_AT.normalize();
    let kinds = [
        LightKind::Point { position: at, aim: at - Vec3::Y, attenuation },
        LightKind::Directional { towards_light },
        LightKind::Spot { position: at, axis: Vec3::NEG_Y, outer_rad: 0.7, falloff, attenuation },
        LightKind::Rectangle {
            position: at,
            aim: at - Vec3::Y,
            half_width: 0.1 * Vec3::X,
            half_height: 0.1 * Vec3::Z,
            samples: 4,
        },
        LightKind::Sphere { position: at, aim: at - Vec3::Y, radius_m: 0.1, samples: 4 },
        LightKind::Sun { towards_light, angular_radius_rad: 0.01, samples: 4 },
    ];
    let light = |kind| {
        let light = Light { name: String::new(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY };
        Light { name: light.kind_name().to_owned(), ..light }
    };
    kinds.into_iter().map(light).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn needs_of(rows: &[MatrixRow], spec: &str) -> Vec<&'static str> {
        rows.iter().find(|row| row.spec == spec).unwrap().needs.clone()
    }

    #[test]
    fn every_family_stands_in_the_table_and_planes_are_found_needed() {
        let rows = matrix(&Gpu::open().unwrap());
        for technique in registry() {
            assert!(rows.iter().any(|row| row.spec == technique.id()), "{}", technique.id());
        }
        let planar = needs_of(&rows, "planar");
        assert_eq!(planar, ["a [[plane]]", "a receiver on the plane", "the light off the plane"]);
        assert_eq!(needs_of(&rows, "map"), ["receivers within one frustum"]);
        assert_eq!(needs_of(&rows, "volume"), [""; 0]);
        assert_eq!(needs_of(&rows, "map:projection=perspective").len(), 1, "a need that only a fit can tell");
        assert!(rows.iter().all(|row| row.handles.len() == light_kinds().len()));
    }
}
