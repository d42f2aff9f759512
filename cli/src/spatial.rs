//! What `papilio mtf`, `crosstalk`, `sparkle`, `palette` and `image` share: compute, print, write files and
//! figures.

use std::io::Write;
use std::path::Path;

use papilio_diagnostics::short_numbers;
use papilio_display::{Control, DisplayError};
use papilio_formats::{SpatialFile, write_file, write_json};
use papilio_scenario::{Resolved, Scenario};
use serde::Serialize;

use crate::arguments::SpatialCommand;
use crate::folder::ResultFolder;
use crate::progress::with_progress;
use crate::{
    Failure, costs, folder, input, interrupt, output, print_notes, print_warnings, report, terminal,
};

/// A result with places.
pub(crate) trait SpatialOutput {
    /// Name of the JSON file.
    const JSON: &'static str;
    /// How the names of its figures begin.
    const FIGURES: &'static [&'static str];

    /// The content of the JSON file.
    fn content<'a>(
        &'a self,
        resolved: &'a Resolved,
        title: &'a str,
        notes: &'a [String],
    ) -> impl Serialize + 'a;

    /// The table on the terminal.
    fn table(&self, title: &str) -> String;

    /// Writes the tables; returns the names of their files.
    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure>;

    /// Names and SVG texts of the figures.
    fn figures(&self, title: &str) -> Vec<(String, String)>;

    /// Notes on the scenario and the computation.
    fn notes(&self, resolved: &Resolved) -> Vec<String> {
        resolved.notes.clone()
    }

    /// Warnings of the result, which its JSON file has: first those of the scenario.
    fn warnings(&mut self) -> &mut Vec<String>;
}

/// The content of a JSON file that has the scenario.
pub(crate) fn with_scenario<'a, R>(
    resolved: &'a Resolved,
    notes: &'a [String],
    result: &'a R,
) -> SpatialFile<'a, R> {
    SpatialFile {
        papilio: env!("CARGO_PKG_VERSION"),
        hash: &resolved.hash,
        scenario: &resolved.canonical,
        notes,
        result,
    }
}

/// Computes a result, prints it, and writes its files unless only JSON is printed.
pub(crate) fn show<R: SpatialOutput>(
    arguments: &SpatialCommand,
    resolved: &Resolved,
    compute: impl FnOnce(&Control<'_>) -> Result<R, DisplayError>,
) -> Result<(), Failure> {
    let (mut result, folder) = computed(arguments, resolved, compute)?;
    let (title, notes) = (title(arguments, resolved), result.notes(resolved));
    let mut stdout = terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &result.content(resolved, &title, &notes))?;
    } else {
        stdout.write_all(short_numbers(&result.table(&title)).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = &folder {
        let names = interrupt::uninterrupted(|| write(folder, &result, resolved, &title, arguments.png))?;
        folder.print_written(&names);
    }
    print_notes(&notes);
    print_warnings(result.warnings());
    Ok(())
}

/// Computes a result, and writes its files to the folder of the arguments without printing anything but progress; returns their
/// names, too.
pub(crate) fn compute_files<R: SpatialOutput>(
    arguments: &SpatialCommand,
    resolved: &Resolved,
    compute: impl FnOnce(&Control<'_>) -> Result<R, DisplayError>,
) -> Result<(R, Vec<String>), Failure> {
    let (result, folder) = computed(arguments, resolved, compute)?;
    let title = title(arguments, resolved);
    let write = |folder: &ResultFolder| write(folder, &result, resolved, &title, arguments.png);
    let names = folder.as_ref().map(|folder| interrupt::uninterrupted(|| write(folder))).transpose()?;
    Ok((result, names.unwrap_or_default()))
}

/// Computes a result; the folder for its files is checked before.
fn computed<R: SpatialOutput>(
    arguments: &SpatialCommand,
    resolved: &Resolved,
    compute: impl FnOnce(&Control<'_>) -> Result<R, DisplayError>,
) -> Result<(R, Option<ResultFolder>), Failure> {
    if arguments.png && !papilio_figures::HAS_PNG {
        return Err(papilio_figures::PngError::NotBuilt.into());
    }
    let folder = arguments.folder(resolved)?;
    costs::check_paths(resolved, None, (1.0, "solver.paths"), arguments.workers.threads)?;
    let result = with_progress(resolved, arguments.workers.threads, compute)?;
    let mut result = result.ok_or(Failure::Interrupted("no file was written"))?;
    resolved.warn_before(result.warnings());
    Ok((result, folder))
}

/// Title of a scenario, or the name of its file.
pub(crate) fn title(arguments: &SpatialCommand, resolved: &Resolved) -> String {
    resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file))
}

/// Writes all files, after those of an earlier run are removed; returns their names.
fn write<R: SpatialOutput>(
    folder: &Path,
    result: &R,
    resolved: &Resolved,
    title: &str,
    png: bool,
) -> Result<Vec<String>, Failure> {
    output::make_folder(folder)?;
    output::remove(folder, |name| output::is_figure_of(R::FIGURES, name))?;
    let notes = result.notes(resolved);
    write_file(&folder.join(R::JSON), |out| write_json(out, &result.content(resolved, title, &notes)))?;
    let mut names = vec![R::JSON.to_owned()];
    names.extend(result.write_tables(folder)?);
    names.extend(output::write_figures(folder, result.figures(title), png)?);
    Ok(names)
}

impl SpatialCommand {
    /// Reads and resolves the scenario, with the seed and a further override.
    pub(crate) fn resolve(&self, more: impl IntoIterator<Item = String>) -> Result<Resolved, Failure> {
        Ok(self.scenario(more)?.resolve()?)
    }

    /// Reads the scenario, with the seed and further overrides.
    pub(crate) fn scenario(&self, more: impl IntoIterator<Item = String>) -> Result<Scenario, Failure> {
        input::scenario::<Scenario>(&self.scenario.file, &self.overrides(more))
    }

    /// All overrides: those of `--set`, further ones, and the seed.
    pub(crate) fn overrides(&self, more: impl IntoIterator<Item = String>) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("solver.seed={seed}"));
        self.scenario.set.iter().cloned().chain(more).chain(seed).collect()
    }

    /// Returns the folder for files; `None` if only JSON is printed.
    fn folder(&self, resolved: &Resolved) -> Result<Option<ResultFolder>, Failure> {
        match (&self.scenario.out, self.json) {
            (None, true) => Ok(None),
            _ => folder::choose(&self.scenario, resolved).map(Some),
        }
    }
}
