// The one way from world to clip space for everything that shares the camera's depth buffer: scene, caps and sides get
// the same bits for the same position. Twin of `Eye` in src/technique/volume/eye.rs.

struct Eye {
    clip_from_world: mat4x4f,
    // Depth of points at infinity (w = 0).
    depth_at_infinity: f32,
    // 1 if the far plane is at infinity: the matrix's own row would put such points on either side of it by rounding.
    infinite: u32,
    padding: vec2u,
}
@group(0) @binding(0) var<uniform> eye: Eye;

struct Clipped {
    @builtin(position) @invariant position_in_clip: vec4f,
}

fn clipped(position_in_world: vec4f) -> Clipped {
    var clip = eye.clip_from_world * position_in_world;
    if position_in_world.w == 0.0 && eye.infinite == 1u {
        clip.z = eye.depth_at_infinity * clip.w;
    }
    return Clipped(clip);
}
