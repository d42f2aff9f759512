//! `papilio schema`: JSON Schemas of scenarios and results.

use std::io::Write;

use clap::{Arg, ArgAction, ArgGroup, ArgMatches};

use crate::{Failure, RESULTS};

/// The file whose schema is printed; none for a scenario.
#[derive(Debug)]
pub(crate) struct Schema(Option<&'static str>);

/// Name of the option of a file: `mtf` of `mtf.json`.
fn option(file: &'static str) -> &'static str {
    file.strip_suffix(".json").unwrap_or(file)
}

impl clap::Args for Schema {
    fn augment_args(command: clap::Command) -> clap::Command {
        let with_schema = RESULTS.iter().filter(|file| file.schema.is_some());
        let flags = with_schema.map(|file| {
            let help = format!("Print that of {}{}", file.name, file.of);
            Arg::new(option(file.name))
                .long(option(file.name))
                .group("of")
                .action(ArgAction::SetTrue)
                .help(help)
        });
        command.group(ArgGroup::new("of")).args(flags)
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for Schema {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let is_set =
            |name: &&'static str| matches.try_get_one(option(name)).is_ok_and(|set| set == Some(&true));
        Ok(Self(RESULTS.iter().map(|file| file.name).find(is_set)))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Prints the JSON Schema of a scenario, or of the result of a command.
pub(crate) fn schema(Schema(of): &Schema) -> Result<(), Failure> {
    let of_result = RESULTS.iter().find(|file| Some(file.name) == *of).and_then(|file| file.schema);
    let schema = of_result.map_or_else(papilio_scenario::schema, |schema| schema());
    let mut out = crate::terminal::stdout();
    serde_json::to_writer_pretty(&mut out, &schema).map_err(std::io::Error::from)?;
    writeln!(out)?;
    Ok(out.flush()?)
}
