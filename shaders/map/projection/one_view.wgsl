// Projections with one view: src/technique/map/projection/mod.rs.

fn select_views(point_in_world: vec3f) -> Shares {
    return one_view(0u);
}
