// Twin of src/technique/map/filter/pcss.rs.

// What `numbers` holds: how many taps and how wide a kernel; the light's half sides; the places of the taps.
const HALVES: u32 = 1u;
const PLACES: u32 = 3u;

// What a receiver sees of the light, in its view.
struct Cone {
    halves_in_world: mat2x3f,
    widest: f32,
    is_parallel: bool,
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
        let found = blocker(reference, texel(cone, PLACES + i, search));
        if found.blocks {
            depth += found.depth;
            blockers += 1.0;
        }
    }
    if blockers == 0.0 {
        return 1.0;
    }
    let blocker_m = cone.distance_m + (depth / blockers - in_map.depth) * cone.metres_per_depth;
    let kernel = limited(cone, spread(cone, blocker_m));
    if kernel * cone.widest < numbers[0].z {
        return f32(is_lit(reference, vec2i(floor(position_in_texels))));
    }
    var lit = 0u;
    for (var i = 0u; i < filter_taps; i++) {
        lit += u32(is_lit(reference, texel(cone, PLACES + search_taps + i, kernel)));
    }
    return f32(lit) / f32(filter_taps);
}

// What a texel holds, and whether that is nearer to the light than the receiver.
struct Found {
    blocks: bool,
    depth: f32,
}

fn blocker(reference: f32, texel: vec2i) -> Found {
    if is_in_view(texel) {
        return Found(!is_lit(reference, texel), textureLoad(stored_depths, texel, own.view, 0));
    }
    if lookup.shares_depth != 0u && lookup.seam == SEAM_PER_TAP {
        let across = texel_across(texel);
        if across.is_found {
            let placed = across.placed;
            let lit = compares_lit(placed.view, reference_at(placed, placed.reference, across.texel), across.texel);
            return Found(!lit, textureLoad(stored_depths, across.texel, placed.view, 0));
        }
    }
    return Found(false, 0.0);
}

fn cone_of(in_map: InMap) -> Cone {
    let view = views[own.view];
    let around = gradients(view, own.point_in_world, in_map);
    let axis = normalize(view.depth_sign * around.depth);
    let metres_per_depth = view.depth_sign / length(around.depth);
    let near_depth = select(1.0, 0.0, view.depth_sign > 0.0);
    let beyond_near_m = (in_map.depth - near_depth) * metres_per_depth;
    let is_parallel = lookup.light.w == 0.0;
    let distance_m = select(dot(axis, own.point_in_world - lookup.light.xyz), beyond_near_m, is_parallel);
    let from_light = select(own.point_in_world - lookup.light.xyz, axis, is_parallel);
    var halves = mat2x3f(numbers[HALVES].xyz, numbers[HALVES + 1u].xyz);
    if numbers[HALVES].w == 1.0 {
        // Nothing in the map changes along the ray, so u changes across it.
        let across = normalize(around.u);
        halves = numbers[HALVES].x * mat2x3f(across, cross(normalize(from_light), across));
    }
    let first = lookup.texels * vec2f(dot(around.u, halves[0]), dot(around.v, halves[0]));
    let second = lookup.texels * vec2f(dot(around.u, halves[1]), dot(around.v, halves[1]));
    let near_m = distance_m - beyond_near_m;
    let widest = 2.0 * max(length(first), length(second));
    return Cone(halves, widest, is_parallel, distance_m, near_m, metres_per_depth);
}

fn spread(cone: Cone, blocker_m: f32) -> f32 {
    return (cone.distance_m - blocker_m) / select(blocker_m, 1.0, cone.is_parallel);
}

fn limited(cone: Cone, spread: f32) -> f32 {
    let max_texels = numbers[0].w;
    return select(spread, max_texels / cone.widest, spread * cone.widest > max_texels);
}

fn texel(cone: Cone, index: u32, spread: f32) -> vec2i {
    let listed = numbers[index].xy;
    var place = 2.0 * shifted(listed) - 1.0;
    if numbers[HALVES].w == 1.0 {
        place = turned(listed);
    }
    let beside = own.point_in_world + spread * (cone.halves_in_world * place);
    let at = project(views[own.view], beside);
    // Kernels wider than the map may reach behind the light.
    return vec2i(floor(select(own.position_in_texels, at.uv * lookup.texels, at.q > 0.0)));
}
