//! Cases that have passed, in a file: a full run that was interrupted is resumed.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::Path;

use papilio_testing::sized;

use super::watch::papilio;

/// The cases that this program has passed.
pub(super) struct Record {
    passed: BTreeSet<String>,
    /// None in every day's test, which keeps no record.
    file: Option<File>,
}

impl Record {
    /// Reads the record of a test; a record of another program is deleted.
    pub(super) fn open(name: &str) -> Self {
        if sized(true, false) {
            return Self { passed: BTreeSet::new(), file: None };
        }
        let program = fs::metadata(papilio()).unwrap();
        let head = format!("{} bytes, changed {:?}", program.len(), program.modified().unwrap());
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("extremes");
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name).with_extension("txt");
        let text = fs::read_to_string(&path).unwrap_or_default();
        let is_same = text.lines().next() == Some(&head);
        let passed = text.lines().skip(1).filter(|_| is_same).map(str::to_owned).collect();
        let mut options = OpenOptions::new();
        let mut file =
            options.create(true).write(true).append(is_same).truncate(!is_same).open(path).unwrap();
        if !is_same {
            writeln!(file, "{head}").unwrap();
        }
        Self { passed, file: Some(file) }
    }

    pub(super) fn has(&self, case: &str) -> bool {
        self.passed.contains(case)
    }

    pub(super) fn passed(&mut self, case: &str) {
        if let Some(file) = &mut self.file {
            writeln!(file, "{case}").unwrap();
        }
    }
}
