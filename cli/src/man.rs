//! `papilio man`: manual pages of the program and of each command.

use clap::CommandFactory;
use clap_mangen::Man as Page;
use papilio_formats::write_file;

use crate::Failure;
use crate::arguments::{Arguments, Man};
use crate::output::make_folder;

pub(crate) fn run(arguments: &Man) -> Result<(), Failure> {
    make_folder(&arguments.out)?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    write(&program, arguments)
}

/// Writes the page of a command, and those of its own commands.
fn write(command: &clap::Command, arguments: &Man) -> Result<(), Failure> {
    let page = Page::new(command.clone());
    let path = arguments.out.join(page.get_filename());
    write_file(&path, |mut out| page.render(&mut out)).map_err(Failure::Write)?;
    command
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .try_for_each(|command| write(command, arguments))
}
