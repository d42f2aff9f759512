//! Campaigns of numbered cases, in parts that several processes and machines can compute.
//!
//! Each process appends the rows of its cases to a CSV file of its own, and computes no case that a file of the campaign
//! has: an interrupted campaign is resumed. `PAPILIO_PART=3/16` computes every sixteenth case from number 3 on, with one
//! thread, and `PAPILIO_CAMPAIGN=FOLDER` is the folder of the files.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Name of the last row of each case, which holds its times.
const END: &str = "seconds";

/// The files of a campaign, and the one that this process appends to.
#[derive(Debug)]
pub struct Campaign {
    folder: PathBuf,
    name: &'static str,
    part: [u64; 2],
    file: Mutex<File>,
}

/// A row of numbers about one case.
#[derive(Debug, Clone)]
pub struct CaseRow {
    /// Number of the case.
    pub number: u64,
    /// Description of the case.
    pub name: String,
    /// What the numbers are of.
    pub quantity: String,
    /// The numbers, in the order of the header; empty cells are NaN.
    pub numbers: Vec<f64>,
}

impl CaseRow {
    /// Returns a row; commas of its texts become semicolons.
    pub fn new(number: u64, name: &str, quantity: &str, numbers: impl Into<Vec<f64>>) -> Self {
        let text = |text: &str| text.replace([',', '\n', '"'], ";");
        Self { number, name: text(name), quantity: text(quantity), numbers: numbers.into() }
    }

    fn from_line(line: &str) -> Option<Self> {
        let mut cells = line.split(',');
        let (number, name, quantity) = (cells.next()?.parse().ok()?, cells.next()?, cells.next()?);
        let numbers = cells.map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        Some(Self { number, name: name.to_owned(), quantity: quantity.to_owned(), numbers })
    }

    fn to_line(&self) -> String {
        let mut line = format!("{},{},{}", self.number, self.name, self.quantity);
        for number in &self.numbers {
            let _ = write!(line, ",{number:.7e}");
        }
        line + "\n"
    }
}

/// Returns the number of this part and of all parts: `PAPILIO_PART`, or the only part.
#[allow(clippy::expect_used, reason = "a test says what it expects")]
fn part() -> Option<[u64; 2]> {
    let text = std::env::var("PAPILIO_PART").ok()?;
    let (number, of) = text.split_once('/').expect("PAPILIO_PART must be NUMBER/PARTS");
    let whole = |text: &str| text.parse::<u64>().expect("PAPILIO_PART must be NUMBER/PARTS");
    Some([whole(number), whole(of)])
}

#[allow(clippy::expect_used, reason = "a test says what it expects")]
impl Campaign {
    /// Opens the files of a campaign: `NAME-PART-of-PARTS.csv` in `folder`, or in `PAPILIO_CAMPAIGN`.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn open(folder: &Path, name: &'static str, header: &str) -> Self {
        let folder = std::env::var_os("PAPILIO_CAMPAIGN").map_or(folder.to_owned(), PathBuf::from);
        fs::create_dir_all(&folder).expect("the folder of a campaign must be writable");
        let part = part().unwrap_or([0, 1]);
        let path = folder.join(format!("{name}-{}-of-{}.csv", part[0], part[1]));
        let text = fs::read_to_string(&path).unwrap_or_default();
        let mut file = OpenOptions::new().create(true).append(true).open(&path).expect("a CSV file");
        // What a killed process wrote last may lack its end.
        let missing =
            if text.is_empty() { format!("number,name,quantity,{header}\n") } else { String::new() };
        let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        write!(file, "{end}{missing}").expect("a CSV file");
        Self { folder, name, part, file: Mutex::new(file) }
    }

    /// Returns the folder of the files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the rows of all finished cases of all parts, without their last ones.
    pub fn rows(&self) -> BTreeMap<u64, Vec<CaseRow>> {
        let mut rows: BTreeMap<u64, Vec<CaseRow>> = BTreeMap::new();
        let files = fs::read_dir(&self.folder).into_iter().flatten().flatten().map(|entry| entry.path());
        for path in files {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if !name.starts_with(&format!("{}-", self.name)) || !name.ends_with(".csv") {
                continue;
            }
            let mut open: BTreeMap<u64, Vec<CaseRow>> = BTreeMap::new();
            for row in fs::read_to_string(&path).unwrap_or_default().lines().filter_map(CaseRow::from_line) {
                let case = open.entry(row.number).or_default();
                if row.quantity == END {
                    rows.insert(row.number, std::mem::take(case));
                } else {
                    case.push(row);
                }
            }
        }
        rows
    }

    /// Returns those of these cases that are of this part, and in no file.
    pub fn missing(&self, numbers: Range<u64>) -> Vec<u64> {
        let known: BTreeSet<u64> = self.rows().into_keys().collect();
        let [part, parts] = self.part;
        numbers.filter(|number| number % parts == part && !known.contains(number)).collect()
    }

    /// Appends the rows of a case, and its last row with these times.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn append(&self, number: u64, name: &str, rows: &[CaseRow], seconds: &[f64]) {
        let end = CaseRow::new(number, name, END, seconds);
        let text: String = rows.iter().chain([&end]).map(CaseRow::to_line).collect();
        self.file.lock().expect("a file").write_all(text.as_bytes()).expect("a CSV file");
    }
}

/// Returns `f` of each item, in order, computed on all processors, or on one for a part of a campaign. (rayon is
/// unsuitable: its threads start other work while a run waits for its own.)
///
/// # Panics
/// If `f` does.
#[allow(clippy::unwrap_used, reason = "a panic of `f` is one of the test")]
pub fn each<T: Sync, R: Send>(all: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::new());
    let work = || {
        while let Some((number, one)) = {
            let number = next.fetch_add(1, Ordering::Relaxed);
            all.get(number).map(|one| (number, one))
        } {
            let result = f(one);
            found.lock().unwrap().push((number, result));
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = if part().is_some() { 1 } else { threads };
        (0..threads).for_each(|_| drop(scope.spawn(work)));
    });
    let mut found = found.into_inner().unwrap();
    found.sort_by_key(|(number, _)| *number);
    found.into_iter().map(|(_, one)| one).collect()
}
