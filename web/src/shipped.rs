//! The example scenarios, surfaces and their data, which are part of the program.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use papilio_formats::DataFile;
use papilio_scenario::MemoryFile;
use rust_embed::RustEmbed;

#[derive(RustEmbed)]
#[folder = "../scenarios"]
struct Scenarios;

#[derive(RustEmbed)]
#[folder = "../surfaces"]
struct Surfaces;

/// The scenario that is shown on the first visit.
pub(crate) const FIRST: &str = "indoor";

/// Names of the examples.
pub(crate) fn examples() -> impl Iterator<Item = String> {
    Scenarios::iter().filter_map(|path| Some(path.strip_suffix(".toml")?.to_owned()))
}

/// The text of an example.
pub(crate) fn example(name: &str) -> Option<String> {
    let known = examples().any(|known| known == name);
    let file = known.then(|| Scenarios::get(&format!("{name}.toml")))??;
    String::from_utf8(file.data.into_owned()).ok()
}

/// Names of the example surfaces.
pub(crate) fn surfaces() -> impl Iterator<Item = String> {
    Surfaces::iter().filter_map(|path| Some(path.strip_suffix(".toml")?.to_owned()))
}

/// The text of an example surface.
pub(crate) fn surface(name: &str) -> Option<String> {
    let known = surfaces().any(|known| known == name);
    let file = known.then(|| Surfaces::get(&format!("{name}.toml")))??;
    String::from_utf8(file.data.into_owned()).ok()
}

/// Data files under the names that scenarios may use: `data/H65.bsdf`, as in the examples, and `H65.bsdf`; and surfaces, as
/// `../surfaces/etched.toml`.
pub(crate) static DATA: LazyLock<BTreeMap<String, MemoryFile>> = LazyLock::new(|| {
    let named = |path: &str| {
        let name = path.strip_prefix("data/").filter(|name| !name.ends_with(".py"))?.to_owned();
        let bytes = Scenarios::get(path)?.data.into_owned();
        let file = MemoryFile::new(DataFile { name: name.clone(), bytes });
        Some([(name, file.clone()), (path.to_owned(), file)])
    };
    let surface = |path: &str| {
        let name = format!("../surfaces/{path}");
        let bytes = Surfaces::get(path)?.data.into_owned();
        let file = MemoryFile::new(DataFile { name: name.clone(), bytes });
        // Surfaces name meshes beside them.
        let beside = (!path.ends_with(".toml")).then(|| (path.to_owned(), file.clone()));
        Some([(name, file)].into_iter().chain(beside))
    };
    let data = Scenarios::iter().filter_map(|path| named(&path)).flatten().collect::<Vec<_>>();
    data.into_iter().chain(Surfaces::iter().filter_map(|path| surface(&path)).flatten()).collect()
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
    }
}
