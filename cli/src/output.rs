//! Files of results.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use papilio_display::{AmbientLight, ConeResult};
use papilio_formats::{
    ConeFile, ResultFile, is_of_place, remove_abandoned, report::RunReport, unwritable, write_cone_csv,
    write_cone_npy, write_file, write_json, write_spectra, write_states,
};

use crate::{Failure, print_message};

/// Fails if results cannot be written to `folder`; creates nothing.
pub(crate) fn check(folder: &Path) -> Result<(), Failure> {
    let existing = folder.ancestors().find(|path| path.exists()).filter(|path| !path.as_os_str().is_empty());
    let existing = existing.unwrap_or(Path::new("."));
    let failure = |reason: &str| {
        let (folder, existing) = (folder.display(), existing.display());
        Failure::Input(format!(
            "results cannot be written to {folder}: {existing} {reason}\n  = help: choose another folder with --out DIR"
        ))
    };
    // A link without a target, or to itself, is a link but does not exist.
    if let Some(link) = folder.ancestors().find(|path| path.is_symlink() && !path.exists()) {
        let link = link.display();
        return Err(Failure::Input(format!(
            "results cannot be written to {}: {link} is a link to a path that does not exist\n  = help: remove the link, or \
             choose another folder with --out DIR",
            folder.display()
        )));
    }
    if !existing.is_dir() {
        return Err(failure("is not a folder"));
    }
    remove_abandoned(folder);
    let probe = existing.join(format!(".papilio.{}.papilio.tmp", std::process::id()));
    let probed = std::fs::write(&probe, "").and_then(|()| std::fs::remove_file(&probe));
    probed.map_err(|error| {
        if is_of_place(&error) { failure("is not writable") } else { unwritable(existing, &error).into() }
    })
}

/// Creates the folder for results.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    let what = || format!("the folder {} cannot be created", folder.display());
    std::fs::create_dir_all(folder).map_err(|error| Failure::of_folder(folder, &what(), &error))
}

/// Creates the folder for a run, and removes the figures of an earlier run, which could be mistaken for new
/// ones.
fn prepare_folder(folder: &Path) -> Result<(), Failure> {
    make_folder(folder)?;
    remove(folder, is_figure_or_cone)
}

/// Removes files of an earlier command from a folder.
pub(crate) fn remove(folder: &Path, is_old: impl Fn(&str) -> bool) -> Result<(), Failure> {
    let unread = |error| {
        let what = format!("the folder {} cannot be read", folder.display());
        Failure::of_folder(folder, &what, &error)
    };
    for entry in std::fs::read_dir(folder).map_err(unread)?.flatten() {
        let path = entry.path();
        if entry.file_name().to_str().is_some_and(&is_old) && !papilio_formats::is_input(&path) {
            let what = || format!("{}, of an earlier run, cannot be removed", path.display());
            std::fs::remove_file(&path).map_err(|error| Failure::of_folder(&path, &what(), &error))?;
        }
    }
    Ok(())
}

/// True for names of figures that begin with one of these words.
pub(crate) fn is_figure_of(kinds: &[&str], name: &str) -> bool {
    let stem = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
    stem.is_some_and(|stem| kinds.iter().any(|kind| stem.starts_with(kind)))
}

/// True for names of figures from [`papilio_figures::of_run`], and of files of a cone.
fn is_figure_or_cone(name: &str) -> bool {
    let of_view = ["overview", "spectra", "chromaticity", "chromaticity_xy", "patches", "rings", "light"];
    let figure = |stem: &str| {
        stem.ends_with("_against_angle")
            || of_view.iter().any(|kind| {
                stem.strip_prefix(kind).is_some_and(|at| at.is_empty() || at.starts_with("_theta"))
            })
    };
    let stem = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
    stem.is_some_and(figure) || CONE.contains(&name) || name == REPORT
}

/// File of the page about a run.
const REPORT: &str = "report.html";

const CONE: [&str; 7] = [
    "cone.csv",
    "cone.npy",
    "cone.json",
    "cone.svg",
    "cone.png",
    "cone_differences.svg",
    "cone_differences.png",
];

/// Content of the files that `papilio run` writes.
pub(crate) struct Files<'a> {
    /// Title of the figures.
    pub(crate) title: &'a str,
    /// The result.
    pub(crate) result: &'a ResultFile<'a>,
    /// Incident light by direction, if it gets a figure.
    pub(crate) light: Option<&'a AmbientLight>,
    /// Conoscopic maps, if requested.
    pub(crate) cone: Option<&'a ConeResult>,
    /// True if figures are written as PNG too.
    pub(crate) png: bool,
    /// True if a page about the run is written.
    pub(crate) report: bool,
    /// True if the angles of the scenario are in glass.
    pub(crate) in_glass: bool,
}

/// Writes the files of `papilio run`, and returns their names.
pub(crate) fn write_run(folder: &Path, files: &Files<'_>) -> Result<Vec<String>, Failure> {
    prepare_folder(folder)?;
    let mut names = Vec::new();
    let mut write = |name: &str, with: &dyn Fn(&mut dyn Write) -> std::io::Result<()>| {
        names.push(name.to_owned());
        write_file(&folder.join(name), with)
    };
    let &Files { title, result: file, light, cone, png, report, in_glass } = files;
    write("result.json", &|out| write_json(out, file))?;
    write("states.csv", &|out| write_states(out, file.result))?;
    write("spectra.csv", &|out| write_spectra(out, file.result))?;
    if let Some(cone) = cone {
        let about = ConeFile::new(file.papilio, file.hash, cone);
        write("cone.csv", &|out| write_cone_csv(out, cone))?;
        write("cone.npy", &|out| write_cone_npy(out, cone))?;
        write("cone.json", &|out| write_json(out, &about))?;
    }
    let figures = papilio_figures::of_run_with_maps(file.result, light, cone, title);
    if report {
        let cone_warnings = cone.map_or(&[][..], |cone| &cone.warnings);
        let page = RunReport { title, file, cone_warnings, figures: &figures, in_glass };
        write(REPORT, &|out| out.write_all(page.html().as_bytes()))?;
    }
    names.extend(write_figures(folder, figures, png)?);
    Ok(names)
}

/// Writes figures (name without extension, SVG): always as SVG, and as PNG too if `png`, which is `--png` of the command; returns
/// the names of the files. Without `--png`, a PNG file of the same name is that of an earlier command, and is removed.
pub(crate) fn write_figures(
    folder: &Path,
    drawn: Vec<(String, String)>,
    png: bool,
) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    let mut incomplete: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (name, svg) in drawn {
        let [vector, raster] = ["svg", "png"].map(|end| format!("{name}.{end}"));
        write_file(&folder.join(&vector), |out| out.write_all(svg.as_bytes()))?;
        names.push(vector);
        if png {
            let picture = papilio_figures::png(&svg, papilio_figures::PNG_SCALE)?;
            write_file(&folder.join(&raster), |out| out.write_all(&picture.value))?;
            for warning in picture.warnings {
                incomplete.entry(warning).or_default().push(raster.clone());
            }
            names.push(raster);
        } else if folder.join(&raster).is_file() {
            remove(folder, |old| old == raster)?;
        }
    }
    for (warning, files) in incomplete {
        print_message(&format!("warning: {}: {warning}", files.join(", ")));
    }
    Ok(names)
}

/// Prints the names of the written files on standard error; of more than four figures only their number.
/// Pictures are no figures.
pub(crate) fn print_written(folder: &Path, names: &[String]) {
    let drawn = |stem: &str| names.iter().any(|name| name.strip_suffix(".svg") == Some(stem));
    let is_figure = |name: &&str| name.ends_with(".svg") || name.strip_suffix(".png").is_some_and(drawn);
    let (figures, tables): (Vec<&str>, Vec<&str>) = names.iter().map(String::as_str).partition(is_figure);
    let mut shown = tables.join(", ");
    match figures.as_slice() {
        [] => {}
        few @ ([_] | [_, _] | [_, _, _] | [_, _, _, _]) => {
            let few = few.join(", ");
            shown = if shown.is_empty() { few } else { format!("{shown}, {few}") };
        }
        many if shown.is_empty() => shown = format!("{} figures", many.len()),
        many => shown = format!("{shown} and {} figures", many.len()),
    }
    print_message(&format!("wrote {}: {shown}", folder.display()));
}
