//! Connected components of a mesh: faces that share a welded vertex belong together (union–find with path halving; R.
//! Tarjan, "Efficiency of a Good But Not Linear Set Union Algorithm", 1975).

/// Vertices of the faces, and how many connected pieces the faces form. Indices are below `vertex_count`.
pub(super) fn vertices_and_components(faces: &[[u32; 3]], vertex_count: usize) -> (usize, usize) {
    let mut is_used = vec![false; vertex_count];
    faces.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let used = (0..vertex_count).filter(|&v| is_used[v]);
    let piece = pieces(faces, vertex_count);
    let roots = used.clone().filter(|&v| piece[v] as usize == v);
    (used.count(), roots.count())
}

/// Per vertex the lowest vertex of the piece that it belongs to.
pub(super) fn pieces(faces: &[[u32; 3]], vertex_count: usize) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..vertex_count as u32).collect();
    for &[a, b, c] in faces {
        join(&mut parent, a, b);
        join(&mut parent, b, c);
    }
    (0..vertex_count as u32).map(|v| root(&mut parent, v)).collect()
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_join_through_a_shared_vertex_only() {
        assert_eq!(vertices_and_components(&[[0, 1, 2], [2, 3, 4]], 6), (5, 1));
        assert_eq!(vertices_and_components(&[[0, 1, 2], [3, 4, 5]], 6), (6, 2));
        assert_eq!(vertices_and_components(&[[4, 5, 0], [1, 2, 3], [3, 0, 1]], 6), (6, 1));
        assert_eq!(vertices_and_components(&[], 3), (0, 0));
    }
}
