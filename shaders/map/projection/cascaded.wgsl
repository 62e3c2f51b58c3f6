// Twin of src/technique/map/projection/cascaded.rs.

fn select_views(point_in_world: vec3f) -> Shares {
    let count = arrayLength(&views);
    if all(views[0].selector == vec4f(0.0)) {
        return one_view(first_that_holds(point_in_world, count));
    }
    var own = 0u;
    while own + 1u < count && past(own + 1u, point_in_world) >= 0.0 {
        own++;
    }
    if own + 1u < count && views[own + 1u].blend_per_m > 0.0 {
        let weight = 1.0 + past(own + 1u, point_in_world) * views[own + 1u].blend_per_m;
        if weight > 0.0 {
            return Shares(own, own + 1u, weight);
        }
    }
    return one_view(own);
}

// Metres beyond where a cascade starts.
fn past(view: u32, point_in_world: vec3f) -> f32 {
    return dot(views[view].selector, vec4f(point_in_world, 1.0));
}

fn first_that_holds(point_in_world: vec3f, count: u32) -> u32 {
    for (var i = 0u; i < count; i++) {
        let at = project(views[i], point_in_world);
        if all(at.uv >= vec2f(0.0)) && all(at.uv < vec2f(1.0)) && at.depth >= 0.0 && at.depth <= 1.0 {
            return i;
        }
    }
    return count - 1u;
}
