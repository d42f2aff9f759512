//! The page of the command line, from the definitions of its commands.

use std::fmt::Write;

use clap::{Arg, ArgAction, Command};

use super::cell;

/// Files of the reader in the examples: words of a command, and what makes the file.
const FILES: [(&str, &str); 6] = [
    ("photograph.jpg", "cp scenarios/data/chelsea.png photograph.jpg"),
    ("scan.csv", "cp scenarios/data/synthetic-scan.csv scan.csv"),
    ("old.toml", "cp scenarios/indoor.toml old.toml"),
    ("sample.bsdf", "cp scenarios/data/H78.bsdf sample.bsdf; cp scenarios/data/H65.bsdf white.bsdf"),
    ("office.toml", "rm -f office.toml"),
    ("reader.toml", "rm -f reader.toml"),
];

/// Describes all commands: their purposes in the table at the beginning, arguments and options that several
/// commands share once.
pub(super) fn reference(mut program: Command) -> String {
    program.build();
    let mut text = String::new();
    let all = commands(&program, "papilio");
    for (name, command) in
        all.iter().filter(|(_, command)| !command.has_subcommands() || has_arguments(command))
    {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(
            text,
            "- [`{name}`](#{}): {}",
            name.replace(' ', "-"),
            cell(about.trim_end_matches('.'))
        );
    }
    let own = |command: &Command| -> Vec<Row> {
        let shown = command.get_arguments().filter(|option| is_shown(option) && !option.is_global_set());
        shown.map(row).collect()
    };
    let every: Vec<Vec<Row>> = all.iter().map(|(_, command)| own(command)).collect();
    // Of the meanings of a name, the most frequent one, if two commands or more have it.
    let count = |row: &Row| every.iter().flatten().filter(|other| *other == row).count();
    let is_common = |row: &Row| {
        let mut of_this_name = every.iter().flatten().filter(|(name, _)| *name == row.0);
        count(row) >= 2 && of_this_name.all(|other| other == row || count(other) < count(row))
    };
    let mut common: Vec<&Row> = Vec::new();
    for row in every.iter().flatten().filter(|row| is_common(row)) {
        if !common.contains(&row) {
            common.push(row);
        }
    }
    text += "\n## Common options\n\nThey have this meaning wherever a command names them. Every command has `--quiet`.\n\n";
    let global = program.get_arguments().filter(|option| is_shown(option)).map(row).collect::<Vec<_>>();
    text += &list(global.iter().chain(common));
    text += &after_help(&program);
    for ((name, command), rows) in all.iter().zip(&every) {
        let _ = write!(text, "\n## {name}\n");
        if command.has_subcommands() && !has_arguments(command) {
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            let _ = write!(text, "\n{}.\n", about.trim_end_matches('.'));
        } else if let Some(usage) = usage((*command).clone()) {
            let _ = write!(text, "\nUsage: {usage}\n");
        }
        let (common, special): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(|row| is_common(row));
        if !special.is_empty() {
            let _ = write!(text, "\n{}", list(special));
        }
        if !common.is_empty() {
            // Without the values of options, which the table of common options has.
            let short = |name: &str| format!("`{}`", name.split(" <").next().unwrap_or(name));
            let names: Vec<String> = common.iter().map(|(name, _)| short(name)).collect();
            let _ = writeln!(text, "\n[Common options](#common-options): {}.", names.join(", "));
        }
        text += &after_help(command);
    }
    text
}

/// How the arguments of a command follow each other, where its list of them does not say it.
fn usage(mut command: Command) -> Option<String> {
    let is_plain = command.get_positionals().count() <= 1;
    let usage = command.render_usage().to_string();
    let usages: Vec<String> =
        usage.trim_start_matches("Usage:").lines().map(|line| format!("`{}`", line.trim())).collect();
    (usages.len() > 1 || !is_plain).then(|| usages.join(" or "))
}

fn has_arguments(command: &Command) -> bool {
    command.get_positionals().next().is_some()
}

/// All commands below one, with their names, in the order of the help.
fn commands<'a>(command: &'a Command, name: &str) -> Vec<(String, &'a Command)> {
    let mut all = Vec::new();
    for inner in command.get_subcommands().filter(|inner| inner.get_name() != "help" && !inner.is_hide_set())
    {
        let name = format!("{name} {}", inner.get_name());
        all.push((name.clone(), inner));
        all.extend(commands(inner, &name));
    }
    all
}

fn is_shown(argument: &Arg) -> bool {
    !argument.is_hide_set() && !["help", "version"].contains(&argument.get_id().as_str())
}

/// An argument as a reader types it, and its meaning.
type Row = (String, String);

fn list<'a>(rows: impl IntoIterator<Item = &'a Row>) -> String {
    rows.into_iter().map(|(name, meaning)| format!("- `{name}`: {meaning}\n")).collect()
}

fn row(argument: &Arg) -> Row {
    let mut meaning = argument.get_help().map(ToString::to_string).unwrap_or_default();
    let takes_values = matches!(argument.get_action(), ArgAction::Set | ArgAction::Append);
    let values = argument.get_possible_values();
    if takes_values && !values.is_empty() {
        let shown = values.iter().filter(|value| !value.is_hide_set());
        let shown = shown.map(|value| match value.get_help() {
            Some(help) => format!("`{}`: {help}", value.get_name()),
            None => format!("`{}`", value.get_name()),
        });
        let _ = write!(meaning, ". Values: {}", shown.collect::<Vec<_>>().join("; "));
    }
    let default = argument.get_default_values();
    if takes_values && !default.is_empty() {
        let default: Vec<_> = default.iter().map(|value| value.to_string_lossy()).collect();
        let _ = write!(meaning, " [default: {}]", default.join(","));
    }
    let words = |text: &str| cell(text).replace("\\|", "|");
    (words(&name(argument, takes_values)), words(&meaning))
}

/// An argument as a reader types it.
fn name(argument: &Arg, takes_values: bool) -> String {
    let value = match argument.get_value_names() {
        Some(names) => names.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "),
        None => argument.get_id().as_str().to_uppercase(),
    };
    let Some(long) = argument.get_long() else {
        return if argument.is_required_set() { format!("<{value}>") } else { format!("[{value}]") };
    };
    let short = argument.get_short().map(|short| format!("-{short}, ")).unwrap_or_default();
    let value = if takes_values { format!(" <{value}>") } else { String::new() };
    format!("{short}--{long}{value}")
}

/// The examples and remarks at the end of a help text: commands as blocks that the tests run.
fn after_help(command: &Command) -> String {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let mut parts: Vec<(bool, Vec<&str>)> = Vec::new();
    let mut goes_on = false;
    for line in help.lines() {
        let line = line.trim().trim_start_matches("Examples:").trim_start_matches("Example:").trim();
        let is_command = goes_on || line.starts_with("papilio ");
        goes_on = is_command && line.ends_with('\\');
        match parts.last_mut() {
            Some((of_commands, lines)) if *of_commands == is_command => lines.push(line),
            _ => parts.push((is_command, vec![line])),
        }
    }
    let mut text = String::new();
    for (is_command, lines) in parts {
        let lines = lines.join("\n");
        if !is_command {
            let paragraphs = lines.split("\n\n").filter(|text| !text.trim().is_empty());
            paragraphs.for_each(|paragraph| text += &format!("\n{}\n", linked(paragraph.trim())));
            continue;
        }
        text += "\n";
        if command.get_name() == "completions" {
            text += "<!-- skip: each path is one of its shell; cli/tests/cli/first_steps.rs tests the scripts -->\n";
        }
        for (_, setup) in FILES.iter().filter(|(word, _)| lines.contains(word)) {
            let _ = writeln!(text, "<!-- setup: {setup} -->");
        }
        let _ = write!(text, "```sh\n{}\n```\n", lines.trim());
    }
    text
}

/// A text whose names of pages, `docs/brdf.md`, are links.
fn linked(text: &str) -> String {
    let link = |word: &str| {
        let page = word.strip_prefix("docs/").and_then(|rest| rest.find(".md").map(|end| &rest[..end + 3]));
        page.map_or(word.to_owned(), |page| {
            word.replacen(&format!("docs/{page}"), &format!("[docs/{page}]({page})"), 1)
        })
    };
    text.split(' ').map(link).collect::<Vec<_>>().join(" ")
}
