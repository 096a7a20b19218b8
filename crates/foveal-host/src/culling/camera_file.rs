//! Cameras from a JSON list, as outside programs write them.
//!
//! Each entry is `{eye, target, up, fov_y_deg or ortho_height, aspect, near, far}`; what may be
//! left out and what then holds is in docs/cull-schema.md. Errors name the file, the entry and the
//! key.

use std::path::Path;

use anyhow::{Context, bail};
use foveal_cull::{Eye, Projection};
use glam::DVec3;
use serde_json::{Map, Value};

use super::eye::NamedEye;

const KEYS: [&str; 9] = [
    "name",
    "eye",
    "target",
    "up",
    "fov_y_deg",
    "ortho_height",
    "aspect",
    "near",
    "far",
];

/// What holds where an entry says nothing.
#[derive(Debug, Clone, Copy)]
pub struct Defaults {
    /// Width over height.
    pub aspect: f64,
    /// Metres.
    pub near: f64,
}

/// Reads a file of cameras.
pub fn read(path: &Path, defaults: Defaults) -> anyhow::Result<Vec<NamedEye>> {
    let text = crate::text_file::read(path)
        .with_context(|| format!("cannot read the camera file '{}'", path.display()))?;
    parse(&text, defaults).with_context(|| format!("the camera file '{}' is wrong", path.display()))
}

/// Reads the text of such a file.
///
/// # Errors
/// Names the entry and the key.
pub fn parse(text: &str, defaults: Defaults) -> anyhow::Result<Vec<NamedEye>> {
    let json: Value = serde_json::from_str(text)?;
    let Value::Array(entries) = json else {
        bail!("it must be a list of cameras: [{{…}}, …]");
    };
    if entries.is_empty() {
        bail!("it has no cameras");
    }
    entries
        .iter()
        .enumerate()
        .map(|(number, entry)| {
            camera(entry, number, defaults).with_context(|| format!("camera {number}"))
        })
        .collect()
}

fn camera(entry: &Value, number: usize, defaults: Defaults) -> anyhow::Result<NamedEye> {
    let Value::Object(entry) = entry else {
        bail!("it must be an object: {{\"eye\": …}}");
    };
    if let Some(key) = entry.keys().find(|key| !KEYS.contains(&key.as_str())) {
        bail!(
            "unknown key '{key}'; there are {}",
            KEYS.map(|k| format!("'{k}'")).join(", ")
        );
    }
    let name = match entry.get("name") {
        None | Some(Value::Null) => format!("camera {number}"),
        Some(Value::String(name)) => name.clone(),
        Some(_) => bail!("key 'name': it must be a string"),
    };
    let eye = point(entry, "eye")?.context("key 'eye' is missing")?;
    let target = point(entry, "target")?.context("key 'target' is missing")?;
    let up = point(entry, "up")?.unwrap_or(DVec3::Y);
    if eye == target {
        bail!("key 'target': it is the same point as 'eye'");
    }
    if up == DVec3::ZERO {
        bail!("key 'up': it is [0, 0, 0]");
    }
    let projection = projection(entry, defaults)?;
    Ok(NamedEye {
        name,
        eye: Eye::look_at(eye, target, up, projection),
    })
}

fn projection(entry: &Map<String, Value>, defaults: Defaults) -> anyhow::Result<Projection> {
    let aspect = positive(entry, "aspect")?.unwrap_or(defaults.aspect);
    let far = number(entry, "far")?;
    let fov = number(entry, "fov_y_deg")?;
    if let Some(height) = positive(entry, "ortho_height")? {
        if fov.is_some() {
            bail!("keys 'fov_y_deg' and 'ortho_height' exclude each other");
        }
        let near = number(entry, "near")?.unwrap_or(0.0);
        let far = far.context("key 'far' is missing: an orthographic camera needs it")?;
        if far <= near {
            bail!("key 'far': {far} is not beyond 'near', {near}");
        }
        return Ok(Projection::orthographic(height, aspect, near, far));
    }
    let Some(fov) = fov else {
        bail!("key 'fov_y_deg' or 'ortho_height' is missing");
    };
    if !(fov > 0.0 && fov < 180.0) {
        bail!("key 'fov_y_deg': {fov} does not lie between 0 and 180");
    }
    let near = positive(entry, "near")?.unwrap_or(defaults.near);
    let far = far.unwrap_or(f64::INFINITY);
    if far <= near {
        bail!("key 'far': {far} is not beyond 'near', {near}");
    }
    Ok(Projection::perspective(fov.to_radians(), aspect, near, far))
}

/// A number, `None` where there is none.
fn number(entry: &Map<String, Value>, key: &str) -> anyhow::Result<Option<f64>> {
    match entry.get(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => match value.as_f64() {
            Some(number) if number.is_finite() => Ok(Some(number)),
            _ => bail!("key '{key}': {value} is not a finite number"),
        },
    }
}

fn positive(entry: &Map<String, Value>, key: &str) -> anyhow::Result<Option<f64>> {
    match number(entry, key)? {
        Some(number) if number <= 0.0 => bail!("key '{key}': {number} is not greater than 0"),
        number => Ok(number),
    }
}

fn point(entry: &Map<String, Value>, key: &str) -> anyhow::Result<Option<DVec3>> {
    let coordinates = match entry.get(key) {
        None | Some(Value::Null) => return Ok(None),
        Some(Value::Array(coordinates)) => coordinates,
        Some(_) => bail!("key '{key}': it must be a list of three numbers"),
    };
    let numbers: Option<Vec<f64>> = coordinates
        .iter()
        .map(|c| c.as_f64().filter(|c| c.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Some(DVec3::new(x, y, z))),
        _ => bail!("key '{key}': it must be a list of three finite numbers"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEFAULTS: Defaults = Defaults {
        aspect: 16.0 / 9.0,
        near: 0.05,
    };

    #[test]
    fn both_kinds_of_camera_are_read() {
        let text = r#"[
            {"eye": [0, 1, 5], "target": [0, 1, 0], "fov_y_deg": 90, "aspect": 1, "near": 0.1, "far": 100},
            {"name": "plan", "eye": [0, 9, 0], "target": [0, 0, 0], "up": [0, 0, -1], "ortho_height": 4, "far": 20}
        ]"#;
        let cameras = parse(text, DEFAULTS).unwrap();
        assert_eq!(cameras[0].name, "camera 0");
        assert_eq!(cameras[0].eye.position(), [0.0, 1.0, 5.0]);
        assert_eq!(cameras[0].eye.projection.near_far_m(), [0.1, 100.0]);
        assert_eq!(cameras[1].name, "plan");
        assert!(cameras[1].eye.projection.is_orthographic());
    }

    #[test]
    fn wrong_entries_are_named_by_number_and_key() {
        let good = r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":60}"#;
        for (entry, cause) in [
            (r#"7"#, "object"),
            (r#"{"target":[0,0,0],"fov_y_deg":60}"#, "'eye' is missing"),
            (r#"{"eye":[0,0],"target":[0,0,0],"fov_y_deg":60}"#, "'eye'"),
            (
                r#"{"eye":[0,0,null],"target":[0,0,0],"fov_y_deg":60}"#,
                "'eye'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,1],"fov_y_deg":60}"#,
                "'target'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0]}"#,
                "'fov_y_deg' or 'ortho_height'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":180}"#,
                "'fov_y_deg'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":"x"}"#,
                "'fov_y_deg'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":60,"near":0}"#,
                "'near'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":60,"near":2,"far":1}"#,
                "'far'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"ortho_height":2}"#,
                "'far' is missing",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":60,"zoom":2}"#,
                "'zoom'",
            ),
            (
                r#"{"eye":[0,0,1],"target":[0,0,0],"fov_y_deg":60,"up":[0,0,0]}"#,
                "'up'",
            ),
        ] {
            let text = format!("[{good},{entry}]");
            let error = format!("{:#}", parse(&text, DEFAULTS).unwrap_err());
            assert!(
                error.contains("camera 1") && error.contains(cause),
                "{entry}: {error}"
            );
        }
    }

    #[test]
    fn numbers_beyond_all_bounds_and_words_for_them_are_refused() {
        for number in ["1e999", "NaN", "Infinity", "-1e400"] {
            let text = format!(r#"[{{"eye":[0,0,{number}],"target":[0,0,0],"fov_y_deg":60}}]"#);
            assert!(parse(&text, DEFAULTS).is_err(), "{number}");
        }
    }

    #[test]
    fn the_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("eyes.json");
        for text in [None, Some("{}"), Some("[]"), Some("[{}]"), Some("[")] {
            if let Some(text) = text {
                std::fs::write(&path, text).unwrap();
            }
            let error = format!("{:#}", read(&path, DEFAULTS).unwrap_err());
            assert!(error.contains("eyes.json"), "{error}");
        }
    }
}
