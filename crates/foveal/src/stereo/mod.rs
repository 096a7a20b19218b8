//! Two eyes: where they stand and what they see, where each has its picture in the targets, how
//! their geometry is submitted, and the lens before them.
//!
//! Both eyes look the same way and stand side by side, an IPD apart; what differs is their frustum.
//! Targets hold the left eye's picture and, from a stride on, the right one's, so that every
//! deferred stage visits both in one draw or dispatch (`shared/frame.wgsl`, `view_of`).

mod choose;
mod eyes;
mod layout;
mod lens;
mod shown;
mod submission;
#[cfg(test)]
mod tests;
mod trial;

pub(crate) use eyes::{Eye, cluster_shifts, eyes};
pub(crate) use layout::EyeLayout;
pub(crate) use lens::{LensFit, check_lens};
pub use shown::ShownEyes;
pub(crate) use submission::{Drawn, Submission};
pub(crate) use trial::Trials;
