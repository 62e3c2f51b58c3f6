//! The command line: the only place that reads and writes files and talks to the terminal, and the only one that uses
//! `anyhow`. A command that finds something prints the command for the next step, too.

mod advise;
mod answered;
mod args;
mod bench_published;
mod check;
mod columns;
mod command;
mod compare;
mod compare_render;
mod context;
mod diagnose;
mod doctor;
mod exit;
mod explain;
mod imagery;
mod inspect;
mod judge;
mod list;
mod masks;
mod matrix;
mod output;
mod pictures;
mod profile;
mod render;
mod report;
mod scaffold;
mod show;
mod sweep;
mod tasks;
mod terminal;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;
use terminal::Terminal;

/// Runs the command line of this process and returns its exit code.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return exit::of_usage(&error),
    };
    let terminal = match Terminal::new() {
        Ok(terminal) => terminal,
        Err(error) => return exit::of_error(&error),
    };
    let result = match cli.command {
        Command::Check(args) => check::run(&args, &terminal),
        Command::Compare(args) => compare::run(&args),
        Command::Sweep(args) => sweep::run(&args, &terminal),
        Command::Merge(args) => sweep::merge(&args),
        Command::Advise(args) => advise::run(&args, &terminal),
        Command::BenchPublished(args) => bench_published::run(&args, &terminal),
        Command::Render(args) => render::run(&args, &terminal),
        Command::Profile(args) => profile::run(&args, &terminal),
        Command::CompareRender(args) => compare_render::run(&args, &terminal),
        Command::Truth(args) => masks::truth(&args, &terminal),
        Command::Mask(args) => masks::mask(&args, &terminal),
        Command::Judge(args) => judge::run(&args, &terminal),
        Command::Inspect(args) => inspect::run(&args, &terminal),
        Command::Explain(args) => explain::run(&args, &terminal),
        Command::Diagnose(args) => diagnose::run(&args, &terminal),
        Command::Scaffold(args) => scaffold::run(&args),
        Command::List(args) => list::run(&args),
        Command::Doctor => doctor::run(),
    };
    terminal.finish();
    result.map_or_else(|error| exit::of_error(&error), ExitCode::from)
}
