// Twin of src/technique/map/filter/pcss.rs.

// What `numbers` holds: how many taps and how wide a kernel; the light's half sides; the places of the taps.
const HALVES: u32 = 1u;
const PLACES: u32 = 3u;

// What a receiver sees of the light, in its view.
struct Cone {
    axes: mat2x2f,
    distance_m: f32,
    near_m: f32,
    metres_per_depth: f32,
}

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    let search_taps = u32(numbers[0].x);
    let filter_taps = u32(numbers[0].y);
    let in_map = project(views[own.view], own.point_in_world);
    let cone = cone_of(in_map);
    let search = limited(cone, spread(cone, cone.near_m));
    var depth = 0.0;
    var blockers = 0.0;
    for (var i = 0u; i < search_taps; i++) {
        let texel = vec2i(floor(position_in_texels + place(cone, PLACES + i, search)));
        if is_in_view(texel) && !is_lit(reference, texel) {
            depth += textureLoad(stored_depths, texel, own.view, 0);
            blockers += 1.0;
        }
    }
    if blockers == 0.0 {
        return 1.0;
    }
    let blocker_m = cone.distance_m + (depth / blockers - in_map.depth) * cone.metres_per_depth;
    let kernel = limited(cone, spread(cone, blocker_m));
    if kernel * widest(cone) < numbers[0].z {
        return f32(is_lit(reference, vec2i(floor(position_in_texels))));
    }
    var lit = 0u;
    for (var i = 0u; i < filter_taps; i++) {
        let texel = vec2i(floor(position_in_texels + place(cone, PLACES + search_taps + i, kernel)));
        lit += u32(is_lit(reference, texel));
    }
    return f32(lit) / f32(filter_taps);
}

fn cone_of(in_map: InMap) -> Cone {
    let view = views[own.view];
    let axis = view.q_row.xyz;
    if all(axis == vec3f(0.0)) {
        return Cone(mat2x2f(), 1.0, 1.0, 0.0);
    }
    let u = across(view.u_row.xyz, axis);
    let v = across(view.v_row.xyz, axis);
    let halves = array(numbers[HALVES], numbers[HALVES + 1u]);
    var axes = mat2x2f(
        lookup.texels * vec2f(dot(u, halves[0].xyz), dot(v, halves[0].xyz)),
        lookup.texels * vec2f(dot(u, halves[1].xyz), dot(v, halves[1].xyz)),
    );
    if halves[0].w == 1.0 {
        let radii = lookup.texels * vec2f(length(u), length(v)) * halves[0].x;
        axes = mat2x2f(vec2f(radii.x, 0.0), vec2f(0.0, radii.y));
    }
    let metres_per_depth = view.depth_sign * length(axis) / length(view.depth_row.xyz);
    let near_depth = select(1.0, 0.0, view.depth_sign > 0.0);
    let near_m = in_map.q + (near_depth - in_map.depth) * metres_per_depth;
    return Cone(axes, in_map.q, near_m, metres_per_depth);
}

fn across(row: vec3f, axis: vec3f) -> vec3f {
    return row - axis * (dot(row, axis) / dot(axis, axis));
}

fn spread(cone: Cone, blocker_m: f32) -> f32 {
    return (cone.distance_m - blocker_m) / (cone.distance_m * blocker_m);
}

fn widest(cone: Cone) -> f32 {
    return 2.0 * max(length(cone.axes[0]), length(cone.axes[1]));
}

fn limited(cone: Cone, spread: f32) -> f32 {
    let max_texels = numbers[0].w;
    return select(spread, max_texels / widest(cone), spread * widest(cone) > max_texels);
}

fn place(cone: Cone, index: u32, spread: f32) -> vec2f {
    let listed = numbers[index].xy;
    if numbers[HALVES].w == 1.0 {
        return spread * (cone.axes * turned(listed));
    }
    return spread * (cone.axes * (2.0 * shifted(listed) - 1.0));
}
