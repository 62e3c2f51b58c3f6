//! What a truth depends on, as one number: two questions with the same key have the same exact answer.

use crate::receiver::Receivers;
use crate::scene::{Light, Scene};
use sha2::{Digest, Sha256};
use std::fmt;

/// SHA-256 of everything that decides an exact answer: the rounded scene, camera with near and far, light, picture size,
/// adapter, the triangle behind every pixel, and gnomon's version.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TruthKey(pub(super) [u8; 32]);

impl TruthKey {
    /// The key of a light's question. `adapter` names adapter and driver.
    #[must_use]
    pub fn new(scene: &Scene, light: &Light, receivers: &Receivers, adapter: &str) -> Self {
        let mut hash = Sha256::new();
        let mut part = |bytes: &[u8]| {
            // With its length before each part, no two lists of parts run into the same bytes.
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        part(env!("CARGO_PKG_VERSION").as_bytes());
        part(adapter.as_bytes());
        part(bytemuck::cast_slice(&scene.positions));
        part(bytemuck::cast_slice(&scene.triangles));
        // What `Debug` writes of a float reads back as the same float.
        let meshes = scene.meshes.iter().map(|mesh| (mesh.triangles.clone(), mesh.casts, mesh.receives));
        part(format!("{:?}", meshes.collect::<Vec<_>>()).as_bytes());
        part(format!("{:?} {:?}", scene.camera, scene.image_size).as_bytes());
        part(format!("{:?} {:?}", light.kind, light.range_m).as_bytes());
        let ids: Vec<u32> = receivers.pixels.iter().map(|r| r.map_or(u32::MAX, |r| r.triangle)).collect();
        part(bytemuck::cast_slice(&ids));
        Self(hash.finalize().into())
    }
}

impl fmt::Display for TruthKey {
    /// In hexadecimal digits, as files are named.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
