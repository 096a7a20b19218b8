//! The things that a culler is asked about.

use foveal_cull::Aabb;
use foveal_scene::Scene;

use super::mocrec::Recorded;

/// The things asked about, one entry per thing in each list.
#[derive(Debug, Clone, Default)]
pub struct Occludees {
    /// World space, metres.
    pub boxes: Vec<Aabb>,
    /// Triangles that one has.
    pub triangles: Vec<u32>,
    /// Draw calls that one costs.
    pub draws: Vec<u32>,
    /// glTF node and element; for recorded draws the number of the record and 0.
    pub ids: Vec<(u32, u32)>,
    /// What a recording says; empty for scenes.
    pub recorded: Vec<Recorded>,
}

impl Occludees {
    /// Takes over the things of `other`, after its own.
    pub fn append(&mut self, other: Self) {
        self.boxes.extend(other.boxes);
        self.triangles.extend(other.triangles);
        self.draws.extend(other.draws);
        self.ids.extend(other.ids);
        self.recorded.extend(other.recorded);
    }

    /// The objects of a scene as it is posed, but for those that it hides.
    pub fn of_scene(scene: &Scene) -> Self {
        let mut occludees = Self::default();
        for object in scene.objects.iter().filter(|object| object.visible) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_objects_are_not_asked_about() {
        let mut scene = foveal_generate::cornell();
        let all = Occludees::of_scene(&scene);
        scene.objects[1].visible = false;
        let shown = Occludees::of_scene(&scene);
        let hidden = scene.objects[1].node;
        assert_eq!(shown.boxes.len() + 1, all.boxes.len());
        assert!(shown.ids.iter().all(|(node, _)| *node != hidden));
    }
}
