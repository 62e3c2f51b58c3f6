//! The GPU side of a map: draw every view into its layer, look receivers up, read chosen texels back.

use super::filter::moments::Storage;
use super::lookup::Lookup;
use super::mask_pass::{EXTREMES, MaskPass};
use super::midpoint::{MIDPOINT, MidpointPass};
use super::moment_passes::{self, MomentPasses};
use super::outline::{POINTS, PointPass, Points, WEDGES};
use super::settings::{CasterSides, NearMode};
use super::{DepthFormat, Settings, filter, projection};
use crate::gpu::shader::{Wgsl, wgsl};
use crate::gpu::{CORNER_LAYOUT, Drawing, Geometry, Gpu, GpuError, PassRecord, Recorder};
use crate::technique::receiver_buffer::{Chunk, LookUp, ReceiverBuffer, workgroups};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, DVec4, Mat4, Vec4};
use projection::{Drawn, GpuView, View};
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, CompareFunction, ComputePipeline, DepthBiasState,
    DepthStencilState, Face, FrontFace, LoadOp, Operations, PrimitiveState, RenderPassDepthStencilAttachment,
    RenderPipeline, StoreOp, Texture, TextureFormat, TextureUsages, TextureView, TextureViewDescriptor,
    TextureViewDimension,
};

const CASTER: Wgsl = wgsl!("map/caster.wgsl");
const CASTER_DEPTH: Wgsl = wgsl!("map/caster_depth.wgsl");
const CASTER_ROWS: Wgsl = wgsl!("map/caster_rows.wgsl");
const CASTER_PARABOLOID: Wgsl = wgsl!("map/caster_paraboloid.wgsl");
const NEAREST_LAYER: Wgsl = wgsl!("map/nearest_layer.wgsl");
const SECOND_LAYER: Wgsl = wgsl!("map/second_layer.wgsl");
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
    let mut modules = vec![
        ("map caster".to_owned(), vec![CASTER]),
        ("map caster depth".to_owned(), vec![CASTER_DEPTH, CASTER_ROWS, NEAREST_LAYER]),
        ("map caster paraboloid".to_owned(), vec![CASTER_DEPTH, CASTER_PARABOLOID, NEAREST_LAYER]),
        ("map second layer".to_owned(), vec![CASTER_DEPTH, CASTER_ROWS, SECOND_LAYER]),
        ("map second layer paraboloid".to_owned(), vec![CASTER_DEPTH, CASTER_PARABOLOID, SECOND_LAYER]),
        ("map midpoint".to_owned(), vec![MIDPOINT]),
        ("map gather".to_owned(), vec![GATHER]),
        ("map depth extremes".to_owned(), vec![EXTREMES]),
        ("map moments gather".to_owned(), vec![moment_passes::GATHER]),
    ];
    modules.push(("silhouette points".to_owned(), POINTS.to_vec()));
    let single = projection::by_name("single");
    modules.push(("silhouette lookup".to_owned(), [&shared_files(single)[..], &[WEDGES]].concat()));
    for filter in filter::registry() {
        for (moments, is_half) in filter.moments().into_iter().flat_map(|moments| [(moments, false), (moments, true)]) {
            let [rows, columns] = Storage::of(moments.count(), is_half).modules(filter.shader());
            let label = |axis: &str| format!("map moments by {axis} {} half={is_half}", filter.choice().name);
            modules.extend([(label("rows"), rows), (label("columns"), columns)]);
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

/// `Caster` of `shaders/map/caster_depth.wgsl`, which begins as that of `shaders/map/caster.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct CasterUniform {
    clip_from_world: Mat4,
    depth_row: [f32; 4],
    depth_q_row: [f32; 4],
    bias_constant: f32,
    bias_constant_ulps: f32,
    bias_slope: f32,
    bias_clamp: f32,
    depth_sign: f32,
    clamps: u32,
    padding: [u32; 2],
    u_row: [f32; 4],
    v_row: [f32; 4],
    q_row: [f32; 4],
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

/// How one view is drawn.
pub(super) struct Layer {
    target: TextureView,
    pipeline: RenderPipeline,
    bindings: BindGroup,
    clear_depth: f32,
    /// What is drawn in place of the casters, three corners per triangle.
    pieces: Option<Buffer>,
    /// Whether a fragment shader writes depth: its pipeline then declares one colour target, which is none.
    writes_depth: bool,
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
            let layers = layers(gpu, settings, lookup, nearest, None);
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
                    + u64::from(layer_count) * size_of::<CasterUniform>() as u64
                    + layers.iter().filter_map(|layer| layer.pieces.as_ref()).map(Buffer::size).sum::<u64>(),
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

    /// The means of moments at some places (column, row, layer, 0), as the GPU holds them; none without moments.
    pub(super) fn gather_means(&self, gpu: &Gpu, places: &[[u32; 4]]) -> Result<Vec<DVec4>, GpuError> {
        self.moments.as_ref().map_or_else(|| Ok(Vec::new()), |moments| moments.gather(gpu, places))
    }

    /// The stored depths of some texels, by index, as the GPU holds them.
    pub(super) fn gather(&self, gpu: &Gpu, lookup: &Lookup, texels: &[u32]) -> Result<Vec<f64>, GpuError> {
        if texels.is_empty() {
            return Ok(Vec::new());
        }
        let position = |index: &u32| {
            let (layer, texel) = lookup.texel_of(*index);
            [texel.x, texel.y, layer as u32, 0]
        };
        let positions: Vec<[u32; 4]> = texels.iter().map(position).collect();
        let depths: Buffer = gpu.scoped("gathering texels", || {
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
            let input = gpu.buffer("texels", &positions, usage);
            let output = gpu.buffer("depths", &vec![0.0_f32; texels.len()], usage);
            let pipeline = gpu.compute_pipeline("map gather", &[GATHER]);
            let all_layers = all_layers(&self.map);
            let resources =
                [input.as_entire_binding(), output.as_entire_binding(), BindingResource::TextureView(&all_layers)];
            let bindings = gpu.bind(&pipeline.get_bind_group_layout(0), &resources);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            let [columns, rows] = workgroups(texels.len());
            pass.dispatch_workgroups(columns, rows, 1);
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            output
        })?;
        let values: Vec<f32> = gpu.read_buffer(&depths, "reading gathered texels")?;
        Ok(values.into_iter().map(f64::from).collect())
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

/// Draws the casters into every view's layer.
pub(super) fn record_layers(recorder: &mut Recorder<'_>, name: &'static str, layers: &[Layer], geometry: &Geometry) {
    for layer in layers {
        let depth = RenderPassDepthStencilAttachment {
            view: &layer.target,
            depth_ops: Some(Operations { load: LoadOp::Clear(layer.clear_depth), store: StoreOp::Store }),
            stencil_ops: None,
        };
        let no_color = if layer.writes_depth { &[None][..] } else { &[] };
        recorder.render(name, no_color, Some(depth), |pass| {
            pass.set_pipeline(&layer.pipeline);
            pass.set_bind_group(0, &layer.bindings, &[]);
            match &layer.pieces {
                Some(corners) => {
                    pass.set_vertex_buffer(0, corners.slice(..));
                    pass.draw(0..(corners.size() / CORNER_LAYOUT.array_stride) as u32, 0..1);
                }
                None => geometry.draw_casters(pass),
            }
        });
    }
}

/// One layer of a texture.
pub(super) fn layer_view(map: &Texture, index: u32) -> TextureView {
    map.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: index,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

/// How every view is drawn into its layer of `map`: everything, or what lies behind the layers of another map.
pub(super) fn layers(
    gpu: &Gpu,
    settings: &Settings,
    lookup: &Lookup,
    map: &Texture,
    behind: Option<&Texture>,
) -> Vec<Layer> {
    let mut pipelines: Vec<(Raster, RenderPipeline)> = Vec::new();
    let layer = |(index, view): (u32, &View)| {
        let raster = Raster::of(settings, lookup, view);
        let known = pipelines.iter().find(|(known, _)| *known == raster).map(|(_, pipeline)| pipeline.clone());
        let pipeline = known.unwrap_or_else(|| {
            let built = raster.pipeline(gpu, settings, lookup, map.format(), behind.is_some());
            pipelines.push((raster, built.clone()));
            built
        });
        let uniform = gpu.uniform("caster", caster_uniform(settings, lookup, view));
        let nearer = behind.map(|nearer| layer_view(nearer, index));
        let mut resources = vec![uniform.as_entire_binding()];
        resources.extend(nearer.as_ref().map(BindingResource::TextureView));
        Layer {
            target: layer_view(map, index),
            bindings: gpu.bind(&pipeline.get_bind_group_layout(0), &resources),
            pipeline,
            clear_depth: view.cleared() as f32,
            pieces: view.drawn.as_ref().map(|drawn| piece_corners(gpu, drawn)),
            writes_depth: raster.writes_depth,
        }
    };
    (0..).zip(&lookup.views).map(layer).collect()
}

/// The corners of pieces; a buffer is never empty.
fn piece_corners(gpu: &Gpu, drawn: &Drawn) -> Buffer {
    let mut corners: Vec<[f32; 3]> =
        drawn.pieces.iter().flat_map(|piece| piece.corners_in_world).map(|corner| corner.to_array()).collect();
    corners.resize(corners.len().max(3), [0.0; 3]);
    gpu.buffer("pieces of casters", &corners, BufferUsages::VERTEX)
}

fn caster_uniform(settings: &Settings, lookup: &Lookup, view: &View) -> CasterUniform {
    let fixed_unit = match settings.format {
        DepthFormat::Depth32Float => 0.0,
        fixed => fixed.hardware_unit(1.0),
    };
    let units = f64::from(lookup.bias.constant_units);
    CasterUniform {
        clip_from_world: view.clip_from_world,
        depth_row: view.rows.depth.to_array(),
        depth_q_row: view.rows.depth_q.to_array(),
        bias_constant: (units * fixed_unit) as f32,
        bias_constant_ulps: if fixed_unit == 0.0 { units as f32 } else { 0.0 },
        bias_slope: lookup.bias.slope as f32,
        bias_clamp: lookup.bias.clamp as f32,
        depth_sign: view.depth_sign as f32,
        clamps: u32::from(settings.near_mode != NearMode::Extend),
        padding: [0; 2],
        u_row: view.rows.u.to_array(),
        v_row: view.rows.v.to_array(),
        q_row: view.rows.q.to_array(),
    }
}

/// What a view's pipeline depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Raster {
    depth_sign: f64,
    winding: f64,
    /// Whether the fragment shader writes depth, because the rasteriser's is not what is stored.
    writes_depth: bool,
    /// Whether pieces are drawn on a paraboloid's disc.
    on_disc: bool,
}

impl Raster {
    fn of(settings: &Settings, lookup: &Lookup, view: &View) -> Self {
        let on_disc = view.drawn.is_some();
        let has_own_depth = match settings.near_mode {
            NearMode::Extend => false,
            NearMode::DepthClamp => on_disc,
            NearMode::FragmentClamp => true,
        };
        Self {
            on_disc,
            depth_sign: view.depth_sign,
            winding: view.winding(lookup.light()),
            writes_depth: has_own_depth || settings.stores_midpoint() || (!on_disc && view.rows.depth_q != view.rows.q),
        }
    }

    fn pipeline(
        &self,
        gpu: &Gpu,
        settings: &Settings,
        lookup: &Lookup,
        format: TextureFormat,
        is_second: bool,
    ) -> RenderPipeline {
        let placed = if self.on_disc { CASTER_PARABOLOID } else { CASTER_ROWS };
        let own_depth = [CASTER_DEPTH, placed, if is_second { SECOND_LAYER } else { NEAREST_LAYER }];
        let bias = |amount: f64| if self.writes_depth { 0.0 } else { amount * self.depth_sign };
        gpu.render_pipeline(&Drawing {
            label: "map caster",
            files: if self.writes_depth || self.on_disc { &own_depth } else { &[CASTER] },
            vertices: &[Some(CORNER_LAYOUT)],
            primitive: PrimitiveState {
                front_face: if self.winding > 0.0 { FrontFace::Ccw } else { FrontFace::Cw },
                cull_mode: match settings.caster_sides {
                    CasterSides::All => None,
                    CasterSides::LightFacing => Some(Face::Back),
                    CasterSides::AwayFacing => Some(Face::Front),
                },
                unclipped_depth: settings.near_mode == NearMode::DepthClamp && !self.writes_depth,
                ..PrimitiveState::default()
            },
            depth_stencil: Some(DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(if self.depth_sign > 0.0 {
                    CompareFunction::Less
                } else {
                    CompareFunction::Greater
                }),
                stencil: Default::default(),
                bias: DepthBiasState {
                    constant: bias(lookup.bias.constant_units.into()) as i32,
                    slope_scale: bias(lookup.bias.slope) as f32,
                    clamp: bias(lookup.bias.clamp) as f32,
                },
            }),
            targets: if self.writes_depth { &[None] } else { &[] },
        })
    }
}
