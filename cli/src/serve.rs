//! `papilio serve`: the web app.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use papilio_formats::{DataFile, FormatError, LARGEST_BSDF_FILE};
use papilio_scenario::{Resolved, Scenario};
use papilio_web::{JobOptions, Options, Site, Start};

use crate::arguments::Serve;
use crate::{Failure, print_message, report};

pub(crate) fn run(arguments: &Serve) -> Result<(), Failure> {
    let options = Options {
        listen: arguments.listen.unwrap_or(Options::default().listen),
        port: arguments.port.unwrap_or(Options::default().port),
        start: arguments.file.as_deref().map(start).transpose()?,
        jobs: jobs(arguments.jobs.as_deref()),
    };
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build();
    let runtime =
        runtime.map_err(|error| Failure::System(format!("the server cannot be started: {error}")))?;
    runtime.block_on(async {
        let (site, listener) = Site::bind(options).await?;
        let url = site.url();
        if site.has_token() {
            print_message(
                &"warning: other machines can reach this address. Anyone who has the token (after # in the address) can run \
                 computations on this machine. The connection is not encrypted.",
            );
        }
        anstream::println!("Papilio is running at {url}");
        print_message(&"press Ctrl-C to stop it");
        if arguments.open && !open(&url) {
            print_message(&"note: the browser could not be opened; open the address above");
        }
        site.serve(listener).await;
        Ok(())
    })
}

/// How jobs are run. In another program, such as Python, there are none.
fn jobs(folder: Option<&Path>) -> Option<JobOptions> {
    let program = std::env::current_exe().ok()?;
    let is_papilio = program.file_stem().is_some_and(|stem| stem == "papilio");
    let folder =
        folder.map_or_else(job_folder, |folder| std::path::absolute(folder).unwrap_or(folder.to_owned()));
    is_papilio.then_some(JobOptions { program, folder })
}

/// The folder of jobs in that of the user's states.
fn job_folder() -> PathBuf {
    let variable = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = variable("XDG_STATE_HOME")
        .or_else(|| variable("LOCALAPPDATA"))
        .or_else(|| variable("HOME").map(|home| home.join(".local/state")));
    state.unwrap_or_else(std::env::temp_dir).join("papilio").join("jobs")
}

/// A scenario and the files that it names. An invalid scenario is opened too, so that it can be corrected in
/// the page.
fn start(path: &Path) -> Result<Start, Failure> {
    let name = path.display().to_string();
    let file = DataFile::open(path, &name).map_err(Failure::Data)?;
    let scenario = file.text().map_err(Failure::Data)?.to_owned();
    let folder = path.parent().unwrap_or(Path::new(""));
    let resolved = Scenario::from_text(&scenario, &name, folder, &[]).and_then(|scenario| scenario.resolve());
    let files = match &resolved {
        Ok(resolved) => files(resolved, folder).map_err(Failure::Data)?,
        Err(errors) => {
            print_message(errors);
            Vec::new()
        }
    };
    Ok(Start { name: report::file_title(path), scenario, files })
}

/// The files that a scenario and its surfaces name, under the names that they use.
fn files(resolved: &Resolved, folder: &Path) -> Result<Vec<DataFile>, FormatError> {
    let inputs = resolved.canonical.get("inputs").and_then(|inputs| inputs.as_object());
    // The entry of a surface is not a file, but its content.
    let is_surface = |name: &str| resolved.surfaces.iter().any(|one| name == format!("{}.surface", one.path));
    let of_scenario = inputs.into_iter().flat_map(|inputs| inputs.keys()).filter(|name| !is_surface(name));
    let of_scenario = of_scenario.map(|name| (folder.to_owned(), name));
    let of_surfaces = resolved.surfaces.iter().flat_map(|surface| {
        let beside = folder.join(Path::new(&surface.file).parent().unwrap_or(Path::new("")));
        surface.inputs.iter().map(move |name| (beside.clone(), name))
    });
    let open = |(folder, name): (PathBuf, &String)| {
        DataFile::open_within(&folder.join(name), name, LARGEST_BSDF_FILE)
    };
    of_scenario.chain(of_surfaces).map(open).collect()
}

/// Opens the page in the system's browser; false if that fails.
fn open(url: &str) -> bool {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        Command::new("explorer")
    } else {
        Command::new("xdg-open")
    };
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().is_ok()
}
