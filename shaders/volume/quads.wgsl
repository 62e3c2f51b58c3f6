// Faces at every edge of every caster; those that are not wanted under this light fall into a point. Twin: the test of
// src/technique/volume/quads.rs.

struct Face {
    // Indices into `positions`.
    corners: vec3u,
    copy: i32,
    // Indices into `casters`.
    casters: vec2u,
    // What each caster adds to the weight if it faces the light, and if it is turned away.
    towards: vec2i,
    away: vec2i,
    padding: vec2u,
}
struct Caster {
    normal_in_world: vec3f,
    // Index into `positions`.
    corner: u32,
}
@group(0) @binding(2) var<storage, read> positions: array<vec4f>;
@group(0) @binding(3) var<storage, read> casters: array<Caster>;
@group(0) @binding(4) var<storage, read> faces: array<Face>;

fn facing(index: u32) -> f32 {
    let caster = casters[index];
    let to_light = extrusion.light.xyz - extrusion.light.w * positions[caster.corner].xyz;
    return dot(caster.normal_in_world, to_light);
}

fn weight(face: Face) -> i32 {
    let sides = vec2f(facing(face.casters.x), facing(face.casters.y));
    let weights = select(vec2i(0), face.towards, sides > vec2f(0.0)) + select(vec2i(0), face.away, sides < vec2f(0.0));
    return weights.x + weights.y;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Clipped {
    let face = faces[index / 3u];
    let weight = weight(face);
    var corner = index % 3u;
    if abs(weight) <= face.copy {
        corner = 0u;
    } else if weight < 0 && corner > 0u {
        corner = 3u - corner;
    }
    return clipped(extruded(positions[face.corners[corner]]));
}
