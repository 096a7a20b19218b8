//! What is culled: occluders, the boxes that are asked about, and the eyes.

use foveal_cull::Aabb;
use foveal_scene::Scene;

use super::mocrec::Recorded;
use foveal_host::culling::NamedEye;
use foveal_host::culling::{Choice, Occluders};

/// The things asked about, one entry per thing in each list.
#[derive(Debug, Clone, Default)]
pub(crate) struct Occludees {
    /// World space, metres.
    pub(crate) boxes: Vec<Aabb>,
    pub(crate) triangles: Vec<u32>,
    /// Draw calls that one costs.
    pub(crate) draws: Vec<u32>,
    /// glTF node and element; for recorded draws the number of the record and 0.
    pub(crate) ids: Vec<(u32, u32)>,
    /// What a recording says; empty for scenes.
    pub(crate) recorded: Vec<Recorded>,
}

/// A scene, or a stretch of a recording.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) occluders: Occluders,
    pub(crate) occludees: Occludees,
    pub(crate) eyes: Vec<NamedEye>,
    /// What could not be represented, for a human.
    pub(crate) notes: Vec<String>,
}

impl Occludees {
    /// Takes over the things of `other`, after its own.
    pub(crate) fn append(&mut self, other: Self) {
        self.boxes.extend(other.boxes);
        self.triangles.extend(other.triangles);
        self.draws.extend(other.draws);
        self.ids.extend(other.ids);
        self.recorded.extend(other.recorded);
    }

    /// The objects of a scene as it is posed.
    pub(crate) fn of_scene(scene: &Scene) -> Self {
        let mut occludees = Self::default();
        for object in &scene.objects {
            let range = object.instances.start as usize..object.instances.end as usize;
            let instances = scene.instances.get(range).unwrap_or_default();
            let triangles: usize = instances
                .iter()
                .map(|i| scene.meshes[i.mesh as usize].triangle_count())
                .sum();
            occludees
                .boxes
                .push(Aabb::new(object.bounds.min, object.bounds.max));
            occludees.triangles.push(triangles as u32);
            occludees.draws.push(instances.len() as u32);
            occludees.ids.push((object.node, object.element));
        }
        occludees
    }
}

impl Subject {
    /// A scene, seen by `eyes`.
    pub(crate) fn of_scene(
        scene: &Scene,
        choice: &Choice,
        eyes: Vec<NamedEye>,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            name: scene.name.clone(),
            occluders: Occluders::of_scene(scene, choice)?,
            occludees: Occludees::of_scene(scene),
            eyes,
            notes: Vec::new(),
        })
    }
}
