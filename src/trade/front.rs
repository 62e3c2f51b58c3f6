//! The Pareto front: the configurations that no other one beats in both error and cost.

/// A configuration's figures; less is better in both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Share of wrong pixels, 0..=1.
    pub error: f64,
    /// Cost, in any unit.
    pub cost: f64,
}

/// Indices of the points that no other point beats in one figure without losing in the other, by rising cost. Of equal
/// points the first stands for all.
#[must_use]
pub fn front(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.cost.total_cmp(&b.cost).then(a.error.total_cmp(&b.error))
    });
    let mut best = f64::INFINITY;
    order.retain(|&index| {
        let is_better = points[index].error < best;
        best = best.min(points[index].error);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(error: f64, cost: f64) -> Point {
        Point { error, cost }
    }

    #[test]
    fn nothing_on_the_front_is_beaten_and_all_else_is() {
        let points: Vec<Point> = (1..=200_u32)
            .map(|i| point(f64::from(i.wrapping_mul(2_654_435_761) % 97), f64::from(i.wrapping_mul(40_503) % 89)))
            .collect();
        let beats = |a: &Point, b: &Point| a.error <= b.error && a.cost <= b.cost && a != b;
        let on_front = front(&points);
        for (index, own) in points.iter().enumerate() {
            let is_beaten = points.iter().any(|other| beats(other, own));
            let stands = on_front.iter().any(|&at| points[at] == *own);
            assert_eq!(stands, !is_beaten, "{index}");
        }
        assert!(on_front.len() > 1 && on_front.is_sorted_by(|a, b| points[*a].cost < points[*b].cost));
    }

    #[test]
    fn equal_points_stand_once() {
        assert_eq!(front(&[point(1.0, 2.0), point(1.0, 2.0), point(1.0, 3.0)]), [0]);
        assert_eq!(front(&[]), [0; 0]);
    }
}
