//! Which part of light from everywhere a surface mirrors and scatters, by the lights' own reflection
//! model, as a table: the second sum of the split-sum approximation (Karis 2013, 'Real Shading in
//! Unreal Engine 4'), and what it leaves for diffuse reflection.

use std::f32::consts::{PI, TAU};
use std::sync::OnceLock;

#[cfg(test)]
use glam::Vec2;
use glam::Vec3;

/// Entries along each axis.
pub(super) const SIDE: usize = 32;

/// Samples per entry of what is scattered.
const SAMPLES: u32 = 512;

/// The base-2 radical inverse.
pub(super) fn radical_inverse(i: u32) -> f32 {
    i.reverse_bits() as f32 / 4_294_967_296.0
}

/// Half vectors around z as GGX's distribution of normals has them, with the cosine's square; `a2`
/// is the square of its alpha.
pub(super) fn half_vector(i: u32, count: u32, a2: f32) -> (Vec3, f32) {
    let u = (i as f32 + 0.5) / count as f32;
    let (sin_phi, cos_phi) = (TAU * radical_inverse(i)).sin_cos();
    let cos2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
    let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
    (Vec3::new(sin * cos_phi, sin * sin_phi, cos), cos2)
}

/// The density of a direction that is reflected at a half vector of this squared cosine, towards a
/// viewer along the normal.
pub(super) fn density(cos2: f32, a2: f32) -> f32 {
    let d = cos2 * (a2 - 1.0) + 1.0;
    a2 / (PI * d * d) / 4.0
}

/// Samples per entry of what is mirrored, along each of two axes.
const MIRRORED_SAMPLES: u32 = 32;

/// A mirror whose reflectance at right angles is f0 reflects f0 times the first, plus the second, in
/// one bounce, and leaves 1 - f0 times the third for diffuse reflection. The first two together are
/// what it reflects where nothing is absorbed. By visible normals (Heitz 2018, 'Sampling the GGX
/// Distribution of Visible Normals').
fn entry(cosine: f32, roughness: f32) -> [f32; 3] {
    let alpha = (roughness * roughness).max(0.002);
    let a2 = alpha * alpha;
    let cosine = cosine.max(1e-3);
    let v = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let stretched = (v * Vec3::new(alpha, alpha, 1.0)).normalize();
    let across = Vec3::Y;
    let up = stretched.cross(across);
    let slanted = |cosine: f32| (cosine * cosine * (1.0 - a2) + a2).sqrt();
    let (mut scale, mut bias) = (0.0, 0.0);
    for i in 0..MIRRORED_SAMPLES * MIRRORED_SAMPLES {
        let at = |i: u32| (i as f32 + 0.5) / MIRRORED_SAMPLES as f32;
        let radius = at(i % MIRRORED_SAMPLES).sqrt();
        let (sin, cos) = (TAU * at(i / MIRRORED_SAMPLES)).sin_cos();
        let x = radius * cos;
        let part = 0.5 * (1.0 + stretched.z);
        let y = (1.0 - part) * (1.0 - x * x).sqrt() + part * radius * sin;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let n = across * x + up * y + stretched * z;
        let h = Vec3::new(alpha * n.x, alpha * n.y, n.z.max(1e-6)).normalize();
        let v_dot_h = v.dot(h);
        let l = 2.0 * v_dot_h * h.z - v.z;
        if l > 0.0 {
            // Masking and shadowing together, over masking alone.
            let reflected =
                l * (cosine + slanted(cosine)) / (l * slanted(cosine) + cosine * slanted(l));
            let fresnel = (1.0 - v_dot_h).max(0.0).powi(5);
            scale += reflected * (1.0 - fresnel);
            bias += reflected * fresnel;
        }
    }
    let mirrored = [scale, bias].map(|sum| sum / (MIRRORED_SAMPLES * MIRRORED_SAMPLES) as f32);
    [mirrored[0], mirrored[1], scattered(v)]
}

/// Sum over light from everywhere of what Fresnel's reflection leaves, where f0 is 0.
fn scattered(v: Vec3) -> f32 {
    let sample = |i| {
        let (sin_phi, cos_phi) = (TAU * radical_inverse(i)).sin_cos();
        let sin2 = (i as f32 + 0.5) / SAMPLES as f32;
        let sin = sin2.sqrt();
        let l = Vec3::new(sin * cos_phi, sin * sin_phi, (1.0 - sin2).sqrt());
        let v_dot_h = v.dot((v + l).normalize());
        1.0 - (1.0 - v_dot_h).powi(5)
    };
    (0..SAMPLES).map(sample).sum::<f32>() / SAMPLES as f32
}

/// The table: cosines between normal and view across, roughness down, both from 0 in the first entry
/// to 1 in the last.
pub(super) fn table() -> &'static [[f32; 3]] {
    static TABLE: OnceLock<Vec<[f32; 3]>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let at = |i: usize| i as f32 / (SIDE - 1) as f32;
        (0..SIDE * SIDE)
            .map(|i| entry(at(i % SIDE), at(i / SIDE)))
            .collect()
    })
}

/// The table's entry between the entries, as shaders look it up.
#[cfg(test)]
pub(super) fn looked_up(cosine: f32, roughness: f32) -> Vec3 {
    let last = (SIDE - 1) as f32;
    let at = Vec2::new(cosine, roughness) * last;
    let low = at.floor().min(Vec2::splat(last - 1.0));
    let f = at - low;
    let entry = |x: f32, y: f32| Vec3::from(table()[y as usize * SIDE + x as usize]);
    let row = |y: f32| entry(low.x, y).lerp(entry(low.x + 1.0, y), f.x);
    row(low.y).lerp(row(low.y + 1.0), f.y)
}
