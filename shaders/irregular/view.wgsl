// The light's grids, what lies in them, and where a point of the world does. Twin of src/technique/irregular/grids.rs.

struct Face {
    x_axis: vec3f,
    // Where the window begins.
    first_x: f32,
    y_axis: vec3f,
    first_y: f32,
    forward: vec3f,
    // 1 where rays are parallel, else 0.
    parallel: f32,
    cells_per_unit: vec2f,
    padding: vec2f,
}

struct View {
    faces: array<Face, 6>,
    // The light's position, or a point amid the receivers of a directional one.
    anchor: vec3f,
    // Cells per side of a face.
    grid: u32,
    // Homogeneous light: w = 0 with a vector towards a directional one.
    light: vec4f,
    face_count: u32,
    padding: u32,
    more_padding: vec2u,
}
@group(0) @binding(0) var<uniform> view: View;

// A receiver. Twin of `GpuSample` in src/technique/irregular/samples.rs.
struct Sample {
    // The receiver's point is the sum of two, exact to 2^-48 of itself.
    point_high: vec3f,
    // The triangle that stands for its own surface.
    own: u32,
    point_low: vec3f,
    face: u32,
}

// Cells of one face that a caster may cover.
struct Rectangle {
    triangle: u32,
    face: u32,
    // x + y * 65536 of the first and the last cell.
    first: u32,
    last: u32,
}

// What of f32's rounding can reach a place in a window, relative to the distance of what is placed.
const ROUNDING: f32 = 3.8146973e-6; // 2^-18

// (x q, y q, q) of a point given relative to the anchor.
fn in_face(face: Face, offset: vec3f) -> vec3f {
    return vec3f(dot(face.x_axis, offset), dot(face.y_axis, offset), dot(face.forward, offset) + face.parallel);
}

// Place in the grid in cells, in no way bounded.
fn position_in_cells(face: Face, place: vec2f) -> vec2f {
    return (place - vec2f(face.first_x, face.first_y)) * face.cells_per_unit;
}

// What lies beyond the rim belongs to the cells along it.
fn cell_at(position_in_cells: vec2f) -> vec2u {
    return vec2u(clamp(floor(position_in_cells), vec2f(0.0), vec2f(f32(view.grid - 1u))));
}

fn head_index(face: u32, cell: vec2u) -> u32 {
    return (face * view.grid + cell.y) * view.grid + cell.x;
}
