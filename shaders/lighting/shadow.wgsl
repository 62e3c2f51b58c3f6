// One triangle over the whole picture: into the stencil where a light is seen no more than a limit, or as darkness.

struct Shadow {
    // Pixels that see more than this are left out.
    most_seen: f32,
    darkening: f32,
    padding: vec2u,
}
@group(0) @binding(0) var<uniform> shadow: Shadow;
@group(0) @binding(1) var visibilities: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index % 2u), f32(index / 2u));
    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let visibility = textureLoad(visibilities, vec2u(position.xy), 0).r;
    if visibility > shadow.most_seen {
        discard;
    }
    return vec4f(0.0, 0.0, 0.0, shadow.darkening * (1.0 - visibility));
}
