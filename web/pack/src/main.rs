//! `pack WASM FOLDER`: makes the JavaScript module that loads the WebAssembly, and the WebAssembly
//! that it loads.

use std::path::PathBuf;

use anyhow::{Context, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [wasm, folder] = arguments.as_slice() else {
        bail!("usage: pack WASM FOLDER");
    };
    Bindgen::new()
        .input_path(wasm)
        .web(true)?
        .omit_default_module_path(false)
        .typescript(false)
        .generate(folder)
        .with_context(|| format!("packing {} into {}", wasm.display(), folder.display()))
}
