//! The workflows of `.github`: each step that can run here is a task of the project or a command of
//! README.md.

use std::process::Command;

use yaml_rust2::{Yaml, YamlLoader};

use crate::{read, root};

const WORKFLOWS: [&str; 3] = ["check", "release", "site"];

/// First words of steps that need the machines of the workflow: they install what it builds with, or act on
/// the project's pages.
const ELSEWHERE: [&str; 5] = [
    "rustup target add ",
    "sudo apt-get install ",
    "gh release create ",
    "mkdir python && mv packages/",
    "cargo publish --workspace --no-verify --allow-dirty",
];

fn workflow(name: &str) -> Yaml {
    YamlLoader::load_from_str(&read(&format!(".github/workflows/{name}.yml"))).unwrap().remove(0)
}

/// Jobs of all workflows, with their names.
fn jobs() -> Vec<(String, Yaml)> {
    let of = |name: &str| {
        let all = workflow(name)["jobs"].as_hash().unwrap().clone();
        let named = move |(job, about): (Yaml, Yaml)| (format!("{name}: {}", job.as_str().unwrap()), about);
        all.into_iter().map(named).collect::<Vec<_>>()
    };
    WORKFLOWS.iter().flat_map(|name| of(name)).collect()
}

/// Values of a key in the steps of all jobs.
fn steps(key: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for (job, about) in jobs() {
        for step in about["steps"].as_vec().unwrap() {
            if let Some(text) = step[key].as_str() {
                found.push((job.clone(), text.to_owned()));
            }
        }
    }
    found
}

#[test]
fn steps_are_tasks_of_the_project() {
    let list = Command::new(env!("CARGO_BIN_EXE_xtask")).output().unwrap();
    let list = String::from_utf8(list.stdout).unwrap();
    let tasks: Vec<&str> =
        list.lines().filter_map(|line| line.strip_prefix("cargo xtask ")?.split(' ').next()).collect();
    let readme = read("README.md");
    let commands: Vec<&str> = readme.lines().map(|line| line.split("  #").next().unwrap().trim()).collect();
    let mut of_tasks = 0;
    for (job, run) in steps("run") {
        if ELSEWHERE.iter().any(|start| run.starts_with(start)) {
            continue;
        }
        if let Some(rest) = run.strip_prefix("cargo xtask ") {
            of_tasks += 1;
            assert!(tasks.contains(&rest.split(' ').next().unwrap()), "{job}: `{run}` is no task");
        } else {
            assert!(commands.contains(&run.as_str()), "{job}: `{run}` is neither a task nor in README.md");
        }
    }
    assert!(of_tasks > 8, "{of_tasks}");
    // The check is that of README.md.
    assert!(
        commands.contains(&"cargo xtask test")
            && steps("run").iter().any(|(_, run)| run == "cargo xtask test")
    );
}

/// The words after `cargo xtask release` are parts that the task knows, for systems of the table.
#[test]
fn parts_of_a_release_are_those_of_the_task() {
    let source = read("xtask/src/release/mod.rs");
    let is_part = |word: &str| source.contains(&format!("(\"{word}\", Part::"));
    let build = workflow("release")["jobs"]["build"]["strategy"]["matrix"]["include"].clone();
    let systems = build.as_vec().unwrap();
    assert!(systems.iter().all(|system| system["parts"].as_str().unwrap().split(' ').all(is_part)));
    for end in ["linux-musl", "linux-gnu", "apple-darwin", "pc-windows-msvc"] {
        assert!(systems.iter().any(|system| system["target"].as_str().unwrap().ends_with(end)), "{end}");
    }
    for (job, run) in steps("run") {
        let Some(parts) = run.strip_prefix("cargo xtask release ").filter(|parts| !parts.contains("${{"))
        else {
            continue;
        };
        assert!(parts.split(' ').all(is_part), "{job}: {run}");
    }
}

#[test]
fn workflows_have_the_least_rights_and_no_secrets() {
    for name in WORKFLOWS {
        let about = workflow(name);
        let rights = about["permissions"].as_hash().unwrap();
        assert!(rights.iter().all(|(_, right)| right.as_str() == Some("read")), "{name}");
        assert!(!about["concurrency"].is_badvalue(), "{name}");
        assert!(!read(&format!(".github/workflows/{name}.yml")).contains("secrets."), "{name}");
    }
    for (job, about) in jobs() {
        assert!(about["timeout-minutes"].as_i64().is_some(), "{job} has no time limit");
        let writes = about["permissions"]
            .as_hash()
            .is_some_and(|rights| rights.values().any(|right| right.as_str() == Some("write")));
        // What others see afterwards happens for a tag, as a draft, or when a person starts the workflow.
        assert!(!writes || !about["if"].is_badvalue(), "{job} writes without a condition");
    }
}

#[test]
fn actions_are_pinned_by_version() {
    for (job, action) in steps("uses") {
        let (_, version) = action.split_once('@').unwrap_or_default();
        let major = version.strip_prefix('v').is_some_and(|number| number.parse::<u32>().is_ok());
        // The packagers of Python name the branch of a major version so.
        assert!(major || version == "release/v1", "{job}: {action}");
    }
}

/// The container is built from the archive: it copies only files that are in it.
#[test]
fn container_copies_files_of_the_archive() {
    let program = read("xtask/src/release/program.rs");
    let mut copied = 0;
    for line in
        read("release/Containerfile").lines().filter_map(|line| line.strip_prefix("COPY ").map(str::to_owned))
    {
        let names: Vec<&str> = line.split(' ').collect();
        for name in &names[..names.len() - 1] {
            copied += 1;
            assert!(
                *name == "papilio"
                    || (program.contains(&format!("\"{name}\"")) && root().join(name).exists()),
                "{name}"
            );
        }
    }
    assert!(copied >= 5);
}
