//! Which pictures `papilio image` shows, and on what: the display of a scenario file, or with `--on` a usual panel; one
//! picture, or all of a folder.
//!
//! A folder has a file `pictures.json` with the numbers of its pictures, which is written after each of them: the same command
//! skips those whose files are all there, with the same bytes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use papilio_display::image::ImageNumbers;
use papilio_formats::{DataFile, FormatError, LARGEST_PICTURE_FILE, Problem, write_file, write_json};
use papilio_scenario::{
    ExampleDisplay, Library, MemoryFile, PICTURE_LIGHT, Resolved, Scenario, looks_like_path,
    picture_scenario, picture_size,
};
use serde::{Deserialize, Serialize};

use crate::arguments::{ImageCommand, SpatialCommand};
use crate::claim::Claim;
use crate::numbers::measured;
use crate::{Failure, image, input, interrupt, output, print_message, report, terminal};

pub(crate) fn command(arguments: &ImageCommand) -> Result<(), Failure> {
    let picture = match (arguments.on, &arguments.picture) {
        (Some(display), Some(picture)) => {
            return Err(Failure::Input(format!(
                "--on {} takes the place of a scenario: there are two files, {} and {picture}\n  = help: papilio image {picture} --on {}",
                display.name,
                arguments.command.scenario.file.display(),
                display.name
            )));
        }
        (Some(_), None) => Some(arguments.command.scenario.file.display().to_string()),
        (None, picture) => picture.clone(),
    };
    if let (None, Some(picture)) = (arguments.on, &picture) {
        check_picture(picture, &arguments.command.scenario.file)?;
    }
    match picture {
        Some(folder) if Path::new(&folder).is_dir() => show_all(arguments, Path::new(&folder)),
        picture => image::show_one(&Shown { arguments, command: arguments.command.clone(), picture }),
    }
}

/// Fails if there is no such picture. Its path is from the current folder, unlike those that a scenario names.
fn check_picture(picture: &str, scenario: &Path) -> Result<(), Failure> {
    let path = Path::new(picture);
    if path.is_dir() || path.is_file() {
        return Ok(());
    }
    let missing = DataFile::open_within(path, picture, 0).err();
    let beside = input::folder(scenario).join(path);
    let missing = missing.map(|missing| match (&missing.problem, beside.is_file()) {
        (Problem::Unreadable { .. }, true) => {
            let wrong = missing.problem.diagnostic().expected("a path from the current folder");
            let hint = format!("did you mean `{}`?", beside.display());
            FormatError { problem: wrong.hint(hint).into(), ..missing }
        }
        _ => missing,
    });
    missing.map_or(Ok(()), |missing| Err(Failure::Data(missing)))
}

/// A picture, and the display that shows it.
pub(crate) struct Shown<'a> {
    pub(crate) arguments: &'a ImageCommand,
    /// The arguments of all commands with places, with the folder for the results.
    pub(crate) command: SpatialCommand,
    /// The file, unless the scenario states the picture.
    picture: Option<String>,
}

impl Shown<'_> {
    /// Reads the scenario, with the picture and further overrides.
    pub(crate) fn scenario(&self, more: Vec<String>) -> Result<Scenario, Failure> {
        let all = self.picture_key().into_iter().chain(more);
        match (self.arguments.on, &self.picture) {
            (Some(display), Some(picture)) => self.on_panel(display, picture, all),
            _ => self.command.scenario(all),
        }
    }

    /// Resolves the scenario, with the picture.
    pub(crate) fn resolved(&self) -> Result<Resolved, Failure> {
        let resolved = self.scenario(Vec::new())?.resolve_with_picture();
        Ok(resolved.map_err(|errors| match self.picture_key() {
            Some(key) => errors.in_argument(&key),
            None => errors,
        })?)
    }

    /// The picture as an override.
    fn picture_key(&self) -> Option<String> {
        let text = |picture: &String| {
            // A name without an ending would not be taken as a path.
            let picture = if looks_like_path(picture) { picture.clone() } else { format!("./{picture}") };
            picture.replace('\\', "\\\\").replace('"', "\\\"")
        };
        self.picture.as_ref().map(|picture| format!("image.file=\"{}\"", text(picture)))
    }

    /// The scenario of a usual panel, upright if the picture is.
    fn on_panel(
        &self,
        display: ExampleDisplay,
        picture: &str,
        more: impl IntoIterator<Item = String>,
    ) -> Result<Scenario, Failure> {
        let file = DataFile::open_within(Path::new(picture), picture, LARGEST_PICTURE_FILE);
        let [columns, rows] = file.and_then(picture_size).map_err(Failure::Data)?;
        let light = self.arguments.light.as_deref().unwrap_or(PICTURE_LIGHT);
        let text = picture_scenario(display, light, rows > columns)
            .ok_or_else(|| Failure::Input(format!("--on: {} has no panel for pictures", display.name)))?;
        let file = |(name, content): &(&str, &str)| {
            let file = DataFile { name: (*name).to_owned(), bytes: content.as_bytes().to_vec() };
            ((*name).to_owned(), MemoryFile::new(file))
        };
        let files: BTreeMap<String, MemoryFile> = display.files.iter().map(file).collect();
        let library = Library::Both { files: Arc::new(files), folder: PathBuf::new() };
        let overrides: Vec<String> = self.command.overrides(more);
        Ok(Scenario::from_text(&text, &format!("--on {}", display.name), library, &overrides)?)
    }
}

/// File with the numbers of all pictures of a folder.
const ALL: &str = "pictures.json";

/// Ends of the names of pictures.
const ENDS: [&str; 7] = ["png", "jpg", "jpeg", "svg", "exr", "hdr", "pic"];

/// A finished picture of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Finished {
    /// File of the picture.
    picture: String,
    /// Folder of its results, within that of all.
    results: String,
    /// Hash of the scenario with the picture.
    hash: String,
    /// What else the command states.
    arguments: String,
    /// Version of the program; empty in records of earlier ones.
    #[serde(default)]
    papilio: String,
    /// SHA-256 of each file of its results, by name; empty in records of earlier versions.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// S-CIELAB against the photograph, mean.
    scielab_mean: Option<f64>,
    hue_error_deg: Option<f64>,
    chroma_ratio: Option<f64>,
    local_contrast_ratio: Option<f64>,
}

/// Shows all pictures of a folder; the others, if one of them cannot be shown.
fn show_all(arguments: &ImageCommand, folder: &Path) -> Result<(), Failure> {
    let Contents { pictures, skipped } = pictures_in(folder)?;
    skipped.iter().for_each(|note| print_message(note));
    let scenario = &arguments.command.scenario;
    let out = scenario.out.clone().unwrap_or_else(|| scenario.default_out());
    // The numbers of all pictures are in one file: a second program would replace those of the first.
    let _claim = match &scenario.out {
        Some(folder) => output::check(folder).map(|()| None)?,
        None => Some(Claim::of(&out)?.ok_or_else(|| {
            Failure::Input(format!(
                "{} is being written by another program\n  = help: wait until it ends, or choose another folder with --out DIR",
                out.display()
            ))
        })?),
    };
    let before: Vec<Finished> = fs::read(out.join(ALL))
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let known = |results: &String| before.iter().find(|one| one.results == *results);
    let stated = stated(arguments);
    let mut all: Vec<Finished> = Vec::new();
    let mut wrong = Vec::new();
    let mut warnings: Vec<String> = Vec::new();
    for (number, (path, results)) in pictures.iter().enumerate() {
        let picture = path.display().to_string();
        let mut command = arguments.command.clone();
        // Results of a picture are files, whatever is printed.
        (command.json, command.scenario.out) = (false, Some(out.join(results)));
        let shown = Shown { arguments, command, picture: Some(picture.clone()) };
        let mut one = || {
            let resolved = shown.resolved()?;
            let is_it = |one: &&Finished| one.is_of(&resolved.hash, &stated) && one.is_whole(&out);
            if let Some(known) = known(results).filter(is_it) {
                return Ok(known.clone());
            }
            let hash = resolved.hash.clone();
            let (numbers, names) = image::write_one(&shown, resolved)?;
            let finished = Finished::new([&picture, results, &hash, &stated], &numbers);
            warnings.extend(numbers.warnings);
            finished.with_files(&out, names)
        };
        match one() {
            Ok(finished) => all.push(finished),
            Err(Failure::Interrupted(_)) => {
                return Err(Failure::Interrupted(
                    "finished pictures are kept: run the same command again to resume",
                ));
            }
            // All others would fail, too, after they are computed.
            Err(failure) if failure.is_of_system() => return Err(failure),
            Err(failure) => {
                print_message(&failure);
                wrong.push(picture);
            }
        }
        // Those of an earlier command that are not reached yet, so that it can be interrupted again.
        let later = pictures[number + 1..].iter().filter_map(|(_, results)| known(results));
        let written: Vec<&Finished> = all.iter().chain(later).collect();
        if !(all.is_empty() && before.is_empty()) {
            interrupt::uninterrupted(|| {
                output::make_folder(&out)?;
                write_file(&out.join(ALL), |out| write_json(out, &written)).map_err(Failure::from)
            })?;
        }
    }
    print(&all, arguments.command.json)?;
    if !all.is_empty() {
        print_message(&format!("wrote {} and the folder of each picture in {}", ALL, out.display()));
    }
    terminal::print_counted(warnings.iter().map(String::as_str), pictures.len(), "pictures");
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{} of {} pictures could not be shown: {}\n  = help: the messages above say why; all others are finished",
        wrong.len(),
        pictures.len(),
        wrong.join(", ")
    )))
}

/// What determines the files of a picture besides its scenario. Threads and the folder do not change a result.
fn stated(arguments: &ImageCommand) -> String {
    let on = arguments.on.map(|display| display.name);
    // The file may have other content under the same name; one that cannot be read is an error of the picture.
    let since = arguments.frame.since.as_deref().map(|path| sha256(path).ok());
    format!(
        "{:?} {:?} {:?} {} {} {:?} {on:?} {since:?}",
        arguments.relative_to,
        arguments.space,
        arguments.rooms,
        arguments.device_colours,
        arguments.command.png,
        arguments.frame
    )
}

/// SHA-256 of a file, in hexadecimal digits.
fn sha256(path: &Path) -> Result<String, Failure> {
    let file = DataFile::open_within(path, &path.display().to_string(), u64::MAX)?;
    Ok(MemoryFile::new(file).sha256().to_owned())
}

/// Contents of a folder.
struct Contents {
    /// Pictures in the order of their names, each with the name of the folder of its results.
    pictures: Vec<(PathBuf, String)>,
    /// A note on what is no picture that can be shown.
    skipped: Option<String>,
}

/// Most names in the note on what is skipped.
const MOST_NAMED: usize = 5;

/// Names of what is skipped in a folder; hidden files are not mentioned.
fn names_of(mut skipped: Vec<PathBuf>) -> Option<String> {
    skipped.sort();
    let name = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let kind = if path.is_dir() { " (a folder)" } else { "" };
        (!name.starts_with('.')).then(|| format!("{name}{kind}"))
    };
    let names: Vec<String> = skipped.iter().filter_map(name).collect();
    let more = names.len().saturating_sub(MOST_NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    (!names.is_empty()).then(|| names[..names.len().min(MOST_NAMED)].join(", ") + &more)
}

/// The pictures of a folder.
fn pictures_in(folder: &Path) -> Result<Contents, Failure> {
    let unreadable = |error: std::io::Error| {
        Failure::Input(format!("the folder {} cannot be read: {error}", folder.display()))
    };
    let (mut paths, mut skipped) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let end = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
        if path.is_file() && ENDS.contains(&&*end) {
            paths.push(path);
        } else {
            skipped.push(path);
        }
    }
    paths.sort();
    let ends = ENDS.map(|end| format!(".{end}")).join(", ");
    let skipped = names_of(skipped);
    if paths.is_empty() {
        let others = skipped.map_or(String::new(), |names| format!("\n  = note: it contains {names}"));
        return Err(Failure::Input(format!(
            "the folder {} contains no picture{others}\n  = help: pictures are files that end in {ends}",
            folder.display()
        )));
    }
    let skipped = skipped.map(|names| {
        format!("note: skipped in {}: {names}: pictures are files that end in {ends}", folder.display())
    });
    let name = |path: &Path, whole: bool| {
        let name = if whole { path.file_name() } else { path.file_stem() };
        name.unwrap_or_default().to_string_lossy().into_owned()
    };
    let is_unique =
        |path: &PathBuf| paths.iter().filter(|other| name(other, false) == name(path, false)).count() == 1;
    let pictures = paths.iter().map(|path| (path.clone(), name(path, !is_unique(path)))).collect();
    Ok(Contents { pictures, skipped })
}

impl Finished {
    fn new([picture, results, hash, arguments]: [&str; 4], numbers: &ImageNumbers) -> Self {
        let against = numbers.against_photograph;
        Self {
            picture: picture.to_owned(),
            results: results.to_owned(),
            hash: hash.to_owned(),
            arguments: arguments.to_owned(),
            papilio: env!("CARGO_PKG_VERSION").to_owned(),
            files: BTreeMap::new(),
            scielab_mean: against.scielab_mean,
            hue_error_deg: against.hue_error_deg,
            chroma_ratio: against.chroma_ratio,
            local_contrast_ratio: against.local_contrast_ratio,
        }
    }

    /// Adds the files of these names, which are in its folder within `out`.
    fn with_files(self, out: &Path, names: Vec<String>) -> Result<Self, Failure> {
        let folder = out.join(&self.results);
        let with_sum = |name: String| Ok((name.clone(), sha256(&folder.join(name))?));
        let files = names.into_iter().map(with_sum).collect::<Result<_, Failure>>()?;
        Ok(Self { files, ..self })
    }

    /// Whether this program would compute it from a scenario with this hash, and these other arguments.
    fn is_of(&self, hash: &str, arguments: &str) -> bool {
        (&*self.hash, &*self.arguments, &*self.papilio) == (hash, arguments, env!("CARGO_PKG_VERSION"))
    }

    /// Whether all its files are as they were written.
    fn is_whole(&self, out: &Path) -> bool {
        let folder = out.join(&self.results);
        let is_same =
            |(name, sum): (&String, &String)| sha256(&folder.join(name)).is_ok_and(|found| found == *sum);
        !self.files.is_empty() && self.files.iter().all(is_same)
    }
}

/// Prints the numbers of all pictures.
fn print(all: &[Finished], as_json: bool) -> Result<(), Failure> {
    use std::io::Write;
    let mut stdout = terminal::output(as_json);
    if as_json {
        write_json(&mut stdout, &all)?;
    } else {
        let head = ["picture", "S-CIELAB: mean", "hue error, deg", "chroma ratio", "local contrast ratio"];
        let row = |one: &Finished| {
            let numbers = [
                (one.scielab_mean, 2),
                (one.hue_error_deg, 1),
                (one.chroma_ratio, 2),
                (one.local_contrast_ratio, 2),
            ];
            let numbers = numbers.into_iter().map(|(value, digits)| measured(value, None, digits));
            std::iter::once(one.results.clone()).chain(numbers).collect::<Vec<String>>()
        };
        let rows: Vec<Vec<String>> =
            std::iter::once(head.map(str::to_owned).to_vec()).chain(all.iter().map(row)).collect();
        stdout.write_all(format!("seen against the photographs\n{}", report::table(&rows)).as_bytes())?;
    }
    Ok(stdout.flush()?)
}
