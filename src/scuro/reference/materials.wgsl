// Scattering of the path tracer's materials. Directions point away from the surface, in its frame:
// z is the normal on the side of the viewer.

//#include "scene.wgsl"
//#include "sampling.wgsl"

const DIFFUSE: u32 = 0u;
const GLOSSY: u32 = 1u;
const METAL: u32 = 2u;
const MIRROR: u32 = 3u;
const GLASS: u32 = 4u;

// Whether any material is other than diffuse.
override SHINY: bool = true;

fn schlick(f0: vec3f, cosine: f32) -> vec3f {
    let rest = 1.0 - saturate(cosine);
    let square = rest * rest;
    return f0 + (1.0 - f0) * (square * square * rest);
}

fn normal_reflectance(ior: f32) -> f32 {
    let r = (ior - 1.0) / (ior + 1.0);
    return r * r;
}

// Fresnel reflectance of a smooth dielectric, ior being that of the far side over the near side's.
fn dielectric(cosine: f32, ior: f32) -> f32 {
    let sine2 = (1.0 - cosine * cosine) / (ior * ior);
    if (sine2 >= 1.0) {
        return 1.0; // total internal reflection
    }
    let inner = sqrt(1.0 - sine2);
    let s = (cosine - ior * inner) / (cosine + ior * inner);
    let p = (ior * cosine - inner) / (ior * cosine + inner);
    return 0.5 * (s * s + p * p);
}

fn base_reflectance(material: Material, albedo: vec3f) -> vec3f {
    return select(vec3f(normal_reflectance(material.ior)), albedo, material.kind == METAL);
}

// GGX: alpha is the square of the roughness (Burley 2012).
fn ggx_alpha(material: Material) -> f32 {
    return max(material.roughness * material.roughness, 1e-3);
}

fn smith_lambda(v: vec3f, alpha: f32) -> f32 {
    let tangent2 = dot(v.xy, v.xy) / max(v.z * v.z, 1e-12);
    return 0.5 * (sqrt(1.0 + alpha * alpha * tangent2) - 1.0);
}

// Microfacet reflection without its Fresnel factor, times pi.
fn ggx_lobe(outgoing: vec3f, incoming: vec3f, alpha: f32) -> f32 {
    let h = normalize(outgoing + incoming);
    let a2 = alpha * alpha;
    let d = h.z * h.z * (a2 - 1.0) + 1.0;
    let shadowing = 1.0 / (1.0 + smith_lambda(outgoing, alpha) + smith_lambda(incoming, alpha));
    return a2 / (d * d) * shadowing / max(4.0 * outgoing.z * incoming.z, 1e-9);
}

// A microfacet normal as seen from `outgoing` (Heitz 2018).
fn visible_normal(outgoing: vec3f, alpha: f32, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(alpha * outgoing.xy, outgoing.z));
    let across = dot(stretched.xy, stretched.xy);
    let t1 = select(vec3f(1.0, 0.0, 0.0),
        vec3f(-stretched.y, stretched.x, 0.0) * inverseSqrt(max(across, 1e-20)), across > 1e-12);
    let t2 = cross(stretched, t1);
    let r = sqrt(u.x);
    let angle = 2.0 * PI * u.y;
    let p1 = r * cos(angle);
    let s = 0.5 * (1.0 + stretched.z);
    let p2 = mix(sqrt(max(0.0, 1.0 - p1 * p1)), r * sin(angle), s);
    let h = p1 * t1 + p2 * t2 + sqrt(max(0.0, 1.0 - p1 * p1 - p2 * p2)) * stretched;
    return normalize(vec3f(alpha * h.xy, max(h.z, 1e-6)));
}

// Reflected share of a light from `incoming`: pi times the BRDF times the cosine. Mirrors and glass
// reflect no light from a single direction.
fn reflected(material: Material, albedo: vec3f, outgoing: vec3f, incoming: vec3f) -> vec3f {
    if (incoming.z <= 0.0 || outgoing.z <= 0.0) {
        return vec3f(0.0);
    }
    let diffuse = albedo * incoming.z;
    if (!SHINY || material.kind == DIFFUSE) {
        return diffuse;
    }
    if (material.kind >= MIRROR) {
        return vec3f(0.0);
    }
    let f0 = base_reflectance(material, albedo);
    let h = normalize(outgoing + incoming);
    let lobe = schlick(f0, dot(h, incoming))
        * (ggx_lobe(outgoing, incoming, ggx_alpha(material)) * incoming.z);
    let through = (1.0 - schlick(f0, outgoing.z)) * diffuse;
    return lobe + select(through, vec3f(0.0), material.kind == METAL);
}

struct Scattered {
    direction: vec3f,
    // BRDF times cosine over probability density
    weight: vec3f,
}

// Choose where a path goes on; `choice` decides between lobes. Glass is not for here.
fn scatter(material: Material, albedo: vec3f, outgoing: vec3f, u: vec2f, choice: f32) -> Scattered {
    let around = cosine_direction(vec3f(0.0, 0.0, 1.0), sphere_direction(u));
    if (!SHINY || material.kind == DIFFUSE) {
        return Scattered(around, albedo);
    }
    if (material.kind == MIRROR) {
        let up = vec3f(-outgoing.xy, outgoing.z);
        return Scattered(up, schlick(albedo, outgoing.z));
    }
    let f0 = base_reflectance(material, albedo);
    let alpha = ggx_alpha(material);
    let coat = schlick(f0, outgoing.z);
    var chance = 1.0;
    if (material.kind == GLOSSY) {
        let below = (1.0 - coat.x) * max(albedo.x, max(albedo.y, albedo.z));
        chance = coat.x / max(coat.x + below, 1e-6);
    }
    if (choice >= chance) {
        return Scattered(around, albedo * (1.0 - coat) / (1.0 - chance));
    }
    let h = visible_normal(outgoing, alpha, u);
    let direction = reflect(-outgoing, h);
    let shadowing = (1.0 + smith_lambda(outgoing, alpha))
        / (1.0 + smith_lambda(outgoing, alpha) + smith_lambda(direction, alpha));
    let weight = schlick(f0, dot(h, direction)) * (shadowing / chance);
    return Scattered(direction, select(vec3f(0.0), weight, direction.z > 0.0));
}
