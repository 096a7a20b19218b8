//! Generated scenes by name, as the command line gives it.

use crate::{DemoOptions, GenerateError};
use foveal_scene::Scene;

/// Generates the scene called `name`: one of [`NAMES`](crate::NAMES), or `demo:N` for about N
/// instances.
///
/// # Errors
/// [`GenerateError::UnknownScene`] for any other name (a caller that also takes file names can try
/// those then); other variants for a size that the scene cannot have.
///
/// ```
/// let scene = foveal_generate::by_name("cornell")?;
/// assert!(scene.triangle_count() < 200);
/// # Ok::<(), foveal_generate::GenerateError>(())
/// ```
pub fn by_name(name: &str) -> Result<Scene, GenerateError> {
    let (base, size) = match name.split_once(':') {
        Some((base, size)) => (base, Some(size)),
        None => (name, None),
    };
    let fixed: fn() -> Scene = match base {
        "demo" => {
            let mut options = DemoOptions::default();
            if let Some(text) = size {
                options.instances = text.parse().map_err(|_| GenerateError::BadSize {
                    name: name.to_owned(),
                    text: text.to_owned(),
                })?;
            }
            return crate::demo(&options);
        }
        "materials" => crate::materials,
        "materials2" => crate::materials2,
        "cornell" => crate::cornell,
        "materials-grid" => crate::materials_grid,
        "alpha" => crate::alpha,
        "lobes" => crate::lobes,
        "yard" => crate::yard,
        _ => {
            return Err(GenerateError::UnknownScene {
                name: name.to_owned(),
            });
        }
    };
    match size {
        None => Ok(fixed()),
        Some(text) => Err(GenerateError::FixedSize {
            name: base.to_owned(),
            text: text.to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::NAMES;

    #[test]
    fn every_name_gives_a_scene() {
        for name in NAMES {
            let scene = by_name(name).unwrap();
            assert!(!scene.instances.is_empty(), "{name}");
            assert!(!scene.cameras.is_empty(), "{name}");
        }
    }

    #[test]
    fn errors_say_what_is_wrong() {
        let message = |name: &str| by_name(name).unwrap_err().to_string();
        assert!(message("castle").contains("'castle'"));
        assert!(message("castle").contains("materials-grid"));
        assert!(message("demo:many").contains("'many'"));
        assert!(message("demo:12").contains("1000 to 100000"));
        assert!(message("cornell:5").contains("':5'"));
    }
}
