// How far a comparison is moved, along the light and along the receiver's normal. Twin of
// src/technique/map/offset.rs.

const CLEARANCE_NONE: u32 = 0u;
const CLEARANCE_CLOSED_FORM: u32 = 1u;
const CLEARANCE_NORMAL: u32 = 2u;
const CLEARANCE_RECEIVER_PLANE: u32 = 3u;
const CLEARANCE_MIDPOINT: u32 = 4u;

// How many texels away the reference must clear the receiver's plane.
fn own_reach_texels() -> f32 {
    return select(0.0, lookup.bias_kernel, lookup.clearance == CLEARANCE_CLOSED_FORM);
}

fn moved_along_normal(view: View, point_in_world: vec3f, normal_in_world: vec3f) -> vec3f {
    return point_in_world + normal_in_world * normal_offset_m(view, point_in_world, normal_in_world);
}

// How far a receiver is moved along its normal.
fn normal_offset_m(view: View, point_in_world: vec3f, normal_in_world: vec3f) -> f32 {
    let clears_plane = lookup.clearance == CLEARANCE_NORMAL;
    if lookup.normal_texels == 0.0 && !clears_plane {
        return 0.0;
    }
    let around = gradients(view, point_in_world, project(view, point_in_world));
    let width = texel_m(around, lookup.texels);
    let towards_light = normalize(lookup.light.xyz - point_in_world * lookup.light.w);
    let sine = length(cross(normal_in_world, towards_light));
    let typed = lookup.normal_texels * max(width.x, width.y) * sine;
    let offset = normal_offset_per_texel_m(around, normal_in_world, lookup.texels);
    return typed + select(0.0, lookup.bias_kernel * (offset.x + offset.y), clears_plane);
}

// How far the comparison is moved towards the light, in units of depth.
fn bias_depth(view: View, point_in_world: vec3f, normal_in_world: vec3f, at: InMap, reach_texels: vec2f) -> f32 {
    let around = gradients(view, point_in_world, at);
    let width = texel_m(around, lookup.texels);
    let along_light = (lookup.depth_m + lookup.depth_texels * max(width.x, width.y)) / metres_per_depth(around);
    if lookup.clearance == CLEARANCE_NONE || lookup.clearance == CLEARANCE_MIDPOINT {
        return along_light;
    }
    let slope = abs(depth_per_texel(around, normal_in_world, lookup.texels));
    let sufficient = dot(reach_texels + lookup.raster_slack_texels, slope)
        + slack(view, point_in_world, normal_in_world, at, slope, reach_texels, lookup.texels)
        + 4.0 * (lookup.fixed_step + lookup.float_step * abs(at.depth));
    return along_light + min(sufficient, cap_depth(around));
}

// The most that is derived from the receiver's plane, in units of depth.
fn cap_depth(around: Gradients) -> f32 {
    let width = texel_m(around, lookup.texels);
    return lookup.cap_texels * max(width.x, width.y) / metres_per_depth(around);
}
