//! The tree over the casters' boxes: topology by obvhs (PLOC: Meister and Bittner, "Parallel Locally-Ordered Clustering
//! for Bounding Volume Hierarchy Construction", 2018), boxes and traversal our own.
//!
//! The builder sees the boxes scaled to unit size, so its single-precision areas neither overflow nor vanish at any
//! scale of the scene. The boxes that rays are tested against come from the triangles themselves and are padded:
//! a ray that runs along the side of a box must not be lost by lying on two of its planes at once.

use super::packed::{larger, smaller};
use super::ray::Ray;
use crate::scene::Bounds;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use std::ops::{ControlFlow, Range};
use std::time::Duration;

/// Boxes grow by this share of the largest coordinate: 4 ulp in f32.
const PADDING: f64 = 4.0 * f32::EPSILON as f64;
/// Trees up to this height are walked with a stack that needs no allocation.
const USUAL_HEIGHT: usize = 64;

/// An inner node with the boxes of both its children, one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Node {
    /// `planes[axis][side][child]`; side 0 is the minimum.
    planes: [[[f32; 2]; 2]; 3],
    /// Per child its node, or the first of its triangles.
    first: [u32; 2],
    /// Per child how many triangles it has if it is a leaf, else 0.
    count: [u32; 2],
}

/// A binary tree over triangles; empty without triangles.
#[derive(Debug)]
pub(super) struct Tree {
    /// Root first.
    nodes: Vec<Node>,
    /// Levels of nodes: the most that a walk has to remember.
    height: usize,
}

/// A part of the tree as its parent sees it.
#[derive(Debug, Clone, Copy)]
struct Child {
    min: Vec3,
    max: Vec3,
    first: u32,
    count: u32,
    height: usize,
}

impl Child {
    /// Neither entered nor visited by any ray.
    const NOTHING: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY, first: 0, count: 0, height: 0 };
}

impl Tree {
    /// The tree over some triangles, and the order (of indices into `triangles`) in which its leaves list them.
    pub(super) fn build(triangles: &[[Vec3; 3]]) -> (Self, Vec<u32>) {
        if triangles.is_empty() {
            return (Self { nodes: Vec::new(), height: 0 }, Vec::new());
        }
        let boxes = unit_boxes(triangles);
        let topology = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let padding = PADDING * largest_coordinate(triangles);
        (Self::from_topology(&topology, triangles, padding), topology.primitive_indices)
    }

    /// Takes over the builder's nodes, children before parents, with boxes made anew from the triangles.
    fn from_topology(topology: &Bvh2, triangles: &[[Vec3; 3]], padding: f64) -> Self {
        let order = parents_first(topology);
        let inner_nodes = order.iter().filter(|&&old| !topology.nodes[old as usize].is_leaf());
        let mut node_of = vec![0; topology.nodes.len()];
        for (new, &old) in (0..).zip(inner_nodes) {
            node_of[old as usize] = new;
        }
        let mut children = vec![Child::NOTHING; topology.nodes.len()];
        let mut nodes = Vec::new();
        for &old in order.iter().rev() {
            let node = &topology.nodes[old as usize];
            let first = node.first_index as usize;
            children[old as usize] = if node.is_leaf() {
                let range = first..first + node.prim_count as usize;
                leaf(node, topology.primitive_indices[range].iter().map(|&i| triangles[i as usize]), padding)
            } else {
                let pair = [children[first], children[first + 1]];
                nodes.push(Node::new(pair));
                inner(node_of[old as usize], pair)
            };
        }
        if nodes.is_empty() {
            nodes.push(Node::new([children[0], Child::NOTHING]));
        }
        nodes.reverse();
        Self { nodes, height: children[0].height }
    }

    /// Calls `visit` with the triangles of every leaf that the ray enters between its start and the limit: 1 at first,
    /// then what `visit` makes of it. Nearer leaves tend to come first. `Break` ends the walk.
    #[inline]
    pub(super) fn walk(&self, ray: &Ray, visit: impl FnMut(Range<usize>, &mut f64) -> ControlFlow<()>) {
        if self.nodes.is_empty() {
            return;
        }
        // A walk leaves at most one node per level for later. Whether it ended early, only the caller's `visit` cares.
        let _ = if self.height <= USUAL_HEIGHT {
            self.walk_with(&mut [0; USUAL_HEIGHT], ray, visit)
        } else {
            self.walk_with(&mut vec![0; self.height], ray, visit)
        };
    }

    #[inline]
    fn walk_with(
        &self,
        stack: &mut [u32],
        ray: &Ray,
        mut visit: impl FnMut(Range<usize>, &mut f64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (mut current, mut pending, mut limit) = (0, 0, 1.0);
        loop {
            let node = &self.nodes[current as usize];
            let [left, right] = node.entries(ray, limit);
            let (near, far) = if right.at < left.at { (right, left) } else { (left, right) };
            let mut next = None;
            if near.at <= limit {
                if near.count > 0 {
                    visit(near.triangles(), &mut limit)?;
                } else {
                    next = Some(near.first);
                }
                // The visit may have lowered the limit.
                if far.at <= limit {
                    if far.count > 0 {
                        visit(far.triangles(), &mut limit)?;
                    } else if next.is_none() {
                        next = Some(far.first);
                    } else {
                        stack[pending] = far.first;
                        pending += 1;
                    }
                }
            }
            current = match next {
                Some(node) => node,
                None if pending == 0 => return ControlFlow::Continue(()),
                None => {
                    pending -= 1;
                    stack[pending]
                }
            };
        }
    }
}

/// A child that a ray may enter.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// Where along the ray, at least 0; infinite if never.
    at: f64,
    first: u32,
    count: u32,
}

impl Entry {
    fn triangles(self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

impl Node {
    fn new(children: [Child; 2]) -> Self {
        let plane = |axis: usize| [children.map(|child| child.min[axis]), children.map(|child| child.max[axis])];
        Self {
            planes: std::array::from_fn(plane),
            first: children.map(|child| child.first),
            count: children.map(|child| child.count),
        }
    }

    /// Where the ray enters the box of each child; never if that is beyond `limit`. Inlined always: the compiler would
    /// otherwise return the entries through memory, at half the speed.
    #[inline(always)]
    fn entries(&self, ray: &Ray, limit: f64) -> [Entry; 2] {
        let (mut entry, mut exit) = ([0.0; 2], [limit; 2]);
        for (sides, slab) in self.planes.iter().zip(&ray.slabs) {
            let (near, far) = (sides[slab.entry_side & 1], sides[1 - (slab.entry_side & 1)]);
            for child in 0..2 {
                entry[child] = larger(entry[child], (f64::from(near[child]) - slab.entry_origin) * slab.inverse);
                exit[child] = smaller(exit[child], (f64::from(far[child]) - slab.exit_origin) * slab.inverse);
            }
        }
        let at = |child: usize| if entry[child] <= exit[child] { entry[child] } else { f64::INFINITY };
        std::array::from_fn(|child| Entry { at: at(child), first: self.first[child], count: self.count[child] })
    }
}

/// The builder's nodes, every parent before its children.
fn parents_first(topology: &Bvh2) -> Vec<u32> {
    let (mut order, mut pending) = (Vec::with_capacity(topology.nodes.len()), vec![0]);
    while let Some(index) = pending.pop() {
        order.push(index);
        let node = &topology.nodes[index as usize];
        if !node.is_leaf() {
            pending.extend([node.first_index + 1, node.first_index]);
        }
    }
    order
}

/// A leaf's padded box.
fn leaf(node: &Bvh2Node, triangles: impl Iterator<Item = [Vec3; 3]>, padding: f64) -> Child {
    let (min, max) =
        triangles.flatten().fold((Child::NOTHING.min, Child::NOTHING.max), |(min, max), v| (min.min(v), max.max(v)));
    Child {
        // Rounding to f32 may pull the padded side back; the next number is certainly outside it.
        min: min.map(|x| ((f64::from(x) - padding) as f32).next_down()),
        max: max.map(|x| ((f64::from(x) + padding) as f32).next_up()),
        first: node.first_index,
        count: node.prim_count,
        height: 0,
    }
}

/// An inner node's box around its children's.
fn inner(node: u32, [a, b]: [Child; 2]) -> Child {
    Child { min: a.min.min(b.min), max: a.max.max(b.max), first: node, count: 0, height: 1 + a.height.max(b.height) }
}

/// The triangles' boxes after the scene was moved and scaled to the unit cube.
fn unit_boxes(triangles: &[[Vec3; 3]]) -> Vec<Aabb> {
    let bounds = Bounds::of(triangles.iter().flatten().map(|corner| corner.as_dvec3()));
    let (centre, extent) = bounds.map_or((DVec3::ZERO, 0.0), |b| (b.centre(), (b.max - b.min).max_element()));
    let scale = if extent > 0.0 { 1.0 / extent } else { 1.0 };
    let to_unit = |corner: Vec3| Vec3A::from((scale * (corner.as_dvec3() - centre)).as_vec3());
    triangles.iter().map(|corners| Aabb::from_points(&corners.map(to_unit))).collect()
}

/// The largest coordinate, by absolute value.
fn largest_coordinate(triangles: &[[Vec3; 3]]) -> f64 {
    triangles.iter().flatten().map(|corner| f64::from(corner.abs().max_element())).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Segment;

    fn strip(count: u16) -> Vec<[Vec3; 3]> {
        (0..count)
            .map(f32::from)
            .map(|i| [Vec3::new(i, 0.0, 0.0), Vec3::new(i + 1.0, 0.0, 0.0), Vec3::new(i, 1.0, 0.0)])
            .collect()
    }

    fn visited(tree: &Tree, segment: &Segment, bounds: &Bounds) -> Vec<usize> {
        let mut leaves = Vec::new();
        tree.walk(&Ray::new(segment, bounds, 0.0).unwrap(), |leaf, _| {
            leaves.extend(leaf);
            ControlFlow::Continue(())
        });
        leaves
    }

    #[test]
    fn every_triangle_is_in_one_leaf_and_in_all_boxes_above_it() {
        for count in [0, 1, 2, 3, 9, 1000] {
            let triangles = strip(count);
            let (tree, mut order) = Tree::build(&triangles);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..u32::from(count)));
            let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(f64::from(count), 1.0, 0.0) };
            let along = Segment { from: DVec3::new(-1.0, 0.0, 0.0), to: DVec3::new(f64::from(count) + 1.0, 0.0, 0.0) };
            let mut leaves = visited(&tree, &along, &bounds);
            leaves.sort_unstable();
            assert!(leaves.into_iter().eq(0..usize::from(count)), "{count}");
        }
    }

    #[test]
    fn a_tree_deeper_than_usual_is_walked_all_the_same() {
        let triangles = strip(1000);
        let (mut tree, _) = Tree::build(&triangles);
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(1000.0, 1.0, 0.0) };
        let along = Segment { from: DVec3::new(-1.0, 0.5, 0.0), to: DVec3::new(1001.0, 0.5, 0.0) };
        let usual = visited(&tree, &along, &bounds);
        tree.height = USUAL_HEIGHT + 1;
        assert_eq!(visited(&tree, &along, &bounds), usual);
    }

    #[test]
    fn a_ray_beside_the_padding_visits_nothing() {
        let (tree, _) = Tree::build(&strip(100));
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(100.0, 1.0, 0.0) };
        let beside = Segment { from: DVec3::new(-1.0, 0.5, 0.01), to: DVec3::new(101.0, 0.5, 0.01) };
        assert_eq!(visited(&tree, &beside, &bounds), Vec::<usize>::new());
    }
}
