//! `foveal completions` and `foveal man`: the commands as shells and manuals know them, made from
//! the arguments themselves.

use std::path::PathBuf;

use anyhow::Context;
use clap::Command;
use clap_complete::Shell;

use foveal_host::console;

/// Arguments of `foveal completions`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Bash: foveal completions bash > ~/.local/share/bash-completion/completions/foveal\n\
                  Zsh:  foveal completions zsh > ~/.zfunc/_foveal, with ~/.zfunc in fpath\n\
                  Fish: foveal completions fish > ~/.config/fish/completions/foveal.fish"
)]
pub(crate) struct Args {
    /// The shell
    shell: Shell,
}

/// Arguments of `foveal man`.
#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// The folder for foveal.1, foveal-render.1 and so on; made if it is not there
    folder: PathBuf,
}

/// Prints the completions of a command.
pub(crate) fn print(args: &Args, mut command: Command) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "foveal", &mut script);
    console::print_result(&String::from_utf8(script)?)
}

/// Writes the manual's pages of a command.
pub(crate) fn write_pages(args: &ManArgs, command: Command) -> anyhow::Result<()> {
    let folder = args.folder.display();
    std::fs::create_dir_all(&args.folder)
        .with_context(|| format!("cannot make the folder '{folder}'"))?;
    clap_mangen::generate_to(command, &args.folder)
        .with_context(|| format!("cannot write the pages to '{folder}'"))
}
