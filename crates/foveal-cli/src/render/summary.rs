//! The few lines for a human after the work is done.

use std::fmt::Write;

use foveal::Timing;

use super::stats::RunStats;
use foveal_host::console::grouped;

/// What was drawn, with what, how long it took, and where it is; other jobs drew so many frames
/// meanwhile.
pub(super) fn text(run: &RunStats, by_others: u64) -> String {
    let mut text = String::new();
    let counts = &run.scene.counts;
    let _ = writeln!(
        text,
        "{}: {} objects, {} triangles, {} lights; {} ({})",
        run.scene.name,
        grouped(counts.objects),
        grouped(counts.triangles),
        grouped(counts.lights),
        run.adapter.name,
        run.adapter.backend,
    );
    let _ = writeln!(
        text,
        "first picture after {}: {}",
        ms(run.first_picture_ms),
        stages(&run.load_ms)
    );
    let median = &run.median;
    let _ = write!(text, "frame {}", ms(median.frame_ms));
    if !median.gpu_ms.is_empty() {
        let _ = write!(text, " (GPU: {})", stages(&median.gpu_ms));
    }
    let _ = writeln!(
        text,
        ": {} objects seen, {} outside, {} hidden; {} draws, {} triangles, {} samples shaded",
        grouped(median.objects_visible as u64),
        grouped(median.objects_outside as u64),
        grouped(median.objects_occluded as u64),
        grouped(median.draws as u64),
        grouped(median.triangles as u64),
        grouped(median.shaded_samples as u64),
    );
    let rest = not_drawn(run.skipped_frames, by_others);
    let [first, .., last] = &run.frames[..] else {
        let _ = match run.frames.first().map(|frame| frame.file.as_str()) {
            Some("-") => writeln!(text, "wrote the picture to standard output"),
            Some(file) => writeln!(text, "wrote {file}{rest}"),
            None => writeln!(text, "wrote nothing"),
        };
        return text;
    };
    let _ = write!(text, "wrote {} frames", run.frames.len());
    let _ = if first.file == last.file {
        write!(text, " into {}", first.file)
    } else {
        write!(text, ", {} to {}", first.file, last.file)
    };
    let _ = writeln!(text, "{rest}; figures above are medians");
    text
}

/// The frames that this job did not draw.
pub(super) fn not_drawn(there: u64, by_others: u64) -> String {
    let mut text = String::new();
    if there > 0 {
        let _ = write!(text, "; {there} were there already");
    }
    if by_others > 0 {
        let _ = write!(text, "; other jobs drew {by_others}");
    }
    text
}

/// Stages that most frames have.
fn stages(timings: &[Timing]) -> String {
    let stages: Vec<String> = timings
        .iter()
        .filter(|t| t.ms > 0.0)
        .map(|t| format!("{} {}", t.name.replace('_', " "), ms(t.ms)))
        .collect();
    stages.join(", ")
}

/// Milliseconds with three significant digits, seconds from ten on.
fn ms(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.2} ms"),
        ms if ms < 100.0 => format!("{ms:.1} ms"),
        ms if ms < 10_000.0 => format!("{ms:.0} ms"),
        ms => format!("{:.1} s", ms / 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_were_there_and_those_of_other_jobs_are_told_apart() {
        assert_eq!(not_drawn(0, 0), "");
        assert_eq!(not_drawn(2, 0), "; 2 were there already");
        assert_eq!(not_drawn(2, 3), "; 2 were there already; other jobs drew 3");
    }

    #[test]
    fn numbers_are_readable() {
        assert_eq!(
            [0.123, 56.78, 999.6, 12_345.0].map(ms),
            ["0.12 ms", "56.8 ms", "1000 ms", "12.3 s"]
        );
    }
}
