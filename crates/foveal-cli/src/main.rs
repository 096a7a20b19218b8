//! The `foveal` program: draws scenes, compares pictures, and says what there is to draw and to
//! draw with.
//!
//! Each subcommand has its own module with its arguments and its `run`. What fails comes back here
//! as one error, is printed as one paragraph, and decides the exit code: 0 done, 1 failed, 2 wrong
//! usage.
#![forbid(unsafe_code)]

mod adapters;
mod cli;
mod compare;
mod completions;
mod cull;
mod quiet;
mod render;
mod scene_info;
mod view;

use std::process::ExitCode;

use clap::CommandFactory;
use cli::{Cli, Command, SceneCommand};
use foveal_host::failure;

fn main() -> ExitCode {
    quiet::hush();
    let cli = Cli::read();
    let name = cli.command.name();
    failure::report(name, || match cli.command {
        Command::Render(args) => render::run(&args),
        Command::View(args) => view::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Adapters(args) => adapters::run(&args),
        Command::Scene(SceneCommand::Info(args)) => scene_info::run(&args),
        Command::Cull(args) => cull::run(&args),
        Command::Bench(command) => command.run(),
        Command::Completions(args) => completions::print(&args, Cli::command()),
        Command::Man(args) => completions::write_pages(&args, Cli::command()),
    })
}
