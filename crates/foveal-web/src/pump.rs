//! What WebGPU does by itself and WebGL does not: telling that work is done.

use wasm_bindgen::JsCast;
use wasm_bindgen::prelude::Closure;

/// Milliseconds between two looks at the device: what browsers give at best.
const INTERVAL_MS: i32 = 4;

/// Asks a device again and again whether work is done, until it is dropped.
pub(crate) struct Pump {
    number: i32,
    // JavaScript holds on to it.
    _ask: Closure<dyn FnMut()>,
}

impl Pump {
    pub(crate) fn start(device: &wgpu::Device) -> Result<Self, String> {
        let device = device.clone();
        let ask = Closure::<dyn FnMut()>::new(move || {
            // A device that is gone says so to whoever waits.
            let _ = device.poll(wgpu::PollType::Poll);
        });
        let window = web_sys::window().ok_or("there is no window")?;
        let number = window
            .set_interval_with_callback_and_timeout_and_arguments_0(
                ask.as_ref().unchecked_ref(),
                INTERVAL_MS,
            )
            .map_err(|_| "the browser gives no timer")?;
        Ok(Self { number, _ask: ask })
    }
}

impl Drop for Pump {
    fn drop(&mut self) {
        if let Some(window) = web_sys::window() {
            window.clear_interval_with_handle(self.number);
        }
    }
}
