//! A part of a G-buffer that a frame is drawn to.

/// A part of a G-buffer, and where the frame lies relative to it; all in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Left, top, width, height of the whole frame; it may reach beyond the G-buffer, and fractions
    /// of a texel move the sample positions.
    pub(crate) frame: [f32; 4],
    /// Left, top, width, height of what is drawn.
    pub(crate) part: [u32; 4],
}

impl Window {
    /// The whole of a target of this size.
    pub(crate) fn sized(width: u32, height: u32) -> Self {
        Self {
            frame: [0.0, 0.0, width as f32, height as f32],
            part: [0, 0, width, height],
        }
    }

    /// Restricts a pass to it.
    pub(crate) fn set(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Self { frame, part } = self;
        pass.set_viewport(frame[0], frame[1], frame[2], frame[3], 0.0, 1.0);
        pass.set_scissor_rect(part[0], part[1], part[2], part[3]);
    }
}
