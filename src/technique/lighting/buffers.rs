//! The lighting model's numbers as `shaders/lighting/` reads them, rounded once.

use super::LightingPipeline;
use crate::scene::{Falloff, Light, LightKind, LightingMode, Material, Scene, Shading};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Mat4, Vec3};
use std::f32::consts::FRAC_1_PI;

/// `Scene` of `shaders/lighting/surface.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct SceneUniform {
    clip_from_world: Mat4,
    eye_in_world: [f32; 3],
    shading: u32,
    ambient: [f32; 3],
    diffuse_scale: f32,
}

/// `Corner` of the same file.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Corner {
    normal_in_world: [f32; 3],
    material: u32,
    facet_normal_in_world: [f32; 3],
    receives: u32,
}

/// `Material` of the same file.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuMaterial {
    ambient: [f32; 3],
    shininess: f32,
    diffuse: [f32; 3],
    padding: u32,
    specular: [f32; 3],
    more_padding: u32,
    emission: [f32; 3],
    last_padding: u32,
}

/// `Light` of the same file.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct LightUniform {
    position: [f32; 4],
    intensity: [f32; 3],
    range_m: f32,
    axis: [f32; 3],
    outer_rad: f32,
    attenuation: [f32; 3],
    distance_law: u32,
    falloff: u32,
    falloff_value: f32,
    padding: [u32; 2],
}

/// `Part` of the same file: which share of the lighting a pass draws.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Part {
    own: f32,
    direct: f32,
    shadowed: f32,
    padding: u32,
}

/// `Shadow` of `shaders/lighting/shadow.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Shadow {
    most_seen: f32,
    darkening: f32,
    padding: [u32; 2],
}

impl SceneUniform {
    pub(super) fn new(scene: &Scene) -> Self {
        Self {
            clip_from_world: scene.camera.clip_from_world(scene.image_size).as_mat4(),
            eye_in_world: scene.camera.eye.to_array(),
            shading: match scene.shading {
                Shading::Phong => 0,
                Shading::BlinnPhong => 1,
                Shading::Gouraud => 2,
                Shading::Flat => 3,
            },
            ambient: scene.ambient.to_array(),
            diffuse_scale: match scene.mode {
                LightingMode::Physical => FRAC_1_PI,
                LightingMode::Classic => 1.0,
            },
        }
    }
}

/// Three corners per triangle, with all normals on the eye's side.
pub(super) fn corners(scene: &Scene) -> Vec<Corner> {
    let eye = scene.camera.eye.as_dvec3().extend(1.0);
    let of_triangle = |triangle: u32| {
        let facet_normal = scene.triangle_normal(triangle).normalize_or_zero();
        let facet_normal = if scene.facing(triangle, eye) < 0.0 { -facet_normal } else { facet_normal };
        let normals = scene.corner_normals[triangle as usize];
        let points_to_eye = normals.iter().map(|normal| normal.as_dvec3()).sum::<DVec3>().dot(facet_normal) >= 0.0;
        let receives = u32::from(scene.mesh_of(triangle).receives);
        normals.map(|normal| Corner {
            normal_in_world: if points_to_eye { normal } else { -normal }.to_array(),
            material: scene.triangle_material[triangle as usize],
            facet_normal_in_world: facet_normal.as_vec3().to_array(),
            receives,
        })
    };
    (0..scene.triangles.len() as u32).flat_map(of_triangle).collect()
}

pub(super) fn materials(scene: &Scene) -> Vec<GpuMaterial> {
    let material = |material: &Material| GpuMaterial {
        ambient: material.ambient.to_array(),
        shininess: material.shininess,
        diffuse: material.diffuse.to_array(),
        padding: 0,
        specular: material.specular.to_array(),
        more_padding: 0,
        emission: material.emission.to_array(),
        last_padding: 0,
    };
    scene.materials.iter().map(material).collect()
}

impl LightUniform {
    /// An area light becomes the point at its centre; nobody asks for one.
    pub(super) fn new(light: &Light, mode: LightingMode) -> Self {
        /// More than any angle.
        const WITHOUT_CONE: f32 = 4.0;
        let (distance_law, attenuation) = match (light.kind, mode) {
            (LightKind::Directional { .. } | LightKind::Sun { .. }, _) => (2, [0.0; 3]),
            (_, LightingMode::Physical) => (0, [0.0; 3]),
            (LightKind::Point { attenuation, .. } | LightKind::Spot { attenuation, .. }, _) => (1, attenuation),
            (LightKind::Rectangle { .. } | LightKind::Sphere { .. }, _) => (2, [0.0; 3]),
        };
        let (axis, outer_rad, falloff) = match light.kind {
            LightKind::Spot { axis, outer_rad, falloff, .. } => (axis, outer_rad as f32, falloff),
            _ => (Vec3::Z, WITHOUT_CONE, Falloff::Hard),
        };
        let (falloff, falloff_value) = match falloff {
            Falloff::Hard => (0, 0.0),
            Falloff::Linear { inner_rad } => (1, inner_rad as f32),
            Falloff::Warn { power } => (2, power as f32),
        };
        Self {
            position: light.homogeneous().as_vec4().to_array(),
            intensity: light.intensity.to_array(),
            range_m: light.range_m.min(f32::MAX.into()) as f32,
            axis: axis.to_array(),
            outer_rad,
            attenuation,
            distance_law,
            falloff,
            falloff_value,
            padding: [0; 2],
        }
    }
}

impl Part {
    fn new(own: f32, direct: f32, shadowed: f32) -> Self {
        Self { own, direct, shadowed, padding: 0 }
    }

    /// What a pipeline starts from.
    pub(super) fn base(pipeline: LightingPipeline) -> Self {
        match pipeline {
            LightingPipeline::AmbientLit | LightingPipeline::Darkening { .. } => Self::new(1.0, 0.0, 0.0),
            LightingPipeline::Black => Self::new(0.0, 0.0, 0.0),
        }
    }
    /// Ambient light and emission where the light is seen.
    pub(super) fn own_where_seen() -> Self {
        Self::new(1.0, 0.0, 1.0)
    }
    /// The light where it is seen.
    pub(super) fn direct_where_seen() -> Self {
        Self::new(0.0, 1.0, 1.0)
    }
    /// The light everywhere.
    pub(super) fn direct() -> Self {
        Self::new(0.0, 1.0, 0.0)
    }
}

impl Shadow {
    /// Full shadow, which a lit pass leaves out; or all that is not fully lit, for a dark quad.
    pub(super) fn new(pipeline: LightingPipeline) -> Self {
        /// The largest visibility below 1.
        const NOT_FULLY_LIT: f32 = 1.0 - f32::EPSILON / 2.0;
        let (most_seen, darkening) = match pipeline {
            LightingPipeline::AmbientLit | LightingPipeline::Black => (0.0, 0.0),
            LightingPipeline::Darkening { amount } => (NOT_FULLY_LIT, amount as f32),
        };
        Self { most_seen, darkening, padding: [0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::technique::lighting::shader_modules;

    #[test]
    fn numbers_lie_where_the_shaders_read_them() {
        let modules = shader_modules();
        let [(_, surface), (_, shadow)] = modules.as_slice() else { panic!("two modules") };
        let of_scene = rust_layout!(SceneUniform { clip_from_world, eye_in_world, shading, ambient, diffuse_scale });
        assert_eq!(wgsl_layout(surface, "Scene"), of_scene);
        let corner = rust_layout!(Corner { normal_in_world, material, facet_normal_in_world, receives });
        assert_eq!(wgsl_layout(surface, "Corner"), corner);
        let material = rust_layout!(GpuMaterial {
            ambient,
            shininess,
            diffuse,
            padding,
            specular,
            more_padding,
            emission,
            last_padding
        });
        assert_eq!(wgsl_layout(surface, "Material"), material);
        let light = rust_layout!(LightUniform {
            position,
            intensity,
            range_m,
            axis,
            outer_rad,
            attenuation,
            distance_law,
            falloff,
            falloff_value,
            padding
        });
        assert_eq!(wgsl_layout(surface, "Light"), light);
        assert_eq!(wgsl_layout(surface, "Part"), rust_layout!(Part { own, direct, shadowed, padding }));
        assert_eq!(wgsl_layout(shadow, "Shadow"), rust_layout!(Shadow { most_seen, darkening, padding }));
    }
}
