//! The CPU twins of the edge tests and of the resolve, in plain Rust.

use foveal_scene::{Camera, Projection};
use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};

use super::pattern::{Band, Pattern};

/// A band of sub-samples as the device drew it; the band is the whole frame.
pub(super) struct SampleTexels {
    pub(super) pattern: Pattern,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) surface: Vec<[u32; 4]>,
    pub(super) identity: Vec<[u32; 2]>,
    pub(super) depth: Vec<f32>,
}

impl SampleTexels {
    /// Index of a sub-sample's texel.
    fn texel(&self, x: u32, y: u32, index: u32) -> usize {
        let (x, y) = match self.pattern {
            Pattern::Grid { side } => (x * side + index % side, y * side + index / side),
            Pattern::Rotated(_) => (x, y + index * self.height),
        };
        let (across, _) = self.pattern.texels(self.width, self.height);
        (y * across + x) as usize
    }

    /// Where a sub-sample lies, in pixels.
    fn position(&self, x: u32, y: u32, index: u32) -> Vec2 {
        let corner = Vec2::new(x as f32, y as f32);
        match self.pattern {
            Pattern::Grid { side } => {
                let cell = Vec2::new((index % side) as f32, (index / side) as f32) + 0.5;
                corner + cell / side as f32
            }
            Pattern::Rotated(offsets) => {
                let [x, y] = offsets[index as usize].map(|v| f32::from(v) / 16.0);
                corner + Vec2::new(x, y)
            }
        }
    }

    /// The source's edge test: whether any depth is more than 1e-4 from the first.
    pub(super) fn depths_differ(&self, x: u32, y: u32) -> bool {
        let depth = |index| self.depth[self.texel(x, y, index)];
        (1..self.pattern.count()).any(|index| (depth(index) - depth(0)).abs() > 1e-4)
    }

    /// How many surfaces the pixel shows, and how many sub-samples the largest has.
    pub(super) fn surfaces(&self, camera: &Camera, x: u32, y: u32) -> [u8; 2] {
        let facets: Vec<Facet> = (0..self.pattern.count())
            .map(|index| self.facet(camera, x, y, index))
            .collect();
        let mut left: Vec<usize> = (0..facets.len()).collect();
        let (mut surfaces, mut largest) = (0, 0);
        while let Some(&leader) = left.first() {
            let before = left.len();
            left.retain(|&i| {
                i != leader && !same_surface(self, camera, &facets[leader], &facets[i])
            });
            surfaces += 1;
            largest = largest.max((before - left.len()) as u8);
        }
        [surfaces, largest]
    }

    fn facet(&self, camera: &Camera, x: u32, y: u32, index: u32) -> Facet {
        let texel = self.texel(x, y, index);
        let view = view_from_ndc(self, camera);
        let size = Vec2::new(self.width as f32, self.height as f32);
        let ndc = Vec2::new(2.0, -2.0) * self.position(x, y, index) / size + Vec2::new(-1.0, 1.0);
        let xy = ndc * view.xy() + Vec2::new(view.z, view.w);
        let distance = match camera.projection {
            Projection::Perspective { near_m, .. } => near_m / self.depth[texel],
            Projection::Orthographic { near_m, far_m, .. } => {
                near_m + (1.0 - self.depth[texel]) * (far_m - near_m)
            }
        };
        let scale = if is_orthographic(camera) {
            1.0
        } else {
            distance
        };
        let word = self.surface[texel][3];
        let e = [word >> 16, word >> 24].map(|byte| f32::from(byte as u8 as i8));
        let z = 127.0 - e[0].abs() - e[1].abs();
        let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
        let normal = if z >= 0.0 {
            Vec3::new(e[0], e[1], z)
        } else {
            let x = (127.0 - e[1].abs()) * sign(e[0]);
            Vec3::new(x, (127.0 - e[0].abs()) * sign(e[1]), z)
        };
        Facet {
            instance: self.identity[texel][0],
            position: (xy * scale).extend(-distance),
            normal,
        }
    }
}

struct Facet {
    instance: u32,
    position: Vec3,
    normal: Vec3,
}

fn is_orthographic(camera: &Camera) -> bool {
    matches!(camera.projection, Projection::Orthographic { .. })
}

fn view_from_ndc(texels: &SampleTexels, camera: &Camera) -> Vec4 {
    let m = camera.clip_from_view(texels.width as f32 / texels.height as f32);
    let (x, y) = (m.x_axis.x, m.y_axis.y);
    let shift = if is_orthographic(camera) {
        -m.w_axis
    } else {
        m.z_axis
    };
    Vec4::new(1.0 / x, 1.0 / y, shift.x / x, shift.y / y)
}

fn same_surface(texels: &SampleTexels, camera: &Camera, a: &Facet, b: &Facet) -> bool {
    if a.instance != b.instance {
        return false;
    }
    if a.instance == 0 {
        return true;
    }
    let ab = a.normal.dot(b.normal);
    let aa = a.normal.dot(a.normal);
    if ab <= 0.0 || ab * ab < 0.75 * aa * b.normal.dot(b.normal) {
        return false;
    }
    let step = b.position - a.position;
    let w = camera.world_from_view;
    let normal = Vec3::new(
        w.x_axis.truncate().dot(a.normal),
        w.y_axis.truncate().dot(a.normal),
        w.z_axis.truncate().dot(a.normal),
    );
    let off = normal.dot(step);
    let scale = if is_orthographic(camera) {
        1.0
    } else {
        -a.position.z
    };
    let pixel_side = 2.0 * view_from_ndc(texels, camera).y / texels.height as f32 * scale;
    let tolerance = 0.5 * 0.5 * pixel_side * pixel_side + 0.03 * 0.03 * step.dot(step);
    off * off <= tolerance * aa
}

/// The resolve: radiances averaged by brightness-dependent weights; each counts for its part of the
/// pixel.
pub(super) fn resolve(parts: impl IntoIterator<Item = (Vec3, f32)>, exposure: f32) -> Vec3 {
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    for (radiance, part) in parts {
        let luma = radiance.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        let weight = part / (1.0 + exposure * luma);
        sum += radiance * weight;
        weights += weight;
    }
    sum / weights
}

/// The windows of one band that is the whole frame.
#[test]
fn a_rotated_patterns_windows_put_each_sample_in_the_middle_of_its_texel() {
    let settings = crate::Settings::default().with(|s| {
        s.antialiasing.pattern = crate::SamplePattern::Rotated;
        s.antialiasing.samples = 8;
    });
    let pattern = Pattern::of(&settings);
    let texels = SampleTexels {
        pattern,
        width: 10,
        height: 6,
        surface: Vec::new(),
        identity: Vec::new(),
        depth: Vec::new(),
    };
    let band = Band {
        first_row: 0,
        rows: 6,
    };
    for (index, window) in (0..).zip(band.windows(&pattern, 10, 6)) {
        let sample = texels.position(3, 2, index);
        let [left, top, width, height] = window.frame;
        assert_eq!((width, height), (10.0, 6.0));
        let texel = texels.texel(3, 2, index);
        assert_eq!(left + sample.x, (texel % 10) as f32 + 0.5);
        assert_eq!(top + sample.y, (texel / 10) as f32 + 0.5);
    }
}
