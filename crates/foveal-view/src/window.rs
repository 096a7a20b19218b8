//! The operating system's window: events in, the interface's triangles out.

use std::sync::Arc;

use anyhow::{Context, anyhow};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use pollster::block_on;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::Host;
use crate::app::App;

/// There is news from the drawing thread.
#[derive(Debug)]
struct Wake;

pub(crate) fn run(host: Host) -> anyhow::Result<()> {
    let event_loop = EventLoop::<Wake>::with_user_event()
        .build()
        .context("cannot open a window: there is no display")?;
    let mut handler = Handler {
        proxy: event_loop.create_proxy(),
        host: Some(host),
        open: None,
        failure: None,
    };
    event_loop
        .run_app(&mut handler)
        .context("the window's event loop failed")?;
    match handler.failure {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

struct Handler {
    proxy: EventLoopProxy<Wake>,
    /// Until the window is open.
    host: Option<Host>,
    open: Option<Open>,
    failure: Option<anyhow::Error>,
}

/// The open window.
struct Open {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    painter: egui_wgpu::Renderer,
    input: egui_winit::State,
    app: App,
}

impl ApplicationHandler<Wake> for Handler {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let Some(host) = self.host.take() else { return };
        match Open::new(event_loop, host, self.proxy.clone()) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => {
                self.failure = Some(error);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: Wake) {
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.input.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested => {
                self.open = None;
                event_loop.exit();
                return;
            }
            WindowEvent::Resized(size) => open.resize(size),
            WindowEvent::DroppedFile(path) => open.app.open_scene(path.display().to_string()),
            WindowEvent::RedrawRequested => match open.redraw() {
                Ok(after) if after.is_zero() => open.window.request_redraw(),
                Ok(after) => match std::time::Instant::now().checked_add(after) {
                    Some(at) => event_loop.set_control_flow(ControlFlow::WaitUntil(at)),
                    None => event_loop.set_control_flow(ControlFlow::Wait),
                },
                Err(error) => {
                    self.failure = Some(error);
                    event_loop.exit();
                    return;
                }
            },
            _ => {}
        }
        if response.repaint {
            open.window.request_redraw();
        }
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: winit::event::StartCause) {
        if let winit::event::StartCause::ResumeTimeReached { .. } = cause {
            event_loop.set_control_flow(ControlFlow::Wait);
            if let Some(open) = &self.open {
                open.window.request_redraw();
            }
        }
    }
}

impl Open {
    fn new(
        event_loop: &ActiveEventLoop,
        host: Host,
        proxy: EventLoopProxy<Wake>,
    ) -> anyhow::Result<Self> {
        let (width, height) = host.window;
        let attributes = Window::default_attributes()
            .with_title("Foveal")
            .with_inner_size(PhysicalSize::new(width, height))
            .with_min_inner_size(PhysicalSize::new(960, 600));
        let window = Arc::new(
            event_loop
                .create_window(attributes)
                .context("cannot open a window")?,
        );
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(Arc::clone(&window))?;
        let adapter = block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .context("no graphics adapter can draw to the window")?;
        let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("window"),
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
                ..wgpu::Limits::downlevel_defaults()
            },
            ..Default::default()
        }))?;
        let size = window.inner_size();
        let mut configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
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
        let context = egui::Context::default();
        crate::look::apply(&context);
        let input = egui_winit::State::new(
            context.clone(),
            egui::ViewportId::ROOT,
            &window,
            None,
            None,
            Some(device.limits().max_texture_dimension_2d as usize),
        );
        let wake = move || {
            let _ = proxy.send_event(Wake);
        };
        let app = App::new(host, wake).context("cannot start a thread")?;
        Ok(Self {
            window,
            surface,
            configuration,
            device,
            queue,
            painter,
            input,
            app,
        })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width > 0 && size.height > 0 {
            (self.configuration.width, self.configuration.height) = (size.width, size.height);
            self.surface.configure(&self.device, &self.configuration);
            self.window.request_redraw();
        }
    }

    /// Draws the interface; says after what time to do so again.
    fn redraw(&mut self) -> anyhow::Result<std::time::Duration> {
        let input = self.input.take_egui_input(&self.window);
        let context = self.input.egui_ctx().clone();
        let app = &mut self.app;
        let mut output = context.run_ui(input, |ui| app.show(ui));
        self.input
            .handle_platform_output(&self.window, output.platform_output);
        let wanted = if self.app.display.vsync {
            wgpu::PresentMode::AutoVsync
        } else {
            wgpu::PresentMode::AutoNoVsync
        };
        if self.configuration.present_mode != wanted {
            self.configuration.present_mode = wanted;
            self.surface.configure(&self.device, &self.configuration);
        }
        let triangles = context.tessellate(output.shapes, output.pixels_per_point);
        let changed = std::mem::take(&mut output.textures_delta.set);
        let freed = std::mem::take(&mut output.textures_delta.free);
        for (id, deltas) in &changed {
            for delta in deltas {
                self.painter
                    .update_texture(&self.device, &self.queue, *id, delta);
            }
        }
        self.paint(&triangles, output.pixels_per_point)?;
        for id in &freed {
            self.painter.free_texture(id);
        }
        Ok(output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(std::time::Duration::MAX, |viewport| viewport.repaint_delay))
    }

    fn paint(
        &mut self,
        triangles: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
    ) -> anyhow::Result<()> {
        use wgpu::CurrentSurfaceTexture as Current;
        let frame = match self.surface.get_current_texture() {
            Current::Success(frame) | Current::Suboptimal(frame) => frame,
            Current::Outdated | Current::Lost => {
                self.surface.configure(&self.device, &self.configuration);
                self.window.request_redraw();
                return Ok(());
            }
            // Hidden, or a frame too many: the next event tries again.
            _ => return Ok(()),
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
        self.window.pre_present_notify();
        self.queue.present(frame);
        Ok(())
    }
}
