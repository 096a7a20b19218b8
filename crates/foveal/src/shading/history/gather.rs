//! The passes that give light to pixels that have no history.

use super::passes::{Frame, HistoryPasses, view};
use super::targets::List;
use crate::recorder::Recorder;

impl HistoryPasses {
    /// Gives pixels without light that of the samples around them. Where none speaks for a pixel, lists
    /// it or its leader to be shaded.
    pub(super) fn gather(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (h, gbuffer) = (frame.history, &frame.targets.gbuffer);
        let gather = frame.group(
            &self.gather,
            "gathering light",
            &[
                view(&frame.rate.owner.whole),
                view(&gbuffer.surface_layers),
                view(&gbuffer.depth_layers),
                frame.light(frame.now),
                view(&h.radiance),
                h.listed.as_entire_binding(),
                h.bare.as_entire_binding(),
                h.samples.as_entire_binding(),
                frame.light(frame.before),
                h.dispatch(List::Bare),
                h.chosen.as_entire_binding(),
                h.wanted_unlit.as_entire_binding(),
            ],
        );
        recorder.encoder.clear_buffer(&h.wanted_unlit, 0, None);
        let mut pass = recorder.compute_pass("composite");
        pass.set_pipeline(&self.gather.pipeline);
        pass.set_bind_group(1, &gather, &[]);
        pass.dispatch_workgroups_indirect(&h.dispatches, List::Bare.offset());
        self.scatter(&mut pass, frame, List::Bare);
        self.size_lists(&mut pass, frame);
    }

    /// Shades the pixels that are listed for that.
    pub(super) fn shade_unlit(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let mut pass = recorder.compute_pass("shading");
        self.shade(&mut pass, frame, List::Unlit);
    }

    /// Gives pixels that are led their leader's light.
    pub(super) fn follow(&self, recorder: &mut Recorder<'_>, frame: &Frame<'_>) {
        let (h, gbuffer) = (frame.history, &frame.targets.gbuffer);
        let follow = frame.group(
            &self.follow,
            "led pixels",
            &[
                view(&gbuffer.surface_layers),
                view(&gbuffer.depth_layers),
                frame.light(frame.now),
                view(&h.radiance),
                h.chosen.as_entire_binding(),
                h.dispatches.as_entire_binding(),
                frame.light(frame.before),
            ],
        );
        let mut pass = recorder.compute_pass("composite");
        pass.set_pipeline(&self.follow.pipeline);
        pass.set_bind_group(1, &follow, &[]);
        pass.dispatch_workgroups_indirect(&h.dispatches, List::Led.offset());
        self.scatter(&mut pass, frame, List::Led);
    }

    /// Puts the light that a list's pixels found where it is kept.
    fn scatter(&self, pass: &mut wgpu::ComputePass<'_>, frame: &Frame<'_>, list: List) {
        let h = frame.history;
        let [of_bare, of_led] = &self.scatter;
        let (by, pixels) = match list {
            List::Led => (of_led, &h.chosen),
            _ => (of_bare, &h.bare),
        };
        let group = frame.group(
            by,
            "gathered light",
            &[
                h.dispatch(list),
                pixels.as_entire_binding(),
                frame.light(frame.before),
                frame.light(frame.now),
            ],
        );
        pass.set_pipeline(&by.pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups_indirect(&h.dispatches, list.offset());
    }
}
