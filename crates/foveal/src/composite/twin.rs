//! The twin of the smooth composite: each pixel by itself, from the tiling, its samples and the
//! G-buffer of one eye.

use foveal_generate as generate;
use foveal_scene::Camera;
use glam::{IVec2, UVec2, Vec2, Vec3};

use crate::gpu::read_level;
use crate::shading::sample_texel;
use crate::shading::twin::{normal_of_depth, position_at, unit_from_octahedral};
use crate::testing::{f32_of_half, gpu, rate_cells, rendered, small, texels};
use crate::{CoarseSample, Composite, Frame, Geometry, RateSource, RefineEdges, Renderer, Shading};

/// Bits of a rate map's cell.
const CELL_LEVEL: u8 = 15;
const CELL_EDGE: u8 = 128;

#[derive(Clone, Copy, PartialEq)]
struct Tile {
    level: u32,
    block: UVec2,
    has_edge: bool,
}

/// What a tile's sample holds, and the texel that it looked at.
#[derive(Clone, Copy)]
struct Sample {
    radiance: Vec3,
    texel: UVec2,
}

struct Seen {
    instance: u32,
    position: Vec3,
    normal: Vec3,
}

/// `composite/seen.wgsl`.
fn same_surface(a: &Seen, b: &Seen, same_normal: f32) -> bool {
    if a.instance != b.instance {
        return false;
    }
    if a.instance == 0 {
        return true;
    }
    let between = b.position - a.position;
    let away = between.dot(a.normal).abs().max(between.dot(b.normal).abs());
    away <= 0.45 * between.length() && a.normal.dot(b.normal) > same_normal
}

/// Radiance at a tile's corners: upper left, upper right, lower left, lower right.
type Corners = [Vec3; 4];

fn bilinear(corners: &Corners, uv: Vec2) -> Vec3 {
    let upper = corners[0].lerp(corners[1], uv.x);
    upper.lerp(corners[2].lerp(corners[3], uv.x), uv.y)
}

/// What the composite reads.
struct Inputs {
    size: UVec2,
    camera: Camera,
    owner: Vec<u8>,
    /// Per level: rows of RGBA.
    samples: Vec<Vec<[f32; 4]>>,
    surface: Vec<[u32; 4]>,
    /// Instance and triangle.
    identity: Vec<[u32; 2]>,
    depth: Vec<f32>,
    by_depth: bool,
}

impl Inputs {
    fn of(renderer: &Renderer, camera: &Camera) -> Self {
        let targets = renderer.targets();
        let coarse = targets.coarse.as_ref().unwrap();
        let read = |texture: &wgpu::Texture, mip, size| {
            pollster::block_on(read_level(gpu(), texture, mip, size)).unwrap()
        };
        let samples = &coarse.samples;
        Self {
            size: UVec2::new(
                renderer.settings().picture.width,
                renderer.settings().picture.height,
            ),
            camera: camera.clone(),
            owner: rate_cells(&coarse.rate.owner, 1),
            samples: samples
                .range()
                .map(|level| {
                    let bytes = read(&samples.texture, level, samples.blocks(level));
                    let halves: Vec<[u16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
                    halves.iter().map(|texel| texel.map(f32_of_half)).collect()
                })
                .collect(),
            surface: texels(&targets.gbuffer.surface_view),
            identity: texels(&targets.gbuffer.identity_view),
            depth: texels(&targets.gbuffer.depth_view),
            by_depth: renderer.settings().sees_by_depth(),
        }
    }

    fn tile_at(&self, texel: UVec2) -> Tile {
        let cell = self.owner[((texel.y / 2) * self.size.x.div_ceil(2) + texel.x / 2) as usize];
        let level = u32::from(cell & CELL_LEVEL);
        Tile {
            level,
            block: texel >> level,
            has_edge: cell & CELL_EDGE != 0,
        }
    }

    fn sample(&self, tile: Tile) -> Sample {
        let across = self.size.x.div_ceil(1 << tile.level);
        let index = (tile.block.y * across + tile.block.x) as usize;
        let [r, g, b, a] = self.samples[tile.level as usize][index];
        let texel = sample_texel(
            tile.block.into(),
            tile.level,
            (a + 0.5) as u32 - 1,
            self.size.into(),
        );
        Sample {
            radiance: Vec3::new(r, g, b),
            texel: texel.into(),
        }
    }

    fn seen(&self, texel: UVec2) -> Seen {
        let i = (texel.y * self.size.x + texel.x) as usize;
        let pixel = texel.as_vec2() + 0.5;
        Seen {
            instance: self.identity[i][0],
            position: position_at(
                &self.camera,
                self.size.as_vec2(),
                pixel,
                self.depth[i].max(1e-20),
            ),
            normal: unit_from_octahedral(self.surface[i][1]),
        }
    }

    /// As pixels are compared: `normal_of_depth.wgsl` where only samples have surfaces.
    fn compared(&self, texel: UVec2) -> Seen {
        let mut seen = self.seen(texel);
        if self.by_depth {
            seen.normal = normal_of_depth(&self.camera, self.size, &self.depth, texel);
        }
        seen
    }

    /// Whether what a pixel shows is what a tile's sample looked at.
    fn looks_the_same(&self, pixel: &Seen, tile: Tile) -> bool {
        let sampled = self.compared(self.sample(tile).texel);
        same_surface(pixel, &sampled, if self.by_depth { 0.7 } else { 0.5 })
    }

    fn low(&self, tile: Tile) -> UVec2 {
        tile.block << tile.level
    }

    fn high(&self, tile: Tile) -> UVec2 {
        (self.low(tile) + (1 << tile.level)).min(self.size)
    }

    /// Where a position lies in a tile's part inside the picture, 0 to 1.
    fn within(&self, tile: Tile, position: Vec2) -> Vec2 {
        let low = self.low(tile).as_vec2();
        (position - low) / (self.high(tile).as_vec2() - low)
    }

    /// The texel of a quadrant around a corner, as `fit.wgsl` says; `None` where there is none.
    fn quadrant_texel(&self, corner: IVec2, quadrant: u32) -> Option<IVec2> {
        let last = self.size.as_ivec2() - 1;
        let mut texel = corner - 1 + IVec2::new(quadrant as i32 & 1, quadrant as i32 >> 1);
        for axis in 0..2 {
            if texel[axis] >= 0 && texel[axis] <= last[axis] {
                continue;
            }
            let touching = self.tile_at(texel.clamp(IVec2::ZERO, last).as_uvec2());
            texel[axis] = if texel[axis] < 0 {
                self.high(touching)[axis] as i32
            } else {
                self.low(touching)[axis] as i32 - 1
            };
            if texel[axis] < 0 || texel[axis] > last[axis] {
                return None;
            }
        }
        Some(texel)
    }

    fn corner(&self, corner: IVec2, own: Tile) -> Vec3 {
        let own_sample = self.sample(own);
        let own_seen = self.seen(own_sample.texel);
        let around: Vec<(IVec2, Tile)> = (0..4)
            .filter_map(|i| self.quadrant_texel(corner, i))
            .map(|texel| (texel, self.tile_at(texel.as_uvec2())))
            .collect();
        let touches = |texel: IVec2| (2 * (texel - corner) + 1).abs() == IVec2::ONE;
        let mut all_touch = around.len() == 4 && around.iter().all(|(texel, _)| touches(*texel));
        let all_pure = around.iter().all(|(_, t)| !t.has_edge && t.level > 0);
        let (mut least, mut most) = (own_sample.radiance, own_sample.radiance);
        // Offset, weight and radiance of each sample that takes part.
        let mut parts: Vec<(Vec2, f32, Vec3)> = Vec::new();
        for (_, tile) in around {
            let sample = self.sample(tile);
            let is_own = tile.block == own.block && tile.level == own.level;
            let counts =
                all_pure || is_own || same_surface(&own_seen, &self.seen(sample.texel), 0.5);
            if !counts {
                all_touch = false;
                continue;
            }
            let (low, high) = (self.low(tile).as_ivec2(), self.high(tile).as_ivec2());
            let is_on_edge = (corner.cmpgt(low) & corner.cmplt(high)).any()
                && (corner.cmpge(low) & corner.cmple(high)).all();
            if tile.level > own.level && is_on_edge {
                return bilinear(&self.corners(tile), self.within(tile, corner.as_vec2()));
            }
            let offset = sample.texel.as_vec2() + 0.5 - corner.as_vec2();
            let weight = 1.0 / (offset.length_squared() + 0.25);
            parts.push((offset, weight, sample.radiance));
            least = least.min(sample.radiance);
            most = most.max(sample.radiance);
        }
        let sum = |of: &dyn Fn(Vec2) -> f32| parts.iter().map(|(d, w, _)| w * of(*d)).sum::<f32>();
        let (sx, sy) = (sum(&|d| d.x), sum(&|d| d.y));
        let (mut sxx, sxy, mut syy) = (
            sum(&|d| d.x * d.x),
            sum(&|d| d.x * d.y),
            sum(&|d| d.y * d.y),
        );
        let ridge = 1e-4 * (sxx + syy);
        sxx += ridge;
        syy += ridge;
        let row = Vec3::new(
            sxx * syy - sxy * sxy,
            sxy * sy - sx * syy,
            sx * sxy - sxx * sy,
        );
        let part = |d: Vec2, w: f32| w * (row.x + row.y * d.x + row.z * d.y);
        let total: f32 = parts.iter().map(|&(d, w, _)| part(d, w)).sum();
        let fitted: Vec3 = parts.iter().map(|&(d, w, c)| part(d, w) * c).sum();
        let slack = if all_touch {
            Vec3::ZERO
        } else {
            (most - least) * 1.5
        };
        (fitted / total).clamp(
            (least - slack).max(Vec3::ZERO),
            (most + slack).min(Vec3::splat(65504.0)),
        )
    }

    fn corners(&self, tile: Tile) -> Corners {
        let (low, high) = (self.low(tile).as_ivec2(), self.high(tile).as_ivec2());
        [
            low,
            IVec2::new(high.x, low.y),
            IVec2::new(low.x, high.y),
            high,
        ]
        .map(|corner| self.corner(corner, tile))
    }

    /// How far the centre of a tile's left (`axis` 0) or upper edge is raised: `raise.wgsl`.
    fn raise(&self, tile: Tile, axis: usize) -> Vec3 {
        let (low, high) = (self.low(tile).as_vec2(), self.high(tile).as_vec2());
        if low[axis] == 0.0 {
            return Vec3::ZERO;
        }
        let corners = self.corners(tile);
        let (begin, end) = (corners[0], if axis == 0 { corners[2] } else { corners[1] });
        let mut center = 0.5 * (low + high);
        center[axis] = low[axis];
        let mut probe = center;
        probe[axis] -= 0.5;
        let other = self.tile_at(probe.as_uvec2());
        let (a, b) = (self.sample(tile), self.sample(other));
        let both_pure = !tile.has_edge && !other.has_edge;
        if other.level != tile.level
            || !(both_pure || same_surface(&self.seen(a.texel), &self.seen(b.texel), 0.5))
        {
            return Vec3::ZERO;
        }
        let (here, there) = (a.texel.as_vec2() + 0.5, b.texel.as_vec2() + 0.5);
        let beside = 0.5 * (here + there) - center;
        let along = (end - begin) / (high[1 - axis] - low[1 - axis]);
        let apart = here - there;
        let across = (a.radiance - b.radiance - along * apart[1 - axis]) / apart[axis];
        let between =
            0.5 * (a.radiance + b.radiance) - across * beside[axis] - along * beside[1 - axis];
        between - 0.5 * (begin + end)
    }

    /// `curve.wgsl`, `tile_radiance`.
    fn tile_radiance(&self, tile: Tile, position: Vec2) -> Vec3 {
        let sample = self.sample(tile);
        if tile.level == 0 {
            return sample.radiance;
        }
        let corners = self.corners(tile);
        let uv = self.within(tile, position).clamp(Vec2::ZERO, Vec2::ONE);
        let peak = self.within(tile, sample.texel.as_vec2() + 0.5);
        let raise = |axis: usize| {
            let mut beside = tile;
            if uv[axis] > peak[axis] {
                beside.block[axis] += 1;
                if (beside.block << tile.level)[axis] >= self.size[axis] {
                    return Vec3::ZERO;
                }
                // A tile of another size there has no common edge with this one.
                let first = (beside.block << tile.level).min(self.size - 1);
                let actual = self.tile_at(first);
                if actual.level != tile.level {
                    return Vec3::ZERO;
                }
                beside = actual;
            }
            self.raise(beside, axis)
        };
        let far = uv.cmpgt(peak);
        let slope = Vec2::select(far, (1.0 - uv) / (1.0 - peak), uv / peak);
        let tent = 1.0 - (2.0 * uv - 1.0).abs();
        let radiance = bilinear(&corners, uv)
            + raise(0) * ((1.0 - slope.x) * tent.y)
            + raise(1) * ((1.0 - slope.y) * tent.x)
            + (sample.radiance - bilinear(&corners, peak)) * (slope.x * slope.y);
        radiance.clamp(Vec3::ZERO, Vec3::splat(65504.0))
    }

    /// `smooth.wgsl`, `across_edge`.
    fn across_edge(&self, position: Vec2, own: Tile, seen: &Seen) -> Vec3 {
        let (low, high) = (self.low(own).as_vec2(), self.high(own).as_vec2());
        let is_far = (2.0 * position).cmpgt(low + high);
        let near = Vec2::select(is_far, high + 0.5, low - 0.5);
        let across = Vec2::select(is_far, low - 0.5, high + 0.5);
        let size = self.size.as_vec2();
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for (turn, probe) in [
            Vec2::new(near.x, position.y),
            Vec2::new(position.x, near.y),
            near,
            Vec2::new(across.x, position.y),
            Vec2::new(position.x, across.y),
        ]
        .into_iter()
        .enumerate()
        {
            if turn >= 3 && total > 0.0 {
                break;
            }
            if probe.cmplt(Vec2::ZERO).any() || probe.cmpge(size).any() {
                continue;
            }
            let tile = self.tile_at(probe.as_uvec2());
            if self.looks_the_same(seen, tile) {
                let weight = 1.0 / ((probe - position).length_squared() + 1.0);
                sum += weight * self.tile_radiance(tile, position);
                total += weight;
            }
        }
        if total == 0.0 {
            return self.tile_radiance(own, position);
        }
        sum / total
    }

    fn pixel(&self, texel: UVec2) -> Vec3 {
        let tile = self.tile_at(texel);
        let position = texel.as_vec2() + 0.5;
        let seen = self.compared(texel);
        if tile.has_edge && !self.looks_the_same(&seen, tile) {
            return self.across_edge(position, tile, &seen);
        }
        self.tile_radiance(tile, position)
    }
}

#[test]
fn smooth_equals_its_twin() {
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 20, 5);
    let by_triangles = Geometry::Visibility;
    for (size, refine_edges, coarse_sample, geometry) in [
        (
            (150, 93),
            RefineEdges::Off,
            CoarseSample::Center,
            Geometry::Gbuffer,
        ),
        (
            (150, 93),
            RefineEdges::Graded,
            CoarseSample::Center,
            Geometry::Gbuffer,
        ),
        (
            (67, 131),
            RefineEdges::Off,
            CoarseSample::Typical,
            Geometry::Gbuffer,
        ),
        (
            (150, 93),
            RefineEdges::Graded,
            CoarseSample::Center,
            by_triangles,
        ),
        (
            (67, 131),
            RefineEdges::Off,
            CoarseSample::Typical,
            by_triangles,
        ),
    ] {
        let settings = small(size.0, size.1).with(|s| {
            s.shading.mode = Shading::Coarse;
            s.coarse.composite = Composite::Smooth;
            s.coarse.source = RateSource::Radii;
            s.coarse.fovea_inner = 0.05;
            s.coarse.fovea_outer = 0.4;
            s.eye.gaze = [0.3, 0.6];
            s.coarse.refine_edges = refine_edges;
            s.coarse.sample = coarse_sample;
            s.geometry.path = geometry;
        });
        let camera = &scene.cameras[0];
        let mut renderer = rendered(&scene, camera, &settings);
        // What an earlier frame with other tiles left behind must not show.
        let coarse = renderer.targets().coarse.as_ref().unwrap();
        for part in &coarse.patches.as_ref().unwrap().parts {
            let twos = vec![0x40; part.size() as usize];
            gpu().queue.write_buffer(part, 0, &twos);
        }
        let frame = Frame::new(camera);
        pollster::block_on(renderer.render(&frame)).unwrap();
        let inputs = Inputs::of(&renderer, camera);
        let drawn: Vec<[u16; 4]> = texels(&renderer.targets().radiance_view);
        let mut wrong = Vec::new();
        let mut edges = 0;
        for (i, texel) in (0..).zip(&drawn) {
            let at = UVec2::new(i % size.0, i / size.0);
            let drawn = Vec3::from_array([0, 1, 2].map(|c| f32_of_half(texel[c])));
            let twin = inputs.pixel(at);
            edges += u32::from(inputs.tile_at(at).has_edge);
            // Patches are kept in halves.
            if (drawn - twin).abs().max_element() > 0.004 * twin.max_element().max(0.25) {
                wrong.push((at, drawn, twin));
            }
        }
        // Where float and float disagree whether two texels show one surface, a few pixels go the
        // other way.
        let most = drawn.len() / 500;
        assert!(
            wrong.len() <= most,
            "{size:?} {refine_edges:?}: {} of {} differ: {:?}",
            wrong.len(),
            drawn.len(),
            &wrong[..8.min(wrong.len())]
        );
        assert!(edges > 100, "{edges}");
    }
}
