//! Files and JSON.

use std::io::Write;
use std::path::Path;

use papilio_display::{ConeResult, RoomLight};
use papilio_figures::HAS_PNG;
use papilio_formats::{
    ConeFile, ResultFile, write_cone_csv, write_cone_npy, write_file, write_json, write_spectra, write_states,
};

use crate::Failure;

/// Prints the JSON Schema of a scenario or of `result.json`.
pub(crate) fn schema(of_result: bool) -> Result<(), Failure> {
    let schema = if of_result { papilio_formats::result_schema() } else { papilio_scenario::schema() };
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, &schema).map_err(std::io::Error::from)?;
    Ok(writeln!(out)?)
}

/// Fails if results could not be written to `folder`; leaves nothing behind.
pub(crate) fn check(folder: &Path) -> Result<(), Failure> {
    let there = folder.ancestors().find(|path| path.exists()).filter(|path| !path.as_os_str().is_empty());
    let there = there.unwrap_or(Path::new("."));
    let why = |reason: &str| {
        let (folder, there) = (folder.display(), there.display());
        Failure::Input(format!(
            "results cannot be written to {folder}: {there} {reason}\n  = help: choose another folder with --out DIR"
        ))
    };
    // A link that leads nowhere, or to itself, is there and does not exist.
    if let Some(link) = folder.ancestors().find(|path| path.is_symlink() && !path.exists()) {
        let where_to = link.display();
        return Err(Failure::Input(format!(
            "results cannot be written to {}: {where_to} is a link that leads to nothing\n  = help: remove the link, or choose \
             another folder with --out DIR",
            folder.display()
        )));
    }
    if !there.is_dir() {
        return Err(why("is not a folder"));
    }
    let probe = there.join(format!(".papilio.{}.tmp", std::process::id()));
    std::fs::write(&probe, "")
        .and_then(|()| std::fs::remove_file(&probe))
        .map_err(|_| why("cannot be written"))
}

/// Makes the folder for results.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    let why = |error| {
        let folder = folder.display();
        Failure::Input(format!(
            "cannot make the folder {folder}: {error}\n  = help: choose another folder with --out DIR"
        ))
    };
    std::fs::create_dir_all(folder).map_err(why)
}

/// Makes the folder for results, and takes the figures of an earlier run out of it: beside
/// new ones they would be mistaken for them.
fn make(folder: &Path) -> Result<(), Failure> {
    make_folder(folder)?;
    remove(folder, is_figure_or_cone)
}

/// Takes files of an earlier command out of a folder.
pub(crate) fn remove(folder: &Path, is_old: impl Fn(&str) -> bool) -> Result<(), Failure> {
    let why = |error| Failure::Input(format!("cannot tidy the folder {}: {error}", folder.display()));
    for entry in std::fs::read_dir(folder).map_err(why)?.flatten() {
        if entry.file_name().to_str().is_some_and(&is_old) {
            std::fs::remove_file(entry.path()).map_err(why)?;
        }
    }
    Ok(())
}

/// The names that [`papilio_figures::of_run`] gives, and those of a cone.
fn is_figure_or_cone(name: &str) -> bool {
    let of_view = ["overview", "spectra", "chromaticity", "patches", "rings", "light"];
    let figure = |stem: &str| {
        stem.ends_with("_against_angle")
            || of_view.iter().any(|kind| {
                stem.strip_prefix(kind).is_some_and(|at| at.is_empty() || at.starts_with("_theta"))
            })
    };
    let stem = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
    stem.is_some_and(figure) || CONE.contains(&name)
}

const CONE: [&str; 5] = ["cone.csv", "cone.npy", "cone.json", "cone.svg", "cone.png"];

/// What `papilio run` writes.
pub(crate) struct Files<'a> {
    /// Above the figures.
    pub(crate) title: &'a str,
    /// The result.
    pub(crate) result: &'a ResultFile<'a>,
    /// Where the light comes from, if that is worth a figure.
    pub(crate) light: Option<&'a RoomLight>,
    /// All directions, if wanted.
    pub(crate) cone: Option<&'a ConeResult>,
    /// Whether figures are wanted as PNG, too.
    pub(crate) png: bool,
}

/// Writes everything that `papilio run` writes, and returns the names.
pub(crate) fn write_run(folder: &Path, files: &Files<'_>) -> Result<Vec<String>, Failure> {
    make(folder)?;
    let mut names = Vec::new();
    let mut write = |name: &str, with: &dyn Fn(&mut dyn Write) -> std::io::Result<()>| {
        names.push(name.to_owned());
        write_file(&folder.join(name), with)
    };
    let &Files { title, result: file, light, cone, png } = files;
    write("result.json", &|out| write_json(out, file))?;
    write("states.csv", &|out| write_states(out, file.result))?;
    write("spectra.csv", &|out| write_spectra(out, file.result))?;
    if let Some(cone) = cone {
        let about = ConeFile::new(file.papilio, file.hash, cone);
        write("cone.csv", &|out| write_cone_csv(out, cone))?;
        write("cone.npy", &|out| write_cone_npy(out, cone))?;
        write("cone.json", &|out| write_json(out, &about))?;
    }
    let of_cone =
        cone.and_then(|cone| papilio_figures::cone(cone, title)).map(|svg| ("cone".to_owned(), svg));
    let of_light = light.map(|light| ("light".to_owned(), papilio_figures::light(light, title)));
    let of_run = papilio_figures::of_run(file.result, title);
    for (name, svg) in of_run.into_iter().chain(of_light).chain(of_cone) {
        write(&format!("{name}.svg"), &|out| out.write_all(svg.as_bytes()))?;
        if HAS_PNG && (png || name == "cone") {
            let picture = papilio_figures::png(&svg, papilio_figures::PNG_SCALE)?;
            write(&format!("{name}.png"), &|out| out.write_all(&picture))?;
        }
    }
    Ok(names)
}

/// Writes a figure as SVG, and as PNG if the program can; returns the names.
pub(crate) fn write_figure(folder: &Path, name: &str, svg: &str) -> Result<Vec<String>, Failure> {
    let mut names = vec![format!("{name}.svg")];
    write_file(&folder.join(&names[0]), |out| out.write_all(svg.as_bytes()))?;
    if HAS_PNG {
        let picture = papilio_figures::png(svg, papilio_figures::PNG_SCALE)?;
        names.push(format!("{name}.png"));
        write_file(&folder.join(&names[1]), |out| out.write_all(&picture))?;
    }
    Ok(names)
}

/// Writes figures, each under its name without an end, as PNG too if that is wanted; returns the names.
pub(crate) fn write_figures(
    folder: &Path,
    drawn: Vec<(String, String)>,
    png: bool,
) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    for (name, svg) in drawn {
        if png {
            names.extend(write_figure(folder, &name, &svg)?);
        } else {
            let name = format!("{name}.svg");
            write_file(&folder.join(&name), |out| out.write_all(svg.as_bytes()))?;
            names.push(name);
        }
    }
    Ok(names)
}

/// Says on standard error what was written; figures beyond the first few only by number.
pub(crate) fn announce(folder: &Path, names: &[String]) {
    let (figures, tables): (Vec<&str>, Vec<&str>) =
        names.iter().map(String::as_str).partition(|name| name.ends_with(".svg") || name.ends_with(".png"));
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
    crate::say(&format!("wrote {}: {shown}", folder.display()));
}
