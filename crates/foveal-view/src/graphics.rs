//! What the window draws itself with: a surface, a device and the interface's painter.
//!
//! A device can be lost at any time: its driver starts anew, or the machine slept. Then all three
//! are made again.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, anyhow};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use pollster::block_on;
use winit::dpi::PhysicalSize;
use winit::window::Window;

pub(crate) struct Graphics {
    // The surface goes first: its images are the device's.
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    painter: egui_wgpu::Renderer,
    device: wgpu::Device,
    queue: wgpu::Queue,
    lost: Arc<AtomicBool>,
}

impl Graphics {
    /// Opens a device for the window; `wake` is called when it is lost.
    pub(crate) fn new(
        window: &Arc<Window>,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> anyhow::Result<Self> {
        // OpenGL draws only to windows of a display that it was opened with.
        let display = Box::new(Arc::clone(window));
        let instance = wgpu::Instance::new(
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(display),
        );
        let surface = instance.create_surface(Arc::clone(window))?;
        let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .context(
            "no graphics adapter can draw to the window; install a Vulkan driver (on Debian: \
             apt-get install mesa-vulkan-drivers)",
        )?;
        let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("window"),
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
                ..wgpu::Limits::downlevel_defaults()
            },
            ..Default::default()
        }))?;
        let lost = Arc::new(AtomicBool::new(false));
        let theirs = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, _| {
            theirs.store(true, Ordering::Relaxed);
            wake();
        });
        let [width, height] = drawn_size(window.inner_size(), &device.limits());
        let mut configuration = surface
            .get_default_config(&adapter, width, height)
            .ok_or_else(|| anyhow!("the graphics adapter cannot draw to the window"))?;
        // The interface blends as if values were sRGB: a target that does not encode suits it.
        let formats = surface.get_capabilities(&adapter).formats;
        if let Some(plain) = formats.iter().find(|f| !f.is_srgb()) {
            configuration.format = *plain;
        }
        configuration.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&device, &configuration);
        let painter =
            egui_wgpu::Renderer::new(&device, configuration.format, RendererOptions::default());
        Ok(Self {
            surface,
            configuration,
            painter,
            device,
            queue,
            lost,
        })
    }

    pub(crate) fn is_lost(&self) -> bool {
        finds_loss(&self.lost, || {
            let _ = self.device.poll(wgpu::PollType::Poll);
        })
    }

    /// What a driver does that starts anew.
    pub(crate) fn lose(&self) {
        self.device.destroy();
    }

    /// Pixels a side of the largest texture.
    pub(crate) fn largest_texture(&self) -> usize {
        self.device.limits().max_texture_dimension_2d as usize
    }

    pub(crate) fn resize(&mut self, size: PhysicalSize<u32>) {
        let size = drawn_size(size, &self.device.limits());
        [self.configuration.width, self.configuration.height] = size;
        self.surface.configure(&self.device, &self.configuration);
    }

    /// Whether pictures wait for the screen.
    pub(crate) fn set_vsync(&mut self, vsync: bool) {
        let wanted = if vsync {
            wgpu::PresentMode::AutoVsync
        } else {
            wgpu::PresentMode::AutoNoVsync
        };
        if self.configuration.present_mode != wanted {
            self.configuration.present_mode = wanted;
            self.surface.configure(&self.device, &self.configuration);
        }
    }

    /// Shows the interface's triangles; `false` where the surface had to be set up again and
    /// nothing is shown yet.
    pub(crate) fn show(
        &mut self,
        window: &Window,
        triangles: &[egui::ClippedPrimitive],
        mut textures: egui::TexturesDelta,
        pixels_per_point: f32,
    ) -> bool {
        for (id, changes) in std::mem::take(&mut textures.set) {
            for change in changes {
                self.painter
                    .update_texture(&self.device, &self.queue, id, &change);
            }
        }
        let is_shown = self.paint(window, triangles, pixels_per_point);
        for id in std::mem::take(&mut textures.free) {
            self.painter.free_texture(&id);
        }
        is_shown
    }

    fn paint(
        &mut self,
        window: &Window,
        triangles: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
    ) -> bool {
        use wgpu::CurrentSurfaceTexture as Current;
        let frame = match self.surface.get_current_texture() {
            Current::Success(frame) | Current::Suboptimal(frame) => frame,
            // Only a new surface helps, and it comes with a new device.
            Current::Lost => {
                self.lost.store(true, Ordering::Relaxed);
                return false;
            }
            Current::Outdated => {
                self.surface.configure(&self.device, &self.configuration);
                return false;
            }
            // A frame too many.
            Current::Timeout => return false,
            // Hidden: the event that shows it again tries again.
            _ => return true,
        };
        let view = frame.texture.create_view(&Default::default());
        let screen = ScreenDescriptor {
            size_in_pixels: [self.configuration.width, self.configuration.height],
            pixels_per_point,
        };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let before = self.painter.update_buffers(
            &self.device,
            &self.queue,
            &mut encoder,
            triangles,
            &screen,
        );
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("interface"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.painter
            .render(&mut pass.forget_lifetime(), triangles, &screen);
        self.queue
            .submit(before.into_iter().chain([encoder.finish()]));
        window.pre_present_notify();
        self.queue.present(frame);
        true
    }
}

/// How much of a window of this size is drawn, from its upper left corner: a window can be larger
/// than any texture.
fn drawn_size(window: PhysicalSize<u32>, limits: &wgpu::Limits) -> [u32; 2] {
    let most = limits.max_texture_dimension_2d;
    [window.width, window.height].map(|pixels| pixels.clamp(1, most))
}

/// Whether the device is lost. A loss that nobody waits for is told when the device is asked; wgpu
/// panics where it is the driver that reports it then.
fn finds_loss(lost: &AtomicBool, ask: impl FnOnce()) -> bool {
    if lost.load(Ordering::Relaxed) {
        return true;
    }
    if catch_unwind(AssertUnwindSafe(ask)).is_err() {
        lost.store(true, Ordering::Relaxed);
    }
    lost.load(Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_larger_than_any_texture_is_drawn_in_part() {
        let limits = wgpu::Limits {
            max_texture_dimension_2d: 8192,
            ..wgpu::Limits::downlevel_defaults()
        };
        let drawn = |width, height| drawn_size(PhysicalSize::new(width, height), &limits);
        assert_eq!(drawn(1280, 720), [1280, 720]);
        assert_eq!(drawn(17000, 300), [8192, 300]);
        assert_eq!(drawn(0, 9000), [1, 8192]);
    }

    #[test]
    fn a_driver_that_panics_when_it_is_asked_has_lost_the_device() {
        let lost = AtomicBool::new(false);
        assert!(!finds_loss(&lost, || ()));
        assert!(finds_loss(&lost, || panic!("the device is lost")));
        assert!(finds_loss(&lost, || unreachable!(
            "a lost device is not asked"
        )));
    }

    #[test]
    fn a_loss_that_is_told_when_the_device_is_asked_is_found_at_once() {
        let lost = AtomicBool::new(false);
        assert!(finds_loss(&lost, || lost.store(true, Ordering::Relaxed)));
    }
}
