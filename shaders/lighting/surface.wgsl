// The scene's surfaces under one light: what no shadow changes, and the light's own share, each by a weight. Twin:
// src/shade/. Formulas: docs/lighting.md#formula.

struct Scene {
    clip_from_world: mat4x4f,
    eye_in_world: vec3f,
    // 0 per pixel with Phong's highlight, 1 per pixel with Blinn's, 2 Gouraud, 3 flat.
    shading: u32,
    ambient: vec3f,
    diffuse_scale: f32,
}
struct Corner {
    normal_in_world: vec3f,
    material: u32,
    facet_normal_in_world: vec3f,
    // 1 on meshes that receive shadows.
    receives: u32,
}
struct Material {
    ambient: vec3f,
    shininess: f32,
    diffuse: vec3f,
    padding: u32,
    specular: vec3f,
    more_padding: u32,
    emission: vec3f,
    last_padding: u32,
}
struct Light {
    // Homogeneous: w = 0 for a direction towards the light.
    position: vec4f,
    intensity: vec3f,
    range_m: f32,
    axis: vec3f,
    // Half angle of the cone; beyond pi for a light without one.
    outer_rad: f32,
    attenuation: vec3f,
    // 0 inverse square, 1 classic, 2 none.
    distance_law: u32,
    // 0 hard, 1 linear, 2 Warn's.
    falloff: u32,
    // The inner half angle, or the exponent.
    falloff_value: f32,
    padding: vec2u,
}
struct Part {
    own: f32,
    direct: f32,
    // 1 to scale both by the visibility.
    shadowed: f32,
    padding: u32,
}
@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<storage, read> corners: array<Corner>;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
@group(0) @binding(3) var<uniform> light: Light;
@group(0) @binding(4) var<uniform> part: Part;
@group(0) @binding(5) var visibilities: texture_2d<f32>;

struct Surface {
    @builtin(position) @invariant position_in_clip: vec4f,
    @location(0) position_in_world: vec3f,
    @location(1) normal_in_world: vec3f,
    @location(2) gouraud: vec3f,
    @location(3) @interpolate(flat, either) facet_normal_in_world: vec3f,
    @location(4) @interpolate(flat, either) material_and_receives: vec2u,
}

fn distance_factor(distance_m: f32) -> f32 {
    if light.distance_law == 0u {
        return 1.0 / (distance_m * distance_m);
    }
    if light.distance_law == 2u {
        return 1.0;
    }
    let denominator = light.attenuation.x + distance_m * (light.attenuation.y + distance_m * light.attenuation.z);
    return select(min(1.0 / denominator, 1.0), 1.0, denominator <= 0.0);
}

fn cone_factor(towards_light: vec3f) -> f32 {
    let along = dot(light.axis, -towards_light);
    let angle_rad = atan2(length(cross(light.axis, towards_light)), along);
    if light.outer_rad > 3.2 {
        return 1.0;
    }
    if angle_rad > light.outer_rad {
        return 0.0;
    }
    if light.falloff == 1u && angle_rad > light.falloff_value {
        return (light.outer_rad - angle_rad) / (light.outer_rad - light.falloff_value);
    }
    // The power of zero is no number of WGSL's.
    return select(1.0, pow(max(along, 1e-30), light.falloff_value), light.falloff == 2u);
}

fn reflected(material: Material, normal: vec3f, towards_light: vec3f, towards_eye: vec3f) -> vec3f {
    let cosine = dot(normal, towards_light);
    if cosine <= 0.0 {
        return vec3f(0.0);
    }
    let mirrored = dot(2.0 * cosine * normal - towards_light, towards_eye);
    let halfway = dot(normal, normalize(towards_light + towards_eye));
    let highlight = max(select(mirrored, halfway, scene.shading == 1u), 1e-30);
    return material.diffuse * (scene.diffuse_scale * cosine) + material.specular * pow(highlight, material.shininess);
}

fn direct(point_in_world: vec3f, normal: vec3f, material: Material) -> vec3f {
    let to_light = light.position.xyz - light.position.w * point_in_world;
    let distance_m = length(to_light);
    if light.position.w != 0.0 && distance_m > light.range_m {
        return vec3f(0.0);
    }
    let towards_light = to_light / distance_m;
    let strength = light.intensity * distance_factor(distance_m) * cone_factor(towards_light);
    return strength * reflected(material, normal, towards_light, normalize(scene.eye_in_world - point_in_world));
}

@vertex
fn vertex(@location(0) position_in_world: vec3f, @builtin(vertex_index) index: u32) -> Surface {
    let corner = corners[index];
    var gouraud = vec3f(0.0);
    if scene.shading == 2u {
        gouraud = direct(position_in_world, corner.normal_in_world, materials[corner.material]);
    }
    return Surface(
        scene.clip_from_world * vec4f(position_in_world, 1.0),
        position_in_world,
        corner.normal_in_world,
        gouraud,
        corner.facet_normal_in_world,
        vec2u(corner.material, corner.receives),
    );
}

@fragment
fn fragment(surface: Surface) -> @location(0) vec4f {
    let material = materials[surface.material_and_receives.x];
    let own = material.emission + material.ambient * scene.ambient;
    var lit = surface.gouraud;
    if scene.shading != 2u {
        var normal = surface.facet_normal_in_world;
        if scene.shading != 3u && dot(surface.normal_in_world, surface.normal_in_world) > 0.0 {
            normal = normalize(surface.normal_in_world);
        }
        lit = direct(surface.position_in_world, normal, material);
    }
    let visibility = textureLoad(visibilities, vec2u(surface.position_in_clip.xy), 0).r;
    let seen = select(1.0, visibility, part.shadowed == 1.0 && surface.material_and_receives.y == 1u);
    return vec4f(seen * (part.own * own + part.direct * lit), 1.0);
}
