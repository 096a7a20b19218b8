//! The result of a query.

/// The classification of one box.
///
/// Results are conservative: [`Visible`](Self::Visible) means "may be seen", and every other value but
/// [`Small`](Self::Small) means that no sample of the picture shows the box. The enum is exhaustive on purpose: a renderer
/// decides about every class, and a new class is a new major version.
/// [`is_visible`](Self::is_visible) is all that drawing needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Visibility {
    /// The box may be seen: draw it. Also for boxes that are not volumes, and after a frame that
    /// failed.
    Visible = 0,
    /// The box is outside the view frustum: beside it, beyond the far plane, or nearer than the
    /// near plane.
    Outside = 1,
    /// The box is below the size threshold of [`FrameOptions`](crate::FrameOptions), seen or not.
    Small = 2,
    /// The box is hidden behind occluders.
    Occluded = 3,
}

impl Visibility {
    /// Whether the box must be drawn.
    #[must_use]
    pub fn is_visible(self) -> bool {
        self == Self::Visible
    }
}
