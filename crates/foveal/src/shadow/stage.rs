//! All of shadows that outlives a frame.

use std::cmp::Reverse;

use foveal_scene::Aabb;

use super::atlas::Tile;
use super::changed::{Place, changed_places};
use super::hidden::HiddenCasters;
use super::kept::{KeptTiles, Received, Urgency};
use super::near::{Near, NearLight, Seen};
use super::pass::{CasterPass, TileDraw};
use super::patch::Patch;
use super::plan::{Plan, TILES_PER_LIGHT, ViewOfPlan, Wanted};
use super::receivers::{Reach, Receivers, SeenCells, SeenSince};
use super::records::{LookupSettings, Row, rows};
use crate::gpu::{Gpu, Table};
use crate::rate::FinestRate;
use crate::recorder::Recorder;
use crate::scene::SceneOnGpu;
use crate::stereo::Eye;
use crate::{Settings, ShadowSizes, ShadowStats, Shadows};

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
    lookup: LookupSettings,
    plan: Plan,
    hidden: HiddenCasters,
    /// Since when cells are seen, and the frame that looked at them last.
    seen: SeenSince,
    frame: u64,
    /// What the frame draws, and counts.
    draws: Vec<TileDraw>,
    counts: Counts,
    /// Triangles that a frame draws into tiles that may wait; 0 for as many as it takes.
    budget: u64,
    /// Spheres within which tiles that had waited have been drawn.
    changed: Vec<Place>,
    /// What the last frame's tiles followed from; they stand while it is the same.
    settled: Option<Settled<'static>>,
}

/// Casters of the tiles that a frame draws.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    in_reach: u64,
    hidden: u64,
    unneeded: u64,
    beside: u64,
    waiting: u64,
    longest_wait: u64,
}

/// A frame after which the next one of the same needs nothing.
#[derive(Debug, PartialEq)]
struct Settled<'a> {
    view: ViewOfPlan,
    /// Whether tiles of another size stay until their place is needed: rates may come and go, and
    /// tiles may wait.
    keeps_sizes: bool,
    receivers: Receivers<'a>,
}

impl ShadowStage {
    pub(crate) fn new(
        gpu: &Gpu,
        settings: &Settings,
        frame_layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let lighting = &settings.lighting;
        let is_on = lighting.shadows != Shadows::Off;
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
        let filter = if gpu.is_reduced() {
            wgpu::FilterMode::Linear
        } else {
            wgpu::FilterMode::Nearest
        };
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            // Reversed depth: light passes to what is as near as what is drawn, or nearer.
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            // The reduced lookup leaves it to the sampler to blend what is compared.
            mag_filter: filter,
            min_filter: filter,
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
                    lookup: LookupSettings::new(lighting),
                    plan: Plan::default(),
                    hidden: HiddenCasters::default(),
                    seen: SeenSince::default(),
                    frame: 0,
                    draws: Vec::new(),
                    counts: Counts::default(),
                    budget: u64::from(lighting.shadow_budget),
                    changed: Vec::new(),
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
            drawing.seen = SeenSince::default();
            drawing.plan = Plan::default();
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
        let lookup = &drawing.lookup;
        changed_places(
            &scene.lights,
            lookup.lamps(),
            boxes,
            &scene.bounds,
            |light| {
                let first = (light * TILES_PER_LIGHT) as u32;
                let texel = kept.widest_texel(first..first + TILES_PER_LIGHT as u32)?;
                Some(lookup.beside() * texel)
            },
        )
    }

    /// Decides what the frame draws, and tells shaders where tiles lie. `receivers`: what
    /// is seen. `rates`: how finely it is shaded, where tiles are to be as coarse. Gives the places
    /// where light changes because tiles are drawn late.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        settings: &Settings,
        (scene, receivers): (&SceneOnGpu, Receivers<'_>),
        eyes: &[Eye; 2],
        rates: Option<FinestRate>,
    ) -> Vec<Place> {
        let Some(drawing) = &mut self.drawing else {
            return Vec::new();
        };
        let now = Settled {
            view: ViewOfPlan::new(eyes, settings, rates),
            keeps_sizes: settings.lighting.shadow_sizes == ShadowSizes::Rate || drawing.budget > 0,
            receivers,
        };
        drawing.draws.clear();
        drawing.counts = Counts::default();
        if drawing.settled.as_ref() != Some(&now) {
            drawing.find_tiles(scene, &now);
            let rows = rows(&scene.lights, &drawing.plan, &drawing.kept);
            if rows != self.written {
                self.rows.write(gpu, bytemuck::cast_slice(&rows));
                self.written = rows;
            }
            drawing.settled = (drawing.counts.waiting == 0).then(|| Settled {
                view: now.view,
                keeps_sizes: now.keeps_sizes,
                receivers: now.receivers.into_owned(),
            });
        } else {
            drawing.kept.rest();
        }
        self.stats = Some(drawing.stats());
        std::mem::take(&mut drawing.changed)
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

    /// The tiles that the last frame looked into.
    #[cfg(test)]
    pub(super) fn tiles(&self) -> Vec<Tile> {
        let drawing = self.drawing.as_ref().unwrap();
        let wanted = drawing.plan.wanted.iter();
        let shown = wanted.filter_map(|want| drawing.kept.shown(want));
        shown.map(|(tile, _)| tile).collect()
    }

    /// The next frame draws whole tiles where it would draw patches; all tiles where `every`.
    #[cfg(test)]
    pub(super) fn draw_whole(&mut self, every: bool) {
        let drawing = self.drawing.as_mut().unwrap();
        drawing.settled = None;
        drawing.kept.spoil(every);
    }

    /// What shaders were told.
    #[cfg(test)]
    pub(crate) fn rows(&self) -> &[Row] {
        &self.written
    }
}

fn light_of(want: &Wanted) -> u32 {
    want.slot / TILES_PER_LIGHT as u32
}

/// Frames after which a tile that is drawn again forgets what only earlier ones saw.
pub(super) const MOST_FRAMES: u64 = 60;

impl Drawing {
    /// Finds the frame's tiles, and lists the draws of those that are seen and not there.
    fn find_tiles(&mut self, scene: &SceneOnGpu, now: &Settled<'_>) {
        let plan = Plan::new(&scene.lights, &now.view, &scene.bounds, self.atlas_level);
        // Light that was kept is wrong where a tile has lost or found room.
        let lost = plan.left_out_of(&self.plan.wanted);
        let found = self.plan.left_out_of(&plan.wanted);
        (self.changed).extend(lost.chain(found).map(|want| want.volume.sphere()));
        self.plan = plan;
        self.kept.place(&self.plan.wanted, now.keeps_sizes);
        self.frame += 1;
        let boxes = scene.culling.cells();
        let cells = match &now.receivers {
            Receivers::Cells(cells) => cells.as_ref(),
            Receivers::Instances(_) => &[],
        };
        self.seen.see(self.frame, cells, boxes);
        let is_new = |cell: &&u32| !self.seen.was_seen(**cell, self.frame - 1);
        let new: Vec<u32> = cells.iter().filter(is_new).copied().collect();
        let seen = std::mem::take(&mut self.seen);
        let seen_cells = SeenCells {
            boxes,
            since: &seen,
            frame: self.frame,
            all: cells,
            new: &new,
            reach: (self.lookup.texels_moved, self.lookup.reach()),
        };
        let receivers = match &now.receivers {
            Receivers::Cells(_) => {
                self.complete_tiles(scene, seen_cells);
                Seen::Cells(seen_cells)
            }
            Receivers::Instances(instances) => {
                self.kept.draw_in_full();
                Seen::Instances(instances)
            }
        };
        let missing = |want: &&Wanted| self.kept.get(want).is_some_and(|k| !k.is_drawn);
        let missing: Vec<Wanted> = self.plan.wanted.iter().filter(missing).copied().collect();
        let mut lights: Vec<NearLight<'_>> = Vec::new();
        let mut tiles: Vec<(Wanted, usize)> = Vec::new();
        for of_light in missing.chunk_by(|a, b| light_of(a) == light_of(b)) {
            let light = NearLight::new(scene, receivers, of_light);
            let mut seen = |want: &&Wanted| {
                let kept = self.kept.get_mut(want);
                kept.is_some_and(|kept| light.near.meets(kept))
            };
            let seen = of_light.iter().filter(|want| seen(want));
            tiles.extend(seen.map(|&want| (want, lights.len())));
            lights.push(light);
        }
        let is_limited = self.budget > 0 && !self.kept.take_is_new();
        if is_limited {
            tiles.sort_by_cached_key(|(want, _)| Reverse((self.kept.urgency(want), want.level)));
        }
        // Of tiles that may wait.
        let mut triangles = 0;
        for (want, light) in tiles {
            let may_wait = is_limited && matches!(self.kept.urgency(&want), Urgency::Waits(_));
            if may_wait && triangles >= self.budget {
                let waited = self.kept.waited(&want) + 1;
                self.kept.wait(&want);
                self.counts.waiting += 1;
                self.counts.longest_wait = self.counts.longest_wait.max(waited);
                continue;
            }
            let drawn = self.list_draw(scene, &mut lights[light], &want);
            triangles += if may_wait { drawn } else { 0 };
        }
        self.seen = seen;
    }

    /// Adds casters to tiles that were drawn without them, and whose shadows are seen by now.
    fn complete_tiles(&mut self, scene: &SceneOnGpu, seen: SeenCells<'_>) {
        let bounds = |i: u32| &scene.instances[i as usize].bounds;
        for of_light in (self.plan.wanted).chunk_by(|a, b| light_of(a) == light_of(b)) {
            let near = seen.near(Reach::of(of_light));
            for want in of_light {
                let Some(kept) = self.kept.get_mut(want) else {
                    continue;
                };
                let Some(received) = kept.received.as_mut().filter(|_| kept.is_drawn) else {
                    continue;
                };
                let (side, volume) = (kept.tile.side() as f32, &want.volume);
                if kept.left_out.is_empty() || !near.add_to(received, volume, side) {
                    continue;
                }
                let is_visible = |i: u32| scene.instances[i as usize].visible;
                let shown = |i: u32| is_visible(i) && received.mask.shows(volume, bounds(i));
                let (shown, still): (Vec<u32>, Vec<u32>) =
                    kept.left_out.iter().partition(|&&i| shown(i));
                kept.left_out = still;
                if !shown.is_empty() {
                    let tile = (kept.tile, volume);
                    self.draws.push(TileDraw::new(scene, tile, shown, None));
                }
            }
        }
    }

    /// Lists the draws of a tile of a light; their triangles.
    fn list_draw(&mut self, scene: &SceneOnGpu, light: &mut NearLight<'_>, want: &Wanted) -> u64 {
        let bounds = |i: u32| &scene.instances[i as usize].bounds;
        let Some(kept) = self.kept.get_mut(want) else {
            return 0;
        };
        let (tile, volume) = (kept.tile, &want.volume);
        let side = tile.side() as f32;
        let is_cast = |i: &u32| volume.resolves(bounds(*i), side) && volume.meets(bounds(*i), side);
        let casters = light.casters(scene).iter().copied().filter(is_cast);
        let mut casters: Vec<u32> = casters.collect();
        let in_reach = casters.len();
        self.counts.in_reach += in_reach as u64;
        let (mut left_out, mut late) = (Vec::new(), Vec::new());
        let patch = kept.wrong;
        if let Some(patch) = patch {
            let covers = |i: u32| Patch::of_box(volume, bounds(i), tile.side());
            // What the tile was drawn without is so still, or else is drawn in all of it.
            left_out = std::mem::take(&mut kept.left_out);
            left_out.retain(|i| casters.binary_search(i).is_ok());
            casters.retain(|&i| covers(i).is_some_and(|covered| covered.meets(patch)));
        }
        // A light that moves asks anew of all that is seen, for one frame: that takes longer than
        // drawing what it would leave out.
        if let Near::Cells(near) = &light.near
            && !kept.light_moves
        {
            let all = casters.len();
            // What changes in each frame is drawn sooner than it is searched, and so is a patch.
            if !kept.is_restless && patch.is_none() {
                self.hidden
                    .take_out(scene, volume, tile.side(), &mut casters);
            }
            self.counts.hidden += (all - casters.len()) as u64;
            let received =
                (kept.received.take()).filter(|received| received.first + MOST_FRAMES > self.frame);
            let mut received =
                received.unwrap_or_else(|| Box::new(Received::new(side, self.frame)));
            near.add_to(&mut received, volume, side);
            let is_shown = |i: &u32| received.mask.shows(volume, bounds(*i));
            (late, left_out) = left_out.into_iter().partition(is_shown);
            casters.retain(|i| late.binary_search(i).is_err());
            let unneeded;
            (casters, unneeded) = casters.into_iter().partition(is_shown);
            left_out.extend(unneeded);
            left_out.sort_unstable();
            left_out.dedup();
            self.counts.unneeded += left_out.len() as u64;
            if kept.is_restless || !left_out.is_empty() {
                kept.received = Some(received);
            }
        }
        if patch.is_some() {
            let others = casters.len() + late.len() + left_out.len();
            self.counts.beside += (in_reach - others) as u64;
        }
        let emptied = patch.unwrap_or(Patch::whole(tile.side()));
        let mut draws = vec![TileDraw::new(scene, (tile, volume), casters, Some(emptied))];
        if !late.is_empty() {
            draws.push(TileDraw::new(scene, (tile, volume), late, None));
        }
        let triangles = draws.iter().map(|draw| draw.casters.triangles).sum();
        self.draws.extend(draws);
        if self.kept.drawn(want, left_out) {
            self.changed.push(volume.sphere());
        }
        triangles
    }

    fn stats(&self) -> ShadowStats {
        let in_use = self.plan.wanted.iter().filter_map(|w| self.kept.shown(w));
        let in_use: Vec<Tile> = in_use.map(|(tile, _)| tile).collect();
        let casters = self.draws.iter().map(|d| d.casters.drawn.len() as u64);
        ShadowStats {
            tiles: in_use.len() as u64,
            tiles_drawn: self.draws.iter().filter(|d| d.emptied.is_some()).count() as u64,
            tiles_completed: self.draws.iter().filter(|d| d.emptied.is_none()).count() as u64,
            casters: casters.sum(),
            casters_in_reach: self.counts.in_reach,
            casters_hidden: self.counts.hidden,
            casters_unneeded: self.counts.unneeded,
            casters_beside: self.counts.beside,
            triangles: self.draws.iter().map(|d| d.casters.triangles).sum(),
            texels: in_use.iter().map(|t| u64::from(t.side()).pow(2)).sum(),
            tiles_waiting: self.counts.waiting,
            longest_wait: self.counts.longest_wait,
            atlas_bytes: 4 << (2 * self.atlas_level),
            lights_left_out: self.plan.lights_left_out() as u64,
            shrunk_by: self.plan.shrunk_by,
        }
    }
}
