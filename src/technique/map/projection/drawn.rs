//! What a rasteriser makes of pieces of casters in one view, in f64: triangles with straight edges between projected
//! corners, over which depth changes linearly. Where a layout bends edges this differs from the casters themselves, and
//! the difference is the chord error.

use super::View;
use super::pieces::{Piece, halfway};
use glam::{DVec2, DVec3, UVec2};
use std::sync::OnceLock;

/// Most cells along a side of the grid that finds pieces by their place.
const MOST_CELLS: u32 = 512;

/// Pieces that are drawn in place of the casters.
#[derive(Debug)]
pub(in crate::technique::map) struct Drawn {
    pub(in crate::technique::map) pieces: Vec<Piece>,
    /// Largest angle that an edge spans as seen from the light, radians; 0 where there is no limit.
    pub(super) longest_rad: f64,
    grid: OnceLock<Grid>,
}

/// A piece at a place in the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::technique::map) struct Cover {
    /// Triangle id of the caster.
    pub(in crate::technique::map) caster: u32,
    /// Depth at that place, as the rasteriser interpolates it.
    pub(in crate::technique::map) depth: f64,
    /// Largest depth of its corners.
    pub(in crate::technique::map) largest_depth: f64,
    /// Change of depth from one texel to the next, the larger of both axes.
    pub(in crate::technique::map) slope_per_texel: f64,
    /// Whether the rasteriser sees the side that the light reaches.
    pub(in crate::technique::map) faces_light: bool,
}

/// Projected pieces by the cells of the map that they may touch.
#[derive(Debug)]
struct Grid {
    cells: u32,
    /// Where the indices of each cell begin.
    starts: Vec<u32>,
    indices: Vec<u32>,
    projected: Vec<Projected>,
}

/// A piece as it is drawn: corners in texels, and their depths.
#[derive(Debug, Clone, Copy)]
struct Projected {
    corners: [DVec2; 3],
    depths: DVec3,
}

impl Drawn {
    /// Of pieces whose edges span no more than that.
    pub(super) fn new(pieces: Vec<Piece>, longest_rad: f64) -> Self {
        Self { pieces, longest_rad, grid: OnceLock::new() }
    }

    /// Calls `found` with every piece that covers a place in the view.
    pub(in crate::technique::map) fn at(&self, view: &View, position_in_texels: DVec2, found: &mut dyn FnMut(Cover)) {
        let grid = self.grid.get_or_init(|| Grid::of(view, &self.pieces));
        for index in grid.near(position_in_texels / view.texels.as_dvec2()) {
            let piece = &grid.projected[*index as usize];
            if let Some(cover) = piece.cover(self.pieces[*index as usize].caster, position_in_texels) {
                found(cover);
            }
        }
    }

    /// The farthest that an edge is drawn beside where it should be, texels: at the middle of its angle.
    pub(super) fn chord_error_texels(&self, view: &View, light: DVec3) -> f64 {
        let place = |seen: DVec3| view.project(light + seen).uv * view.texels.as_dvec2();
        let error = |from: DVec3, to: DVec3| {
            let [start, end, middle] = [from, to, halfway(from, to)].map(place);
            (end - start).try_normalize().map_or(0.0, |along| along.perp_dot(middle - start).abs())
        };
        let of_piece = |piece: &Piece| {
            let [a, b, c] = piece.corners_in_world.map(|corner| corner.as_dvec3() - light);
            error(a, b).max(error(b, c)).max(error(c, a))
        };
        self.pieces.iter().map(of_piece).fold(0.0, f64::max)
    }
}

impl Projected {
    /// `None` where it does not cover the place.
    fn cover(&self, caster: u32, place: DVec2) -> Option<Cover> {
        let [a, b, c] = self.corners;
        let area = (b - a).perp_dot(c - a);
        let shares = DVec3::new(
            (b - place).perp_dot(c - place),
            (c - place).perp_dot(a - place),
            (a - place).perp_dot(b - place),
        ) / area;
        if area == 0.0 || shares.min_element() < 0.0 {
            return None;
        }
        let rise = DVec2::new(self.depths.y - self.depths.x, self.depths.z - self.depths.x);
        let slope = DVec2::new(rise.x * (c - a).y - rise.y * (b - a).y, rise.y * (b - a).x - rise.x * (c - a).x) / area;
        Some(Cover {
            caster,
            depth: shares.dot(self.depths),
            largest_depth: self.depths.max_element(),
            slope_per_texel: slope.abs().max_element(),
            // Seen from the light, which looks into the map, counter-clockwise is clockwise where v points down.
            faces_light: area < 0.0,
        })
    }
}

impl Grid {
    fn of(view: &View, pieces: &[Piece]) -> Self {
        let texels = view.texels.as_dvec2();
        let project = |piece: &Piece| {
            let [a, b, c] = piece.corners_in_world.map(|corner| view.project(corner.as_dvec3()));
            Projected { corners: [a, b, c].map(|at| at.uv * texels), depths: DVec3::new(a.depth, b.depth, c.depth) }
        };
        let projected: Vec<Projected> = pieces.iter().map(project).collect();
        let cells = ((pieces.len() as f64).sqrt() as u32).clamp(1, MOST_CELLS);
        let mut counts = vec![0_u32; (cells * cells) as usize + 1];
        let touched = |piece: &Projected| {
            let [a, b, c] = piece.corners;
            let cell = |place: DVec2| {
                (place / texels * f64::from(cells)).clamp(DVec2::ZERO, DVec2::splat(f64::from(cells - 1))).as_uvec2()
            };
            let (low, high) = (cell(a.min(b).min(c)), cell(a.max(b).max(c)));
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| (y * cells + x) as usize))
        };
        for cell in projected.iter().flat_map(touched) {
            counts[cell + 1] += 1;
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let (starts, mut next) = (counts.clone(), counts);
        let mut indices = vec![0; starts.last().map_or(0, |count| *count as usize)];
        for (index, piece) in (0..).zip(&projected) {
            for cell in touched(piece) {
                indices[next[cell] as usize] = index;
                next[cell] += 1;
            }
        }
        Self { cells, starts, indices, projected }
    }

    /// The pieces that may cover a place; `uv` in 0..1.
    fn near(&self, uv: DVec2) -> &[u32] {
        let cells = f64::from(self.cells);
        let UVec2 { x, y } = (uv * cells).clamp(DVec2::ZERO, DVec2::splat(cells - 1.0)).as_uvec2();
        let cell = (y * self.cells + x) as usize;
        &self.indices[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::map::projection::paraboloid::tests::view;

    fn drawn(corners: [DVec3; 3]) -> Drawn {
        Drawn::new(vec![Piece { corners_in_world: corners.map(|corner| corner.as_vec3()), caster: 3 }], 0.0)
    }

    /// R − √(R² − a²) with R = 1/sin c and a = sin t/(1 + cos c cos t), in half widths of the map, for an edge of half-angle
    /// t across the radius whose middle lies c from the axis.
    #[test]
    fn an_edge_is_off_by_the_closed_form() {
        let view = view(2000);
        for (half_deg, from_axis_deg, expected) in
            [(10.0_f64, 45.0_f64, 0.0037), (10.0, 80.0, 0.0109), (45.0, 45.0, 0.081), (45.0, 80.0, 0.219)]
        {
            let (t, c) = (half_deg.to_radians(), from_axis_deg.to_radians());
            let middle = DVec3::new(c.sin(), 0.0, c.cos());
            let end = |side: f64| 2.0 * (middle * t.cos() + side * t.sin() * DVec3::Y);
            // The third corner makes both other edges meridians' neighbours, which are shorter in the map.
            let found = drawn([end(-1.0), end(1.0), end(1.0)]).chord_error_texels(&view, DVec3::ZERO) / 1000.0;
            let (r, a) = (1.0 / c.sin(), t.sin() / (1.0 + c.cos() * t.cos()));
            let closed_form = r - (r * r - a * a).sqrt();
            assert!((closed_form - expected).abs() < 5e-4, "{closed_form}");
            assert!((found / closed_form - 1.0).abs() < 1e-3, "{half_deg} {from_axis_deg}: {found} {closed_form}");
        }
    }

    #[test]
    fn edges_through_the_axis_are_straight() {
        let view = view(2000);
        let meridian = drawn([DVec3::new(2.0, 0.0, 1.0), DVec3::new(-1.0, 0.0, 1.0), DVec3::new(-1.0, 0.0, 1.0)]);
        assert!(meridian.chord_error_texels(&view, DVec3::ZERO) < 1e-9);
    }

    #[test]
    fn a_piece_covers_its_triangle_with_its_depths() {
        let view = view(100);
        let corners = [DVec3::new(-1.0, -1.0, 2.0), DVec3::new(1.0, -1.0, 3.0), DVec3::new(0.0, 1.5, 4.0)];
        let drawn = drawn(corners);
        let placed = corners.map(|corner| view.project(corner));
        let centre = placed.iter().map(|at| at.uv).sum::<DVec2>() / 3.0 * 100.0;
        let covers = |place: DVec2| {
            let mut found = Vec::new();
            drawn.at(&view, place, &mut |cover| found.push(cover));
            found
        };
        let found = covers(centre);
        assert_eq!(found.len(), 1);
        let mean = placed.iter().map(|at| at.depth).sum::<f64>() / 3.0;
        assert!((found[0].depth - mean).abs() < 1e-7 && found[0].caster == 3);
        // A step along u changes depth by no more than the slope says.
        let beside = covers(centre + DVec2::X)[0].depth;
        assert!((beside - found[0].depth).abs() <= found[0].slope_per_texel * (1.0 + 1e-9));
        assert_eq!(covers(DVec2::new(3.0, 3.0)), []);
        assert!(covers(centre)[0].faces_light != drawn_backwards(corners, &view, centre));
    }

    fn drawn_backwards([a, b, c]: [DVec3; 3], view: &View, place: DVec2) -> bool {
        let mut faces = false;
        drawn([a, c, b]).at(view, place, &mut |cover| faces = cover.faces_light);
        faces
    }
}
