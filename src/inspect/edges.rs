//! The directed-edge table: how often the faces of a mesh run along each edge, and in which direction.
//!
//! A surface is closed when every edge is run as often forward as backward, so that the sum of all face boundaries is
//! zero; it is a 2-manifold when both counts are one. Faces with a repeated vertex enclose nothing and cancel against
//! themselves: they are left out.

/// An undirected edge with its uses by directed faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The smaller welded index.
    pub low: u32,
    /// The larger welded index.
    pub high: u32,
    /// Faces that run from `low` to `high`.
    pub forward: u32,
    /// Faces that run from `high` to `low`.
    pub backward: u32,
}

impl Edge {
    /// Faces at this edge.
    #[must_use]
    pub fn faces(&self) -> u32 {
        self.forward + self.backward
    }
    /// The edge bounds one face only: the surface ends here.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.faces() == 1
    }
    /// More than two faces meet here.
    #[must_use]
    pub fn is_non_manifold(&self) -> bool {
        self.faces() > 2
    }
    /// Two faces meet here and disagree about which side is outside.
    #[must_use]
    pub fn is_inconsistent(&self) -> bool {
        self.faces() == 2 && self.forward != self.backward
    }
    /// The faces' boundaries cancel here.
    #[must_use]
    pub fn is_balanced(&self) -> bool {
        self.forward == self.backward
    }
    /// Exactly two faces meet here, and they agree about the outside.
    #[must_use]
    pub fn is_manifold(&self) -> bool {
        self.forward == 1 && self.backward == 1
    }
}

/// Whether a triangle repeats a welded index, and so is no face.
#[must_use]
pub fn is_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// The edges of triangles given by welded indices, sorted by (`low`, `high`).
#[must_use]
pub fn edges_of(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let faces = triangles.iter().filter(|&&corners| !is_collapsed(corners));
    let mut runs: Vec<(u32, u32, bool)> = faces
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(from, to)| (from.min(to), from.max(to), from < to))
        .collect();
    runs.sort_unstable();
    runs.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1))
        .map(|uses| {
            let forward = uses.iter().filter(|&&(_, _, is_forward)| is_forward).count();
            let (low, high, _) = uses[0];
            Edge { low, high, forward: forward as u32, backward: (uses.len() - forward) as u32 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_faces_share_one_balanced_edge() {
        let edges = edges_of(&[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(edges.len(), 5);
        let shared = Edge { low: 1, high: 2, forward: 1, backward: 1 };
        assert!(edges.contains(&shared) && shared.is_manifold());
        assert_eq!(edges.iter().filter(|edge| edge.is_open()).count(), 4);
    }

    #[test]
    fn a_face_the_wrong_way_round_is_inconsistent() {
        let edges = edges_of(&[[0, 1, 2], [1, 2, 3]]);
        assert_eq!(edges.iter().filter(|edge| edge.is_inconsistent()).count(), 1);
        assert!(edges.iter().all(|edge| !edge.is_balanced()));
    }

    #[test]
    fn three_faces_at_an_edge_are_non_manifold() {
        let edges = edges_of(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        let crowded: Vec<_> = edges.iter().filter(|edge| edge.is_non_manifold()).collect();
        assert_eq!(crowded, [&Edge { low: 0, high: 1, forward: 2, backward: 1 }]);
    }

    #[test]
    fn a_collapsed_triangle_has_no_edges() {
        assert_eq!(edges_of(&[[3, 3, 5], [1, 2, 1], [4, 0, 0]]), []);
    }
}
