//! Reports of `foveal bench all` as `foveal bench diff` reads them: an error, or what changed.

use foveal_bench::diff_of_texts;

/// Compares the text with itself and with a good report.
pub fn report(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    for (old, new) in [(&*text, &*text), (REPORT, &*text), (&*text, REPORT)] {
        if let Ok([said, page]) = diff_of_texts(old, new) {
            assert!(said.contains("times compared"), "{said}");
            assert!(
                !page.contains("<script>alert"),
                "markup of a report in a page"
            );
        }
    }
}

const REPORT: &str = r#"{
    "schema": "foveal-report", "schema_version": 2, "scene": "demo", "width": 320, "height": 180,
    "quick": true, "program_version": "0.1.0", "date": "2026-11-01",
    "machine": { "processor": "x", "threads": 2, "system": "linux" },
    "benches": [
        { "name": "baseline", "title": "Baseline", "status": "measured", "seconds": 2.5, "rows": [
            { "label": "a", "ms": 2.0, "ms_spread": [1.9, 2.1], "other_ms": 0.5 },
            { "label": "<script>alert(1)</script>", "ms": 4, "why": "it is" }
        ] },
        { "name": "culling", "status": "skipped", "cause": "not asked for", "rows": [] }
    ]
}"#;

pub(super) fn seeds() -> Vec<Vec<u8>> {
    vec![REPORT.as_bytes().to_vec()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seed_is_a_good_report() {
        let said = diff_of_texts(REPORT, REPORT).map(|[said, _]| said);
        assert!(said.is_ok_and(|said| said.starts_with("3 times compared")));
    }
}
