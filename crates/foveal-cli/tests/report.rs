//! `foveal bench all` and `foveal bench diff`, from the command to the page in a browser. Needs a
//! graphics adapter.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]
#![allow(clippy::print_stdout, reason = "a test says what it skipped")]

mod common;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

use common::{fail, folder, stdout, succeed};
use serde_json::Value;

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn bench<'r>(report: &'r Value, name: &str) -> &'r Value {
    let benches = report["benches"].as_array().unwrap();
    benches.iter().find(|b| b["name"] == name).unwrap()
}

#[test]
fn a_report_has_figures_pictures_and_what_was_left_out() {
    let folder = folder();
    let words = [
        "bench",
        "all",
        "cornell",
        "--quick",
        "--size",
        "96x64",
        "--only",
        "verdict,baseline,antialiasing",
        "--report",
        "r",
        "--markdown",
        "tables",
        "--of",
        "commit abc1234",
    ];
    succeed(folder.path(), &words);
    let at = folder.path().join("r");
    let tables = folder.path().join("tables");
    let index = fs::read_to_string(tables.join("README.md")).unwrap();
    assert!(index.contains("[Baseline](baseline.md)") && index.contains("commit abc1234"));
    assert!(tables.join("antialiasing.md").exists() && !tables.join("culling.md").exists());
    let report = json(&at.join("report.json"));
    assert_eq!(bench(&report, "culling")["status"], "skipped");
    for name in ["baseline", "antialiasing"] {
        let bench = bench(&report, name);
        assert_eq!(bench["status"], "measured", "{bench}");
        assert!(bench["rows"].as_array().unwrap().len() > 3, "{name}");
        let command = bench["commands"][0].as_str().unwrap();
        assert!(command.starts_with("foveal "), "{command}");
    }
    // The first page decides about each candidate, and says why.
    for row in bench(&report, "verdict")["rows"].as_array().unwrap() {
        let decision = row["decision"].as_str().unwrap();
        assert!(
            [
                "adopt",
                "faster-but-visible",
                "skip",
                "better-as-fast",
                "better-but-slower",
                "impossible"
            ]
            .contains(&decision)
        );
        assert!(!row["why"].as_str().unwrap().is_empty(), "{row}");
        assert_eq!(row["pairs"], 40, "{row}");
    }
    let modes = bench(&report, "antialiasing")["rows"].as_array().unwrap();
    let label = |row: &Value| row["label"].as_str().unwrap().to_owned();
    let labels: std::collections::HashSet<_> = modes.iter().map(label).collect();
    assert_eq!(labels.len(), modes.len(), "{labels:?}");
    let csv = fs::read_to_string(at.join("report.csv")).unwrap();
    assert!(csv.contains("culling,,skipped,not asked for"), "{csv}");
    let page = fs::read_to_string(at.join("report.html")).unwrap();
    assert!(page.contains("data:image/jpeg;base64,"));
    assert!(
        !page.contains("http:") && !page.contains("https:"),
        "no network"
    );
    opens_in_chromium(&at.join("report.html"));

    // Against itself nothing is slower.
    let words = ["bench", "diff", "r/report.json", "r/report.json", "--fail"];
    let said = stdout(&succeed(folder.path(), &words));
    assert!(said.contains("0 slower, 0 faster"), "{said}");
    // A report in which all takes twice as long.
    let mut slower = report.clone();
    for row in slower["benches"][1]["rows"].as_array_mut().unwrap() {
        let ms = row["ms"].as_f64().unwrap();
        row["ms"] = (3.0 * ms).into();
        row["spread"] = serde_json::json!({ "ms": [3.0 * ms, 3.0 * ms] });
    }
    fs::write(at.join("slower.json"), slower.to_string()).unwrap();
    fail(
        folder.path(),
        &[
            "bench",
            "diff",
            "r/report.json",
            "r/slower.json",
            "--fail",
            "--page",
            "diff.html",
        ],
        &["became slower"],
    );
    // The page shows the same, the old time by the new one.
    let page = fs::read_to_string(folder.path().join("diff.html")).unwrap();
    assert!(page.contains("<td>0.33</td><td class=\"slower\">slower</td>"));
    assert!(!page.contains("class=\"faster\""), "nothing became faster");
}

#[test]
fn a_run_that_is_stopped_leaves_what_it_has_measured() {
    let folder = folder();
    let words = [
        "bench",
        "all",
        "cornell",
        "--quick",
        "--size",
        "96x64",
        "--only",
        "baseline,antialiasing",
        "--report",
        "r",
        "--quiet",
    ];
    let mut run = common::spawn_in(folder.path(), &words);
    let at = folder.path().join("r");
    let page = at.join("report.html");
    while !page.exists() && run.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(10));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    let report = json(&at.join("report.json"));
    assert_eq!(bench(&report, "baseline")["status"], "measured");
    let waiting = bench(&report, "antialiasing");
    assert_eq!(
        (&waiting["status"], &waiting["cause"]),
        (&"skipped".into(), &"not yet run".into())
    );
    assert!(
        fs::read_to_string(page)
            .unwrap()
            .contains("skipped: not yet run")
    );
}

#[test]
fn what_is_no_report_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("a.json"), "{}").unwrap();
    fail(
        folder.path(),
        &["bench", "diff", "a.json", "a.json"],
        &["a.json", "no report"],
    );
    let output = common::foveal_in(
        folder.path(),
        &["bench", "all", "--only", "sideways", "--report", "r"],
    );
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_bench_that_fails_is_in_the_report() {
    let folder = folder();
    let words = [
        "bench", "all", "cornell", "--quick", "--size", "99999x4", "--only", "baseline",
        "--report", "r",
    ];
    fail(folder.path(), &words, &["baseline", "99999"]);
    let at = folder.path().join("r");
    let report = json(&at.join("report.json"));
    assert_eq!(bench(&report, "baseline")["status"], "failed");
    let page = fs::read_to_string(at.join("report.html")).unwrap();
    assert!(page.contains("failed: "), "the page says so");
}

#[test]
fn a_report_of_a_scene_that_is_not_there_takes_no_others_place() {
    let folder = folder();
    let at = folder.path().join("r");
    fs::create_dir(&at).unwrap();
    fs::write(at.join("report.json"), "an earlier one").unwrap();
    let words = ["bench", "all", "missing.glb", "--quick", "--report", "r"];
    fail(folder.path(), &words, &["missing.glb", "cornell"]);
    assert_eq!(common::names(&at), ["report.json"]);
    assert_eq!(
        fs::read_to_string(at.join("report.json")).unwrap(),
        "an earlier one"
    );
}

#[test]
fn tables_that_cannot_be_written_are_named_before_anything_is_measured() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("tables/culling.md")).unwrap();
    let words = [
        "bench",
        "all",
        "cornell",
        "--quick",
        "--report",
        "r",
        "--markdown",
        "tables",
    ];
    fail(folder.path(), &words, &["culling.md"]);
    assert!(common::names(&folder.path().join("r")).is_empty());
}

/// Loads the page in a browser: its script has run, and the console holds no error.
fn opens_in_chromium(page: &Path) {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let version = |name: &&&str| Command::new(name).arg("--version").output().is_ok();
    let Some(browser) = names.iter().find(version) else {
        println!("skipped: there is no Chromium to open the page with");
        return;
    };
    let profile = folder();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-dev-shm-usage",
            "--enable-logging=stderr",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let (dom, said) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(dom.contains("data-ready=\"yes\""), "the script ran: {said}");
    assert!(dom.contains("Anti-aliasing in compute"));
    assert!(!said.contains(":CONSOLE"), "{said}");
}
