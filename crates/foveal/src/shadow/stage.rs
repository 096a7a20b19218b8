//! All of shadows that outlives a frame.

use foveal_scene::{Aabb, AlphaMode};
use glam::Vec3;

use super::atlas::Tile;
use super::changed::{Place, changed_places};
use super::kept::KeptTiles;
use super::pass::{CasterPass, TileDraw};
use super::plan::{Plan, TILES_PER_LIGHT, ViewOfPlan, Wanted};
use super::records::{Row, rows};
use super::volume::Volume;
use crate::geometry::DrawList;
use crate::gpu::{Gpu, Table};
use crate::recorder::Recorder;
use crate::scene::{DrawnInstance, SceneOnGpu};
use crate::stereo::Eye;
use crate::{Settings, ShadowStats, Shadows};

/// What lighting looks up, bound wherever lights are; the shadows themselves where they are on.
#[derive(Debug)]
pub(crate) struct ShadowStage {
    rows: Table,
    written: Vec<Row>,
    atlas: wgpu::TextureView,
    sampler: wgpu::Sampler,
    drawing: Option<Box<Drawing>>,
    stats: Option<ShadowStats>,
}

/// What draws tiles.
#[derive(Debug)]
struct Drawing {
    pass: CasterPass,
    kept: KeptTiles,
    atlas_level: u32,
    texels_moved: f32,
    plan: Plan,
    /// What the frame draws.
    draws: Vec<TileDraw>,
    /// What the last frame's tiles followed from; they stand while it is the same.
    settled: Option<Settled>,
}

/// A frame after which the next one of the same needs nothing.
#[derive(Debug, PartialEq)]
struct Settled {
    view: ViewOfPlan,
    /// Instances that are drawn.
    receivers: Vec<u32>,
}

impl ShadowStage {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let lighting = &settings.lighting;
        let is_on = lighting.shadows != Shadows::Off && !gpu.is_reduced();
        let atlas_level = lighting.shadow_atlas.ilog2();
        let side = if is_on { 1 << atlas_level } else { 1 };
        let atlas = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow atlas"),
            size: wgpu::Extent3d {
                width: side,
                height: side,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: crate::formats::DEPTH_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            // Reversed depth: light passes to what is as near as what is drawn, or nearer.
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Self {
            rows: Table::new(gpu, "shadow rows"),
            written: Vec::new(),
            atlas: atlas.create_view(&Default::default()),
            sampler,
            drawing: is_on.then(|| {
                Box::new(Drawing {
                    pass: CasterPass::new(gpu, frame_layout, material_layout),
                    kept: KeptTiles::new(atlas_level),
                    atlas_level,
                    texels_moved: lighting.shadow_bias,
                    plan: Plan::default(),
                    draws: Vec::new(),
                    settled: None,
                })
            }),
            stats: None,
        }
    }

    /// What lighting binds: rows, atlas, sampler.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 3] {
        [
            self.rows.resource(),
            wgpu::BindingResource::TextureView(&self.atlas),
            wgpu::BindingResource::Sampler(&self.sampler),
        ]
    }

    /// What the last frame did; `None` without shadows.
    pub(crate) fn stats(&self) -> Option<ShadowStats> {
        self.stats
    }

    /// The next frame shows another scene.
    pub(crate) fn forget(&mut self) {
        if let Some(drawing) = &mut self.drawing {
            drawing.kept.forget();
            drawing.settled = None;
        }
    }

    /// Things that cast shadows have moved: into, within or out of these boxes. Gives the places
    /// where that changes light.
    ///
    /// `wants_places`: whether anybody asks for them; they cost time with many lights and boxes.
    pub(crate) fn scene_moved(
        &mut self,
        boxes: &[Aabb],
        scene: &SceneOnGpu,
        wants_places: bool,
    ) -> Vec<Place> {
        let Some(drawing) = &mut self.drawing else {
            return Vec::new();
        };
        // Lights may have moved too.
        drawing.settled = None;
        if boxes.is_empty() {
            return Vec::new();
        }
        drawing.kept.disturb(boxes);
        if !wants_places {
            return Vec::new();
        }
        let kept = &drawing.kept;
        changed_places(&scene.lights, boxes, &scene.bounds, |light| {
            let first = (light * TILES_PER_LIGHT) as u32;
            (first..first + TILES_PER_LIGHT as u32).any(|slot| kept.get(slot).is_some())
        })
    }

    /// Decides what the frame draws, and tells shaders where tiles lie. `list`: what is seen.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        settings: &Settings,
        (scene, list): (&SceneOnGpu, &DrawList),
        eyes: &[Eye; 2],
    ) {
        let Some(drawing) = &mut self.drawing else {
            return;
        };
        let now = Settled {
            view: ViewOfPlan::new(eyes, settings.picture.height),
            receivers: list.drawn.clone(),
        };
        drawing.draws.clear();
        if drawing.settled.as_ref() != Some(&now) {
            drawing.find_tiles(scene, &now);
            let rows = rows(
                &scene.lights,
                &drawing.plan,
                &drawing.kept,
                drawing.texels_moved,
            );
            if rows != self.written {
                self.rows.write(gpu, bytemuck::cast_slice(&rows));
                self.written = rows;
            }
            drawing.settled = Some(now);
        }
        self.stats = Some(drawing.stats());
    }

    /// Encodes the tiles' drawing.
    pub(crate) fn draw(&mut self, recorder: &mut Recorder<'_>, scene: &SceneOnGpu) {
        if let Some(drawing) = &mut self.drawing {
            (drawing.pass).draw(recorder, scene, &self.atlas, &drawing.draws);
        }
    }

    /// The atlas's texture.
    #[cfg(test)]
    pub(crate) fn atlas(&self) -> &wgpu::TextureView {
        &self.atlas
    }

    /// What shaders were told.
    #[cfg(test)]
    pub(crate) fn rows(&self) -> &[Row] {
        &self.written
    }
}

/// A light's own lamp is no larger than this part of its range.
const LARGEST_LAMP: f32 = 0.5;

/// Whether an instance keeps a light, given by its place and range, from what is beyond. What
/// glows, is small, and holds the light within its box is the light's own lamp.
fn casts(instance: &DrawnInstance, light: Option<(Vec3, f32)>) -> bool {
    let b = &instance.bounds;
    let is_own_lamp = instance.glows
        && light.is_some_and(|(at, range)| {
            at.cmpge(b.min).all()
                && at.cmple(b.max).all()
                && b.size().length() <= LARGEST_LAMP * range
        });
    instance.alpha_mode != AlphaMode::Blend && b.is_valid() && !is_own_lamp
}

impl Drawing {
    /// Finds the frame's tiles, and lists the draws of those that are seen and not there.
    fn find_tiles(&mut self, scene: &SceneOnGpu, now: &Settled) {
        self.plan = Plan::new(&scene.lights, &now.view, &scene.bounds, self.atlas_level);
        self.kept.place(&self.plan.wanted);
        let missing = |want: &&Wanted| self.kept.get(want.slot).is_some_and(|k| !k.is_drawn);
        let missing: Vec<Wanted> = self.plan.wanted.iter().filter(missing).copied().collect();
        let per_light = |w: &Wanted| w.slot / TILES_PER_LIGHT as u32;
        for of_light in missing.chunk_by(|a, b| per_light(a) == per_light(b)) {
            self.list_draws(scene, now, of_light);
        }
    }

    /// Lists the draws of one light's tiles.
    fn list_draws(&mut self, scene: &SceneOnGpu, now: &Settled, wanted: &[Wanted]) {
        let sphere = match wanted.first().map(|w| w.volume) {
            Some(Volume::Pyramid { apex, range, .. }) => Some((apex, range)),
            _ => None,
        };
        let is_near = |b: &Aabb| {
            sphere.is_none_or(|(apex, range)| {
                apex.clamp(b.min, b.max).distance_squared(apex) <= range * range
            })
        };
        let bounds = |i: u32| &scene.instances[i as usize].bounds;
        let receivers = now.receivers.iter().filter(|&&i| is_near(bounds(i)));
        let receivers: Vec<u32> = receivers.copied().collect();
        let mut casters: Option<Vec<u32>> = None;
        for want in wanted {
            let Some(tile) = self.kept.get(want.slot).map(|kept| kept.tile) else {
                continue;
            };
            let side = tile.side() as f32;
            let meets = |i: u32| want.volume.meets(bounds(i), side);
            if !receivers.iter().any(|&i| meets(i)) {
                continue;
            }
            let casters = casters.get_or_insert_with(|| {
                (0..)
                    .zip(&scene.instances)
                    .filter(|(_, i)| casts(i, sphere) && is_near(&i.bounds))
                    .map(|(number, _)| number)
                    .collect()
            });
            let is_resolved = |i: u32| want.volume.resolves(bounds(i), side);
            let seen = casters.iter().copied();
            let seen = seen.filter(|&i| is_resolved(i) && meets(i));
            self.draws.push(TileDraw {
                tile,
                clip_from_world: want.volume.clip_from_world(side),
                casters: DrawList::of_casters(scene, seen, CasterPass::key),
            });
            self.kept.drawn(want.slot);
        }
    }

    fn stats(&self) -> ShadowStats {
        let in_use = self
            .plan
            .wanted
            .iter()
            .filter_map(|w| self.kept.get(w.slot));
        let in_use: Vec<Tile> = in_use.filter(|k| k.is_drawn).map(|k| k.tile).collect();
        let casters = self.draws.iter().map(|d| d.casters.drawn.len() as u64);
        ShadowStats {
            tiles: in_use.len() as u64,
            tiles_drawn: self.draws.len() as u64,
            casters: casters.sum(),
            triangles: self.draws.iter().map(|d| d.casters.triangles).sum(),
            texels: in_use.iter().map(|t| u64::from(t.side()).pow(2)).sum(),
            atlas_bytes: 4 << (2 * self.atlas_level),
            lights_left_out: u64::from(self.plan.lights_left_out),
            shrunk_by: self.plan.shrunk_by,
        }
    }
}
