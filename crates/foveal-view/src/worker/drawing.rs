//! Device, scene and up to two renderers: the one that is asked about, and its reference.

use foveal::{
    AdapterStats, EnvironmentSource, Error, FrameStats, Gpu, RateCombine, RateSource, Renderer,
    Settings, Shading,
};
use foveal_scene::{Camera, Clip, Scene, printable};
use pollster::block_on;

use super::measuring::Measuring;
use super::{LoadedScene, OccluderDepth, Request, Rgba, SETTLING_FRAMES, Shown};
use crate::needs::Abilities;
use crate::pick::{Picked, Ray, pick};
use crate::{Host, Loaded, clock};

#[derive(Default)]
pub(super) struct Drawing {
    gpu: Option<Gpu>,
    scene: Option<Scene>,
    /// The animation that the scene plays.
    clip: Clip,
    /// How many lights are its own.
    own_lights: usize,
    chosen: Option<Side>,
    reference: Option<Side>,
    /// The reference's last frame, with what it was drawn for.
    reference_drawn: Option<ReferenceFrame>,
    measuring: Option<Measuring>,
}

/// A frame of the reference, with what it was drawn for.
struct ReferenceFrame {
    settings: Settings,
    camera: Camera,
    time_s: f32,
    clip: Clip,
    picture: Rgba,
    stats: FrameStats,
}

/// A renderer with the scene.
struct Side {
    renderer: Renderer,
    /// Name of the file that the renderer's environment map came from.
    environment: Option<String>,
    /// Where the last frame was seen from.
    before: Option<Camera>,
    /// The moment of its pose; `None` until it has one.
    posed_s: Option<f32>,
}

impl Drawing {
    /// Opens the device, if there is none; says which it is if it is a new one.
    pub(super) fn open(
        &mut self,
        host: &Host,
    ) -> anyhow::Result<Option<(AdapterStats, Abilities)>> {
        if self.gpu.is_some() {
            return Ok(None);
        }
        let gpu = block_on(Gpu::open(host.adapter.as_deref()))?;
        let adapter = gpu.adapter_stats();
        let features = gpu.device.features();
        let abilities = Abilities {
            clip_distances: features.contains(wgpu::Features::CLIP_DISTANCES),
            is_reduced: gpu.is_reduced(),
        };
        self.gpu = Some(gpu);
        Ok(Some((adapter, abilities)))
    }

    /// What a driver does that starts anew.
    pub(super) fn lose_device(&self) {
        if let Some(gpu) = &self.gpu {
            gpu.device.destroy();
        }
    }

    /// After an error: what it may have spoilt is made anew before the next frame, the device
    /// included where it is the device's. A file that cannot be read has spoilt nothing.
    pub(super) fn give_up(&mut self, error: &anyhow::Error) {
        let Some(error) = error.downcast_ref() else {
            return;
        };
        self.give_up_sides();
        match error {
            Error::Limit { .. }
            | Error::Setting { .. }
            | Error::NoTexels { .. }
            | Error::Scene { .. }
            | Error::OtherScene { .. }
            | Error::Environment { .. } => {}
            _ => self.gpu = None,
        }
    }

    /// The next frame is drawn by new renderers.
    fn give_up_sides(&mut self) {
        self.chosen = None;
        self.reference = None;
        self.reference_drawn = None;
        self.measuring = None;
    }

    /// Loads a scene; the old one stays where that fails.
    pub(super) fn load(&mut self, host: &Host, name: &str) -> anyhow::Result<LoadedScene> {
        let Loaded {
            mut scene,
            camera,
            clip,
        } = (host.load)(name)?;
        let own_lights = scene.lights.len();
        (host.light)(&mut scene);
        let loaded = LoadedScene {
            name: printable(&scene.name),
            source: name.to_owned(),
            counts: foveal::SceneStats {
                objects: scene.objects.len() as u64,
                instances: scene.instances.len() as u64,
                triangles: scene.triangle_count(),
                lights: scene.lights.len() as u64,
                ..Default::default()
            },
            start: Camera {
                name: printable(&camera.name),
                ..camera
            },
            cameras: shown_cameras(&scene),
            bounds: scene.bounds(),
            clips: scene.clips().map(|(n, s)| (n.to_owned(), s)).collect(),
            clip: clip.clone(),
            warnings: scene.warnings.len(),
        };
        self.scene = Some(scene);
        self.clip = clip;
        self.own_lights = own_lights;
        self.give_up_sides();
        Ok(loaded)
    }

    /// Draws the `repeat`th frame of a request; `None` without a scene.
    pub(super) fn draw(
        &mut self,
        host: &Host,
        request: &Request,
        repeat: u32,
    ) -> anyhow::Result<Option<Shown>> {
        self.open(host)?;
        self.play(host, &request.clip);
        let (Some(gpu), Some(scene)) = (&self.gpu, &mut self.scene) else {
            return Ok(None);
        };
        // A view that stands still is drawn as if nothing had been before: its picture does not
        // depend on the way to it.
        let is_afresh = repeat == 1;
        let Some(settings) = &request.reference else {
            self.reference = None;
            self.reference_drawn = None;
            self.measuring = None;
            let side = Side::with(&mut self.chosen, gpu, scene, host, &request.settings)?;
            side.renderer.freeze_culling(request.frozen);
            let drawn = side.draw(scene, request, is_afresh)?;
            return Ok(Some(side.shown(scene, request, drawn)));
        };
        let Request { camera, time_s, .. } = request;
        self.measuring.take_if(|m| !m.is_of(request));
        let measuring = self
            .measuring
            .get_or_insert_with(|| Measuring::new(request));
        // While settings change all the time, the picture of a reference that stays is good enough.
        let known = self.reference_drawn.as_ref().is_some_and(|drawn| {
            (&drawn.settings, &drawn.camera, &drawn.clip) == (settings, camera, &request.clip)
                && drawn.time_s == *time_s
        });
        let draws_both = !known || repeat > 0 || request.always;
        let reference_first = draws_both && measuring.reference_first();
        let reference = &mut self.reference;
        let mut draw_reference = |scene: &mut Scene| -> anyhow::Result<ReferenceFrame> {
            let (picture, stats) = Side::with(reference, gpu, scene, host, settings)?
                .draw(scene, request, is_afresh)?;
            Ok(ReferenceFrame {
                settings: settings.clone(),
                camera: camera.clone(),
                time_s: *time_s,
                clip: request.clip.clone(),
                picture,
                stats,
            })
        };
        if reference_first {
            self.reference_drawn = Some(draw_reference(scene)?);
        }
        let side = Side::with(&mut self.chosen, gpu, scene, host, &request.settings)?;
        side.renderer.freeze_culling(request.frozen);
        let drawn = side.draw(scene, request, is_afresh)?;
        if draws_both && !reference_first {
            self.reference_drawn = Some(draw_reference(scene)?);
        }
        let mut shown = side.shown(scene, request, drawn);
        if let Some(reference) = &self.reference_drawn {
            if draws_both {
                measuring.add(&reference.stats, &shown.stats);
            }
            // It takes longer than some frames: only now and then, for a view that stands still.
            if repeat == 1 || repeat == SETTLING_FRAMES - 1 || request.always && repeat % 8 == 1 {
                shown.flip = mean_flip(&reference.picture, &shown.picture);
            }
            shown.reference = Some((reference.picture.clone(), reference.stats.clone()));
            shown.compared = Some(measuring.compared());
        }
        Ok(Some(shown))
    }

    /// Has the scene play another animation.
    fn play(&mut self, host: &Host, clip: &Clip) {
        let Some(scene) = self.scene.as_mut().filter(|_| self.clip != *clip) else {
            return;
        };
        if scene.play(clip) {
            // As if it had been loaded with this one.
            scene.lights.truncate(self.own_lights);
            scene.pose(0.0);
            (host.light)(scene);
        }
        self.clip = clip.clone();
        // What moves may be another part of the scene.
        self.give_up_sides();
    }

    /// The object that a ray meets.
    pub(super) fn pick(&self, ray: Ray) -> Option<Picked> {
        pick(self.scene.as_ref()?, ray)
    }

    /// Whether drawing the same again can tell nothing more about two sides.
    pub(super) fn is_measured(&self) -> bool {
        self.measuring.as_ref().is_none_or(Measuring::is_done)
    }
}

impl Side {
    /// What is told of a frame that this side drew, and of what it culled.
    fn shown(
        &self,
        scene: &Scene,
        request: &Request,
        (picture, stats): (Rgba, FrameStats),
    ) -> Shown {
        let culling = self.renderer.culling();
        let boxes = match &culling {
            Some(_) if request.boxes => scene
                .objects
                .iter()
                .map(|object| object.bounds)
                .zip(self.renderer.visibility().iter().copied())
                .collect(),
            _ => Vec::new(),
        };
        let depth = if request.depth {
            self.renderer
                .occluder_depth()
                .map(|(width, height, near_over_distance)| OccluderDepth {
                    width,
                    height,
                    near_over_distance,
                })
        } else {
            None
        };

        Shown {
            picture,
            stats,
            request: request.clone(),
            reference: None,
            compared: None,
            flip: None,
            culling,
            boxes,
            depth,
        }
    }

    /// The side in `slot` with these settings, made or changed where needed.
    fn with<'s>(
        slot: &'s mut Option<Self>,
        gpu: &Gpu,
        scene: &Scene,
        host: &Host,
        settings: &Settings,
    ) -> anyhow::Result<&'s mut Self> {
        let named = |s: &Settings| {
            let lighting = &s.lighting;
            let is_image = lighting.environment == EnvironmentSource::Image;
            is_image.then(|| lighting.environment_image.clone())
        };
        let before = slot.as_ref().map(|side| side.renderer.settings().clone());
        let name = named(settings);
        // The renderer may hold another map than its settings name, where those failed that came
        // with it.
        let held = slot.as_ref().and_then(|side| side.environment.clone());
        let environment =
            if before.as_ref().and_then(named) != name || name.is_some() && held != name {
                (host.environment)(settings)?
            } else {
                None
            };
        let used = used_image(settings);
        let image = if used.is_some() && used != before.as_ref().and_then(used_image) {
            (host.rate_image)(settings)?
        } else {
            None
        };
        let side = match slot {
            Some(side) => {
                if let Some(map) = environment {
                    side.environment = None;
                    block_on(side.renderer.set_environment(map))?;
                    side.environment = name;
                }
                block_on(side.renderer.set_settings(settings))?;
                side
            }
            None => {
                let mut renderer = block_on(Renderer::new(
                    gpu,
                    settings,
                    foveal::RendererOptions::default().with_clock(clock::now_ns),
                ))?;
                let mut held = None;
                if let Some(map) = environment {
                    block_on(renderer.set_environment(map))?;
                    held = name;
                }
                slot.insert(Self {
                    renderer,
                    environment: held,
                    before: None,
                    posed_s: None,
                })
            }
        };
        if let Some(image) = image {
            side.renderer.set_rate_image(image)?;
        }
        let needs_scene = |before: &Settings| settings.needs_scene_again(before);
        if before.as_ref().is_none_or(needs_scene) {
            block_on(side.renderer.set_scene(scene))?;
            side.posed_s = None;
        }
        Ok(side)
    }

    /// Draws the request's view; `scene` is posed for its moment. `is_afresh`: what was learnt from
    /// the frames before is forgotten.
    fn draw(
        &mut self,
        scene: &mut Scene,
        request: &Request,
        is_afresh: bool,
    ) -> anyhow::Result<(Rgba, FrameStats)> {
        let Request { camera, time_s, .. } = request;
        if scene.is_animated() && self.posed_s != Some(*time_s) {
            scene.pose(*time_s);
            block_on(self.renderer.update_pose(scene))?;
            self.posed_s = Some(*time_s);
        }
        let mut before = self.before.replace(camera.clone());
        if is_afresh {
            // The same view by another name: not the one that was drawn last, and nothing moves.
            before = Some(Camera {
                name: format!("{} afresh", camera.name),
                ..camera.clone()
            });
        }
        let frame = foveal::Frame::new(camera).with_previous(before.as_ref());
        let stats = block_on(self.renderer.render(&frame))?;
        let bytes = block_on(self.renderer.read_picture())?;
        let picture = Rgba {
            width: stats.width,
            height: stats.height,
            bytes,
        };
        Ok((picture, stats))
    }
}

/// The image that gives rates; `None` where none does.
fn used_image(settings: &Settings) -> Option<&str> {
    let coarse = &settings.coarse;
    let is_second =
        coarse.combine != RateCombine::First && coarse.other_source == RateSource::Image;
    let is_used =
        settings.shading.mode != Shading::Full && (coarse.source == RateSource::Image || is_second);
    is_used.then_some(coarse.image_name.as_str())
}

/// The scene's cameras with names that can be shown.
fn shown_cameras(scene: &Scene) -> Vec<Camera> {
    let shown = |camera: &Camera| Camera {
        name: printable(&camera.name),
        ..camera.clone()
    };
    scene.cameras.iter().map(shown).collect()
}

/// The mean of FLIP's error map; `None` for pictures of different sizes.
fn mean_flip(reference: &Rgba, picture: &Rgba) -> Option<f32> {
    if (reference.width, reference.height) != (picture.width, picture.height) {
        return None;
    }
    let rgb = |picture: &Rgba| {
        let pixels = picture.bytes.as_chunks::<4>().0;
        let rgb: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        nv_flip::FlipImageRgb8::with_data(picture.width, picture.height, &rgb)
    };
    let map = nv_flip::flip(
        rgb(reference),
        rgb(picture),
        nv_flip::DEFAULT_PIXELS_PER_DEGREE,
    );
    Some(nv_flip::FlipPool::from_image(&map).mean())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_image_is_used_where_shading_asks_for_rates() {
        let full = Settings::default().with(|s| {
            s.shading.mode = Shading::Full;
            s.coarse.source = RateSource::Image;
            s.coarse.image_name = "rates.png".to_owned();
        });
        assert_eq!(used_image(&full), None);
        let coarse = full.with(|s| s.shading.mode = Shading::Coarse);
        assert_eq!(used_image(&coarse), Some("rates.png"));
        let second = coarse.with(|s| {
            s.coarse.source = RateSource::Radii;
            s.coarse.other_source = RateSource::Image;
            s.coarse.combine = RateCombine::First;
        });
        assert_eq!(used_image(&second), None);
        let combined = second.with(|s| s.coarse.combine = RateCombine::Finer);
        assert_eq!(used_image(&combined), Some("rates.png"));
    }

    #[test]
    fn a_file_that_cannot_be_read_leaves_device_and_renderer() {
        let host = Host {
            load: Box::new(|_| {
                let scene = foveal_generate::cornell();
                let camera = scene.cameras[0].clone();
                let clip = Clip::default();
                Ok(Loaded {
                    scene,
                    camera,
                    clip,
                })
            }),
            environment: |_| anyhow::bail!("there is no such file"),
            ..crate::app::tests::host()
        };
        let mut drawing = Drawing::default();
        let loaded = drawing.load(&host, "cornell").unwrap();
        let mut request = Request {
            settings: Settings::default().with(|s| {
                s.picture.width = 32;
                s.picture.height = 32;
            }),
            reference: None,
            camera: loaded.start,
            frozen: false,
            boxes: false,
            depth: false,
            time_s: 0.0,
            clip: Clip::default(),
            always: false,
        };
        assert!(drawing.draw(&host, &request, 0).unwrap().is_some());
        request.settings.lighting.environment = EnvironmentSource::Image;
        let error = drawing.draw(&host, &request, 0).unwrap_err();
        drawing.give_up(&error);
        assert!(drawing.gpu.is_some() && drawing.chosen.is_some());
        let lost = Error::DeviceLost {
            reason: "a test".to_owned(),
        };
        drawing.give_up(&lost.into());
        assert!(drawing.gpu.is_none() && drawing.chosen.is_none());
    }
}
