//! One device for everything: opening it, and running work with its errors caught.

use super::GpuError;
use super::adapter::{ADAPTER_VARIABLE, AdapterSummary, LimitsSummary, WANTED_FEATURES, choose, instance};
use super::pipelines::Pipelines;
use super::snapping::vertex_step_px;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{
    Device, DeviceDescriptor, Error, ErrorFilter, ExperimentalFeatures, Features, Limits, MemoryHints, PollType, Queue,
};

/// An open device and its queue.
#[derive(Debug)]
pub struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    adapter: AdapterSummary,
    lost: Arc<Mutex<Option<String>>>,
    vertex_step_px: f64,
    pub(super) pipelines: Pipelines,
    /// Text of shaders that is replaced, to see whether anybody notices.
    #[cfg(test)]
    pub(crate) fault: Option<(&'static str, &'static str)>,
}

impl Gpu {
    /// Opens the best adapter, or the one that the environment variable `GNOMON_ADAPTER` names.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::NoDevice`], or what the device reported.
    pub fn open() -> Result<Self, GpuError> {
        let wish = std::env::var(ADAPTER_VARIABLE).ok().filter(|wish| !wish.is_empty());
        let adapter = choose(&instance(), wish.as_deref())?;
        let summary = AdapterSummary::of(&adapter);
        let wanted = WANTED_FEATURES.iter().fold(Features::empty(), |all, (feature, _)| all | *feature);
        let (device, queue) = pollster::block_on(adapter.request_device(&DeviceDescriptor {
            label: Some("gnomon"),
            required_features: adapter.features() & wanted,
            experimental_features: experimental(adapter.features() & wanted),
            required_limits: adapter.limits(),
            memory_hints: MemoryHints::MemoryUsage,
            ..DeviceDescriptor::default()
        }))
        .map_err(|error| GpuError::NoDevice { adapter: summary.name.clone(), why: error.to_string() })?;
        let lost = Arc::new(Mutex::new(None));
        let note = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            *note.lock().unwrap_or_else(PoisonError::into_inner) = Some(format!("{reason:?} {message}"));
        });
        let mut gpu = Self {
            device,
            queue,
            adapter: summary,
            lost,
            vertex_step_px: 0.0,
            pipelines: Pipelines::default(),
            #[cfg(test)]
            fault: None,
        };
        gpu.vertex_step_px = vertex_step_px(&gpu)?;
        Ok(gpu)
    }

    /// What reports say about the adapter.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        &self.adapter
    }

    /// The limits that decide what can run here.
    #[must_use]
    pub fn limits(&self) -> LimitsSummary {
        let limits: Limits = self.device.limits();
        LimitsSummary {
            texture_side: limits.max_texture_dimension_2d,
            texture_layers: limits.max_texture_array_layers,
            storage_binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
        }
    }

    /// The step of the grid that the rasteriser snaps vertices to, pixels of the target, as measured.
    #[must_use]
    pub fn vertex_step_px(&self) -> f64 {
        self.vertex_step_px
    }

    /// How long building pipelines took so far, milliseconds: once for each that was asked for.
    #[must_use]
    pub fn building_ms(&self) -> f64 {
        self.pipelines.spent().as_secs_f64() * 1e3
    }

    pub(crate) fn has(&self, feature: Features) -> bool {
        self.device.features().contains(feature)
    }

    /// Runs `work` with every kind of device error caught, and waits until the device is done with what was submitted.
    ///
    /// # Errors
    /// The first error the device reported meanwhile.
    pub(crate) fn scoped<T>(&self, during: &str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        let scopes = [ErrorFilter::Internal, ErrorFilter::OutOfMemory, ErrorFilter::Validation]
            .map(|filter| self.device.push_error_scope(filter));
        let result = work();
        let waited = self.device.poll(PollType::wait_indefinitely());
        // Scopes pop in the reverse order of their pushes.
        let errors: Vec<Error> = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).collect();
        let during = during.to_owned();
        if let Some(why) = self.lost.lock().unwrap_or_else(PoisonError::into_inner).clone() {
            return Err(GpuError::Lost { during, why });
        }
        if !errors.is_empty() {
            self.pipelines.forget();
        }
        match errors.into_iter().next() {
            Some(Error::OutOfMemory { .. }) => Err(GpuError::OutOfMemory { during }),
            Some(Error::Validation { description, .. } | Error::Internal { description, .. }) => {
                Err(GpuError::Invalid { during, why: description })
            }
            None => waited.map(|_| result).map_err(|error| GpuError::Lost { during, why: error.to_string() }),
        }
    }
}

/// The token without which wgpu opens no device with experimental features.
#[allow(unsafe_code, reason = "the one token that wgpu wants for ray queries; see Safety")]
fn experimental(features: Features) -> ExperimentalFeatures {
    if features.intersects(Features::all_experimental_mask()) {
        // Safety: what may be unsound are experimental interfaces used wrongly. Only the ray-query technique uses one, on
        // buffers that wgpu validates, and only on adapters that have it.
        unsafe { ExperimentalFeatures::enabled() }
    } else {
        ExperimentalFeatures::disabled()
    }
}
