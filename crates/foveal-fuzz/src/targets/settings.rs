//! Settings: TOML as in files, JSON as from the page. An error that says where, or settings that
//! are checked, and that are the same after they were written.

use foveal::Settings;
use foveal_host::settings;

/// Reads the text as both.
pub fn settings(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    match settings::from_text(&text, "fuzz.toml") {
        Ok(read) => check(&read),
        Err(error) => assert!(error.to_string().contains("fuzz.toml"), "{error}"),
    }
    if let Ok(read) = serde_json::from_str::<Settings>(&text) {
        check(&read);
    }
}

fn check(read: &Settings) {
    if settings::check(read).is_err() {
        return;
    }
    let Ok(text) = toml::to_string(read) else {
        panic!("good settings cannot be written");
    };
    let again = settings::from_text(&text, "again");
    assert!(again.is_ok_and(|again| again == *read), "{text}");
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    let defaults = Settings::default();
    let mut seeds = vec![b"width = 64\nlighting = \"blinn-phong\"\n".to_vec()];
    seeds.extend(toml::to_string(&defaults).map(String::into_bytes));
    seeds.extend(serde_json::to_vec(&defaults));
    seeds
}
