//! Names of files that are named by a state, a metric or a room.

/// Returns the name of a file for each name: `start`, the name, and `end`.
///
/// Users may choose any names. Hyphens replace all characters but letters, digits, `-`, `_` and `.`, and a name that an earlier
/// file has, perhaps in other case, gets a number.
///
/// ```
/// use papilio_figures::file_names;
///
/// let names = file_names(["white", "a/b", "a-b", "A-B"], "kernel-", ".npy");
/// assert_eq!(names, ["kernel-white.npy", "kernel-a-b.npy", "kernel-a-b-2.npy", "kernel-A-B-3.npy"]);
/// ```
pub fn file_names<'a>(names: impl IntoIterator<Item = &'a str>, start: &str, end: &str) -> Vec<String> {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    let mut all: Vec<String> = Vec::new();
    // File systems may ignore case.
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let stem: String = name.chars().map(plain).collect();
        let mut file = format!("{start}{stem}{end}");
        let mut number = 2;
        while taken.contains(&file.to_lowercase()) {
            file = format!("{start}{stem}-{number}{end}");
            number += 1;
        }
        taken.push(file.to_lowercase());
        all.push(file);
    }
    all
}
