// Twin of src/technique/map/projection/cube.rs.

fn select_views(point_in_world: vec3f) -> Shares {
    let point = vec4f(point_in_world, 1.0);
    var best = 0u;
    for (var i = 1u; i < arrayLength(&views); i++) {
        if dot(views[i].selector, point) > dot(views[best].selector, point) {
            best = i;
        }
    }
    return one_view(best);
}
