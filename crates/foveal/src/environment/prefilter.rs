//! What rough mirrors reflect of a cube map: the first sum of the split-sum approximation (Karis
//! 2013, 'Real Shading in Unreal Engine 4'), sampled by importance from a mip chain (Křivánek and
//! Colbert 2008, 'Real-time Shading with Filtered Importance Sampling'), so that a small sun is no
//! rain of dots.

use std::f32::consts::PI;

use glam::{Vec3, Vec3A};
use half::f16;

use super::cube::{Cube, SIDES, direction_of, texel_center};
use super::reflectance::{density, half_vector};

/// Texels a side of the coarsest level.
const LEAST_SIDE: u32 = 8;

/// Levels of the mip chain by which samples are looked up coarser than their own solid angle.
const BLUR: f32 = 1.5;

/// Which roughness each level of the map stands for.
///
/// Level 0 is a mirror. The squared roughness of the others grows evenly in its logarithm up to 1
/// at the last: that of level 1 is four of its texels wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels {
    /// Number of the last level.
    pub(crate) last: f32,
    /// Levels per doubling of the roughness, from level 1 on.
    pub(crate) per_doubling: f32,
    /// One over the squared roughness of level 1.
    pub(crate) sharpness: f32,
}

impl Levels {
    /// Of a map of `side` texels a side, a power of two of at least 64.
    pub(crate) fn of(side: u32) -> Self {
        let last = (side / LEAST_SIDE).ilog2() as f32;
        let sharpness = (side / 8) as f32;
        Self {
            last,
            per_doubling: 2.0 * (last - 1.0) / sharpness.log2(),
            sharpness,
        }
    }

    /// Squared roughness of a level; 0 for a mirror.
    pub(super) fn alpha(&self, level: u32) -> f32 {
        if level == 0 {
            return 0.0;
        }
        (2.0 * (level as f32 - self.last) / self.per_doubling).exp2()
    }

    /// The level of a roughness, between levels too: `environment_level` in
    /// `shared/environment.wgsl`.
    #[cfg(test)]
    pub(super) fn level(&self, roughness: f32) -> f32 {
        let r = roughness.max(1e-3);
        let near = (r * r * self.sharpness).min(1.0);
        near.max(self.last + self.per_doubling * r.log2())
    }
}

/// Samples per texel of a level: the finest level has the narrowest lobes and most texels.
fn sample_count(level: u32) -> u32 {
    (64 << level).min(4096)
}

/// A direction around a lobe's axis, z.
#[derive(Clone, Copy, Debug)]
struct Tap {
    direction: Vec3,
    weight: f32,
    /// Of the mip chain.
    mip: usize,
}

/// Samples of the GGX lobe whose viewer looks along the normal. `texel`: solid angle of a texel of
/// level 0 of the mip chain, which has `mips` levels.
fn taps(alpha: f32, count: u32, texel: f32, mips: usize) -> Vec<Tap> {
    let a2 = alpha * alpha;
    let tap = |i| {
        let (h, cos2) = half_vector(i, count, a2);
        let direction = 2.0 * h.z * h - Vec3::Z;
        let solid_angle = 1.0 / (count as f32 * density(cos2, a2));
        let mip = 0.5 * (solid_angle / texel).log2() + BLUR;
        Tap {
            direction,
            weight: direction.z,
            mip: (mip.round().max(0.0) as usize).min(mips - 1),
        }
    };
    (0..count).map(tap).filter(|t| t.weight > 0.0).collect()
}

/// A right-handed frame around a unit vector (Duff et al. 2017, 'Building an Orthonormal Basis,
/// Revisited').
fn frame_around(n: Vec3) -> [Vec3; 2] {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
    ]
}

/// What a mirror of this roughness reflects, with `side` texels a side.
fn filtered(chain: &[Cube], side: usize, alpha: f32, count: u32) -> Cube {
    let texel = 4.0 * PI / (SIDES * chain[0].side * chain[0].side) as f32;
    let taps = taps(alpha, count, texel, chain.len());
    let weights: f32 = taps.iter().map(|t| t.weight).sum();
    Cube::from_texels(side, |face, x, y| {
        let axis = direction_of(face, texel_center(side, x, y)).normalize();
        let [across, up] = frame_around(axis);
        let mut sum = Vec3A::ZERO;
        for tap in &taps {
            let d = tap.direction;
            let direction = across * d.x + up * d.y + axis * d.z;
            sum += chain[tap.mip].sample(direction) * tap.weight;
        }
        sum / weights
    })
}

/// All levels of the map whose level 0 is `cube`.
pub(super) fn prefilter(cube: Cube) -> Vec<Cube> {
    let side = cube.side;
    let levels = Levels::of(side as u32);
    let mut chain = vec![cube];
    while let Some(last) = chain.last().filter(|last| last.side > 1) {
        chain.push(last.halved());
    }
    let rough: Vec<Cube> = (1..=levels.last as u32)
        .map(|level| {
            let alpha = levels.alpha(level);
            filtered(&chain, side >> level, alpha, sample_count(level))
        })
        .collect();
    chain.truncate(1);
    chain.extend(rough);
    chain
}

/// A level's texels as the device has them, halves, side by side and row by row.
pub(super) fn halves(cube: &Cube) -> Vec<[u16; 4]> {
    let most = f32::from(f16::MAX);
    let mut texels = Vec::with_capacity(SIDES * cube.side * cube.side);
    for face in 0..SIDES {
        for y in 0..cube.side {
            for x in 0..cube.side {
                let rgb = cube.texel(face, x, y).to_array();
                let [r, g, b] = rgb.map(|v| f16::from_f32(v.min(most)).to_bits());
                texels.push([r, g, b, f16::ONE.to_bits()]);
            }
        }
    }
    texels
}
