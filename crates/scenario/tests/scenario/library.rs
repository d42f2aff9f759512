//! Files in memory: what they make is what the same files make on disk, and nothing else is read.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use papilio_formats::DataFile;
use papilio_scenario::{KeptFile, Library, Memo, Resolved, Scenario};

use crate::common::shipped;

/// The shipped data in memory, as the examples name it.
fn in_memory() -> BTreeMap<String, KeptFile> {
    let data = shipped().join("data");
    let file = |path: &Path| {
        let name = format!("data/{}", path.file_name()?.to_str()?);
        Some((name.clone(), KeptFile::new(DataFile { name, bytes: std::fs::read(path).ok()? })))
    };
    data.read_dir().unwrap().filter_map(|entry| file(&entry.unwrap().path())).collect()
}

fn resolved(text: &str, library: Library) -> Resolved {
    Scenario::from_text(text, "s.toml", library, &[]).unwrap().resolve().unwrap_or_else(|e| panic!("{e}"))
}

/// First from files, then from what was kept of them, and after other scenarios in between.
#[test]
fn files_in_memory_make_what_files_on_disk_make() {
    let (files, memo) = (Arc::new(in_memory()), Arc::new(Memo::default()));
    let names = [
        "measured-diffused",
        "measured-h65",
        "map-regions",
        "epaper-measured",
        "own-material",
        "table-pixel",
    ];
    for name in names.into_iter().chain(names) {
        let text = std::fs::read_to_string(shipped().join(format!("{name}.toml"))).unwrap();
        let memory = resolved(&text, Library::Memory { files: files.clone(), memo: memo.clone() });
        let disk = resolved(&text, Library::from(&shipped()));
        // Tables of scattering are equal only if they are one; what they hold is the same.
        let [memory_scene, disk_scene] = [&memory, &disk].map(|resolved| format!("{:?}", resolved.scene));
        assert!(memory_scene == disk_scene, "{name}");
        assert_eq!(memory.canonical, disk.canonical, "{name}");
        assert_eq!((memory.warnings, memory.notes), (disk.warnings, disk.notes), "{name}");
    }
}

/// A file of the same name and other contents is another file; keys that change something count, too.
#[test]
fn what_was_kept_is_not_taken_for_something_else() {
    let memo = Arc::new(Memo::default());
    let mut files = in_memory();
    let text = std::fs::read_to_string(shipped().join("measured-diffused.toml")).unwrap();
    assert!(text.contains("data/H78-raw.bsdf"));
    let look = |text: &str, files: &BTreeMap<String, KeptFile>| {
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
fn a_file_that_is_not_in_memory_is_not_looked_for_on_disk() {
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
