//! Receivers as the light's samples: points in two f32 each, so that a difference from a caster's corner is rounded by
//! what it is and not by how far the origin is.

use super::grids::Grids;
use crate::cast::Casters;
use crate::receiver::Receiver;
use bytemuck::{Pod, Zeroable};

/// `Sample` of `shaders/irregular/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct GpuSample {
    point_high: [f32; 3],
    own: u32,
    point_low: [f32; 3],
    face: u32,
}

impl GpuSample {
    /// Rounds a receiver to the nearest pair of f32, and finds the face it lies in.
    pub(super) fn new(receiver: &Receiver, casters: &Casters, grids: &Grids) -> Self {
        let point = receiver.point_in_world;
        let high = point.as_vec3();
        Self {
            point_high: high.to_array(),
            own: casters.surface_of(receiver.triangle),
            point_low: (point - high.as_dvec3()).as_vec3().to_array(),
            face: grids.face_of(point) as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::gpu::shader::wgsl;

    #[test]
    fn samples_lie_as_the_shaders_read_them() {
        let in_rust = rust_layout!(GpuSample { point_high, own, point_low, face });
        assert_eq!(wgsl_layout(&[wgsl!("irregular/view.wgsl")], "Sample"), in_rust);
    }
}
