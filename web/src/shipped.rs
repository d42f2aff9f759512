//! The example scenarios, surfaces and their data, which are part of the program.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use papilio_examples::{file, paths};
use papilio_formats::DataFile;
use papilio_scenario::MemoryFile;

/// The scenario that is shown on the first visit.
pub(crate) const FIRST: &str = "indoor";

/// Names of the examples.
pub(crate) fn examples() -> impl Iterator<Item = String> {
    names("scenarios/")
}

/// The text of an example.
pub(crate) fn example(name: &str) -> Option<String> {
    text("scenarios/", name)
}

/// Names of the example surfaces.
pub(crate) fn surfaces() -> impl Iterator<Item = String> {
    names("surfaces/")
}

/// The text of an example surface.
pub(crate) fn surface(name: &str) -> Option<String> {
    text("surfaces/", name)
}

/// Names of the TOML files of a folder, without those of folders in it, which are data.
fn names(folder: &'static str) -> impl Iterator<Item = String> {
    let all =
        paths().filter_map(move |path| Some(path.strip_prefix(folder)?.strip_suffix(".toml")?.to_owned()));
    all.filter(|name| !name.contains('/'))
}

fn text(folder: &str, name: &str) -> Option<String> {
    if name.contains('/') {
        return None;
    }
    String::from_utf8(file(&format!("{folder}{name}.toml"))?.into_owned()).ok()
}

/// Data files under the names that scenarios may use: `data/H65.bsdf`, as in the examples, and `H65.bsdf`;
/// and surfaces, as `../surfaces/etched.toml`, with the meshes beside them, as `corner-cubes.obj`.
pub(crate) static DATA: LazyLock<BTreeMap<String, MemoryFile>> = LazyLock::new(|| {
    let named = |path: &str| {
        let (long, short) = match (path.strip_prefix("scenarios/data/"), path.strip_prefix("surfaces/")) {
            (Some(name), _) => (format!("data/{name}"), Some(name)),
            (_, Some(name)) => (format!("../{path}"), (!name.ends_with(".toml")).then_some(name)),
            _ => return None,
        };
        let data = DataFile { name: short.unwrap_or(&long).to_owned(), bytes: file(path)?.into_owned() };
        let memory = MemoryFile::new(data);
        let short = short.map(|name| (name.to_owned(), memory.clone()));
        Some(short.into_iter().chain([(long, memory)]))
    };
    paths().filter_map(|path| named(&path)).flatten().collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_and_data_are_found_by_name_and_other_paths_are_not() {
        assert!(example(FIRST).is_some_and(|text| text.contains("[display.pixel]")));
        assert!(DATA.contains_key("H65.bsdf") && DATA.contains_key("data/H65.bsdf"));
        assert!(DATA.contains_key("../surfaces/etched.toml") && DATA.contains_key("corner-cubes.obj"));
        assert!(example("../Cargo").is_none() && example("data/H65").is_none());
        assert!(file("scenarios/data/samples.toml").is_some() && example("data/samples").is_none());
    }
}
