//! Pipelines are built once per device: translating and compiling a shader takes longer than most runs of it, and every
//! technique that is evaluated asks for a few that others asked for before. They are known by their text and their state.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use wgpu::{ComputePipeline, RenderPipeline};

/// What a device has built so far.
#[derive(Debug, Default)]
pub(super) struct Pipelines {
    compute: Mutex<HashMap<String, ComputePipeline>>,
    render: Mutex<HashMap<String, RenderPipeline>>,
    spent: Mutex<Duration>,
}

impl Pipelines {
    /// The compute pipeline of that text.
    pub(super) fn compute(&self, key: String, build: impl FnOnce() -> ComputePipeline) -> ComputePipeline {
        self.known(&self.compute, key, build)
    }

    /// The render pipeline of that text and state.
    pub(super) fn render(&self, key: String, build: impl FnOnce() -> RenderPipeline) -> RenderPipeline {
        self.known(&self.render, key, build)
    }

    /// How long building them took altogether.
    pub(super) fn spent(&self) -> Duration {
        *self.spent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Builds everything anew from here on: what was built while something failed may be of no use.
    pub(super) fn forget(&self) {
        self.compute.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.render.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    fn known<P: Clone>(&self, built: &Mutex<HashMap<String, P>>, key: String, build: impl FnOnce() -> P) -> P {
        let mut built = built.lock().unwrap_or_else(PoisonError::into_inner);
        let build = || {
            let start = Instant::now();
            let pipeline = build();
            *self.spent.lock().unwrap_or_else(PoisonError::into_inner) += start.elapsed();
            pipeline
        };
        built.entry(key).or_insert_with(build).clone()
    }
}

#[cfg(test)]
mod tests {
    use crate::gpu::shader::{Wgsl, wgsl};
    use crate::gpu::{CORNER_LAYOUT, Drawing, Gpu};
    use wgpu::{CompareFunction, DepthStencilState, TextureFormat};

    const COMPUTE: Wgsl = wgsl!("map/gather.wgsl");
    const RENDER: Wgsl = wgsl!("map/caster.wgsl");

    #[test]
    fn a_text_and_a_state_are_built_once() {
        let mut gpu = Gpu::open().unwrap();
        let build = |gpu: &Gpu, compare: CompareFunction| {
            let before_ms = gpu.building_ms();
            let render = gpu.render_pipeline(&Drawing {
                label: "casters",
                files: &[RENDER],
                vertices: &[Some(CORNER_LAYOUT)],
                depth_stencil: Some(DepthStencilState {
                    format: TextureFormat::Depth32Float,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                ..Drawing::default()
            });
            (gpu.compute_pipeline("gather", &[COMPUTE]), render, gpu.building_ms() > before_ms)
        };
        let (compute, render, is_new) = build(&gpu, CompareFunction::Less);
        assert!(is_new);
        assert_eq!(build(&gpu, CompareFunction::Less), (compute.clone(), render.clone(), false));
        let (_, other, is_new) = build(&gpu, CompareFunction::Greater);
        assert!(is_new && other != render, "another state");
        gpu.fault = Some(("vec4f(position_in_world, 1.0)", "vec4f(position_in_world, 2.0)"));
        let (_, other, is_new) = build(&gpu, CompareFunction::Less);
        assert!(is_new && other != render, "another text");
        gpu.fault = None;
        let failed = gpu.scoped("a broken shader", || gpu.compute_pipeline("broken", &[RENDER]));
        assert!(failed.is_err());
        assert!(build(&gpu, CompareFunction::Less).2, "after a failure");
    }
}
