//! Keeps other libraries from writing to stderr.

/// Without `XDG_RUNTIME_DIR`, the Wayland client library says so on stderr each time a graphics
/// device is looked for. A folder that is not there is enough to keep it quiet. Variables of the
/// own process cannot be set safely once other libraries may read them: the program is replaced by
/// itself.
#[cfg(target_os = "linux")]
pub(crate) fn hush() {
    use std::os::unix::process::CommandExt;
    const NAME: &str = "XDG_RUNTIME_DIR";
    if std::env::var_os(NAME).is_some_and(|folder| !folder.is_empty()) {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        // Comes back only where it fails; then there is a line more on stderr.
        let _ = std::process::Command::new(program)
            .args(std::env::args_os().skip(1))
            .env(NAME, "/nonexistent")
            .exec();
    }
}

/// Elsewhere nobody speaks.
#[cfg(not(target_os = "linux"))]
pub(crate) fn hush() {}
