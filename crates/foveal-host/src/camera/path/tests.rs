//! Paths through keys, and files that are wrong.

use super::*;

const PATH: &str = r#"[
    {"t": 0, "eye": [0, 0, 5], "target": [0, 0, 0]},
    {"t": 1, "eye": [1, 0, 5], "target": [0, 0, 0], "fov_y_deg": 40},
    {"t": 3, "eye": [3, 4, 5], "target": [0, 1, 0], "up": [0, 1, 0.1]}
]"#;

#[test]
fn the_path_passes_through_its_keys_and_rests_at_its_ends() {
    let path = CameraPath::parse(PATH, 60.0).unwrap();
    for (time_s, pose) in path.keys.clone() {
        assert_eq!(path.pose(time_s), pose);
    }
    assert_eq!(path.pose(-1.0), path.keys[0].1);
    assert_eq!(path.pose(9.0), path.keys[2].1);
}

#[test]
fn the_path_has_no_corner_at_a_key() {
    let path = CameraPath::parse(PATH, 60.0).unwrap();
    let step = 1e-3;
    let before = (path.pose(1.0).eye - path.pose(1.0 - step).eye) / step;
    let after = (path.pose(1.0 + step).eye - path.pose(1.0).eye) / step;
    assert!((before - after).length() < 0.02, "{before} {after}");
}

#[test]
fn an_even_motion_stays_even() {
    let keys: Vec<String> = [0.0, 0.5, 2.0, 2.25]
        .map(|t| format!(r#"{{"t":{t},"eye":[{t},0,5],"target":[{t},0,0]}}"#))
        .into();
    let path = CameraPath::parse(&format!("[{}]", keys.join(",")), 60.0).unwrap();
    for i in 0..=90 {
        let t = i as f32 * 0.025;
        assert!((path.pose(t).eye.x - t).abs() < 1e-5, "{t}");
    }
}

#[test]
fn without_times_the_keys_are_a_second_apart() {
    let path = CameraPath::parse(
        r#"[{"eye":[0,0,1],"target":[0,0,0]},{"eye":[0,0,2],"target":[0,0,0]}]"#,
        60.0,
    )
    .unwrap();
    assert_eq!(path.pose(1.0).eye.z, 2.0);
}

#[test]
fn wrong_paths_say_where() {
    for (text, cause) in [
        ("[]", "no keyframes"),
        ("[1]", "line 1"),
        (r#"[{"eye":[0,0,1],"target":[0,0,1]}]"#, "keyframe 0"),
        (r#"[{"eye":[0,0,1],"target":[0,0,0],"zoom":2}]"#, "zoom"),
        (r#"[{"eye":[0,0,1e39],"target":[0,0,0]}]"#, ""),
        (
            r#"[{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":180}]"#,
            "fov_y_deg",
        ),
        (
            r#"[{"eye":[0,0,1],"target":[0,0,0],"t":0},{"eye":[0,0,1],"target":[0,0,0]}]"#,
            "all or to none",
        ),
        (
            r#"[{"eye":[0,0,1],"target":[0,0,0],"t":1},{"eye":[0,0,1],"target":[0,0,0],"t":1}]"#,
            "keyframe 1",
        ),
    ] {
        let error = format!("{:#}", CameraPath::parse(text, 60.0).unwrap_err());
        assert!(error.contains(cause), "{text}: {error}");
    }
}
