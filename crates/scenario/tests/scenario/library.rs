//! Files in memory: they give the same results as files on disk, and nothing else is read.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use papilio_formats::DataFile;
use papilio_scenario::{Library, MemoryFile, ResolveCache, Resolved, Scenario};
use papilio_testing::everyday;

use crate::common::shipped;

/// The shipped data in memory, with the names in the examples.
fn in_memory() -> BTreeMap<String, MemoryFile> {
    let data = shipped().join("data");
    let file = |path: &Path| {
        let name = format!("data/{}", path.file_name()?.to_str()?);
        Some((name.clone(), MemoryFile::new(DataFile { name, bytes: std::fs::read(path).ok()? })))
    };
    data.read_dir().unwrap().filter_map(|entry| file(&entry.unwrap().path())).collect()
}

fn resolved(text: &str, library: Library) -> Resolved {
    Scenario::from_text(text, "s.toml", library, &[]).unwrap().resolve().unwrap_or_else(|e| panic!("{e}"))
}

/// Results from files, then from the cache, and again after other scenarios.
#[test]
fn files_in_memory_and_on_disk_give_the_same_results() {
    let (files, memo) = (Arc::new(in_memory()), Arc::new(ResolveCache::default()));
    let names = [
        "measured-diffused",
        "map-regions",
        "epaper-measured",
        "own-material",
        "own-files",
        "table-pixel",
        "measured-h65",
    ];
    let text = |name| std::fs::read_to_string(shipped().join(format!("{name}.toml"))).unwrap();
    let texts: Vec<String> = everyday(4, names).map(text).collect();
    // Tables of scattering are equal only if they are one; what they hold is the same.
    let held = |resolved: Resolved| {
        (format!("{:?}", resolved.scene), resolved.canonical, resolved.warnings, resolved.notes)
    };
    let disk: Vec<_> = texts.iter().map(|text| held(resolved(text, Library::from(&shipped())))).collect();
    for k in (0..texts.len()).chain(0..texts.len()) {
        let library = Library::Memory { files: files.clone(), memo: memo.clone() };
        assert!(held(resolved(&texts[k], library)) == disk[k], "{}", names[k]);
    }
}

/// Neither a file with the same name and other contents, nor a changed key, is served from the cache.
#[test]
fn cached_value_is_not_used_for_other_files_or_keys() {
    let memo = Arc::new(ResolveCache::default());
    let mut files = in_memory();
    let text = std::fs::read_to_string(shipped().join("measured-diffused.toml")).unwrap();
    assert!(text.contains("data/H78-raw.bsdf"));
    let look = |text: &str, files: &BTreeMap<String, MemoryFile>| {
        resolved(text, Library::Memory { files: Arc::new(files.clone()), memo: memo.clone() }).scene.display
    };
    let first = look(&text, &files);
    let coarser = text.replace("[display.glass]", "[spectrum]\nstep_nm = 10\n\n[display.glass]");
    assert!(look(&text, &files) == first);
    assert!(look(&coarser, &files) != first);
    files.insert("data/H78-raw.bsdf".to_owned(), files["data/H78.bsdf"].clone());
    assert!(look(&text, &files) != first);
}

#[test]
fn file_missing_in_memory_is_not_read_from_disk() {
    let (files, memo) = (Arc::default(), Arc::default());
    let library = Library::Memory { files, memo };
    for name in ["/etc/passwd", "Cargo.toml", "data/H78-raw.bsdf"] {
        let text = format!("[display.pixel]\nmodel = \"table\"\nangles = \"air\"\nfile = \"{name}\"\n");
        let errors =
            Scenario::from_text(&text, "s.toml", library.clone(), &[]).unwrap().resolve().unwrap_err();
        let error = errors.iter().next().unwrap();
        assert_eq!(error.diagnostic.message, format!("there is no file `{name}` here"));
        assert_eq!(error.path.as_deref(), Some("display.pixel.file"));
    }
}
