//! Random boxes, the same on every machine.
//!
//! Box i has its centre anywhere in the scene's bounds and, in each axis on its own, a half extent
//! of 0.1 % to 2 % of the bounds' diagonal, small ones as likely as large ones on a logarithmic
//! scale. Numbers come from an integer hash of (i, which number), top 24 bits.

use foveal_cull::Aabb;
use glam::Vec3;

/// `count` boxes within `bounds`; none where there is no geometry.
pub(super) fn random(bounds: foveal_scene::Aabb, count: u32) -> Vec<Aabb> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let size = bounds.size();
    let diagonal = size.length();
    (0..count)
        .map(|i| {
            let point = |first: u32| {
                Vec3::from_array([0, 1, 2].map(|axis| unit(i.wrapping_mul(8) + first + axis)))
            };
            let center = bounds.min + size * point(0);
            let half = point(3).map(|u| 0.001 * diagonal * 20.0_f32.powf(u));
            Aabb::new(center - half, center + half)
        })
        .collect()
}

/// A number in [0, 1) from a number: the finalizer of SplitMix64 (Steele, Lea, Flood 2014).
pub(super) fn unit(n: u32) -> f32 {
    let mut z = (u64::from(n) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_fill_the_bounds_and_stay_the_same() {
        let bounds = foveal_scene::Aabb {
            min: Vec3::new(-10.0, 0.0, 5.0),
            max: Vec3::new(10.0, 4.0, 6.0),
        };
        let boxes = random(bounds, 1000);
        assert_eq!(boxes, random(bounds, 1000));
        let center = |b: &Aabb| (Vec3::from(b.min) + Vec3::from(b.max)) * 0.5;
        let mean = boxes.iter().map(center).sum::<Vec3>() / 1000.0;
        assert!(
            (mean - bounds.center())
                .abs()
                .cmplt(bounds.size() * 0.05)
                .all()
        );
        let grows = |b: &Aabb| (0..3).all(|axis| b.min[axis] < b.max[axis]);
        assert!(boxes.iter().all(grows));
    }
}
