//! The table of `foveal cull`: the figures of Intel's occlusion culling sample, for a human.

use std::fmt::Write;

use super::report::{CameraReport, Report};
use foveal_host::console::grouped;
use foveal_host::culling::Check;
use foveal_host::culling::mocrec::Agreement;

/// All cameras, one after the other.
pub(super) fn text(report: &Report) -> String {
    let mut text = format!(
        "{}: depth buffer {}x{}, {}, {}, medians of {}\n",
        report.scene,
        report.width,
        report.height,
        plural(u64::from(report.threads), "thread"),
        report.instruction_set,
        plural(u64::from(report.frames), "frame"),
    );
    if report.eyes_apart_m > 0.0 {
        let _ = writeln!(text, "for two eyes, {} m apart", report.eyes_apart_m);
    }
    if report.validity_radius_m > 0.0 {
        let _ = writeln!(text, "for all places within {} m", report.validity_radius_m);
    }
    for camera in &report.cameras {
        push_camera(&mut text, camera);
    }
    text
}

fn push_camera(text: &mut String, camera: &CameraReport) {
    let _ = writeln!(text, "\ncamera '{}'", foveal_scene::printable(&camera.name));
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:31} {value:>14}");
    };
    let ms = |ms: f64| format!("{ms:.3} ms");
    let f = &camera.figures;
    let o = &f.occluders;
    line("occluder models", grouped(o.models));
    line("  rasterized models", grouped(o.rasterized_models));
    line("  triangles", grouped(o.triangles));
    line("  rasterized triangles", grouped(o.rasterized_triangles));
    line("  rasterize time", ms(o.rasterize_ms));
    if o.clusters_over_budget > 0 {
        let left_out = grouped(o.clusters_over_budget);
        line("  clusters over the time budget", left_out);
    }
    line("  size threshold", o.size_threshold.to_string());
    let o = &f.occludees;
    line("occludee models", grouped(o.models));
    line("  culled", grouped(o.culled));
    line("    outside the frustum", grouped(o.culled_by_frustum));
    line("    too small", grouped(o.culled_by_size));
    line("    occluded", grouped(o.culled_by_occlusion));
    line("  visible", grouped(o.visible));
    line("  triangles", grouped(o.triangles));
    line("  culled triangles", grouped(o.culled_triangles));
    line("  visible triangles", grouped(o.visible_triangles));
    line("  test time", ms(o.test_ms));
    line("  test time by hierarchy", ms(o.tree_test_ms));
    line("  size threshold", o.size_threshold.to_string());
    line("total time", ms(f.occluders.rasterize_ms + o.test_ms));
    line("draw calls", grouped(f.draw_calls.occlusion));
    line("  with the frustum alone", grouped(f.draw_calls.frustum));
    line("  without culling", grouped(f.draw_calls.off));
    if let Some(check) = &camera.check {
        let Check {
            false_occluded,
            false_occluded_4x,
            hidden,
            missed,
            hidden_4x,
            missed_4x,
        } = check;
        line("visible but culled", grouped(*false_occluded));
        line("  at 4x resolution", grouped(*false_occluded_4x));
        line("hidden", grouped(*hidden));
        line("  but kept", grouped(*missed));
        line("hidden at 4x resolution", grouped(*hidden_4x));
        line("  but kept", grouped(*missed_4x));
    }
    if let Some(a) = &camera.recorded {
        push_agreement(&mut line, a);
    }
}

fn push_agreement(line: &mut impl FnMut(&str, String), a: &Agreement) {
    line("recorded queries", grouped(a.queries));
    line("  recorded as visible", grouped(a.recorded_visible));
    line("  recorded as occluded", grouped(a.recorded_occluded));
    line("  recorded as outside", grouped(a.recorded_view_culled));
    line("  equal answers", grouped(a.agree));
    line("  culled there, kept here", grouped(a.kept_here));
    line("  kept there, culled here", grouped(a.culled_here));
}

fn plural(count: u64, what: &str) -> String {
    format!(
        "{} {what}{}",
        grouped(count),
        if count == 1 { "" } else { "s" }
    )
}
