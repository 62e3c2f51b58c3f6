// Draws every caster as the rectangle of cells it may cover; each cell tests its receivers against the triangle. The
// test is the twin of src/technique/irregular/segment_test.rs.

@group(0) @binding(1) var<storage, read> rectangles: array<Rectangle>;
@group(0) @binding(2) var<storage, read> corners: array<f32>;
@group(0) @binding(3) var<storage, read> light_sides: array<i32>;
@group(0) @binding(4) var<storage, read> samples: array<Sample>;
@group(0) @binding(5) var<storage, read> heads: array<u32>;
@group(0) @binding(6) var<storage, read> next: array<u32>;
// One bit per receiver.
@group(0) @binding(7) var<storage, read_write> blocked: array<atomic<u32>>;

struct Cell {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat, either) triangle: u32,
    @location(1) @interpolate(flat, either) face: u32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) instance: u32) -> Cell {
    let rectangle = rectangles[instance];
    let low = vec2u(rectangle.first & 0xffffu, rectangle.first >> 16u);
    let high = vec2u(rectangle.last & 0xffffu, rectangle.last >> 16u) + 1u;
    let cell = vec2f(select(low, high, vec2<bool>((corner & 1u) == 1u, corner >= 2u))) / f32(view.grid);
    return Cell(vec4f(2.0 * cell.x - 1.0, 1.0 - 2.0 * cell.y, 0.0, 1.0), rectangle.triangle, rectangle.face);
}

@fragment
fn fragment(cell: Cell) {
    let a = corner_of(cell.triangle, 0u);
    let b = corner_of(cell.triangle, 1u);
    let c = corner_of(cell.triangle, 2u);
    let light_side = f32(light_sides[cell.triangle]);
    var entry = heads[head_index(cell.face, vec2u(cell.position.xy))];
    while entry != 0u {
        let index = entry - 1u;
        let receiver = samples[index];
        if receiver.own != cell.triangle && blocks(receiver, a, b, c, light_side) {
            atomicOr(&blocked[index / 32u], 1u << (index % 32u));
        }
        entry = next[index];
    }
}

fn corner_of(triangle: u32, corner: u32) -> vec3f {
    let at = 9u * triangle + 3u * corner;
    return vec3f(corners[at], corners[at + 1u], corners[at + 2u]);
}

// Whether the open segment from a receiver to the light crosses a triangle.
fn blocks(receiver: Sample, a: vec3f, b: vec3f, c: vec3f, light_side: f32) -> bool {
    if plane_side(receiver, a, b, c) * light_side >= 0.0 {
        return false;
    }
    let to_light = view.light.w * from_receiver(receiver, view.light.xyz) + (1.0 - view.light.w) * view.light.xyz;
    let ab = edge_side(receiver, to_light, a, b);
    let bc = edge_side(receiver, to_light, b, c);
    let ca = edge_side(receiver, to_light, c, a);
    return (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}

fn from_receiver(receiver: Sample, point: vec3f) -> vec3f {
    return (point - receiver.point_high) - receiver.point_low;
}

// Positive where the receiver is on the triangle's counter-clockwise side.
fn plane_side(receiver: Sample, a: vec3f, b: vec3f, c: vec3f) -> f32 {
    return -dot(cross(b - a, c - a), from_receiver(receiver, a));
}

// On which side of an edge the line to the light passes. Both triangles at an edge work with the same numbers, so no
// line passes between them.
fn edge_side(receiver: Sample, to_light: vec3f, start: vec3f, end: vec3f) -> f32 {
    if comes_before(end, start) {
        return -dot(to_light, cross(from_nearer_end(receiver, end), start - end));
    }
    return dot(to_light, cross(from_nearer_end(receiver, start), end - start));
}

// From that end of the ray to a point which rounds least.
fn from_nearer_end(receiver: Sample, point: vec3f) -> vec3f {
    let offset = from_receiver(receiver, point);
    let from_light = point - view.light.xyz;
    let is_nearer_light = view.light.w != 0.0 && dot(from_light, from_light) < dot(offset, offset);
    return select(offset, from_light, is_nearer_light);
}

// An order of points in space.
fn comes_before(p: vec3f, q: vec3f) -> bool {
    if p.x != q.x {
        return p.x < q.x;
    }
    if p.y != q.y {
        return p.y < q.y;
    }
    return p.z < q.z;
}
