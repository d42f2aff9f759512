//! The script `scene.py`, which renders the files of [`write_rgl`](super::write_rgl) with Mitsuba 3.

use super::display::BsdfSource;

const TEMPLATE: &str = include_str!("scene.py");

/// Place of the title in the template.
const TITLE: &str = "@TITLE@";

/// Returns the text of `scene.py`, which reads `display-mirror.json` and the files that it names.
pub fn scene_script(source: &BsdfSource<'_>) -> String {
    // A JSON string is also a string of Python.
    let title = serde_json::to_string(source.title).unwrap_or_else(|_| "\"\"".to_owned());
    TEMPLATE.replacen(TITLE, &title, 1)
}
