//! Device, scene and up to two renderers: the one that is asked about, and its reference.

use foveal::{AdapterStats, Culling, FrameStats, Gpu, RateSource, Renderer, Settings};
use foveal_scene::{Camera, Scene};
use pollster::block_on;

use super::{LoadedScene, OccluderDepth, Request, Rgba, Shown};
use crate::{Host, Loaded, clock};

#[derive(Default)]
pub(super) struct Drawing {
    gpu: Option<Gpu>,
    scene: Option<Scene>,
    chosen: Option<Side>,
    reference: Option<Side>,
    /// The reference's last frame, with what it was drawn for.
    reference_drawn: Option<(Settings, Camera, f32, Rgba, FrameStats)>,
}

/// A renderer with the scene.
struct Side {
    renderer: Renderer,
    /// Where the last frame was seen from.
    before: Option<Camera>,
    posed_s: f32,
}

impl Drawing {
    /// Opens the device, if there is none; says which it is if it is a new one.
    pub(super) fn open(&mut self, host: &Host) -> anyhow::Result<Option<AdapterStats>> {
        if self.gpu.is_some() {
            return Ok(None);
        }
        let gpu = block_on(Gpu::open(host.adapter.as_deref()))?;
        let adapter = gpu.adapter_stats();
        self.gpu = Some(gpu);
        Ok(Some(adapter))
    }

    /// What a driver does that starts anew.
    pub(super) fn lose_device(&self) {
        if let Some(gpu) = &self.gpu {
            gpu.device.destroy();
        }
    }

    /// The next frame is drawn on a new device.
    pub(super) fn give_up_device(&mut self) {
        self.chosen = None;
        self.reference = None;
        self.reference_drawn = None;
        self.gpu = None;
    }

    /// Loads a scene; the old one stays where that fails.
    pub(super) fn load(&mut self, host: &Host, name: &str) -> anyhow::Result<LoadedScene> {
        let Loaded { scene, camera } = (host.load)(name)?;
        let loaded = LoadedScene {
            name: scene.name.clone(),
            counts: foveal::SceneStats {
                objects: scene.objects.len() as u64,
                instances: scene.instances.len() as u64,
                triangles: scene.triangle_count(),
                lights: scene.lights.len() as u64,
                ..Default::default()
            },
            start: camera,
            cameras: scene.cameras.clone(),
            bounds: scene.bounds(),
            is_animated: scene.is_animated(),
            warnings: scene.warnings.len(),
        };
        self.scene = Some(scene);
        self.chosen = None;
        self.reference = None;
        self.reference_drawn = None;
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
        let (Some(gpu), Some(scene)) = (&self.gpu, &mut self.scene) else {
            return Ok(None);
        };
        let side = Side::with(&mut self.chosen, gpu, scene, host, &request.settings)?;
        side.renderer.freeze_culling(request.frozen);
        let (picture, stats) = side.draw(scene, &request.camera, request.time_s)?;
        let culling = side.renderer.culling();
        let boxes = match &culling {
            Some(_) if request.boxes => scene
                .objects
                .iter()
                .map(|object| object.bounds)
                .zip(side.renderer.visibility().iter().copied())
                .collect(),
            _ => Vec::new(),
        };
        let depth = if request.depth {
            side.renderer
                .occluder_depth()
                .map(|(width, height, near_over_distance)| OccluderDepth {
                    width,
                    height,
                    near_over_distance,
                })
        } else {
            None
        };

        let mut flip = None;
        let reference = match &request.reference {
            None => {
                self.reference = None;
                self.reference_drawn = None;
                None
            }
            Some(settings) => {
                let known = self.reference_drawn.as_ref().is_some_and(|(s, c, t, ..)| {
                    s == settings && *c == request.camera && *t == request.time_s
                });
                if !known || request.always {
                    let side = Side::with(&mut self.reference, gpu, scene, host, settings)?;
                    let (picture, stats) = side.draw(scene, &request.camera, request.time_s)?;
                    self.reference_drawn = Some((
                        settings.clone(),
                        request.camera.clone(),
                        request.time_s,
                        picture,
                        stats,
                    ));
                }
                self.reference_drawn
                    .as_ref()
                    .map(|(.., picture, stats)| (picture.clone(), stats.clone()))
            }
        };
        // It takes longer than some frames: only now and then, for a view that stands still.
        if let (Some((reference, _)), 1) = (&reference, repeat % 8) {
            flip = mean_flip(reference, &picture);
        }
        Ok(Some(Shown {
            picture,
            stats,
            camera: request.camera.clone(),
            reference,
            flip,
            culling,
            boxes,
            depth,
        }))
    }
}

impl Side {
    /// The side in `slot` with these settings, made or changed where needed.
    fn with<'s>(
        slot: &'s mut Option<Self>,
        gpu: &Gpu,
        scene: &Scene,
        host: &Host,
        settings: &Settings,
    ) -> anyhow::Result<&'s mut Self> {
        let new_image = |before: Option<&Settings>| {
            let uses =
                |s: &Settings| s.rate == RateSource::Image || s.rate_other == RateSource::Image;
            uses(settings)
                && !before.is_some_and(|b| uses(b) && b.rate_image == settings.rate_image)
        };
        let before = slot.as_ref().map(|side| side.renderer.settings().clone());
        let image = if new_image(before.as_ref()) {
            (host.rate_image)(settings)?
        } else {
            None
        };
        let side = match slot {
            Some(side) => {
                block_on(side.renderer.set_settings(settings))?;
                side
            }
            None => {
                let renderer = block_on(Renderer::new(gpu, settings, Some(clock::now_ms)))?;
                slot.insert(Self {
                    renderer,
                    before: None,
                    posed_s: 0.0,
                })
            }
        };
        if let Some(image) = image {
            side.renderer.set_rate_image(image);
        }
        let rebaked = |before: &Settings| {
            before.anisotropy != settings.anisotropy
                || before.culling != settings.culling && settings.culling == Culling::Occlusion
        };
        if before.as_ref().is_none_or(rebaked) {
            block_on(side.renderer.set_scene(scene))?;
        }
        Ok(side)
    }

    fn draw(
        &mut self,
        scene: &mut Scene,
        camera: &Camera,
        time_s: f32,
    ) -> anyhow::Result<(Rgba, FrameStats)> {
        if scene.is_animated() && self.posed_s != time_s {
            scene.pose(time_s);
            block_on(self.renderer.update_pose(scene))?;
            self.posed_s = time_s;
        }
        let before = self.before.replace(camera.clone());
        let frame = foveal::Frame {
            camera,
            previous_camera: before.as_ref(),
        };
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
