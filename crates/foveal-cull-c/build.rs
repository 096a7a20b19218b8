//! Names the shared library as the dynamic linker looks for it. Below 1.0 a minor version may break
//! its predecessor, so the name has both numbers.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let (major, minor) = (
        variable("CARGO_PKG_VERSION_MAJOR"),
        variable("CARGO_PKG_VERSION_MINOR"),
    );
    let number = if major == "0" {
        format!("0.{minor}")
    } else {
        major
    };
    match variable("CARGO_CFG_TARGET_OS").as_str() {
        "linux" | "android" | "freebsd" => {
            println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libfoveal_cull_c.so.{number}");
        }
        "macos" => {
            println!(
                "cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libfoveal_cull_c.{number}.dylib"
            );
        }
        _ => {}
    }
}
