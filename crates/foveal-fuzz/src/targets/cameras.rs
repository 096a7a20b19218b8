//! Camera files and camera paths: an error, or cameras at finite places.

use foveal_host::camera::CameraPath;
use foveal_host::culling::camera_file::{self, Defaults};
use glam::DVec3;

/// Reads the text as both kinds of file.
pub fn cameras(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let defaults = Defaults {
        aspect: 1.5,
        near: 0.05,
    };
    for camera in camera_file::parse(&text, defaults).unwrap_or_default() {
        assert!(DVec3::from(camera.eye.position()).is_finite());
    }
    if let Ok(path) = CameraPath::parse(&text, 60.0) {
        for time_s in [-1.0, 0.0, 2.5, 1e30] {
            let _ = path.at(time_s);
        }
    }
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    [
        r#"[{"eye": [0, 1, 5], "target": [0, 1, 0], "fov_y_deg": 90, "aspect": 1, "near": 0.1, "far": 100}]"#,
        r#"[{"name": "plan", "eye": [0, 9, 0], "target": [0, 0, 0], "up": [0, 0, -1], "ortho_height": 4, "far": 20}]"#,
        r#"[
            {"t": 0, "eye": [-8, 2, 0], "target": [0, 3, 0]},
            {"t": 4, "eye": [6, 2, 1], "target": [12, 4, 0], "fov_y_deg": 45},
            {"t": 6, "eye": [9, 5, 0], "target": [0, 2, 0], "up": [0, 1, 0]}
        ]"#,
    ]
    .map(|text| text.as_bytes().to_vec())
    .into()
}
