//! A k-d tree over points that answers which of them are near a line segment (J. L. Bentley, "Multidimensional Binary
//! Search Trees Used for Associative Searching", 1975).
//!
//! The tree is implicit: the middle of a range of `points` is its node, the halves beside it are its children. Nodes
//! split the widest axis of their points at the median, so neither clusters nor long segments spoil it.

use glam::DVec3;
use std::ops::Range;

/// Points in tree order, each with a name.
pub(super) struct PointTree {
    points: Vec<(DVec3, u32)>,
    /// The axis at which the node at this index splits.
    axes: Vec<usize>,
}

impl PointTree {
    /// Builds the tree in O(n log n).
    pub(super) fn build(mut points: Vec<(DVec3, u32)>) -> Self {
        let mut axes = vec![0; points.len()];
        split(&mut points, &mut axes);
        Self { points, axes }
    }

    /// Calls `found` with every point that may be within `reach` of the segment from `a` to `b`: all that are, and
    /// some that are not.
    pub(super) fn near_segment(&self, a: DVec3, b: DVec3, reach: f64, found: &mut impl FnMut(DVec3, u32)) {
        self.visit(0..self.points.len(), a, b, reach, found);
    }

    fn visit(&self, range: Range<usize>, a: DVec3, b: DVec3, reach: f64, found: &mut impl FnMut(DVec3, u32)) {
        if range.is_empty() {
            return;
        }
        let node = middle(range.len()) + range.start;
        let (point, name) = self.points[node];
        let axis = self.axes[node];
        let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
        let (below, above) = (point[axis] - reach, point[axis] + reach);
        if a[axis] <= above {
            self.visit(range.start..node, a, cut(a, b, axis, above), reach, found);
        }
        if b[axis] >= below {
            self.visit(node + 1..range.end, cut(b, a, axis, below), b, reach, found);
        }
        found(point, name);
    }
}

/// `to`, drawn towards `from` as far as the plane `axis = at` if that lies between the two.
fn cut(from: DVec3, to: DVec3, axis: usize, at: f64) -> DVec3 {
    let share = (at - from[axis]) / (to[axis] - from[axis]);
    if (0.0..1.0).contains(&share) { from.lerp(to, share) } else { to }
}

fn middle(len: usize) -> usize {
    len / 2
}

fn split(points: &mut [(DVec3, u32)], axes: &mut [usize]) {
    let Some(&(first, _)) = points.first() else { return };
    let (min, max) = points.iter().fold((first, first), |(min, max), (p, _)| (min.min(*p), max.max(*p)));
    let axis = (max - min).max_position();
    let node = middle(points.len());
    points.select_nth_unstable_by(node, |(p, _), (q, _)| p[axis].total_cmp(&q[axis]));
    axes[node] = axis;
    split(&mut points[..node], &mut axes[..node]);
    split(&mut points[node + 1..], &mut axes[node + 1..]);
}
