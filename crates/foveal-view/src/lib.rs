//! A window on the renderer: fly through a scene, switch every setting, see what it costs.
//!
//! [`run`] opens it. The window draws itself on a device of its own and asks a thread for pictures
//! of the scene, so that it answers whatever a frame takes. Panels are made from the table of the
//! settings; files, flags and loading are the [`Host`]'s.
#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a test may stop at once"))]

mod app;
mod boxes;
mod browser;
mod capture;
mod clock;
mod command;
mod graphics;
mod history;
mod host;
mod keys;
mod legend;
mod look;
mod memory;
mod navigator;
mod needs;
mod panels;
mod pick;
mod settled;
mod viewport;
mod window;
mod worker;

pub use host::{
    Files, Format, Host, LightScene, Listing, LoadScene, Loaded, Record, Recording, SceneFlags,
};
pub use keys::help as keys_help;
pub use settled::{Settled, Settler, Sight};

/// Opens the window and returns when it is closed.
///
/// # Errors
/// Where there is no display or no graphics adapter that can draw to it.
pub fn run(host: Host) -> anyhow::Result<()> {
    window::run(host)
}
