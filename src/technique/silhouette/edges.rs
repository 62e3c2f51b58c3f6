//! The silhouette of the casters as the light sees it: edges at which the triangles, each turned towards the light, do not
//! cancel. That is the outline of closed meshes, and also the rims of open and crowded ones.

use crate::inspect::{edges_of, weld};
use crate::scene::{Light, Mesh, Scene};
use glam::DVec3;

/// Both ends of every silhouette edge, in the order of meshes and of their welded vertices.
pub(super) fn silhouette_edges(scene: &Scene, light: &Light) -> Vec<[DVec3; 2]> {
    let welded = weld(&scene.positions);
    let positions = welded.positions(&scene.positions);
    let homogeneous = light.homogeneous();
    let towards_light = |triangle: u32| {
        let [a, b, c] = scene.triangles[triangle as usize].map(|vertex| welded.index_of_vertex[vertex as usize]);
        let facing = scene.facing(triangle, homogeneous);
        // One that the light sees edge-on covers nothing.
        (facing != 0.0).then_some(if facing > 0.0 { [a, b, c] } else { [a, c, b] })
    };
    let of_mesh = |mesh: &Mesh| {
        let triangles: Vec<[u32; 3]> = mesh.triangles.clone().filter_map(towards_light).collect();
        let outline = edges_of(&triangles).into_iter().filter(|edge| !edge.is_balanced());
        outline.map(|edge| [edge.low, edge.high].map(|place| positions[place as usize])).collect::<Vec<_>>()
    };
    scene.meshes.iter().filter(|mesh| mesh.casts).flat_map(of_mesh).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::fixtures::{pyramid, scene_of};
    use crate::scene::LightKind;
    use glam::Vec3;

    #[test]
    fn a_light_above_a_pyramid_sees_its_base() {
        let scene = scene_of(&[pyramid()]);
        let sun = |towards_light: Vec3| Light {
            name: "sun".into(),
            kind: LightKind::Directional { towards_light },
            intensity: Vec3::ONE,
            range_m: f64::INFINITY,
        };
        let bounds = scene.bounds();
        let on_base = |edge: &[DVec3; 2]| edge.iter().all(|end| end.y == bounds.min.y);
        let seen = silhouette_edges(&scene, &sun(Vec3::Y));
        assert!(seen.len() >= 3 && seen.iter().all(on_base), "{seen:?}");
        assert!(!silhouette_edges(&scene, &sun(Vec3::new(1.0, 0.2, 0.0).normalize())).iter().all(on_base));
    }
}
