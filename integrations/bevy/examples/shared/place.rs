//! What the examples walk through.

use bevy::prelude::*;

/// Somewhere to walk.
pub trait Place: Send + Sync + 'static {
    /// Spawns everything but a camera.
    fn spawn(&mut self, world: &mut World);

    /// Whether all of it is there; asked after each frame until it is so.
    fn is_ready(&mut self, _world: &mut World) -> bool {
        true
    }

    /// Where a walker is after so many metres, and where they look.
    fn walker(&self, metres: f32) -> Transform;

    /// Metres from begin to end.
    fn length(&self) -> f32;
}
