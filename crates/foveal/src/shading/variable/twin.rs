//! The CPU twins of reprojection, rates and samples.

use foveal_scene::Camera;
use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

use super::probes::Probe;
use crate::rate::RequestUniform;
use crate::shading::twin::position_at;
use crate::testing::f32_of_half;
use crate::{Contrast, RateCombine, RateSource, Settings};

/// What the passes read of a frame; rows top to bottom.
pub(super) struct Seen {
    pub(super) size: UVec2,
    pub(super) identity: Vec<[u32; 2]>,
    pub(super) depth: Vec<f32>,
}

/// Content asks for a block where its pixels are alike: a bit of requested rates.
const IF_ALIKE: u32 = 8;
/// The constants of the shaders.
const DARK: f32 = 0.1;
const FLAT: f32 = 0.9;
const SAME_DISTANCE: f32 = 0.02;
const INSTANCE: u32 = 0x3fff;
pub(super) const KNOWN: u32 = 0x4000;
pub(super) const FULL: u32 = 0x8000;
pub(super) const PROBED: u32 = 16;
pub(super) const UNKNOWN: u32 = 32;

impl Seen {
    fn at(&self, texel: UVec2) -> usize {
        (texel.y * self.size.x + texel.x) as usize
    }

    pub(super) fn quads(&self) -> UVec2 {
        (self.size + 1) / 2
    }

    /// Motion in pixels; of the background as `[camera, previous]` see it, perspective cameras.
    fn motion(&self, texel: UVec2, cameras: [&Camera; 2]) -> Vec2 {
        let [who, motion] = self.identity[self.at(texel)];
        if who == 0 {
            return self.motion_of_background(texel, cameras);
        }
        Vec2::new(
            f32_of_half(motion as u16),
            f32_of_half((motion >> 16) as u16),
        )
    }

    fn motion_of_background(&self, texel: UVec2, [camera, previous]: [&Camera; 2]) -> Vec2 {
        let size = self.size.as_vec2();
        let pixel = texel.as_vec2() + 0.5;
        let direction = position_at(camera, size, pixel, 0.01) - camera.eye();
        let before = previous.clip_from_world(size.x / size.y) * direction.extend(0.0);
        if before.w <= 0.0 {
            return Vec2::splat(60000.0);
        }
        let ndc = before.truncate().truncate() / before.w;
        pixel - (ndc * Vec2::new(0.5, -0.5) + 0.5) * size
    }

    /// Position at a place relative to a texel, as far as the picture goes.
    fn position(&self, camera: &Camera, texel: UVec2, offset: IVec2) -> Vec3 {
        let last = self.size.as_ivec2() - 1;
        let texel = (texel.as_ivec2() + offset)
            .clamp(IVec2::ZERO, last)
            .as_uvec2();
        let pixel = texel.as_vec2() + 0.5;
        position_at(
            camera,
            self.size.as_vec2(),
            pixel,
            self.depth[self.at(texel)],
        )
    }
}

fn texel_of(texel: IVec2, size: UVec2) -> Option<usize> {
    let inside = texel.cmpge(IVec2::ZERO).all() && texel.as_uvec2().cmplt(size).all();
    inside.then(|| (texel.y as u32 * size.x + texel.x as u32) as usize)
}

/// The distance that is kept with what is known.
pub(super) fn distance_of(place: u32) -> f32 {
    f32::from_bits(place & 0xffff_0000)
}

/// What `reproject.wgsl` knows of each quad, but for whether it is shaded in full now; perspective
/// cameras.
pub(super) fn reproject(
    seen: &Seen,
    [camera, previous]: [&Camera; 2],
    before: &[[u32; 2]],
    picture: &[[u8; 4]],
) -> Vec<[u32; 2]> {
    let size = seen.size.as_vec2();
    let quads = seen.quads();
    let luma = |texel: UVec2| {
        let rgba = picture[seen.at(texel.min(seen.size - 1))].map(|b| f32::from(b) / 255.0);
        let luma = Vec3::new(rgba[0], rgba[1], rgba[2]).dot(Vec3::new(0.2126, 0.7152, 0.0722));
        (luma * 255.0 + 0.5).floor() as u8
    };
    let near = camera.clip_from_view(1.0).w_axis.z;
    (0..quads.y)
        .flat_map(|y| (0..quads.x).map(move |x| UVec2::new(x, y)))
        .map(|quad| {
            let texel = quad * 2;
            let i = seen.at(texel);
            let who = seen.identity[i][0];
            let depth = seen.depth[i];
            let (mut distance, mut expected) = (0.0, 0.0);
            if depth > 0.0 {
                distance = near / depth;
                let world = position_at(camera, size, texel.as_vec2() + 0.5, depth);
                expected = (previous.clip_from_world(size.x / size.y) * world.extend(1.0)).w;
            }
            let place = (distance.to_bits() + 0x8000) & 0xffff_0000 | who & INSTANCE;
            let mut found = [0, place];
            let motion = seen.motion(texel, [camera, previous]);
            let then = ((texel.as_vec2() + 1.0 - motion) * 0.5).floor();
            if let Some(then_at) = texel_of(then.as_ivec2(), quads) {
                let [lumas, old] = before[then_at];
                let off = (distance_of(old) - expected).abs();
                if old & INSTANCE == who & INSTANCE && off <= SAME_DISTANCE * expected {
                    found = [lumas, place | old & KNOWN];
                    if old & FULL != 0 {
                        let first = then.as_uvec2() * 2;
                        let of = |x, y| luma(first + UVec2::new(x, y));
                        let lumas = [of(0, 0), of(1, 0), of(0, 1), of(1, 1)];
                        found = [u32::from_le_bytes(lumas), place | KNOWN];
                    }
                }
            }
            found
        })
        .collect()
}

fn lumas(word: u32) -> Vec4 {
    Vec4::from_array(word.to_le_bytes().map(|b| f32::from(b) / 255.0))
}

/// Contrast of each quad across and down.
fn contrast(kind: Contrast, known: &[[u32; 2]], quads: UVec2, quad: UVec2) -> Vec2 {
    let own = lumas(known[(quad.y * quads.x + quad.x) as usize][0]);
    // Luma of a pixel of the 4 x 4 around and in the quad; a quad that is not there or unknown is
    // like this one.
    let pixel = |x: i32, y: i32| {
        let at = quad.as_ivec2() * 2 + IVec2::new(x, y);
        let cell = texel_of(at.div_euclid(IVec2::splat(2)), quads).map(|i| known[i]);
        let l = cell
            .filter(|c| c[1] & KNOWN != 0)
            .map_or(own, |c| lumas(c[0]));
        let within = at.rem_euclid(IVec2::splat(2));
        l[(within.x + 2 * within.y) as usize]
    };
    let each = || (0..2).flat_map(|y| (0..2).map(move |x| (x, y)));
    let most = |f: &dyn Fn(i32, i32) -> f32| each().map(|(x, y)| f(x, y).abs()).fold(0.0, f32::max);
    let mean = |cells: &mut dyn Iterator<Item = (i32, i32)>| {
        let all: Vec<f32> = cells.map(|(x, y)| pixel(x, y)).collect();
        all.iter().sum::<f32>() / all.len() as f32 + DARK
    };
    let square = || (-1..3).flat_map(|y| (-1..3).map(move |x| (x, y)));
    match kind {
        Contrast::Quad => {
            let across = most(&|_, y| pixel(0, y) - pixel(1, y));
            let down = most(&|x, _| pixel(x, 0) - pixel(x, 1));
            Vec2::new(across, down) / mean(&mut each())
        }
        Contrast::Neighbors => {
            let across = most(&|x, y| pixel(x, y) - pixel(x + 1, y))
                .max(most(&|x, y| pixel(x, y) - pixel(x - 1, y)));
            let down = most(&|x, y| pixel(x, y) - pixel(x, y + 1))
                .max(most(&|x, y| pixel(x, y) - pixel(x, y - 1)));
            let corner = |v: i32| v == -1 || v == 2;
            let mut cross = square().filter(|&(x, y)| !(corner(x) && corner(y)));
            Vec2::new(across, down) / mean(&mut cross)
        }
        Contrast::Sobel => {
            let weight = |i: i32| 2.0 - i.abs() as f32;
            let kernel = |x: i32, y: i32, along_x: bool| {
                let mut sum = 0.0;
                for i in -1..=1 {
                    for (end, sign) in [(1, 1.0), (-1, -1.0)] {
                        let (dx, dy) = if along_x { (end, i) } else { (i, end) };
                        sum += sign * weight(i) * pixel(x + dx, y + dy);
                    }
                }
                sum / 4.0
            };
            let across = most(&|x, y| kernel(x, y, true));
            let down = most(&|x, y| kernel(x, y, false));
            Vec2::new(across, down) / mean(&mut square())
        }
    }
}

fn are_parallel(a: Vec3, b: Vec3) -> bool {
    a.dot(b) >= FLAT * a.length() * b.length()
}

/// The coarsest rate at which a quad's pixels show one surface.
fn surface_limit(seen: &Seen, camera: &Camera, first: UVec2) -> u32 {
    let offsets = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE];
    let texels = offsets.map(|o| (first + o).min(seen.size - 1));
    let who = texels.map(|t| seen.identity[seen.at(t)][0]);
    let wide = who[0] == who[1] && who[2] == who[3];
    let tall = who[0] == who[2] && who[1] == who[3];
    if who[0] == 0 || who[3] == 0 {
        return u32::from(wide) | u32::from(tall) << 1;
    }
    if texels[3] != first + 1 {
        return 0;
    }
    let at = |x, y| seen.position(camera, first, IVec2::new(x, y));
    let [p, q, r, s] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
    let upper = (q - p).cross(r - p);
    let flat = are_parallel(upper, (r - s).cross(q - s));
    let across = are_parallel(upper, (p - at(-1, 0)).cross(r - p))
        || are_parallel(upper, (at(2, 0) - q).cross(s - q));
    let down = are_parallel(upper, (q - p).cross(p - at(0, -1)))
        || are_parallel(upper, (s - r).cross(at(0, 2) - r));
    u32::from(wide && flat && across) | u32::from(tall && flat && down) << 1
}

/// Whether the quads of a block, whose first pixel is given, lie in one plane.
fn block_is_flat(seen: &Seen, camera: &Camera, first: UVec2) -> bool {
    if seen.identity[seen.at(first)][0] == 0 {
        return true;
    }
    let plane = |x, y, side| {
        let at = |dx, dy| seen.position(camera, first, IVec2::new(x + dx * side, y + dy * side));
        (at(1, 0) - at(0, 0)).cross(at(0, 1) - at(0, 0))
    };
    let own = plane(0, 0, 1);
    let of_block = [plane(0, 0, 2), plane(2, 2, -2)];
    let of_quads = [plane(2, 0, 1), plane(0, 2, 1), plane(2, 2, 1)];
    let mut all = of_block.into_iter().chain(of_quads);
    all.all(|other| are_parallel(own, other))
}

/// The mask that follows from what is known.
pub(super) fn rates(
    settings: &Settings,
    seen: &Seen,
    [camera, previous]: [&Camera; 2],
    known: &[[u32; 2]],
    probe: Probe,
) -> Vec<u32> {
    let quads = seen.quads();
    let eyes = crate::stereo::eyes(settings, camera).unwrap();
    let request = RequestUniform::new(settings, &eyes, None);
    let each = || (0..quads.y).flat_map(|y| (0..quads.x).map(move |x| UVec2::new(x, y)));
    let of_level = |level: u32| [0, 3, 7 | IF_ALIKE][level.min(2) as usize];
    let single: Vec<(u32, u32)> = each()
        .map(|quad| {
            let cell = known[(quad.y * quads.x + quad.x) as usize];
            let probed =
                quad.x & probe.mask == probe.class[0] && quad.y & probe.mask == probe.class[1];
            let notes =
                if probed { PROBED } else { 0 } | if cell[1] & KNOWN == 0 { UNKNOWN } else { 0 };
            if notes != 0 {
                return (0, notes);
            }
            let from = |source| match source {
                RateSource::Foveated => {
                    let centre = (quad * 2).as_vec2() + 1.0;
                    of_level(request.foveated(settings, centre.into()))
                }
                RateSource::Radii => {
                    let centre = (quad * 2).as_vec2() + 1.0
                        - Vec2::new(request.gaze[0][0], request.gaze[0][1]);
                    let radii = request.squared_radii.as_flattened().iter();
                    of_level(radii.filter(|&&r| centre.length_squared() >= r).count() as u32)
                }
                RateSource::Constant => of_level(request.constant_level),
                RateSource::Image | RateSource::Lens | RateSource::Content => {
                    let motion = seen.motion(quad * 2, [camera, previous]).length();
                    let threshold = settings.variable.threshold
                        * (1.0 + settings.variable.velocity_gain * motion);
                    let c = contrast(settings.variable.contrast, known, quads, quad);
                    let (wide, tall) = (c.x <= threshold, c.y <= threshold);
                    let if_alike = if wide && tall { IF_ALIKE } else { 0 };
                    u32::from(wide) | u32::from(tall) << 1 | if_alike
                }
            };
            let requested = match settings.coarse.combine {
                RateCombine::First => from(settings.coarse.source),
                RateCombine::Coarser => {
                    from(settings.coarse.source) | from(settings.coarse.other_source)
                }
                RateCombine::Finer => {
                    from(settings.coarse.source) & from(settings.coarse.other_source)
                }
            };
            let rate = requested & (surface_limit(seen, camera, quad * 2) | 4 | IF_ALIKE);
            (if rate & 3 == 3 { rate } else { rate & 3 }, 0)
        })
        .collect();
    each()
        .map(|quad| {
            let (rate, notes) = single[(quad.y * quads.x + quad.x) as usize];
            let first = quad / 2 * 2;
            let block: Vec<usize> = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE]
                .iter()
                .filter_map(|&o| texel_of((first + o).as_ivec2(), quads))
                .collect();
            let who = |i: usize| {
                let quad = UVec2::new(i as u32 % quads.x, i as u32 / quads.x);
                seen.identity[seen.at(quad * 2)][0]
            };
            let together = block
                .iter()
                .fold(7 | IF_ALIKE, |rates, &i| rates & single[i].0);
            let all = block.iter().flat_map(|&i| lumas(known[i][0]).to_array());
            let (low, high) = all.fold((1.0f32, 0.0f32), |(l, h), v| (l.min(v), h.max(v)));
            let alike = high - low <= settings.variable.threshold * (0.5 * (low + high) + DARK);
            let is_block = settings.variable.blocks_4x4
                && block.len() == 4
                && block.iter().all(|&i| who(i) == who(block[0]))
                && (together & 4 != 0 || (together & IF_ALIKE != 0 && alike))
                && together & 3 == 3
                && block_is_flat(seen, camera, first * 2);
            if is_block {
                7 | notes
            } else {
                rate & 3 | notes
            }
        })
        .collect()
}

/// Pixels across and down of a sample.
pub(crate) fn extent(rate: u32) -> UVec2 {
    match rate & 7 {
        7 => UVec2::splat(4),
        rate => UVec2::new(1 + (rate & 1), 1 + (rate >> 1 & 1)),
    }
}

/// The samples of a mask, packed as in `rates.wgsl`, sorted.
pub(super) fn samples(mask: &[u32], size: UVec2) -> Vec<u32> {
    let across = size.x.div_ceil(2);
    let mut samples: Vec<u32> = (0..size.y)
        .flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)))
        .filter_map(|t| {
            let rate = mask[(t.y / 2 * across + t.x / 2) as usize] & 7;
            (t % extent(rate) == UVec2::ZERO).then(|| packed(t, rate))
        })
        .collect();
    samples.sort_unstable();
    samples
}

/// A sample in one word.
fn packed(texel: UVec2, rate: u32) -> u32 {
    let [quad, within] = [texel / 2, texel % 2];
    let column = if rate == 7 { 1 } else { within.x };
    quad.x | quad.y << 14 | column << 28 | within.y << 29 | (rate & 3) << 30
}

/// The upper left pixel of a sample in one word.
pub(super) fn first_pixel(sample: u32) -> UVec2 {
    let quad = UVec2::new(sample & 0x3fff, sample >> 14 & 0x3fff);
    let wide = sample >> 30 & 1;
    quad * 2 + UVec2::new((sample >> 28 & 1) & !wide, sample >> 29 & 1)
}
