//! From a recording to what the culler takes: occluder meshes, boxes, and the eye that saw it.

use std::collections::HashMap;

use foveal_cull::{Aabb, Eye, Projection};
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::read::Triangles;
use super::{Record, Recorded, Recording, Verdict};
use crate::cull::occluders::{Occluders, Shape};
use crate::cull::subject::{Occludees, Subject};
use crate::cull::views::NamedEye;

/// One subject per run of queries with equal occluders before it; at least one.
pub(crate) fn subjects(name: &str, recording: &Recording) -> anyhow::Result<Vec<Subject>> {
    let mut batches = vec![Batch::default()];
    let mut shapes = Shapes::default();
    for (number, record) in recording.records.iter().enumerate() {
        let number = number as u32;
        let last = batches.len() - 1;
        match record {
            Record::Clear if batches[last].is_empty() => {}
            Record::Clear => batches.push(Batch::default()),
            Record::Render(_, triangles) => {
                let Some(placed) = shapes.place(triangles) else {
                    batches[last].skip(number, "an occluder that is empty or not finite");
                    continue;
                };
                if batches[last].occludees.boxes.is_empty() {
                    batches[last].placed.push(placed);
                } else {
                    let mut placed_so_far = batches[last].placed.clone();
                    placed_so_far.push(placed);
                    batches.push(Batch {
                        placed: placed_so_far,
                        ..Batch::default()
                    });
                }
            }
            Record::TestRect(verdict, rect, w) => match rect_box(*rect, *w, recording.near) {
                Ok(bounds) => batches[last].ask(number, bounds, 2, *verdict),
                Err(why) => batches[last].skip(number, why),
            },
            Record::TestTriangles(verdict, triangles) => match triangles_box(triangles) {
                Some(bounds) => {
                    let count = triangles.indices.len() as u32 / 3;
                    batches[last].ask(number, bounds, count, *verdict);
                }
                None => batches[last].skip(number, "triangles that are empty or not finite"),
            },
        }
    }
    if batches.len() > 1 {
        batches.retain(|batch| !batch.is_empty());
    }
    let eye = eye(f64::from(recording.near));
    let total = batches.len();
    batches
        .into_iter()
        .enumerate()
        .map(|(i, batch)| {
            let eye_name = if total == 1 {
                "recorded".to_owned()
            } else {
                format!("recorded {i}")
            };
            Ok(Subject {
                name: name.to_owned(),
                occluders: Occluders::bake(shapes.list.clone(), batch.placed)?,
                occludees: batch.occludees,
                eyes: vec![NamedEye {
                    name: eye_name,
                    eye,
                }],
                notes: batch.notes,
            })
        })
        .collect()
}

/// Tangents of ±1: the clip cube's own sides.
fn eye(near: f64) -> Eye {
    Eye {
        world_from_eye: DAffine3::IDENTITY,
        projection: Projection::Perspective {
            left: -1.0,
            right: 1.0,
            bottom: -1.0,
            top: 1.0,
            near,
            far: f64::INFINITY,
        },
    }
}

#[derive(Default)]
struct Batch {
    placed: Vec<(usize, DAffine3)>,
    occludees: Occludees,
    notes: Vec<String>,
}

impl Batch {
    fn is_empty(&self) -> bool {
        self.placed.is_empty() && self.occludees.boxes.is_empty()
    }

    fn ask(&mut self, number: u32, bounds: Aabb, triangles: u32, verdict: Verdict) {
        self.occludees.boxes.push(bounds);
        self.occludees.triangles.push(triangles);
        self.occludees.draws.push(1);
        self.occludees.ids.push((number, 0));
        self.occludees.recorded.push(Recorded { verdict });
    }

    fn skip(&mut self, number: u32, why: &str) {
        self.notes
            .push(format!("record {number} is left out: {why}"));
    }
}

/// Equal geometry is kept once.
#[derive(Default)]
struct Shapes {
    list: Vec<Shape>,
    known: HashMap<Vec<u32>, usize>,
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
        // Counter-clockwise *on the screen* is the front of the recorder; the culler turns the front of
        // mirrored placements around, as glTF says.
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
    let bounds = Aabb::from_points(points);
    (bounds.min.is_finite() && bounds.max.is_finite() && bounds.min.cmple(bounds.max).all())
        .then_some(bounds)
}
