// Twin of src/technique/map/projection/homogeneous.rs.

fn project(view: View, point_in_world: vec3f) -> InMap {
    let point = vec4f(point_in_world, 1.0);
    let q = dot(view.q_row, point);
    let uv = vec2f(dot(view.u_row, point), dot(view.v_row, point)) / q;
    return InMap(uv, dot(view.depth_row, point) / dot(view.depth_q_row, point), q);
}

fn gradients(view: View, point_in_world: vec3f, at: InMap) -> Gradients {
    return Gradients(
        (view.u_row.xyz - at.uv.x * view.q_row.xyz) / at.q,
        (view.v_row.xyz - at.uv.y * view.q_row.xyz) / at.q,
        (view.depth_row.xyz - at.depth * view.depth_q_row.xyz) / dot(view.depth_q_row, vec4f(point_in_world, 1.0)),
    );
}

// On the plane of equal q, or for parallel rays on the plane across them: u and v are affine there, so this is exact.
fn point_beside(view: View, point_in_world: vec3f, at: InMap, uv: vec2f) -> vec3f {
    let around = gradients(view, point_in_world, at);
    let ray = cross(around.u, around.v);
    let normal = select(view.q_row.xyz, ray, all(view.q_row.xyz == vec3f(0.0)));
    let move_uv = uv - at.uv;
    return point_in_world
        + (move_uv.x * cross(around.v, normal) + move_uv.y * cross(normal, around.u)) / dot(normal, ray);
}

// By how much rounding the point and the rows to f32 can move its depth against a plane of that slope, and where depth has
// a divisor of its own, what the plane bends.
fn slack(
    view: View, point_in_world: vec3f, normal_in_world: vec3f, in_map: InMap, slope: vec2f, reach_texels: vec2f,
    texels: vec2f,
) -> f32 {
    let point = abs(vec4f(point_in_world, 1.0));
    let reach_q = dot(abs(view.q_row), point);
    let depth_q = dot(view.depth_q_row, vec4f(point_in_world, 1.0));
    let depth = (dot(abs(view.depth_row), point) + abs(in_map.depth) * dot(abs(view.depth_q_row), point)) / depth_q;
    let u = (dot(abs(view.u_row), point) + abs(in_map.uv.x) * reach_q) / in_map.q;
    let v = (dot(abs(view.v_row), point) + abs(in_map.uv.y) * reach_q) / in_map.q;
    let rounding = POSITION_ROUNDING * (depth + slope.x * texels.x * u + slope.y * texels.y * v);
    if all(view.depth_q_row == view.q_row) {
        return rounding;
    }
    return rounding + bend(view, point_in_world, normal_in_world, in_map, reach_texels, texels);
}

// How fast depth bends along u and along v on a plane: as the ratio of the map's divisor and its own changes.
fn bend_per_texel(view: View, point_in_world: vec3f, normal_in_world: vec3f, in_map: InMap, texels: vec2f) -> vec2f {
    if all(view.depth_q_row == view.q_row) {
        return vec2f(0.0);
    }
    let depth_q = dot(view.depth_q_row, vec4f(point_in_world, 1.0));
    let of_ratio = view.q_row.xyz / in_map.q - view.depth_q_row.xyz / depth_q;
    return change_per_texel(gradients(view, point_in_world, in_map), of_ratio, normal_in_world, texels);
}

// By how much more than its slope says a plane comes nearer to the light within so many texels: most at a corner.
fn bend(
    view: View, point_in_world: vec3f, normal_in_world: vec3f, in_map: InMap, reach_texels: vec2f, texels: vec2f,
) -> f32 {
    let around = gradients(view, point_in_world, in_map);
    let nearer_per_texel = -view.depth_sign * depth_per_texel(around, normal_in_world, texels);
    let bends = bend_per_texel(view, point_in_world, normal_in_world, in_map, texels);
    let straight = dot(abs(nearer_per_texel), reach_texels);
    var most = straight;
    for (var corner = 0u; corner < 4u; corner++) {
        let away = (vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0) * reach_texels;
        most = max(most, bent(nearer_per_texel, bends, away));
    }
    return most - straight;
}

fn nearest_texel(texel: vec2i, texels: vec2f) -> vec2i {
    return clamp(texel, vec2i(0), vec2i(texels) - 1);
}
