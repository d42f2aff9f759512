//! `papilio man`: manual pages of the program and of each command.

use clap::CommandFactory;
use clap_mangen::Man as Page;
use papilio_formats::write_file;

use crate::arguments::{Arguments, Man};
use crate::output::make_folder;
use crate::{Failure, print_message};

pub(crate) fn run(arguments: &Man) -> Result<(), Failure> {
    make_folder(&arguments.out)?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let count = write(&program, arguments)?;
    let out = arguments.out.display();
    print_message(&format!("wrote {out}: papilio.1 and {} pages of commands", count - 1));
    Ok(())
}

/// Writes the page of a command, and those of its own commands; returns their number.
fn write(command: &clap::Command, arguments: &Man) -> Result<usize, Failure> {
    let page = Page::new(command.clone());
    let path = arguments.out.join(page.get_filename());
    write_file(&path, |mut out| page.render(&mut out))?;
    command
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .try_fold(1, |count, command| Ok(count + write(command, arguments)?))
}
