//! The operating system's window: events in, the interface's triangles out.

use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, anyhow};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::Host;
use crate::app::App;
use crate::graphics::Graphics;

/// There is news from the drawing thread.
#[derive(Debug)]
struct Wake;

pub(crate) fn run(host: Host) -> anyhow::Result<()> {
    let event_loop = EventLoop::<Wake>::with_user_event()
        .build()
        .map_err(|error| what_it_said(&error))
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
    // Before the window that it draws to.
    graphics: Option<Graphics>,
    window: Arc<Window>,
    proxy: EventLoopProxy<Wake>,
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
        // A redraw says itself when the next one is due: for it the answer is always yes, and the
        // window would be drawn without end.
        if response.repaint && !matches!(event, WindowEvent::RedrawRequested) {
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
            .with_min_inner_size(LogicalSize::new(960.0, 540.0));
        let window = Arc::new(
            event_loop
                .create_window(attributes)
                .map_err(|error| what_it_said(&error))
                .context("cannot open a window")?,
        );
        let graphics = Graphics::new(&window, waker(&proxy))?;
        let context = egui::Context::default();
        let input = input(context, &window, &graphics);
        let app = App::new(host, waker(&proxy)).context("cannot start a thread")?;
        Ok(Self {
            graphics: Some(graphics),
            window,
            proxy,
            input,
            app,
        })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if size.width > 0 && size.height > 0 {
            if let Some(graphics) = &mut self.graphics {
                graphics.resize(size);
            }
            self.window.request_redraw();
        }
    }

    /// Opens a new device if the last was lost, and has the interface's textures made again.
    fn recover(&mut self) -> anyhow::Result<()> {
        if self.graphics.as_ref().is_some_and(Graphics::is_lost) {
            self.graphics = None;
            self.app
                .complain("The window's graphics device was lost; this is a new one");
        }
        if self.graphics.is_none() {
            let graphics = Graphics::new(&self.window, waker(&self.proxy))
                .context("the window's graphics device was lost")?;
            let context = egui::Context::default();
            let memory = self.input.egui_ctx().memory(Clone::clone);
            context.memory_mut(|fresh| *fresh = memory);
            self.app.move_to(&context, self.input.egui_ctx());
            self.input = input(context, &self.window, &graphics);
            self.graphics = Some(graphics);
        }
        Ok(())
    }

    /// Draws the interface; says after what time to do so again.
    fn redraw(&mut self) -> anyhow::Result<Duration> {
        self.recover()?;
        let Some(graphics) = &mut self.graphics else {
            return Ok(Duration::MAX);
        };
        graphics.set_vsync(self.app.display.vsync);
        let input = self.input.take_egui_input(&self.window);
        let context = self.input.egui_ctx().clone();
        let app = &mut self.app;
        let output = context.run_ui(input, |ui| app.show(ui));
        self.input
            .handle_platform_output(&self.window, output.platform_output);
        let triangles = context.tessellate(output.shapes, output.pixels_per_point);
        let is_shown = graphics.show(
            &self.window,
            &triangles,
            output.textures_delta,
            output.pixels_per_point,
        );
        if std::mem::take(&mut self.app.loses_devices) {
            graphics.lose();
        }
        if !is_shown || graphics.is_lost() {
            return Ok(Duration::ZERO);
        }
        Ok(output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay))
    }
}

/// An error of winit's without the place in its source that it begins with.
fn what_it_said(error: &impl std::fmt::Display) -> anyhow::Error {
    let text = error.to_string();
    let place_and_cause = text.split_once(".rs:");
    let cause = place_and_cause.and_then(|(_, line)| line.split_once(": "));
    anyhow!("{}", cause.map_or(text.as_str(), |(_, cause)| cause))
}

/// Has the window drawn again, from any thread.
fn waker(proxy: &EventLoopProxy<Wake>) -> impl Fn() + Send + Sync + 'static {
    let proxy = proxy.clone();
    move || {
        let _ = proxy.send_event(Wake);
    }
}

/// The interface's ears, with its look put on.
fn input(context: egui::Context, window: &Window, graphics: &Graphics) -> egui_winit::State {
    crate::look::apply(&context);
    let largest = Some(graphics.largest_texture());
    egui_winit::State::new(context, egui::ViewportId::ROOT, window, None, None, largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_no_place_in_the_source_of_winit() {
        let said = |text: &str| what_it_said(&text).to_string();
        assert_eq!(
            said("os error at /home/eva/winit/src/linux/mod.rs:788: no X server: refused"),
            "no X server: refused"
        );
        assert_eq!(said("Exit Failure: 1"), "Exit Failure: 1");
    }
}
