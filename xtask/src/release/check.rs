//! Checks of the packages: each is installed in an empty folder and runs the first command of README.md,
//! whose output is compared.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};

use super::copy;
use super::sandbox::Sandbox;
use crate::shell::{self, Needs, Outcome};

/// Scenario of the README's first command.
const SCENARIO: &str = "scenarios/indoor.toml";

/// Page of the Python package in the registry.
const ABOUT: &str = "ABOUT.md";

/// Checks the archive of the program.
pub(super) fn archive(archive: &Path, name: &str) -> Outcome {
    let sandbox = Sandbox::new("program")?;
    sandbox.unpack(archive)?;
    let root = sandbox.folder().join(name);
    let program = || match sandbox.in_empty_root(&root, "/papilio") {
        Some(command) => command,
        None => {
            let mut command = sandbox.command(root.join("papilio"));
            command.current_dir(&root);
            command
        }
    };
    runs(program())?;
    written(&root)?;
    serves_the_page(program())?;
    if name.contains("linux") { container(&root, &sandbox) } else { Ok(()) }
}

/// Builds the container in the unpacked archive, and runs it, if this machine has buildah.
fn container(archive: &Path, sandbox: &Sandbox) -> Outcome {
    if shell::need(Needs { tool: &["buildah"], install: "" }).is_err() {
        println!("The container is not checked: buildah is missing (apt-get install buildah).");
        return Ok(());
    }
    let images = sandbox.folder().join("images");
    let buildah = |arguments: &[&str]| {
        let mut buildah = Command::new("buildah");
        // Beside the images of the user, without mounts; removed with the folder.
        buildah.args(["--storage-driver", "vfs", "--root"]).arg(&images);
        buildah.arg("--runroot").arg(images.join("run")).args(arguments);
        buildah
    };
    let mut build = buildah(&["build", "--quiet", "--isolation", "chroot", "--tag", "papilio"]);
    shell::run({
        build.arg(archive);
        build
    })?;
    let from = shell::run_apart(buildah(&["from", "--pull=never", "localhost/papilio"]));
    from.outcome?;
    let container = from.texts[0].trim();
    runs(buildah(&["run", "--isolation", "chroot", container, "--", "/papilio"]))
}

/// Checks a package of Python in a new environment. `build` are the options of maturin for a source
/// distribution, which needs Rust.
pub(super) fn python(package: &Path, build: Option<&str>) -> Outcome {
    let sandbox = Sandbox::new("python")?;
    let here = sandbox.folder();
    copy(&shell::root().join("scenarios"), &here.join("scenarios"))?;
    let mut create = Command::new("python3");
    create.args(["-m", "venv"]).arg(here.join("venv"));
    shell::run(create)?;
    let programs = here.join("venv").join(if cfg!(windows) { "Scripts" } else { "bin" });
    let mut install = match build {
        None => sandbox.command(programs.join("python")),
        // With Rust. In a folder of its own: cargo tells compiled crates apart by their place in the
        // workspace and their times, which are the same here, and would take those of the repository for
        // those of the package.
        Some(options) => {
            let mut install = Command::new(programs.join("python"));
            install
                .env("MATURIN_PEP517_ARGS", options)
                .env("CARGO_TARGET_DIR", here.join("target"))
                .current_dir(here);
            install
        }
    };
    install.args(["-m", "pip", "install", "--quiet"]).arg(package);
    shell::run(install)?;
    runs(sandbox.command(programs.join("papilio")))?;
    written(here)?;
    // The example of the package's page in the registry: its shell commands, then its Python.
    copy(&shell::root().join("python").join(ABOUT), &here.join(ABOUT))?;
    let mut new = sandbox.command(programs.join("papilio"));
    new.args(["new", "office", "office.toml"]);
    shell::run(new)?;
    let mut examples = sandbox.command(programs.join("python"));
    examples.args(["-m", "doctest", ABOUT]);
    shell::run(examples)
}

/// Runs the first command, and compares what it prints with README.md, line by line.
fn runs(mut program: Command) -> Outcome {
    program.args(["run", SCENARIO]);
    let mut printed = Vec::new();
    shell::run_and_read(program, Some(&mut |line| printed.push(line.to_owned())))?;
    let readme = shell::root().join("README.md");
    let text = fs::read_to_string(&readme).map_err(|error| format!("README.md: {error}"))?;
    let mut blocks = text.split("```text\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0));
    let block = blocks.find(|block| block.starts_with("Indoor reading"));
    let expected = block.ok_or("README.md does not show the output of its first command")?;
    let expected = expected.lines().filter(|line| !line.is_empty() && line.trim() != "...");
    for line in expected {
        if !printed.iter().any(|found| found.trim_end() == line.trim_end()) {
            return Err(format!("{SCENARIO}: the program does not print this line of README.md:\n{line}"));
        }
    }
    Ok(())
}

/// The first command writes its result and figures into a folder.
fn written(folder: &Path) -> Outcome {
    let out = folder.join("out").join("indoor");
    let missing = ["result.json", "overview.svg"].into_iter().find(|name| !out.join(name).is_file());
    missing.map_or(Ok(()), |name| Err(format!("{SCENARIO}: {name} was not written")))
}

/// Starts the web app, and requests its page.
fn serves_the_page(mut program: Command) -> Outcome {
    program.args(["serve", "--port", "0"]).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut server = program.spawn().map_err(|error| format!("papilio serve: {error}"))?;
    let page = server.stdout.take().ok_or_else(String::new).and_then(|out| page(BufReader::new(out)));
    let _ = server.kill();
    let _ = server.wait();
    let page = page.map_err(|error| format!("papilio serve: {error}"))?;
    // The page loads its script; the text that replaces a missing page has none.
    if page.contains("<script") {
        Ok(())
    } else {
        Err(format!("papilio serve: no page in the program:\n{page}"))
    }
}

/// The start page of the server that prints its address.
fn page(printed: impl BufRead) -> Result<String, String> {
    let mut lines = printed.lines().map_while(Result::ok);
    let address = lines.find_map(|line| {
        let (_, rest) = line.split_once("http://")?;
        Some(rest.split(|end: char| end == '/' || end.is_whitespace()).next()?.to_owned())
    });
    let address = address.ok_or("it prints no address")?;
    let mut stream = TcpStream::connect(&address).map_err(|error| format!("{address}: {error}"))?;
    let request = format!("GET / HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    let mut answer = String::new();
    let exchange = stream.write_all(request.as_bytes()).and_then(|()| stream.read_to_string(&mut answer));
    exchange.map_err(|error| format!("{address}: {error}"))?;
    Ok(answer)
}
