//! From a recording to what the culler takes: occluder meshes, boxes, and the eye that saw it.

use std::collections::HashMap;
use std::ops::Range;

use foveal_cull::{Aabb, Eye, Projection};
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::agreement::Recorded;
use super::read::{Record, Recording, Triangles, Verdict};
use crate::culling::eye::NamedEye;
use crate::culling::occludees::Occludees;
use crate::culling::occluders::{Occluders, Shape};
use crate::culling::subject::Subject;

/// Most subjects that a recording becomes. Each draws its occluders from the start, so that a
/// recording in which every query follows a draw of its own would take time by the square of its
/// length.
const MOST_SUBJECTS: usize = 16;

/// Records that are left out are named up to this many.
const MOST_NOTES: usize = 16;

/// One subject per run of queries with equal occluders before it, at least one. Beyond
/// `MOST_SUBJECTS` neighbouring runs share a subject with the occluders of the first of them:
/// fewer occluders hide nothing more.
///
/// # Errors
/// Where occluders cannot be baked.
pub fn subjects(name: &str, recording: &Recording) -> anyhow::Result<Vec<Subject>> {
    let mut shapes = Shapes::default();
    let mut runs = runs(recording, &mut shapes);
    let found = runs.len();
    runs = joined(runs);
    let baked = Occluders::bake(std::mem::take(&mut shapes.list), Vec::new())?;
    let eye = eye(f64::from(recording.near));
    let total = runs.len();
    let subject = |(i, mut run): (usize, Run)| {
        let eye_name = if total == 1 {
            "recorded".to_owned()
        } else {
            format!("recorded {i}")
        };
        if i == 0 && total < found {
            run.notes.push(format!(
                "{found} runs of queries are answered as {total}: some see fewer occluders than when they were recorded"
            ));
        }
        Ok(Subject {
            name: name.to_owned(),
            occluders: baked.placed(shapes.placed[run.occluders].to_vec())?,
            occludees: run.occludees,
            eyes: vec![NamedEye {
                name: eye_name,
                eye,
            }],
            notes: run.notes,
        })
    };
    let mut subjects: Vec<Subject> = runs
        .into_iter()
        .enumerate()
        .map(subject)
        .collect::<anyhow::Result<_>>()?;
    if let (Some(first), more @ 1..) = (subjects.first_mut(), shapes.unnamed) {
        first
            .notes
            .push(format!("{more} more records are left out"));
    }
    Ok(subjects)
}

/// Splits a recording where the occluders change.
fn runs(recording: &Recording, shapes: &mut Shapes) -> Vec<Run> {
    let mut runs = vec![Run::default()];
    for (number, record) in recording.records.iter().enumerate() {
        let number = number as u32;
        let last = runs.len() - 1;
        let run = &mut runs[last];
        let reached = shapes.placed.len();
        match record {
            Record::Clear if run.is_empty() => run.occluders = reached..reached,
            Record::Clear => runs.push(Run::with(reached..reached)),
            Record::Render(_, triangles) => match shapes.place(triangles) {
                None => run.skip(shapes, number, "an occluder that is empty or not finite"),
                Some(placed) => {
                    shapes.placed.push(placed);
                    let occluders = run.occluders.start..reached + 1;
                    if run.occludees.boxes.is_empty() {
                        run.occluders = occluders;
                    } else {
                        runs.push(Run::with(occluders));
                    }
                }
            },
            Record::TestRect(verdict, rect, w) => match rect_box(*rect, *w, recording.near) {
                Ok(bounds) => run.ask(number, bounds, 2, *verdict),
                Err(why) => run.skip(shapes, number, why),
            },
            Record::TestTriangles(verdict, triangles) => match triangles_box(triangles) {
                Some(bounds) => {
                    let count = triangles.indices.len() as u32 / 3;
                    run.ask(number, bounds, count, *verdict);
                }
                None => run.skip(shapes, number, "triangles that are empty or not finite"),
            },
        }
    }
    if runs.len() > 1 {
        runs.retain(|run| !run.is_empty());
    }
    runs
}

/// At most [`MOST_SUBJECTS`] runs. Runs after a clear are never answered with occluders from before
/// it: where that would be, they see none.
fn joined(runs: Vec<Run>) -> Vec<Run> {
    if runs.len() <= MOST_SUBJECTS {
        return runs;
    }
    let each = runs.len().div_ceil(MOST_SUBJECTS);
    let mut joined: Vec<Run> = Vec::with_capacity(MOST_SUBJECTS);
    for (i, run) in runs.into_iter().enumerate() {
        match joined.last_mut() {
            Some(group) if !i.is_multiple_of(each) => {
                if group.occluders.start != run.occluders.start {
                    group.occluders = 0..0;
                }
                group.occludees.append(run.occludees);
                group.notes.extend(run.notes);
            }
            _ => joined.push(run),
        }
    }
    joined
}

/// Tangents of ±1: the clip cube's own sides.
fn eye(near: f64) -> Eye {
    let projection = Projection::Perspective {
        left: -1.0,
        right: 1.0,
        bottom: -1.0,
        top: 1.0,
        near_m: near,
        far_m: f64::INFINITY,
    };
    Eye::new(DAffine3::IDENTITY, projection)
}

/// Queries with the same occluders before them.
#[derive(Default)]
struct Run {
    /// Range of [`Shapes::placed`].
    occluders: Range<usize>,
    occludees: Occludees,
    notes: Vec<String>,
}

impl Run {
    fn with(occluders: Range<usize>) -> Self {
        Self {
            occluders,
            ..Self::default()
        }
    }

    fn is_empty(&self) -> bool {
        self.occluders.is_empty() && self.occludees.boxes.is_empty()
    }

    fn ask(&mut self, number: u32, bounds: Aabb, triangles: u32, verdict: Verdict) {
        self.occludees.boxes.push(bounds);
        self.occludees.triangles.push(triangles);
        self.occludees.draws.push(1);
        self.occludees.ids.push((number, 0));
        self.occludees.recorded.push(Recorded { verdict });
    }

    fn skip(&mut self, shapes: &mut Shapes, number: u32, why: &str) {
        shapes.named += 1;
        if shapes.named > MOST_NOTES {
            shapes.unnamed += 1;
        } else {
            self.notes
                .push(format!("record {number} is left out: {why}"));
        }
    }
}

/// Equal geometry is kept once.
#[derive(Default)]
struct Shapes {
    list: Vec<Shape>,
    known: HashMap<Vec<u32>, usize>,
    /// All occluders in the order in which they were drawn.
    placed: Vec<(usize, DAffine3)>,
    /// Records left out, and those of them that no note names.
    named: usize,
    unnamed: usize,
}

impl Shapes {
    fn place(&mut self, triangles: &Triangles) -> Option<(usize, DAffine3)> {
        let world_from_model = world_from_model(triangles);
        let finite = world_from_model.is_finite()
            && triangles
                .indices
                .iter()
                .all(|&i| triangles.vertices[i as usize].is_finite());
        if triangles.indices.is_empty() || !finite {
            return None;
        }
        let mirrored = world_from_model.matrix3.determinant() < 0.0;
        // Counter-clockwise *on the screen* is the front of the recorder; the culler turns the
        // front of mirrored placements around, as glTF says.
        let turn = mirrored != (triangles.backface_winding == 2);
        let two_sided = !matches!(triangles.backface_winding, 1 | 2);
        let key: Vec<u32> = [u32::from(turn), u32::from(two_sided)]
            .into_iter()
            .chain([triangles.vertices.len() as u32])
            .chain(
                triangles
                    .vertices
                    .iter()
                    .flat_map(|v| v.to_array().map(f32::to_bits)),
            )
            .chain(triangles.indices.iter().copied())
            .collect();
        let shape = *self.known.entry(key).or_insert_with(|| {
            let mut indices = triangles.indices.clone();
            if turn {
                indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
            }
            self.list.push(Shape {
                positions: triangles.vertices.clone(),
                indices,
                two_sided,
            });
            self.list.len() - 1
        });
        Some((shape, world_from_model))
    }
}

/// Recorded coordinates to (x, y, -w).
fn world_from_model(triangles: &Triangles) -> DAffine3 {
    match triangles.matrix {
        None => DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)),
        Some(m) => {
            let column = |i: usize| DVec3::new(m[i].into(), m[i + 1].into(), -f64::from(m[i + 3]));
            DAffine3::from_mat3_translation(
                DMat3::from_cols(column(0), column(4), column(8)),
                column(12),
            )
        }
    }
}

/// A rectangle at one distance is a box without depth.
fn rect_box([x0, y0, x1, y1]: [f32; 4], w: f32, near: f32) -> Result<Aabb, &'static str> {
    if ![x0, y0, x1, y1, w].iter().all(|v| v.is_finite()) {
        return Err("a rectangle that is not finite");
    }
    if w < near {
        return Err("a rectangle nearer than the near plane");
    }
    if x0 > x1 || y0 > y1 {
        return Err("a rectangle that is inside out");
    }
    Ok(Aabb::new(
        Vec3::new(x0 * w, y0 * w, -w),
        Vec3::new(x1 * w, y1 * w, -w),
    ))
}

/// The box around triangles: what hides it hides them.
fn triangles_box(triangles: &Triangles) -> Option<Aabb> {
    let world_from_model = world_from_model(triangles);
    let points = triangles.indices.iter().map(|&i| {
        let p = triangles.vertices[i as usize].as_dvec3();
        world_from_model.transform_point3(p).as_vec3()
    });
    let bounds = Aabb::of_points(points);
    bounds.is_valid().then_some(bounds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(x: f32) -> Triangles {
        Triangles {
            vertices: vec![
                Vec3::new(x, 0.0, 1.0),
                Vec3::new(x + 0.1, 0.0, 1.0),
                Vec3::new(x, 0.1, 1.0),
            ],
            indices: vec![0, 1, 2],
            ..Triangles::default()
        }
    }

    fn draw(x: f32) -> Record {
        Record::Render(Verdict::Unknown, triangle(x))
    }

    fn query() -> Record {
        Record::TestRect(Verdict::Visible, [-0.5, -0.5, 0.5, 0.5], 2.0)
    }

    fn replayed(records: Vec<Record>) -> Vec<Subject> {
        let recording = Recording {
            near: 0.1,
            width: 64,
            height: 64,
            records,
        };
        subjects("test", &recording).unwrap()
    }

    /// Occluders and queries of each subject.
    fn sizes(subjects: &[Subject]) -> Vec<(usize, usize)> {
        let size = |s: &Subject| (s.occluders.placed.len(), s.occludees.boxes.len());
        subjects.iter().map(size).collect()
    }

    #[test]
    fn queries_see_what_was_drawn_before_them_since_the_last_clear() {
        let records = vec![
            draw(0.0),
            draw(0.2),
            query(),
            draw(0.4),
            query(),
            query(),
            Record::Clear,
            query(),
            draw(0.6),
            query(),
        ];
        assert_eq!(sizes(&replayed(records)), [(2, 1), (3, 2), (0, 1), (1, 1)]);
    }

    #[test]
    fn many_runs_become_few_subjects_that_lose_no_query_and_gain_no_occluder() {
        let records = (0..2000).flat_map(|i| [draw(i as f32), query()]).collect();
        let subjects = replayed(records);
        assert_eq!(subjects.len(), MOST_SUBJECTS);
        let mut asked = 0;
        for subject in &subjects {
            // The first query of the subject came after as many draws as it had queries before it,
            // and its own.
            assert_eq!(subject.occluders.placed.len(), asked + 1);
            asked += subject.occludees.boxes.len();
        }
        assert_eq!(asked, 2000);
        assert!(subjects[0].notes[0].contains("2000 runs of queries are answered as 16"));
    }

    #[test]
    fn occluders_from_before_a_clear_answer_no_query_after_it() {
        let records = (0..500)
            .flat_map(|i| [draw(i as f32), query(), Record::Clear])
            .collect();
        for subject in &replayed(records) {
            assert_eq!(subject.occluders.placed.len(), 0);
        }
    }

    #[test]
    fn what_is_left_out_is_named_a_few_times() {
        let broken = Record::TestRect(Verdict::Visible, [f32::NAN; 4], 1.0);
        let subjects = replayed(vec![broken; 100]);
        let notes: Vec<&String> = subjects.iter().flat_map(|s| &s.notes).collect();
        assert_eq!(notes.len(), MOST_NOTES + 1);
        assert!(notes[MOST_NOTES].contains("84 more records"));
    }
}
