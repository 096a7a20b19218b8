//! Changed camera paths and settings files: an error or a value, never a panic.

use foveal::Settings;

use super::camera_path::CameraPath;
use super::settings;
use crate::mutate::{self, mutate};

#[test]
fn fuzz_camera_paths() {
    let seeds = [br#"[
        {"t": 0, "eye": [-8, 2, 0], "target": [0, 3, 0]},
        {"t": 4, "eye": [6, 2, 1], "target": [12, 4, 0], "fov_y_deg": 45},
        {"t": 6, "eye": [9, 5, 0], "target": [0, 2, 0], "up": [0, 1, 0]}
    ]"#
    .to_vec()];
    mutate::run("camera paths", &seeds, mutate, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        if let Ok(path) = CameraPath::parse(&text, 60.0) {
            for time_s in [-1.0, 0.0, 2.5, 1e30] {
                let _ = path.at(time_s);
            }
        }
    });
}

#[test]
fn fuzz_settings() {
    let all = toml::to_string(&Settings::default()).unwrap();
    let seeds = [
        all.into_bytes(),
        b"width = 64\nlighting = \"blinn-phong\"\n".to_vec(),
    ];
    mutate::run("settings", &seeds, mutate, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        match settings::parse(&text) {
            Ok(settings) => drop(settings::check(&settings)),
            Err(error) => {
                let start = error.span().map_or(0, |span| span.start);
                assert!(settings::place(&text, start).contains("line"));
            }
        }
    });
}
