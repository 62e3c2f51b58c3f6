// Draws silhouette edges into the grid between a shadow map's texel centres: every cell that an edge touches receives the
// middle of the part inside it. src/technique/map/outline.rs reads them.

@group(0) @binding(0) var<storage, read> views: array<View>;
// Two points per edge.
@group(0) @binding(1) var<storage, read> edges: array<vec4f>;
@group(0) @binding(2) var stored_depths: texture_depth_2d_array;

// Least distance from the light at which an edge is cut, relative to its far end.
const NEAREST: f32 = 1e-4;
// Cells by which an edge may miss one that it is tried in: rounding, and edges along a border, which touch both sides.
const RIM: f32 = 0.001;
// An edge is hidden if it is farther than all four corners by more than this, in units of depth.
const HIDDEN: f32 = 1e-6;

struct Cell {
    @builtin(position) position: vec4f,
    // Both ends in cells.
    @location(0) @interpolate(flat, either) ends: vec4f,
    @location(1) @interpolate(flat, either) depths: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) edge: u32) -> Cell {
    let texels = vec2f(textureDimensions(stored_depths));
    let cells = texels - 1.0;
    let view = views[0];
    let near = vec4f(edges[2u * edge].xyz, 1.0);
    let far = vec4f(edges[2u * edge + 1u].xyz, 1.0);
    let q = vec2f(dot(view.q_row, near), dot(view.q_row, far));
    let least = NEAREST * max(q.x, q.y);
    if least <= 0.0 {
        // Behind the light: nothing.
        return Cell(vec4f(2.0, 2.0, 0.0, 1.0), vec4f(0.0), vec2f(0.0));
    }
    let start = select(near, mix(near, far, (least - q.x) / (q.y - q.x)), q.x < least);
    let end = select(far, mix(far, near, (least - q.y) / (q.x - q.y)), q.y < least);
    let a = project(view, start.xyz);
    let b = project(view, end.xyz);
    let ends = vec4f(a.uv * texels - 0.5, b.uv * texels - 0.5);
    let low = clamp(floor(min(ends.xy, ends.zw) - RIM), vec2f(0.0), cells);
    let high = clamp(floor(max(ends.xy, ends.zw) + RIM) + 1.0, vec2f(0.0), cells);
    let place = select(low, high, vec2<bool>((corner & 1u) == 1u, corner >= 2u)) / cells;
    return Cell(vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), ends, vec2f(a.depth, b.depth));
}

@fragment
fn fragment(cell: Cell) -> @location(0) vec2f {
    let corner = floor(cell.position.xy);
    let start = cell.ends.xy;
    let along = cell.ends.zw - start;
    var first = 0.0;
    var last = 1.0;
    // The cells on both sides of a border find the same place on it, so that no rounding parts them.
    for (var axis = 0u; axis < 2u; axis++) {
        let low = corner[axis];
        let high = corner[axis] + 1.0;
        if along[axis] == 0.0 {
            if start[axis] < low || start[axis] > high {
                discard;
            }
        } else {
            let enter = (low - start[axis]) / along[axis];
            let leave = (high - start[axis]) / along[axis];
            first = max(first, min(enter, leave));
            last = min(last, max(enter, leave));
        }
    }
    let middle = 0.5 * (first + last);
    if first > last || is_hidden(vec2i(corner), mix(cell.depths.x, cell.depths.y, middle)) {
        discard;
    }
    return clamp(start + middle * along - corner, vec2f(0.0), vec2f(1.0));
}

fn is_hidden(cell: vec2i, depth: f32) -> bool {
    for (var i = 0; i < 4; i++) {
        let stored = textureLoad(stored_depths, cell + vec2i(i & 1, i >> 1u), 0, 0);
        if views[0].depth_sign * (depth - stored) <= HIDDEN {
            return false;
        }
    }
    return true;
}
