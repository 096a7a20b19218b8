//! What occludes: chosen by mark, set or opacity, and baked once per mesh.

use std::collections::HashMap;
use std::convert::Infallible;
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context, bail};
use foveal_cull::{BakeOptions, OccluderMesh, OccluderSet};
use foveal_scene::{Object, Scene};
use glam::{DAffine3, Vec3};
use rayon::prelude::*;

/// Which objects occlude.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Choice {
    /// Those that the file marks, else all.
    Auto,
    /// Those that the file marks.
    Marked,
    /// All.
    All,
    /// Those of these sets.
    Sets(Vec<String>),
}

impl FromStr for Choice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "auto" => Self::Auto,
            "marked" => Self::Marked,
            "all" => Self::All,
            sets => Self::Sets(sets.split(',').map(|s| s.trim().to_owned()).collect()),
        })
    }
}

/// Geometry as it was before baking; the exact reference draws this.
#[derive(Debug, Clone)]
pub struct Shape {
    /// Vertices in the mesh's space, metres.
    pub positions: Vec<Vec3>,
    /// Three per triangle, counter-clockwise from the front.
    pub indices: Vec<u32>,
    /// Whether its back faces occlude too.
    pub two_sided: bool,
}

/// Shapes and where they stand.
#[derive(Debug, Clone, Default)]
pub struct Occluders {
    /// All of them, baked and placed, as the culler takes them.
    pub set: OccluderSet,
    /// The geometry behind them, before baking.
    pub shapes: Arc<[Shape]>,
    /// Baked shapes, one for one.
    pub meshes: Arc<[Arc<OccluderMesh>]>,
    /// Number of the shape, and where it is.
    pub placed: Vec<(usize, DAffine3)>,
}

impl Occluders {
    /// The occluders of a scene as it is posed.
    pub fn of_scene(scene: &Scene, choice: &Choice) -> anyhow::Result<Self> {
        let mut shapes = Vec::new();
        let mut placed = Vec::new();
        let mut known: HashMap<(u32, bool), usize> = HashMap::new();
        let chosen = chosen(scene, choice)?;
        for instance in &scene.instances {
            let material = &scene.materials[instance.material as usize];
            let mesh = &scene.meshes[instance.mesh as usize];
            let object = &scene.objects[instance.object as usize];
            let occludes = scene.can_occlude(instance) && scene.is_visible(instance);
            if !occludes || !chosen(object) {
                continue;
            }
            let two_sided = material.double_sided;
            let shape = *known.entry((instance.mesh, two_sided)).or_insert_with(|| {
                shapes.push(Shape {
                    positions: mesh.vertices.iter().map(|v| v.position.into()).collect(),
                    indices: mesh.indices.clone(),
                    two_sided,
                });
                shapes.len() - 1
            });
            placed.push((
                shape,
                DAffine3::from_mat4(instance.world_from_object.as_dmat4()),
            ));
        }
        Self::bake(shapes, placed)
            .with_context(|| format!("the occluders of the scene '{}'", scene.name))
    }

    /// Bakes each shape once, on all cores, and places it as often as it stands somewhere.
    pub fn bake(shapes: Vec<Shape>, placed: Vec<(usize, DAffine3)>) -> anyhow::Result<Self> {
        let meshes: Arc<[Arc<OccluderMesh>]> = shapes
            .par_iter()
            .map(|shape| {
                let options = BakeOptions::default().with_two_sided(shape.two_sided);
                OccluderMesh::bake(&shape.positions, &shape.indices, options).map(Arc::new)
            })
            .collect::<Result<_, _>>()?;
        let baked = Self {
            shapes: shapes.into(),
            meshes,
            ..Self::default()
        };
        baked.placed(placed)
    }

    /// The same shapes, baked already, at other places.
    pub fn placed(&self, placed: Vec<(usize, DAffine3)>) -> anyhow::Result<Self> {
        let mut set = OccluderSet::new();
        for &(shape, world_from_mesh) in &placed {
            set.add(self.meshes[shape].clone(), world_from_mesh)?;
        }
        Ok(Self {
            set,
            shapes: Arc::clone(&self.shapes),
            meshes: Arc::clone(&self.meshes),
            placed,
        })
    }
}

/// Whether an object occludes, if its surface is such that it can.
fn chosen(scene: &Scene, choice: &Choice) -> anyhow::Result<impl Fn(&Object) -> bool> {
    let marked = |object: &Object| object.occluder == Some(true);
    if let Choice::Sets(names) = choice {
        for name in names {
            if !scene.objects.iter().any(|o| o.set.as_deref() == Some(name)) {
                bail!("--occluders: {}", no_such_set(scene, name));
            }
        }
    }
    let choice = match choice {
        Choice::Auto if scene.marks_occluders() => Choice::Marked,
        Choice::Auto => Choice::All,
        other => other.clone(),
    };
    Ok(move |object: &Object| match &choice {
        Choice::Marked => marked(object),
        Choice::Auto | Choice::All => true,
        Choice::Sets(names) => object.set.as_ref().is_some_and(|set| names.contains(set)),
    })
}

fn no_such_set(scene: &Scene, name: &str) -> String {
    let mut sets: Vec<&str> = scene
        .objects
        .iter()
        .filter_map(|o| o.set.as_deref())
        .collect();
    sets.sort_unstable();
    sets.dedup();
    let sets = if sets.is_empty() {
        "none".to_owned()
    } else {
        sets.join(", ")
    };
    format!(
        "the scene '{}' has no set '{name}'; its sets are: {sets}",
        scene.name
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use foveal_generate as generate;
    use foveal_scene::AlphaMode;

    fn models(scene: &Scene, choice: &Choice) -> usize {
        Occluders::of_scene(scene, choice).unwrap().set.len()
    }

    #[test]
    fn masked_and_blended_surfaces_never_occlude() {
        let mut scene = generate::by_name("cornell").unwrap();
        assert!(models(&scene, &Choice::All) > 0);
        for (i, material) in scene.materials.iter_mut().enumerate() {
            material.alpha_mode = if i % 2 == 0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Mask { cutoff: 0.5 }
            };
        }
        assert_eq!(models(&scene, &Choice::All), 0);
    }

    #[test]
    fn marks_are_followed_where_there_are_any() {
        let mut scene = generate::by_name("cornell").unwrap();
        scene.objects.iter_mut().for_each(|o| o.occluder = None);
        let all = models(&scene, &Choice::All);
        assert_eq!(models(&scene, &Choice::Auto), all);
        assert_eq!(models(&scene, &Choice::Marked), 0);
        scene.objects[0].occluder = Some(true);
        assert!(models(&scene, &Choice::Auto) < all);
    }

    #[test]
    fn an_unknown_set_lists_those_that_there_are() {
        let mut scene = generate::by_name("cornell").unwrap();
        scene.objects[0].set = Some("walls".to_owned());
        let choice: Choice = "roof".parse().unwrap();
        let error = Occluders::of_scene(&scene, &choice)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("'roof'") && error.contains("walls"),
            "{error}"
        );
    }

    #[test]
    fn equal_meshes_are_baked_once() {
        let scene = generate::by_name("demo:1000").unwrap();
        let occluders = Occluders::of_scene(&scene, &Choice::All).unwrap();
        assert!(occluders.meshes.len() < occluders.placed.len());
    }
}
