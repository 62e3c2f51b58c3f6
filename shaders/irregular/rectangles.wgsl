// Finds, for every caster and face, the rectangle of cells that may hold receivers in its shadow. Twin of
// `Grids::rectangle` in src/technique/irregular/grids.rs.

// What an indirect draw reads.
struct Draw {
    vertices: u32,
    instances: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}
@group(0) @binding(1) var<storage, read> corners: array<f32>;
// Which side of each triangle the light is on: 1 or -1; 0 for what casts nothing.
@group(0) @binding(2) var<storage, read> light_sides: array<i32>;
@group(0) @binding(3) var<storage, read_write> rectangles: array<Rectangle>;
@group(0) @binding(4) var<storage, read_write> draw: Draw;

// How far beyond its four sides a face is drawn.
const SLACK: f32 = 0.001;
// A triangle clipped by four planes has at most so many corners.
const MOST_CORNERS: u32 = 7u;

struct Polygon {
    corners: array<vec3f, MOST_CORNERS>,
    count: u32,
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let triangle = thread.x + thread.y * groups.x * 64u;
    if triangle >= arrayLength(&light_sides) || light_sides[triangle] == 0 {
        return;
    }
    for (var face = 0u; face < view.face_count; face++) {
        append_rectangle(triangle, face);
    }
}

fn append_rectangle(triangle: u32, index: u32) {
    let face = view.faces[index];
    var polygon: Polygon;
    polygon.count = 3u;
    var reach = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let at = 9u * triangle + 3u * i;
        let offset = vec3f(corners[at], corners[at + 1u], corners[at + 2u]) - view.anchor;
        polygon.corners[i] = in_face(face, offset);
        reach = max(reach, max(max(abs(offset.x), abs(offset.y)), abs(offset.z)));
    }
    let rounding = ROUNDING * reach;
    if face.parallel == 0.0 {
        polygon = clipped(polygon, vec3f(1.0, 0.0, 1.0 + SLACK), rounding);
        polygon = clipped(polygon, vec3f(-1.0, 0.0, 1.0 + SLACK), rounding);
        polygon = clipped(polygon, vec3f(0.0, 1.0, 1.0 + SLACK), rounding);
        polygon = clipped(polygon, vec3f(0.0, -1.0, 1.0 + SLACK), rounding);
        if polygon.count == 0u {
            return;
        }
    }
    var nearest = polygon.corners[0].z;
    for (var i = 1u; i < polygon.count; i++) {
        nearest = min(nearest, polygon.corners[i].z);
    }
    let rim = f32(view.grid);
    var low = vec2f(0.0);
    var high = vec2f(rim);
    // Next to the light no direction is certain.
    if nearest > rounding {
        low = polygon.corners[0].xy / polygon.corners[0].z;
        high = low;
        for (var i = 1u; i < polygon.count; i++) {
            let place = polygon.corners[i].xy / polygon.corners[i].z;
            low = min(low, place);
            high = max(high, place);
        }
        let pad = rounding / nearest;
        low = position_in_cells(face, low - pad);
        high = position_in_cells(face, high + pad);
        if any(high < vec2f(0.0)) || any(low > vec2f(rim)) {
            return;
        }
    }
    let first = cell_at(low);
    let last = cell_at(high);
    let slot = atomicAdd(&draw.instances, 1u);
    rectangles[slot] = Rectangle(triangle, index, first.x + (first.y << 16u), last.x + (last.y << 16u));
}

// The part of a polygon on the inner side of a plane through the light, which rounding may move out by `rounding`.
fn clipped(polygon: Polygon, plane: vec3f, rounding: f32) -> Polygon {
    var inside: Polygon;
    inside.count = 0u;
    var source = polygon;
    for (var i = 0u; i < source.count; i++) {
        let to = source.corners[i];
        let before = source.corners[(i + source.count - 1u) % source.count];
        let depth_to = dot(plane, to) + rounding;
        let depth_before = dot(plane, before) + rounding;
        if (depth_to >= 0.0) != (depth_before >= 0.0) && inside.count < MOST_CORNERS {
            inside.corners[inside.count] = mix(before, to, depth_before / (depth_before - depth_to));
            inside.count++;
        }
        if depth_to >= 0.0 && inside.count < MOST_CORNERS {
            inside.corners[inside.count] = to;
            inside.count++;
        }
    }
    return inside;
}
