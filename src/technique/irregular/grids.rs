//! The light's grids: one parallel window for a directional light, up to six faces of a cube around any other, each
//! fitted to the receivers in it. `shaders/irregular/view.wgsl` and `rectangles.wgsl` are the twins.

use crate::scene::Light;
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec2, DVec3, UVec2, Vec3};

/// What of f32's rounding can reach a place in a window, relative to the distance of what is placed: about 20 roundings
/// are derived (differences, rotation, division, window), 64 taken.
const ROUNDING: f64 = 64.0 * 0.5 * f32::EPSILON as f64;
/// How far beyond its four sides a face is drawn, so that a receiver on the rim finds its casters.
const SLACK: f64 = 1e-3;
/// Share of a window that is added on each side, and its least width as a share of the distance.
const MARGIN: f64 = 1e-3;
/// Most faces.
pub(super) const FACES: usize = 6;

/// `Face` of `shaders/irregular/view.wgsl`: a window of cells.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct Face {
    x_axis: [f32; 3],
    first_x: f32,
    y_axis: [f32; 3],
    first_y: f32,
    forward: [f32; 3],
    parallel: f32,
    cells_per_unit: [f32; 2],
    padding: [f32; 2],
}

/// `View` of `shaders/irregular/view.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct ViewUniform {
    faces: [Face; FACES],
    anchor: [f32; 3],
    grid: u32,
    light: [f32; 4],
    face_count: u32,
    padding: u32,
    more_padding: [u32; 2],
}

/// The grids of one light.
#[derive(Debug, Clone)]
pub(super) struct Grids {
    /// Cells per side of a face.
    pub(super) grid: u32,
    /// The faces that hold receivers.
    pub(super) faces: Vec<Face>,
    /// For each of the six directions, the face that looks there.
    face_towards: [Option<usize>; FACES],
    axes: DMat3,
    anchor: Vec3,
    is_parallel: bool,
    light: [f32; 4],
}

/// Cells that a caster may cover, first and last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub(super) first: UVec2,
    pub(super) last: UVec2,
}

impl Grids {
    /// Fits grids of `grid` cells a side to the receivers' points.
    pub(super) fn fit(light: &Light, points: &[DVec3], grid: u32) -> Self {
        let light = light.homogeneous();
        let centre = middle(points);
        let is_parallel = light.w == 0.0;
        let (anchor, forward) =
            if is_parallel { (centre, light.truncate()) } else { (light.truncate(), centre - light.truncate()) };
        let forward = forward.try_normalize().unwrap_or(DVec3::Z);
        let (x, y) = forward.any_orthonormal_pair();
        let mut grids = Self {
            grid,
            faces: Vec::new(),
            face_towards: [None; FACES],
            axes: DMat3::from_cols(x, y, forward).transpose(),
            anchor: anchor.as_vec3(),
            is_parallel,
            light: light.as_vec4().to_array(),
        };
        for direction in 0..FACES {
            let inside: Vec<DVec3> = points.iter().copied().filter(|p| grids.direction_of(*p) == direction).collect();
            if !inside.is_empty() {
                grids.face_towards[direction] = Some(grids.faces.len());
                let face = grids.face(direction, &inside);
                grids.faces.push(face);
            }
        }
        grids
    }

    /// The window of one direction around some points.
    fn face(&self, direction: usize, points: &[DVec3]) -> Face {
        let axis = |i: usize| self.axes.row((direction / 2 + 1 + i) % 3).as_vec3();
        let turn = if direction.is_multiple_of(2) { 1.0 } else { -1.0 };
        let forward = if self.is_parallel { Vec3::ZERO } else { axis(2) * turn };
        let mut face = Face {
            x_axis: axis(0).to_array(),
            first_x: 0.0,
            y_axis: axis(1).to_array(),
            first_y: 0.0,
            forward: forward.to_array(),
            parallel: if self.is_parallel { 1.0 } else { 0.0 },
            cells_per_unit: [1.0; 2],
            padding: [0.0; 2],
        };
        let places: Vec<DVec2> = points.iter().map(|point| face.place(self.offset(*point))).collect();
        let (low, high) =
            places.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        let reach = if self.is_parallel {
            points.iter().map(|point| self.offset(*point).abs().max_element()).fold(f64::MIN_POSITIVE, f64::max)
        } else {
            1.0
        };
        // A cell narrower than rounding separates nothing.
        let least = 4.0 * ROUNDING * reach * f64::from(self.grid);
        let size = ((1.0 + 2.0 * MARGIN) * (high - low)).max(DVec2::splat(least));
        let first = 0.5 * (low + high - size);
        [face.first_x, face.first_y] = first.as_vec2().to_array();
        face.cells_per_unit = (f64::from(self.grid) / size).as_vec2().to_array();
        face
    }

    fn offset(&self, point: DVec3) -> DVec3 {
        point - self.anchor.as_dvec3()
    }

    /// The axis along which a point is farthest from the light, times two, plus one if backwards. Parallel rays have one.
    fn direction_of(&self, point: DVec3) -> usize {
        if self.is_parallel {
            return FORWARD;
        }
        let along = self.axes * self.offset(point);
        let size = along.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        2 * axis + usize::from(along[axis] < 0.0)
    }

    /// The face that holds a receiver.
    pub(super) fn face_of(&self, point: DVec3) -> usize {
        self.face_towards[self.direction_of(point)].unwrap_or_default()
    }

    /// The cell that holds a receiver; `None` if there is none, which would be a bug of the fit.
    pub(super) fn cell_of(&self, point: DVec3) -> Option<(usize, UVec2)> {
        let index = self.face_towards[self.direction_of(point)]?;
        let face = &self.faces[index];
        let at = face.position_in_cells(face.place(self.offset(point)));
        let is_inside = at.min_element() >= 0.0 && at.max_element() < f64::from(self.grid);
        is_inside.then(|| (index, self.cell_at(at)))
    }

    /// What lies beyond the rim belongs to the cells along it.
    fn cell_at(&self, position_in_cells: DVec2) -> UVec2 {
        position_in_cells.floor().clamp(DVec2::ZERO, DVec2::splat(f64::from(self.grid - 1))).as_uvec2()
    }

    /// The cells of a face that may hold receivers in the shadow of a triangle; `None` if none can.
    pub(super) fn rectangle(&self, face: usize, corners: [DVec3; 3]) -> Option<Rectangle> {
        let face = &self.faces[face];
        let offsets = corners.map(|corner| self.offset(corner));
        let reach = offsets.iter().map(|offset| offset.abs().max_element()).fold(0.0, f64::max);
        let rounding = ROUNDING * reach;
        let mut polygon = offsets.map(|offset| face.in_face(offset)).to_vec();
        if !self.is_parallel {
            for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                polygon = clipped(&polygon, DVec3::new(x, y, 1.0 + SLACK), rounding);
            }
        }
        let nearest = polygon.iter().map(|corner| corner.z).reduce(f64::min)?;
        let whole = Rectangle { first: UVec2::ZERO, last: UVec2::splat(self.grid - 1) };
        // Next to the light no direction is certain.
        if nearest <= rounding {
            return Some(whole);
        }
        let places = polygon.iter().map(|corner| corner.truncate() / corner.z);
        let (low, high) =
            places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let pad = rounding / nearest;
        let (low, high) = (face.position_in_cells(low - pad), face.position_in_cells(high + pad));
        let is_beside = high.min_element() < 0.0 || low.max_element() > f64::from(self.grid);
        (!is_beside).then(|| Rectangle { first: self.cell_at(low), last: self.cell_at(high) })
    }

    pub(super) fn uniform(&self) -> ViewUniform {
        let mut faces = [Face::zeroed(); FACES];
        faces[..self.faces.len()].copy_from_slice(&self.faces);
        ViewUniform {
            faces,
            anchor: self.anchor.to_array(),
            grid: self.grid,
            light: self.light,
            face_count: self.faces.len() as u32,
            padding: 0,
            more_padding: [0; 2],
        }
    }
}

/// The direction of the third axis.
const FORWARD: usize = 4;

impl Face {
    /// (x q, y q, q) of a point given relative to the anchor.
    fn in_face(&self, offset: DVec3) -> DVec3 {
        let along = |axis: [f32; 3]| Vec3::from_array(axis).as_dvec3().dot(offset);
        DVec3::new(along(self.x_axis), along(self.y_axis), along(self.forward) + f64::from(self.parallel))
    }

    fn place(&self, offset: DVec3) -> DVec2 {
        let in_face = self.in_face(offset);
        in_face.truncate() / in_face.z
    }

    fn position_in_cells(&self, place: DVec2) -> DVec2 {
        let [x, y] = self.cells_per_unit;
        (place - DVec2::new(self.first_x.into(), self.first_y.into())) * DVec2::new(x.into(), y.into())
    }
}

/// The middle of the box around some points; the origin without any.
fn middle(points: &[DVec3]) -> DVec3 {
    crate::scene::Bounds::of(points.iter().copied()).map_or(DVec3::ZERO, |bounds| bounds.centre())
}

/// The part of a polygon on the inner side of a plane through the light, which rounding may move out by `rounding`.
fn clipped(polygon: &[DVec3], plane: DVec3, rounding: f64) -> Vec<DVec3> {
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (i, &to) in polygon.iter().enumerate() {
        let before = polygon[(i + polygon.len() - 1) % polygon.len()];
        let (depth_to, depth_before) = (plane.dot(to) + rounding, plane.dot(before) + rounding);
        if (depth_to >= 0.0) != (depth_before >= 0.0) {
            inside.push(before.lerp(to, depth_before / (depth_before - depth_to)));
        }
        if depth_to >= 0.0 {
            inside.push(to);
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::layout::{rust_layout, wgsl_layout};
    use crate::gpu::shader::wgsl;
    use crate::scene::LightKind;
    use glam::DVec4;

    #[test]
    fn the_uniform_lies_as_the_shaders_read_it() {
        let files = [wgsl!("irregular/view.wgsl")];
        let face = rust_layout!(Face { x_axis, first_x, y_axis, first_y, forward, parallel, cells_per_unit, padding });
        assert_eq!(wgsl_layout(&files, "Face"), face);
        let view = rust_layout!(ViewUniform { faces, anchor, grid, light, face_count, padding, more_padding });
        assert_eq!(wgsl_layout(&files, "View"), view);
    }

    /// Points all around the origin, on a lattice that hits axes and diagonals.
    fn around() -> Vec<DVec3> {
        let range = [-3.0, -1.0, -0.5, 0.0, 0.5, 1.0, 3.0];
        let lattice = range.into_iter().flat_map(|x| range.into_iter().map(move |y| (x, y)));
        let lattice = lattice.flat_map(|(x, y)| range.into_iter().map(move |z| DVec3::new(x, y, z)));
        lattice.filter(|p| p.length() > 0.1).collect()
    }

    fn light(homogeneous: DVec4) -> Light {
        let position = homogeneous.truncate().as_vec3();
        let kind = if homogeneous.w == 0.0 {
            LightKind::Directional { towards_light: position }
        } else {
            LightKind::Point { position, aim: Vec3::ZERO, attenuation: [1.0, 0.0, 0.0] }
        };
        Light { name: "light".into(), kind, intensity: Vec3::ONE, range_m: f64::INFINITY }
    }

    /// A triangle that the segment from a receiver to the light crosses must cover the receiver's cell.
    #[test]
    fn whatever_blocks_a_receiver_covers_its_cell() {
        let points = around();
        for homogeneous in [DVec4::new(0.01, 0.02, -0.03, 1.0), DVec4::new(0.3, 0.8, -0.5, 0.0)] {
            for grid in [1, 7, 64] {
                let grids = Grids::fit(&light(homogeneous), &points, grid);
                assert_eq!(grids.faces.len(), if homogeneous.w == 0.0 { 1 } else { FACES });
                for (i, &point) in points.iter().enumerate() {
                    let (face, cell) = grids.cell_of(point).unwrap();
                    assert_eq!(face, grids.face_of(point));
                    let towards = homogeneous.truncate() - homogeneous.w * point;
                    let through = point + 0.4 * towards;
                    // Small, large and far off to one side: the segment leaves through the first corner's neighbourhood.
                    let spread = [0.01, 1.0, 40.0][i % 3];
                    let (u, v) = towards.normalize().any_orthonormal_pair();
                    let corners = [through - 0.01 * (u + v), through + spread * u, through + spread * v];
                    let covers = |r: Rectangle| cell.cmpge(r.first).all() && cell.cmple(r.last).all();
                    assert!(grids.rectangle(face, corners).is_some_and(covers), "{point} {grid}");
                }
            }
        }
    }

    #[test]
    fn small_triangles_cover_few_cells_and_none_behind_the_light() {
        let grids = Grids::fit(&light(DVec4::new(0.0, 0.0, 0.0, 1.0)), &around(), 64);
        let small = [DVec3::new(2.0, 0.3, 0.3), DVec3::new(2.0, 0.31, 0.3), DVec3::new(2.0, 0.3, 0.31)];
        let covered: Vec<Rectangle> = (0..FACES).filter_map(|face| grids.rectangle(face, small)).collect();
        assert_eq!(covered.len(), 1);
        assert!((covered[0].last - covered[0].first).max_element() <= 1);
        // A plate that passes beside the light is seen by the four faces it crosses, not by those it is parallel to.
        let plate = [DVec3::new(9.0, 9.0, 1.0), DVec3::new(-9.0, 0.0, 1.0), DVec3::new(9.0, -9.0, 1.0)];
        assert!((0..FACES).filter(|&face| grids.rectangle(face, plate).is_some()).count() == 5);
    }
}
