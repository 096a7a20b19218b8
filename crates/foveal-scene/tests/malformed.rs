//! Broken and odd files give a picture or a clear error: no panic, no hang, and agreement with what
//! the Khronos validator says of each file, as far as that bears on a picture.
//!
//! The files lie beside the repository (`../shared/data/malformed`); without them the test says so
//! and passes.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop at once, and its counts are for reading"
)]

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use foveal_scene::{LoadOptions, Scene, SceneError, load};

/// Validator errors that leave the picture as it is: the file breaks a rule that we do not need, or
/// the rule guards a part that is not read. Each with the reason why we stay silent.
const HARMLESS: &[(&str, &str)] = &[
    ("ACCESSOR_OFFSET_ALIGNMENT", "bytes are read one by one"),
    (
        "ACCESSOR_TOTAL_OFFSET_ALIGNMENT",
        "bytes are read one by one",
    ),
    (
        "MESH_PRIMITIVE_ACCESSOR_UNALIGNED",
        "bytes are read one by one",
    ),
    (
        "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
        "tight packing is assumed",
    ),
    (
        "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE",
        "the stride is followed",
    ),
    (
        "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND",
        "stored bounds are not used",
    ),
    (
        "ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND",
        "stored bounds are not used",
    ),
    ("ACCESSOR_MAX_MISMATCH", "stored bounds are not used"),
    ("ACCESSOR_MIN_MISMATCH", "stored bounds are not used"),
    (
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
        "stored bounds are not used",
    ),
    (
        "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
        "stored bounds are not used",
    ),
    ("EMPTY_ENTITY", "an empty list is a list"),
    (
        "UNDECLARED_EXTENSION",
        "what is there is used or ignored as if declared",
    ),
    ("UNUSED_EXTENSION_REQUIRED", "nothing depends on it"),
    (
        "UNSATISFIED_DEPENDENCY",
        "the part without its dependency is not used",
    ),
    (
        "UNEXPECTED_EXTENSION_OBJECT",
        "an extension in the wrong place is not read",
    ),
    (
        "NON_REQUIRED_EXTENSION",
        "quantized attributes are always understood",
    ),
    ("ONE_OF_MISMATCH", "the kind that `type` names is read"),
    (
        "VALUE_NOT_IN_RANGE",
        "of extensions that are not supported, or a buffer of no bytes",
    ),
    (
        "BUFFER_BYTE_LENGTH_MISMATCH",
        "more bytes than declared are no harm",
    ),
    (
        "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
        "attributes of unknown name are not read",
    ),
    (
        "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR",
        "differences without a base are not read",
    ),
    (
        "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION",
        "rotations are normalized",
    ),
    (
        "ACCESSOR_WEIGHTS_NEGATIVE",
        "weights are clamped and normalized",
    ),
    (
        "ACCESSOR_WEIGHTS_NON_NORMALIZED",
        "weights are clamped and normalized",
    ),
    ("ACCESSOR_JOINTS_INDEX_DUPLICATE", "their weights add up"),
    ("ACCESSOR_INVALID_IBM", "the matrix is used as it is"),
    (
        "NODE_SKIN_NO_SCENE",
        "joints outside the scene still have a transform",
    ),
];

/// Files that the validator lets pass and we refuse, each with the reason.
const REFUSED: &[(&str, &str)] = &[(
    "asset/min_version_valid.gltf",
    "it says that glTF 2.1 is needed to understand it, and we know 2.0",
)];

/// What is known of one file.
struct Expected {
    file: String,
    /// `None` where no validator has seen it.
    errors: Option<u32>,
    codes: Vec<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/malformed")
}

fn read_expected(folder: &Path) -> Option<Vec<Expected>> {
    let text = std::fs::read_to_string(folder.join("EXPECTED.tsv")).ok()?;
    let row = |line: &str| {
        let columns: Vec<&str> = line.split('\t').collect();
        Expected {
            file: columns[0].to_owned(),
            errors: columns[1].parse().ok(),
            codes: columns[3]
                .split(',')
                .filter(|c| !c.is_empty())
                .map(str::to_owned)
                .collect(),
        }
    };
    Some(text.lines().skip(1).map(row).collect())
}

/// Loads on a thread of its own; the error is a fault of the importer.
fn load_within(path: PathBuf, limit: Duration) -> Result<Result<Scene, SceneError>, String> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut outcome = load(&path, &LoadOptions::default());
        if let Ok(scene) = &mut outcome {
            // What loads must also move.
            for time_s in [0.0, 0.37, 1e9, -1.0, f32::NAN] {
                scene.pose(time_s);
            }
        }
        let _ = sender.send(outcome);
    });
    match receiver.recv_timeout(limit) {
        Ok(Err(SceneError::Internal { cause, .. })) => Err(format!("internal fault: {cause}")),
        Ok(outcome) => Ok(outcome),
        Err(mpsc::RecvTimeoutError::Timeout) => Err("still busy after the time limit".to_owned()),
        Err(mpsc::RecvTimeoutError::Disconnected) => Err("panicked".to_owned()),
    }
}

/// Why an outcome contradicts what is known of the file.
fn contradiction(expected: &Expected, outcome: &Result<Scene, SceneError>) -> Option<String> {
    match (expected.errors?, outcome) {
        (0, Err(error))
            if REFUSED
                .iter()
                .any(|(file, _)| expected.file.ends_with(file)) =>
        {
            println!("         ^ refused on purpose: {error}");
            None
        }
        (0, Err(error)) => Some(format!("a valid file is refused: {error}")),
        (0, Ok(_)) | (_, Err(_)) => None,
        // Nothing is shown, which a warning says; what is wrong with parts that nobody sees is not
        // judged.
        (_, Ok(scene)) if scene.objects.is_empty() => None,
        (_, Ok(scene)) => {
            let harmless = |code: &String| HARMLESS.iter().any(|(known, _)| known == code);
            let silent = scene.warnings.is_empty();
            let serious: Vec<_> = expected.codes.iter().filter(|c| !harmless(c)).collect();
            (silent && !serious.is_empty()).then(|| format!("nothing is said about {serious:?}"))
        }
    }
}

#[test]
fn broken_files_give_a_picture_or_a_clear_error() {
    let folder = folder();
    let Some(expected) = read_expected(&folder) else {
        println!("skipped: {} is not there", folder.display());
        return;
    };
    let (mut clean, mut warned, mut refused) = (0, 0, 0);
    let mut faults = Vec::new();
    for one in &expected {
        let outcome = match load_within(folder.join(&one.file), Duration::from_secs(5)) {
            Ok(outcome) => outcome,
            Err(fault) => {
                faults.push(format!("{}: {fault}", one.file));
                continue;
            }
        };
        match &outcome {
            Ok(scene) if scene.warnings.is_empty() => {
                clean += 1;
                println!("ok       {}", one.file);
            }
            Ok(scene) => {
                warned += 1;
                println!("warning  {}: {}", one.file, scene.warnings[0]);
            }
            Err(error) => {
                refused += 1;
                println!("error    {error}");
                let text = error.to_string();
                if !text.contains(one.file.rsplit('/').next().unwrap()) || text.contains('\n') {
                    faults.push(format!("{}: the message is not clear: {text}", one.file));
                }
            }
        }
        if let Some(fault) = contradiction(one, &outcome) {
            faults.push(format!("{}: {fault}", one.file));
        }
    }
    println!(
        "{} files: {clean} ok, {warned} ok with warnings, {refused} errors",
        expected.len()
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
