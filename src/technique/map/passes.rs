//! The GPU side of a map: draw every view into its layer, look receivers up, read chosen texels back.

use super::filter::moments::Storage;
use super::gather::{Gather, Place};
use super::layers::{self, Layer, record_layers};
use super::lookup::Lookup;
use super::mask_pass::{EXTREMES, MaskPass};
use super::midpoint::{MIDPOINT, MidpointPass};
use super::moment_passes::{self, MomentPasses};
use super::outline::{POINTS, PointPass, Points, WEDGES};
use super::{Settings, filter, projection};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{Geometry, Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::{Chunk, LookUp, ReceiverBuffer};
use glam::{DVec3, DVec4, Vec4};
use projection::{GpuView, View};
use std::collections::BTreeMap;
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, CompareFunction, ComputePipeline, Texture, TextureUsages,
    TextureView, TextureViewDescriptor, TextureViewDimension,
};

const VIEW: Wgsl = wgsl!("map/view.wgsl");
const LOOKUP: Wgsl = wgsl!("map/lookup.wgsl");
const OFFSET: Wgsl = wgsl!("map/offset.wgsl");
const GATHER: Wgsl = wgsl!("map/gather.wgsl");
const RECEIVER: Wgsl = wgsl!("shared/receiver.wgsl");

/// The files of a lookup with one value of each axis.
fn lookup_files(projection: &dyn projection::Projection, filter: &dyn filter::Filter) -> Vec<Wgsl> {
    [&shared_files(projection), filter.builds_on(), &[filter.shader()]].concat()
}

/// Those of a lookup that only lacks its filter.
fn shared_files(projection: &dyn projection::Projection) -> [Wgsl; 6] {
    [RECEIVER, VIEW, projection.layout(), projection.shader(), LOOKUP, OFFSET]
}

/// Every shader module this family can build, as label and files: what tests parse and validate without a GPU.
#[must_use]
pub fn shader_modules() -> Vec<(String, Vec<Wgsl>)> {
    let mut modules = layers::shader_modules();
    modules.extend([
        ("map midpoint".to_owned(), vec![MIDPOINT]),
        ("map gather".to_owned(), vec![GATHER]),
        ("map depth extremes".to_owned(), vec![EXTREMES]),
        ("map moments gather".to_owned(), vec![moment_passes::GATHER]),
    ]);
    modules.push(("silhouette points".to_owned(), POINTS.to_vec()));
    let single = projection::by_name("single");
    modules.push(("silhouette lookup".to_owned(), [&shared_files(single)[..], &[WEDGES]].concat()));
    let layouts: BTreeMap<&str, Wgsl> =
        projection::registry().iter().map(|projection| (projection.layout().path, projection.layout())).collect();
    for filter in filter::registry() {
        for (moments, is_half) in filter.moments().into_iter().flat_map(|moments| [(moments, false), (moments, true)]) {
            for (path, layout) in &layouts {
                let [rows, columns] = Storage::of(moments.count(), is_half).modules(filter.shader(), *layout);
                let label =
                    |axis: &str| format!("map moments by {axis} {} half={is_half} {path}", filter.choice().name);
                modules.extend([(label("rows"), rows), (label("columns"), columns)]);
            }
        }
    }
    for projection in projection::registry() {
        for filter in filter::registry() {
            let label = format!("map lookup {} {}", projection.name(), filter.choice().name);
            modules.push((label, lookup_files(*projection, *filter)));
        }
    }
    modules
}

/// Texture, pipelines and bindings of one map and its lookups.
pub(super) struct MapPasses {
    map: Texture,
    layers: Vec<Layer>,
    /// What makes the map of two others, for a map that stores the middle between two surfaces.
    midpoint: Option<MidpointPass>,
    lookup_pipeline: ComputePipeline,
    lookup_bindings: Vec<BindGroup>,
    points: Option<PointPass>,
    moments: Option<MomentPasses>,
    mask: Option<MaskPass>,
    buffer_bytes: u64,
    texel_reads: u32,
}

impl MapPasses {
    /// Builds everything once.
    pub(super) fn new(
        gpu: &Gpu,
        settings: &Settings,
        lookup: &Lookup,
        numbers: &[Vec4],
        receivers: &ReceiverBuffer,
        silhouettes: Option<&[[DVec3; 2]]>,
    ) -> Result<Self, GpuError> {
        gpu.scoped("the shadow map's set-up", || {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
            let format = settings.format.texture_format();
            let layer_count = lookup.views.len() as u32;
            let map = gpu.texture_array("shadow map", lookup.texels(), layer_count, format, usage);
            let views: Vec<GpuView> = lookup.views.iter().map(View::gpu).collect();
            let views = gpu.buffer("views", &views, BufferUsages::STORAGE);
            let uniform = gpu.uniform("lookup", lookup.uniform(&settings.kernel));
            let numbers = (!numbers.is_empty()).then(|| gpu.buffer("filter numbers", numbers, BufferUsages::STORAGE));
            let files = match silhouettes {
                Some(_) => [&shared_files(settings.projection)[..], &[WEDGES]].concat(),
                None => lookup_files(settings.projection, settings.filter),
            };
            let lookup_pipeline = gpu.compute_pipeline("map lookup", &files);
            let midpoint = settings.stores_midpoint().then(|| MidpointPass::new(gpu, settings, lookup, &map));
            let nearest = midpoint.as_ref().map_or(&map, MidpointPass::nearest);
            let layers = layers::layers(gpu, settings, lookup, nearest, None);
            let all_layers = all_layers(&map);
            let points = silhouettes.map(|edges| PointPass::new(gpu, lookup.texels(), &views, &all_layers, edges));
            let moments = settings
                .filter
                .moments()
                .zip(numbers.as_ref())
                .map(|(moments, numbers)| MomentPasses::new(gpu, settings, moments, lookup, &all_layers, numbers));
            let means = moments.as_ref().map(MomentPasses::view);
            let level = settings.filter.mask_level(&settings.kernel);
            let mask = level.map(|level| MaskPass::new(gpu, lookup, &all_layers, level));
            let extremes = mask.as_ref().map(MaskPass::view);
            let sampler = settings.filter.samples().then(|| gpu.comparing_sampler(is_lit(lookup)));
            let bind = |chunk: &Chunk| {
                let mut resources: Vec<(u32, BindingResource<'_>)> = vec![
                    (0, chunk.receivers.as_entire_binding()),
                    (1, chunk.visibilities.as_entire_binding()),
                    (2, uniform.as_entire_binding()),
                    (4, views.as_entire_binding()),
                ];
                // In place of depths.
                match &means {
                    Some(means) => resources.push((6, BindingResource::TextureView(means))),
                    None => resources.push((3, BindingResource::TextureView(&all_layers))),
                }
                resources.extend(extremes.as_ref().map(|extremes| (6, BindingResource::TextureView(extremes))));
                resources.extend(sampler.as_ref().map(|sampler| (7, BindingResource::Sampler(sampler))));
                resources.extend(numbers.as_ref().map(|numbers| (5, numbers.as_entire_binding())));
                resources.extend(points.as_ref().map(|points| (5, BindingResource::TextureView(&points.view))));
                gpu.bind_at(&lookup_pipeline.get_bind_group_layout(0), &resources)
            };
            Self {
                buffer_bytes: points.as_ref().map_or(0, PointPass::bytes)
                    + midpoint.as_ref().map_or(0, MidpointPass::bytes)
                    + moments.as_ref().map_or(0, MomentPasses::bytes)
                    + mask.as_ref().map_or(0, MaskPass::bytes)
                    + numbers.as_ref().map_or(0, Buffer::size)
                    + views.size()
                    + uniform.size()
                    + layers.iter().map(Layer::bytes).sum::<u64>(),
                lookup_bindings: receivers.chunks().iter().map(bind).collect(),
                layers,
                midpoint,
                texel_reads: texel_reads(settings, silhouettes.is_some()),
                map,
                lookup_pipeline,
                points,
                moments,
                mask,
            }
        })
    }

    /// Draws the map and looks every receiver up.
    pub(super) fn run(
        &self,
        gpu: &Gpu,
        geometry: &Geometry,
        receivers: &ReceiverBuffer,
    ) -> Result<Vec<PassRecord>, GpuError> {
        let recorder = gpu.scoped("recording the shadow map", || {
            let mut recorder = Recorder::new(gpu);
            record_layers(&mut recorder, "map", &self.layers, geometry);
            if let Some(midpoint) = &self.midpoint {
                midpoint.record(&mut recorder, geometry);
            }
            if let Some(points) = &self.points {
                points.record(&mut recorder);
            }
            if let Some(mask) = &self.mask {
                mask.record(&mut recorder);
            }
            if let Some(moments) = &self.moments {
                moments.record(gpu, &mut recorder);
            }
            let (pipeline, bindings) = (&self.lookup_pipeline, self.lookup_bindings.as_slice());
            receivers
                .look_up(&mut recorder, &LookUp { name: "lookup", pipeline, bindings, texel_reads: self.texel_reads });
            recorder
        })?;
        recorder.finish("the shadow map")
    }

    /// Draws the map alone.
    pub(super) fn draw(&self, gpu: &Gpu, geometry: &Geometry) -> Result<(), GpuError> {
        let recorder = gpu.scoped("recording a map to be read back", || {
            let mut recorder = Recorder::new(gpu);
            record_layers(&mut recorder, "map", &self.layers, geometry);
            recorder
        })?;
        recorder.finish("a map to be read back").map(drop)
    }

    /// The outline's points that the last run drew; `None` for a map without silhouettes.
    pub(super) fn points(&self, gpu: &Gpu) -> Result<Option<Points>, GpuError> {
        self.points.as_ref().map(|points| points.read(gpu)).transpose()
    }

    /// How many means of moments the last run could not store; `None` without moments.
    pub(super) fn overflowed(&self, gpu: &Gpu) -> Result<Option<u32>, GpuError> {
        self.moments.as_ref().map(|moments| moments.overflowed(gpu)).transpose()
    }

    /// The means of moments at some places, as the GPU holds them; none without moments.
    pub(super) fn gather_means(&self, gpu: &Gpu, places: &[Place]) -> Result<Vec<DVec4>, GpuError> {
        self.moments.as_ref().map_or_else(|| Ok(Vec::new()), |moments| moments.gather(gpu, places))
    }

    /// The stored depths of some texels, by index, as the GPU holds them.
    pub(super) fn gather(&self, gpu: &Gpu, lookup: &Lookup, texels: &[u32]) -> Result<Vec<f64>, GpuError> {
        let place = |index: &u32| {
            let (layer, texel) = lookup.texel_of(*index);
            [texel.x, texel.y, layer as u32, 0]
        };
        let layers = &all_layers(&self.map);
        let gather = Gather { gpu, label: "gathering texels", shader: GATHER, layers };
        let depths: Vec<f32> = gather.texels(texels, place)?;
        Ok(depths.into_iter().map(f64::from).collect())
    }

    /// Bytes of the map and its buffers.
    pub(super) fn bytes(&self, settings: &Settings) -> u64 {
        let texels = u64::from(self.map.width()) * u64::from(self.map.height()) * self.layers.len() as u64;
        texels * settings.format.bytes() + self.buffer_bytes
    }
}

/// Texels that a lookup reads at most. With silhouettes that is one depth and the points of five cells.
fn texel_reads(settings: &Settings, has_silhouettes: bool) -> u32 {
    if has_silhouettes { 1 + 5 } else { settings.filter.texel_reads(&settings.kernel) }
}

fn all_layers(map: &Texture) -> TextureView {
    let dimension = Some(TextureViewDimension::D2Array);
    map.create_view(&TextureViewDescriptor { dimension, ..Default::default() })
}

/// How a reference compares with a stored depth where it is lit. Equality is.
fn is_lit(lookup: &Lookup) -> CompareFunction {
    if lookup.views[0].depth_sign > 0.0 { CompareFunction::LessEqual } else { CompareFunction::GreaterEqual }
}
