//! The header says what the library does: functions, layouts, enumerators, version.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{Language, compiler, crate_dir, done, scratch};
use core::mem::{align_of, offset_of, size_of};
use foveal_cull_c::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

fn header() -> String {
    std::fs::read_to_string(crate_dir().join("include/foveal_cull.h")).unwrap()
}

/// Without comments, with single spaces.
fn code(text: &str) -> String {
    let mut rest = text;
    let mut code = String::new();
    while let Some((before, after)) = rest.split_once("/*") {
        code.push_str(before);
        rest = after.split_once("*/").unwrap().1;
    }
    code.push_str(rest);
    code.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Code without the functions that the header defines, and those: name and body.
fn without_inline(code: &str) -> (String, BTreeMap<String, String>) {
    let mut parts = code.split("static inline FovealCullStatus ");
    let mut rest = parts.next().unwrap().to_owned();
    let mut inline = BTreeMap::new();
    for part in parts {
        let (function, after) = part.split_once('}').unwrap();
        let (name, body) = function.split_once('(').unwrap();
        inline.insert(name.to_owned(), body.to_owned());
        rest.push_str(after);
    }
    (rest, inline)
}

/// Functions that the library keeps for programs that were compiled with an earlier header. Its
/// successor defines a function of the same name.
const KEPT: [&str; 1] = ["foveal_culler_stats"];

/// The C spelling of a Rust type, with a place for the name.
fn c_type(rust: &str, name: &str) -> String {
    if let Some(to) = rust.strip_prefix("*const ") {
        return format!("const {}", c_type(to, &format!("*{name}")));
    }
    if let Some(to) = rust.strip_prefix("*mut ") {
        return c_type(to, &format!("*{name}"));
    }
    let c = match rust {
        "u8" => "uint8_t",
        "u32" => "uint32_t",
        "u64" => "uint64_t",
        "i32" => "int32_t",
        "usize" => "size_t",
        "f32" => "float",
        "f64" => "double",
        "c_char" => "char",
        "c_void" => "void",
        own => own,
    };
    format!("{c} {name}")
}

/// Prototypes by name, from the Rust sources.
fn functions() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(crate_dir().join("src")).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        for part in text.split("#[unsafe(no_mangle)]").skip(1) {
            let part = part.split_once("extern \"C\" fn ").unwrap().1;
            let part = part.split_once(" {\n").unwrap().0;
            let (name, rest) = part.split_once('(').unwrap();
            let (parameters, result) = rest.rsplit_once(')').unwrap();
            let parameters: Vec<String> = parameters
                .split(',')
                .filter_map(|p| p.trim().split_once(": "))
                .map(|(name, rust)| c_type(rust, name))
                .collect();
            let parameters = match parameters.len() {
                0 => "void".to_owned(),
                _ => parameters.join(", "),
            };
            let result = result.trim().strip_prefix("-> ").map_or("void", str::trim);
            let prototype = c_type(result, &format!("{name}({parameters})"));
            found.insert(name.to_owned(), prototype);
        }
    }
    for kept in KEPT {
        assert!(found.remove(kept).is_some(), "{kept} is gone");
    }
    found
}

#[test]
fn the_header_declares_exactly_the_functions_that_the_library_has() {
    let (code, inline) = without_inline(&code(&header()));
    let functions = functions();
    assert!(functions.len() > 25, "{}", functions.len());
    for prototype in functions.values() {
        assert!(
            code.contains(&format!("{prototype};")),
            "missing: {prototype}"
        );
    }
    // Names that are followed by a bracket are functions.
    let declared: Vec<&str> = code
        .split(|c: char| !(c.is_alphanumeric() || "_(".contains(c)))
        .filter_map(|word| word.split_once('(').map(|(name, _)| name))
        .filter(|name| name.starts_with("foveal_cull"))
        .collect();
    assert_eq!(declared.len(), functions.len(), "{declared:?}");
    assert!(inline.keys().all(|name| !functions.contains_key(name)));
    assert!(declared.iter().all(|name| functions.contains_key(*name)));
}

#[test]
fn structs_are_filled_as_far_as_the_caller_s_header_has_them() {
    let (code, inline) = without_inline(&code(&header()));
    let mut sized = 0;
    for name in functions().keys().filter(|name| name.ends_with("_sized")) {
        let body = &inline[name.strip_suffix("_sized").unwrap()];
        let parameters = code.split_once(&format!("{name}(")).unwrap().1;
        let parameters = parameters.split_once(", size_t size)").unwrap().0;
        let last = parameters.rsplit(", ").next().unwrap();
        let (filled, variable) = last.split_once(" *").unwrap();
        assert!(body.starts_with(&format!("{parameters}) {{")), "{body}");
        assert!(body.contains(&format!("return {name}(")), "{body}");
        assert!(
            body.contains(&format!("{variable}, sizeof({filled}));")),
            "{body}"
        );
        sized += 1;
    }
    assert_eq!((sized, inline.len()), (5, 5));
}

/// Enumerators with their numbers, from the Rust sources.
fn enumerators() -> Vec<(String, i64)> {
    let mut found = Vec::new();
    for (file, name, prefix) in [
        ("status.rs", "FovealCullStatus", "FOVEAL_CULL_"),
        ("culler.rs", "FovealCullVisibility", "FOVEAL_CULL_"),
        ("view.rs", "FovealCullDepth", "FOVEAL_CULL_DEPTH_"),
    ] {
        let text = std::fs::read_to_string(crate_dir().join("src").join(file)).unwrap();
        let body = text.split_once(&format!("pub enum {name} {{")).unwrap().1;
        let body = body.split_once("\n}").unwrap().0;
        for (variant, number) in body.lines().filter_map(|l| l.trim().split_once(" = ")) {
            let mut upper = String::new();
            for c in variant.chars() {
                if c.is_uppercase() && !upper.is_empty() {
                    upper.push('_');
                }
                upper.push(c.to_ascii_uppercase());
            }
            let number = number.trim_end_matches(',').parse().unwrap();
            found.push((format!("{prefix}{upper}"), number));
        }
    }
    found
}

#[test]
fn layouts_enumerators_and_version_of_the_header_are_those_of_the_library() {
    let mut asserts = String::new();
    let mut assert_equal = |c: &str, number: i64| {
        writeln!(
            asserts,
            "typedef char a{}[({c}) == {number} ? 1 : -1];",
            asserts.len()
        )
        .unwrap();
    };
    macro_rules! layout {
        ($type:ident: $($field:ident),*) => {
            let name = stringify!($type);
            assert_equal(&format!("sizeof({name})"), size_of::<$type>() as i64);
            assert!(align_of::<$type>() <= 8);
            let mut all = 0;
            $(
                let offset = offset_of!($type, $field);
                assert_equal(&format!("offsetof({name}, {})", stringify!($field)), offset as i64);
                all += 1;
            )*
            // The header has no field that is not compared.
            let code = code(&header());
            let body = code.split_once(&format!("typedef struct {name} {{")).unwrap().1;
            let body = body.split_once(&format!("}} {name};")).unwrap().0;
            assert_eq!(body.matches(';').count(), all, "{name}");
        };
    }
    layout!(FovealCullOccluderId: set, occluder);
    layout!(FovealCullOccludeeId: set, occludee);
    layout!(FovealCullMeshSource: size, index_bytes, positions, position_count, position_stride,
        indices, index_count, two_sided, adjacency, deformable, inner_shape);
    layout!(FovealCullEye: world_from_eye, left, right, bottom, top, near_m, far_m, orthographic,
        reserved);
    layout!(FovealCullView: size, eye_count, eyes, validity_radius_m);
    layout!(FovealCullFrameOptions: size, occlusion, occluder_size_threshold,
        occluder_pixels_per_quad, occludee_size_threshold, reserved, clock, clock_user, deadline_ns,
        usefulness);
    layout!(FovealCullJobs: size, count, user, run, wake);
    layout!(FovealCullStats: size, reserved, occluder_models, occluder_models_rasterized,
        occluder_triangles, occluder_triangles_rasterized, polygons_rasterized, clusters,
        clusters_rasterized, clusters_over_budget, clusters_not_useful);
    let enumerators = enumerators();
    assert_eq!(enumerators.len(), 16 + 4 + 3);
    let code = code(&header());
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    let named: BTreeSet<&str> = words.filter(|w| w.starts_with("FOVEAL_CULL_")).collect();
    // The rest: the guard of the header and its version.
    assert_eq!(named.len(), enumerators.len() + 2, "{named:?}");
    for (name, number) in &enumerators {
        assert_equal(name, *number);
    }
    assert_equal(
        "sizeof(FovealCullStatus)",
        size_of::<FovealCullStatus>() as i64,
    );
    assert_equal("FOVEAL_CULL_VERSION", foveal_cull_version().into());
    let folder = scratch("layouts");
    let source = folder.join("layouts.c");
    std::fs::write(&source, format!("#include \"foveal_cull.h\"\n{asserts}")).unwrap();
    done(compiler(Language::C).arg("-fsyntax-only").arg(&source));
}

#[test]
fn headers_compile_alone_in_c_and_in_cpp_with_and_without_exceptions() {
    let folder = scratch("alone");
    for (header, language, flags) in [
        ("foveal_cull.h", Language::C, &[][..]),
        ("foveal_cull.h", Language::Cpp, &[]),
        ("foveal_cull.hpp", Language::Cpp, &[]),
        (
            "foveal_cull.hpp",
            Language::Cpp,
            &["-fno-exceptions", "-fno-rtti"],
        ),
        ("moc_shim.hpp", Language::Cpp, &[]),
        (
            "moc_shim.hpp",
            Language::Cpp,
            &["-fno-exceptions", "-fno-rtti"],
        ),
        // The last standard that is named counts: programs for MOC may be as old.
        ("foveal_cull.h", Language::Cpp, &["-std=c++11"]),
        ("moc_shim.hpp", Language::Cpp, &["-std=c++11"]),
    ] {
        let name = if language == Language::C {
            "alone.c"
        } else {
            "alone.cpp"
        };
        let source = folder.join(name);
        std::fs::write(
            &source,
            format!("#include \"{header}\"\n#include \"{header}\"\n"),
        )
        .unwrap();
        done(
            compiler(language)
                .args(flags)
                .arg("-fsyntax-only")
                .arg(&source),
        );
    }
}
