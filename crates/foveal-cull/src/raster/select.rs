//! Selection: which clusters may be drawn in a frame, and in which order.
//!
//! Clusters are rejected by frustum, normal cone, size and detail before any vertex is transformed.
//! The others are sorted front to back by their content (nearest distance, then a hash), so that
//! the result does not depend on the order in which occluders were added. Several threads share the
//! work in more parts than there are threads, and take the next part when they are done.

use super::candidates::{Candidate, FrameScratch, Part, Worth};
use super::near_cut::near_may_cut;
use super::place::{Place, candidate, crossing};
use crate::camera::Camera;
use crate::format::SAMPLES;
use crate::occluder::OccluderUsefulness;
use crate::occluder::set::{Instance, OccluderSet};
use crate::projection::project::project;
use crate::projection::screen::Screen;
use crate::simd::{InstructionSet, Kernel, Lanes};
use crate::stats::CullStats;
use crate::threads::Threads;
use glam::DVec4;
use std::sync::Mutex;

/// Most parts, and parts per thread. There are several per thread because their cost is
/// unpredictable.
const MAX_PARTS: usize = 64;
const PARTS_PER_THREAD: usize = 4;
/// Fewest groups of eight clusters that are worth a part.
const LEAST_GROUPS: usize = 32;
/// With a view region a cluster hides next to nothing if its quads are, in the mean, shorter than
/// so many shifts: `SHIFTS` for a surface that continues at every edge, and `SHIFTS_OF_CREASES`
/// more for one that ends or bends at every edge.
const SHIFTS: f32 = 4.0;
const SHIFTS_OF_CREASES: f32 = 8.0;

/// How far ahead meshes, and the bounds of their first clusters, are fetched.
const MESHES_AHEAD: usize = 8;
const CLUSTERS_AHEAD: usize = 4;

/// Stands for the place of a candidate that was chosen.
const TAKEN: u64 = u64::MAX;

/// Part of a frame's work that clusters of unknown worth get first.
const PART_OF_UNKNOWN: f64 = 0.25;

/// Input of the selection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) set: &'a OccluderSet,
    /// Size of the screen, samples.
    pub(crate) width: f32,
    pub(crate) height: f32,
    pub(crate) size_threshold: f32,
    pub(crate) pixels_per_quad: f32,
    /// Shift of a point at depth 1 within the view region, samples.
    pub(crate) shift: f32,
    /// Leaves out what hid nothing in the frames before.
    pub(crate) usefulness: Option<&'a OccluderUsefulness>,
}

impl FrameScratch {
    /// Finds the clusters that may be drawn, and their order; returns the stats.
    pub(crate) fn select(
        &mut self,
        choice: &Choice<'_>,
        instruction_set: InstructionSet,
        threads: &dyn Threads,
    ) -> CullStats {
        let instances = &choice.set.instances;
        // As many as the mesh has boxes of eight; most meshes are not touched in a frame.
        let groups = |i: &Instance| match i.mesh {
            Some(_) => (i.clusters as usize).div_ceil(8),
            None => 0,
        };
        let all: usize = instances.iter().map(groups).sum();
        let parts = match threads.count() {
            0 | 1 => 1,
            n => n.saturating_mul(PARTS_PER_THREAD).min(MAX_PARTS),
        };
        let parts = parts.min(1 + all / LEAST_GROUPS);
        self.rows.resize(instances.len(), [[0.0; 4]; 4]);
        self.parts
            .resize_with(self.parts.len().max(parts), Part::default);
        let mut jobs: [Mutex<Option<Select<'_>>>; MAX_PARTS] =
            [const { Mutex::new(None) }; MAX_PARTS];
        let (mut rows, mut first, mut first_group, mut done) = (&mut self.rows[..], 0, 0, 0);
        for (k, (job, part)) in jobs.iter_mut().zip(&mut self.parts[..parts]).enumerate() {
            // Every part has as many groups; `done` of them lie before instance `end`.
            let wanted = (all as u64 * (k as u64 + 1) / parts as u64) as usize;
            let mut end = first;
            while end < instances.len() && done + groups(&instances[end]) <= wanted {
                done += groups(&instances[end]);
                end += 1;
            }
            // The next part continues with an instance that is cut. Its clip rows belong to the
            // part that begins it.
            let (last_groups, begun) = (wanted - done, usize::from(first_group > 0));
            let cut = usize::from(last_groups > 0);
            let (here, after) = rows.split_at_mut(end + cut - first - begun);
            // A part whose task the caller's threads leave out selects nothing, and no other part
            // depends on it: it has no list of the frame before, and the instance that the next
            // part continues has its rows.
            part.clear();
            if let Some(rows) = here.last_mut().filter(|_| cut > 0) {
                *rows = choice.camera.exact_rows(&instances[end].world_from_mesh);
            }
            *job = Mutex::new(Some(Select {
                choice: *choice,
                instances: &instances[first..end + cut],
                first,
                first_group,
                end_group: if cut > 0 { last_groups } else { usize::MAX },
                rows: here,
                part,
            }));
            (rows, first, first_group) = (after, end, last_groups);
        }
        let task = |i: usize| {
            let job = jobs.get(i).and_then(|job| job.lock().ok()?.take());
            if let Some(select) = job {
                instruction_set.run(select);
            }
        };
        if parts == 1 {
            task(0);
        } else {
            threads.run(parts, &task);
        }
        self.join(parts);
        let mut stats = CullStats::default();
        for part in &self.parts[..parts] {
            stats.occluder_models += part.stats.occluder_models;
            stats.occluder_triangles += part.stats.occluder_triangles;
            stats.clusters += part.stats.clusters;
            stats.clusters_not_useful += part.stats.clusters_not_useful;
        }
        stats
    }

    /// Keeps those clusters that hide most for their work, as far as so much work goes; returns how
    /// many are left out.
    pub(crate) fn keep_best(
        &mut self,
        set: &OccluderSet,
        usefulness: &OccluderUsefulness,
        most_work: f64,
    ) -> u64 {
        let all = self.order.len();
        self.worths.clear();
        self.worths.extend(self.order.iter().map(|&o| {
            let c = &self.candidates[o as u32 as usize];
            let (slot, cluster) = (c.instance as usize, c.cluster as usize);
            let [x0, y0, x1, y1] = c.blocks.map(u32::from);
            let blocks = (x1 + 1 - x0) * (y1 + 1 - y0);
            let (hides, work) = usefulness.worth(slot, &set.instances[slot], cluster, blocks);
            Worth {
                hides,
                work,
                order: o,
            }
        }));
        // The best first, and the nearest of equally good ones. What is not known comes last, but
        // gets a part of the work before.
        self.worths.sort_unstable_by(|a, b| {
            let known = |w: &Worth| w.hides.unwrap_or(-1.0);
            known(b).total_cmp(&known(a)).then(a.order.cmp(&b.order))
        });
        let known = self.worths.partition_point(|w| w.hides.is_some());
        let (known, unknown) = self.worths.split_at_mut(known);
        // In every frame another one comes first: what others hide is never drawn nor known.
        unknown.rotate_left(usefulness.first_unknown(unknown.len()));
        self.order.clear();
        let mut sum = 0.0;
        // Takes what fits, and the first in any case if asked for.
        let mut take = |some: &mut [Worth], most: f64, mut any: bool| {
            for w in some.iter_mut().filter(|w| w.order != TAKEN) {
                if any || sum + f64::from(w.work) <= most {
                    any = false;
                    sum += f64::from(w.work);
                    self.order.push(w.order);
                    w.order = TAKEN;
                }
            }
        };
        take(unknown, most_work * PART_OF_UNKNOWN, true);
        take(known, most_work, true);
        take(unknown, most_work, false);
        self.sort();
        (all - self.order.len()) as u64
    }

    /// Joins the lists of the first `parts` parts.
    fn join(&mut self, parts: usize) {
        self.candidates.clear();
        self.order.clear();
        for part in &self.parts[..parts] {
            let offset = self.candidates.len() as u64;
            self.candidates.extend_from_slice(&part.candidates);
            self.order.extend(part.order.iter().map(|o| o + offset));
        }
        self.sort();
    }

    /// Sorts the clusters into the order of drawing.
    fn sort(&mut self) {
        self.order.sort_unstable();
        // Equal distances are ordered by content, not by the order in which occluders were added.
        let candidates = &self.candidates;
        for run in self.order.chunk_by_mut(|a, b| a >> 32 == b >> 32) {
            if run.len() > 1 {
                run.sort_unstable_by_key(|&o| candidates[o as u32 as usize].hash);
            }
        }
    }
}

/// The kernel that finds the candidates among the clusters of some instances.
struct Select<'a> {
    choice: Choice<'a>,
    instances: &'a [Instance],
    /// Number of the first of these instances.
    first: usize,
    /// First group of eight clusters in the first instance, and the end of the groups in the last.
    first_group: usize,
    end_group: usize,
    /// Clip rows of the instances, except for the first one if another part begins it.
    rows: &'a mut [[[f64; 4]; 4]],
    part: &'a mut Part,
}

impl Kernel for Select<'_> {
    type Output = ();

    #[cfg_attr(not(unoptimized), inline(always))]
    fn run<L: Lanes>(self, l: L) {
        let Self {
            choice,
            instances,
            first: first_instance,
            first_group,
            end_group,
            rows: clip_rows,
            part,
        } = self;
        let Choice {
            camera,
            width,
            height,
            size_threshold,
            pixels_per_quad,
            shift,
            usefulness,
            ..
        } = choice;
        let samples_per_quad = pixels_per_quad * (SAMPLES * SAMPLES) as f32;
        let stats = &mut part.stats;
        let planes = instance_planes(camera, f64::from(width), f64::from(height));
        let threshold = f64::from(size_threshold.max(0.0));
        let small = threshold * threshold * camera.tan_half_fov_y;
        let begun = usize::from(first_group > 0);
        // Meshes lie anywhere in memory: only those that may be on the screen are fetched, before
        // their turn comes.
        let near = &mut part.near;
        for (index, instance) in instances.iter().enumerate() {
            if instance.mesh.is_none() | !instance.enabled {
                continue;
            }
            if index >= begun {
                stats.occluder_models += 1;
                stats.occluder_triangles += u64::from(instance.triangles);
                stats.clusters += u64::from(instance.clusters);
            }
            if !outside(camera, &planes, instance, small) {
                near.push(index as u32);
            }
        }
        let mesh_of = |n: usize| {
            let instance = &instances[*near.get(n)? as usize];
            instance.mesh.as_deref()
        };
        for n in 0..MESHES_AHEAD {
            mesh_of(n).inspect(|mesh| l.prefetch(*mesh));
        }
        for (n, &index) in near.iter().enumerate() {
            mesh_of(n + MESHES_AHEAD).inspect(|mesh| l.prefetch(*mesh));
            if let Some(mesh) = mesh_of(n + CLUSTERS_AHEAD) {
                mesh.bounds8.first().inspect(|b| l.prefetch(*b));
                mesh.clusters.first().inspect(|c| l.prefetch(*c));
            }
            let index = index as usize;
            let instance = &instances[index];
            let Some(mesh) = instance.mesh.as_deref() else {
                continue;
            };
            if let Some(solid) = mesh.solid
                && near_may_cut(camera, instance, solid)
            {
                continue;
            }
            let begins = index >= begun;
            let rows = camera.object_rows(&instance.world_from_mesh, mesh.center);
            if begins {
                clip_rows[index - begun] = camera.exact_rows(&instance.world_from_mesh);
            }
            let screen = Screen {
                rows,
                width,
                height,
                far_depth: camera.far_depth as f32 * 0.999_99,
                dilate: 0.0,
                grow: 0.0,
                hiz: None,
            };
            let eye = instance.mesh_from_world.transform_point3(camera.eye) - mesh.center;
            let forward = instance.mesh_from_world.transform_vector3(camera.forward);
            let (eye, forward) = (eye.as_vec3(), forward.as_vec3());
            let from = if begins { 0 } else { first_group };
            let end = if index + 1 == instances.len() {
                end_group.min(mesh.bounds8.len())
            } else {
                mesh.bounds8.len()
            };
            for (g, bounds) in (from..end).zip(&mesh.bounds8[from..end]) {
                let p = project(l, &screen, bounds);
                let first = g * 8;
                let clusters = &mesh.clusters[first..mesh.clusters.len().min(first + 8)];
                for (i, cluster) in clusters.iter().enumerate() {
                    if p.outside >> i & 1 != 0 {
                        continue;
                    }
                    if !mesh.two_sided && cluster.faces_away(eye, forward, camera.orthographic) {
                        continue;
                    }
                    let place = if p.crossing >> i & 1 == 0 {
                        Place {
                            rect: [p.x0[i], p.y0[i], p.x1[i], p.y1[i]],
                            depth: p.depth[i],
                            crossing: false,
                        }
                    } else if let Some(place) = crossing(&screen, cluster) {
                        place
                    } else {
                        continue;
                    };
                    let Some(c) = candidate(&place, width, height) else {
                        continue;
                    };
                    let area = (p.x1[i] - p.x0[i]) * (p.y1[i] - p.y0[i]) * cluster.fill;
                    // With a view region, quads must be larger than their silhouette margins.
                    let shifts = SHIFTS + SHIFTS_OF_CREASES * cluster.creased;
                    let lost = shifts * shift * p.depth[i];
                    let least = samples_per_quad.max(lost * lost);
                    if !c.crossing && area < least * f32::from(cluster.quad_count) {
                        continue;
                    }
                    // Perspective: the nearest distance. In orthographic views W is 1, so that
                    // depth decides.
                    let near = (1.0 / place.depth).max(0.0);
                    let slot = first_instance + index;
                    if usefulness.is_some_and(|u| !u.wants(slot, instance, first + i)) {
                        stats.clusters_not_useful += 1;
                        continue;
                    }
                    let number = part.candidates.len() as u64;
                    part.order.push((u64::from(near.to_bits()) << 32) | number);
                    part.candidates.push(Candidate {
                        hash: cluster.hash ^ instance.hash,
                        instance: slot as u32,
                        cluster: (first + i) as u32,
                        ..c
                    });
                }
            }
        }
    }
}

/// The six frustum planes relative to the eye, with unit normals: inside is `n . p + d >= 0`.
fn instance_planes(camera: &Camera, width: f64, height: f64) -> [DVec4; 6] {
    let [x, y, z, w] = camera.rows;
    [
        x,
        w * width - x,
        y,
        w * height - y,
        // Beyond the near plane, and not beyond the far plane.
        w - z,
        z - w * camera.far_depth,
    ]
    .map(|plane| {
        let length = plane.truncate().length();
        // A plane at infinity has everything inside.
        if length > 0.0 {
            plane / length
        } else {
            DVec4::ZERO
        }
    })
}

/// Whether a whole instance is outside the frustum or too small, by its bounding sphere.
fn outside(camera: &Camera, planes: &[DVec4; 6], instance: &Instance, small: f64) -> bool {
    let c = instance.center - camera.eye;
    let r = instance.radius;
    if planes.iter().any(|p| p.truncate().dot(c) + p.w < -r) {
        return true;
    }
    let w = camera.rows[3].truncate().dot(c) + camera.rows[3].w;
    w > 1.0 && r * r < w * small
}
