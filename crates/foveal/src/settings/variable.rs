//! Choices about the geometry pass and about shading at a rate that the picture's content decides.

use serde::{Deserialize, Serialize};

/// How the G-buffer is filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Geometry {
    /// By the rasterizer: materials are evaluated for every fragment that passes the depth test.
    #[default]
    Gbuffer,
    /// By a visibility buffer: the rasterizer finds the triangle at each pixel, and materials are evaluated once per
    /// pixel afterwards.
    Visibility,
}
