// Twin of src/technique/map/projection/dual_paraboloid.rs.

fn select_views(point_in_world: vec3f) -> Shares {
    let before = dot(views[0].selector, vec4f(point_in_world, 1.0));
    return one_view(select(0u, 1u, before < 0.0 && arrayLength(&views) > 1u));
}
