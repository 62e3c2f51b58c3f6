// Patterns of taps turned and shifted for each pixel otherwise. Twin of src/technique/map/filter/turn.rs.

const LARGEST_HALF_TANGENT: f32 = 0.41421356; // tan(π/8)
const OF_24_BITS: f32 = 1.0 / 16777216.0;

// A place of the pattern around zero, turned for the receiver's pixel.
fn turned(place: vec2f) -> vec2f {
    if lookup.turns == 0u {
        return place;
    }
    let bits = hash(own_pixel ^ hash(lookup.seed));
    let half = (f32(bits >> 8u) * OF_24_BITS * 2.0 - 1.0) * LARGEST_HALF_TANGENT;
    let turn = vec2f(1.0 - half * half, 2.0 * half) / (1.0 + half * half);
    let within_eighth = vec2f(turn.x * place.x - turn.y * place.y, turn.y * place.x + turn.x * place.y);
    let quarter = select(within_eighth, vec2f(-within_eighth.y, within_eighth.x), (bits & 1u) != 0u);
    return select(quarter, -quarter, (bits & 2u) != 0u);
}

// A place of the unit square, shifted for the receiver's pixel.
fn shifted(place: vec2f) -> vec2f {
    if lookup.turns == 0u {
        return place;
    }
    let bits = hash(own_pixel ^ hash(lookup.seed));
    return fract(place + vec2f(f32(bits >> 8u), f32(hash(bits) >> 8u)) * OF_24_BITS);
}

fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}
