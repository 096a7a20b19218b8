//! Scenes and their poses.

use std::borrow::Cow;

use foveal_scene::{Scene, Texture};

use super::Renderer;
use crate::Error;
use crate::environment::resolved;
use crate::gpu::ErrorTrap;
use crate::scene::{ArrayLimits, FrameBindings, SceneMaterials, SceneOnGpu};

impl Renderer {
    /// Uploads a scene in place of the last one.
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance's mesh, material or object, a material's texture, or a
    /// mesh's vertex is not there, where a number of an instance, object, light, material or
    /// environment is not finite, and where a texture or the scene's own environment has other texels
    /// than its size says; [`Error::Limit`] where the scene exceeds the device's limits,
    /// [`Error::NoTexels`], [`Error::OutOfMemory`]; the renderer keeps its old scene then.
    pub async fn set_scene(&mut self, scene: &Scene) -> Result<(), Error> {
        self.set_scene_within(scene, ArrayLimits::of(&self.gpu))
            .await
    }

    /// As [`Renderer::set_scene`], for a host that shows the scene once and is short of memory: the
    /// texels of each texture are freed as soon as they are on the device, so that they are never
    /// there twice. Afterwards, also after an error, [`Texture::levels`](foveal_scene::Texture::levels)
    /// of all textures are empty, and the scene cannot be set again.
    ///
    /// # Errors
    /// As [`Renderer::set_scene`], which refuses it then with [`Error::NoTexels`].
    pub async fn set_scene_and_free_textures(&mut self, scene: &mut Scene) -> Result<(), Error> {
        let whole = std::mem::take(&mut scene.textures);
        let emptied = |texture: &Texture| Texture {
            name: texture.name.clone(),
            levels: Vec::new(),
            ..*texture
        };
        scene.textures = whole.iter().map(emptied).collect();
        let textures = whole.into_iter().map(Cow::Owned).collect();
        self.upload_scene(scene, textures, ArrayLimits::of(&self.gpu))
            .await
    }

    /// As [`Renderer::set_scene`], with arrays of textures no larger than `limits`.
    pub(crate) async fn set_scene_within(
        &mut self,
        scene: &Scene,
        limits: ArrayLimits,
    ) -> Result<(), Error> {
        let textures = scene.textures.iter().map(Cow::Borrowed).collect();
        self.upload_scene(scene, textures, limits).await
    }

    async fn upload_scene(
        &mut self,
        scene: &Scene,
        textures: Vec<Cow<'_, Texture>>,
        limits: ArrayLimits,
    ) -> Result<(), Error> {
        FrameBindings::check_instances(&self.gpu, scene.instances.len())?;
        SceneMaterials::check(&self.gpu, scene.materials.len())?;
        // The old scene may be what does not fit: the next frame mends with the new one.
        self.mend_as_memory_allows().await?;
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene");
        if self.is_torn {
            // Its tables may be invalid; what else binds them is mended before it is drawn with.
            self.frame_bindings = FrameBindings::new(&self.gpu, self.environment.to_bind());
        }
        let uploaded = SceneOnGpu::new(
            &self.gpu,
            scene,
            textures,
            &self.stages.settings,
            &self.material_layout,
            limits,
        );
        let geometry = self.stages.settings.geometry.path;
        let uploaded = uploaded.and_then(|mut scene| {
            let readable = scene.geometry.readable(&self.gpu, geometry)?;
            scene.geometry.take_readable(readable);
            Ok(scene)
        });
        trap.finish().await?;
        let uploaded = uploaded?;
        let uniforms = uploaded.instance_uniforms();
        // With an environment of its own, or without, it may be drawn by other shaders.
        let settings = resolved(self.settings.drawn(), uploaded.image_light.is_some());
        let stages = if settings == self.stages.settings {
            None
        } else {
            Some(self.new_stages(&settings, None).await?)
        };
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene's instances");
        self.frame_bindings.write_instances(&self.gpu, uniforms);
        // The old scene's instances are gone from here on.
        let written = trap.finish().await;
        self.torn(written)?;
        let around = (&uploaded.environment, uploaded.image_light.as_ref());
        let environment = self.upload_environment(&settings, around, None).await;
        let environment = self.torn(environment)?;
        self.scene = uploaded;
        if let Some(stages) = stages {
            // Its counters are read from targets that go.
            self.in_flight = None;
            self.stages = stages;
            self.rate_image_is_new = false;
        }
        self.stages.forget_scene();
        self.take_environment(environment);
        Ok(())
    }

    /// Takes over a new pose of the same scene (after [`Scene::pose`]): places and shapes, lights,
    /// which objects are visible, and the numbers of materials. Their textures and alpha modes, and
    /// what kinds of reflection they have, stay as [`Renderer::set_scene`] found them. The pose
    /// before it becomes the previous one, from which motion vectors are taken; a frame that follows
    /// another without a new pose shows nothing in motion. With the pose of the frame before all
    /// rests, unless the scene has meshes that deform. What is kept from frame to frame is given up
    /// where things had moved with the pose before and no frame has shown it: call this once a frame,
    /// with the pose that it shows.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`]. Call it again then: until it succeeds, objects and lights have the
    /// new pose, and meshes that deform may have the old shape. [`Error::OtherScene`] where meshes,
    /// materials, objects or instances were added, removed or exchanged, or a mesh deforms that did
    /// not; [`Error::Scene`] where a number is not finite, as in [`Renderer::set_scene`], and
    /// [`Error::Limit`] where there are too many lights: nothing of the pose is taken over then.
    pub async fn update_pose(&mut self, scene: &Scene) -> Result<(), Error> {
        self.scene.check_pose(scene)?;
        self.mend().await?;
        let trap = ErrorTrap::new(&self.gpu, "uploading the scene's pose");
        let change = self.scene.update_pose(&self.gpu, scene);
        if change.skips {
            // Motion leads to places that the last frame did not show.
            self.stages.forget_light();
        }
        let wants_places = self.stages.history().is_some();
        let shadows = self
            .stages
            .shadows
            .scene_moved(&change.boxes, &self.scene, wants_places);
        // The same pose once more shows nothing else.
        if change.moves || change.lights_before != self.scene.lights {
            if let Some(variable) = &mut self.stages.variable {
                variable.scene_moved();
            }
            if let Some(coarse) = &mut self.stages.coarse {
                coarse.scene_moved();
            }
        }
        if let Some(history) = self.stages.history() {
            if change.moves {
                history.scene_moved();
            }
            history.lights_changed(&change.lights_before, &self.scene.lights);
            history.light_changed(&shadows);
            history.light_changed(&change.places);
        }
        let uniforms = self.scene.instance_uniforms();
        self.frame_bindings.write_instances(&self.gpu, uniforms);
        let written = trap.finish().await;
        self.torn(written)
    }
}
