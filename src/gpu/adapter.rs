//! Which adapter gnomon uses, and what it tells the user about it.

use super::{GpuError, INSTALL_HINT};
use serde::{Deserialize, Serialize};
use wgpu::{Adapter, AdapterInfo, Backend, Backends, DeviceType, Features, Instance, InstanceDescriptor};

/// Environment variable naming part of the adapter's name, its backend, or its number in `gnomon doctor`'s list.
pub(super) const ADAPTER_VARIABLE: &str = "GNOMON_ADAPTER";

/// wgpu's own: which graphics interfaces it looks at.
const BACKENDS_VARIABLE: &str = "WGPU_BACKEND";

/// Features gnomon uses where the adapter has them; everything works without, or says what is missing.
pub(super) const WANTED_FEATURES: [(Features, &str); 9] = [
    (Features::TIMESTAMP_QUERY, "timestamp-query"),
    (Features::PIPELINE_STATISTICS_QUERY, "pipeline-statistics-query"),
    (Features::DEPTH_CLIP_CONTROL, "depth-clip-control"),
    (Features::DEPTH32FLOAT_STENCIL8, "depth32float-stencil8"),
    (Features::POLYGON_MODE_LINE, "polygon-mode-line"),
    (Features::PRIMITIVE_INDEX, "primitive-index"),
    (Features::FLOAT32_FILTERABLE, "float32-filterable"),
    (Features::CONSERVATIVE_RASTERIZATION, "conservative-rasterization"),
    (Features::EXPERIMENTAL_RAY_QUERY, "ray-query"),
];

/// What reports say about the adapter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AdapterSummary {
    /// The adapter's own name.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`, `gl`, …
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Those of gnomon's optional features that it has.
    pub features: Vec<String>,
    /// True for a software rasteriser: its milliseconds stand for no real machine.
    #[serde(skip)]
    pub is_software: bool,
}

/// The limits that decide what gnomon can run here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LimitsSummary {
    /// Largest side of a picture or map, texels.
    pub texture_side: u32,
    /// Most layers of a map.
    pub texture_layers: u32,
    /// Largest storage buffer binding, bytes.
    pub storage_binding_bytes: u64,
    /// Largest buffer, bytes.
    pub buffer_bytes: u64,
}

impl AdapterSummary {
    pub(super) fn of(adapter: &Adapter) -> Self {
        let info = adapter.get_info();
        let has = adapter.features();
        Self {
            backend: info.backend.to_str().to_owned(),
            driver: [info.driver.as_str(), info.driver_info.as_str()].join(" ").trim().to_owned(),
            features: WANTED_FEATURES.iter().filter(|f| has.contains(f.0)).map(|f| f.1.to_owned()).collect(),
            is_software: info.device_type == DeviceType::Cpu,
            name: info.name,
        }
    }
}

pub(super) fn instance() -> Instance {
    Instance::new(InstanceDescriptor::new_without_display_handle_from_env())
}

fn all_adapters(instance: &Instance) -> Vec<Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(Backends::all()));
    adapters.sort_by_key(|adapter| preference(&adapter.get_info()));
    adapters
}

/// Smaller is better: real devices before software; the GL backend last, because it lacks what gnomon needs.
fn preference(info: &AdapterInfo) -> (bool, u8) {
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (info.backend == Backend::Gl, kind)
}

/// Every adapter that answers, best first.
#[must_use]
pub fn describe_adapters() -> Vec<AdapterSummary> {
    all_adapters(&instance()).iter().map(AdapterSummary::of).collect()
}

/// The adapter to use: the best one, or the one that `wish` names.
///
/// # Errors
/// [`GpuError::NoAdapter`] if none answers or none matches.
pub(super) fn choose(instance: &Instance, wish: Option<&str>) -> Result<Adapter, GpuError> {
    let mut adapters = all_adapters(instance);
    let names: Vec<String> =
        adapters.iter().map(|a| a.get_info()).map(|i| format!("{} ({})", i.name, i.backend)).collect();
    // The GL backend lacks depth copies and samples stencil as 0: answers would be wrong.
    let is_usable = |adapter: &Adapter| adapter.get_info().backend != Backend::Gl;
    let position = match wish {
        None => adapters.iter().position(is_usable),
        Some(wish) => wish.parse().ok().filter(|n| *n < adapters.len()).or_else(|| {
            let wish = wish.to_lowercase();
            names.iter().position(|name| name.to_lowercase().contains(&wish))
        }),
    };
    let chosen = position.filter(|at| is_usable(&adapters[*at])).map(|at| adapters.swap_remove(at));
    chosen.ok_or_else(|| {
        let (why, remedy) = match (wish, position) {
            (None, _) => {
                let backends = std::env::var(BACKENDS_VARIABLE).map(|typed| format!(" ({BACKENDS_VARIABLE}={typed})"));
                let why = format!("no Vulkan, Metal or DX12 driver answered{}", backends.unwrap_or_default());
                (why, format!("install a software Vulkan driver with: {INSTALL_HINT}"))
            }
            (Some(wish), Some(_)) => {
                let why = format!("{ADAPTER_VARIABLE}={wish} is a GL driver, which cannot copy depth or read stencils");
                (why, format!("choose another, or none: unset {ADAPTER_VARIABLE}"))
            }
            (Some(wish), None) => {
                (format!("{ADAPTER_VARIABLE}={wish} matches none"), "name one of these, or its number".to_owned())
            }
        };
        GpuError::NoAdapter { why, found: if names.is_empty() { "none".to_owned() } else { names.join(", ") }, remedy }
    })
}
