//! Zygo XYZ of MetroPro and Mx: a header of 13 lines, a line `#`, lines `column row height` or
//! `column row No Data`, and a line `#`.
//!
//! Heights are in um by rows from the top; the distance of pixels, CameraRes, is in m. The other numbers of
//! the header are about the interferogram, from which these heights were computed.

use super::table::Source;
use super::{HeightFile, UM, damaged, sized};
use crate::error::FormatError;

pub(super) const WORDS: &str = "Zygo XYZ Data File";

/// Lines of the header with the rectangle of the heights and with the scales, from 0, and the place of
/// CameraRes among these.
const RECTANGLE: usize = 3;
const SCALES: usize = 7;
const CAMERA_RES: usize = 6;

pub(super) fn is_zygo(text: &str) -> bool {
    text.trim_start().starts_with(WORDS)
}

/// Reads the heights.
pub(super) fn read(source: &Source<'_>) -> Result<HeightFile, FormatError> {
    let wrong = |what: String| source.whole(damaged("Zygo XYZ", what));
    let mut lines = source.text.lines();
    let head: Vec<&str> = lines.by_ref().take_while(|line| line.trim() != "#").collect();
    let numbers = |line: usize| -> Vec<f64> {
        let words = head.get(line).map_or("", |line| line).split_whitespace();
        words.map(|word| word.parse().unwrap_or(f64::NAN)).collect()
    };
    let [left, top, columns, rows, ..] = numbers(RECTANGLE)[..] else {
        return Err(wrong("line 4 does not state the rectangle of the heights".to_owned()));
    };
    let is_count = |number: f64| number.fract() == 0.0 && (0.0..1e9).contains(&number);
    if !(is_count(columns) && is_count(rows)) {
        return Err(wrong(format!("line 4 states {columns} x {rows} heights")));
    }
    let columns = columns as usize;
    let count = sized(columns, rows as usize).map_err(|problem| source.whole(problem))?;
    let camera_res_m = numbers(SCALES).get(CAMERA_RES).copied().filter(|res| res.is_finite() && *res > 0.0);
    let mut heights = vec![f64::NAN; count];
    for line in lines.take_while(|line| line.trim() != "#").filter(|line| !line.trim().is_empty()) {
        let mut words = line.split_whitespace();
        let mut place = |first: f64| words.next()?.parse::<f64>().ok().map(|place| place - first);
        let place = [place(left), place(top)];
        let rest = words.next().unwrap_or("");
        let at = match place {
            [Some(x), Some(y)] if is_count(x) && is_count(y) && (x as usize) < columns => {
                y as usize * columns + x as usize
            }
            _ => {
                return Err(wrong(format!(
                    "`{}` is no place within the rectangle",
                    super::header::shown(line)
                )));
            }
        };
        let height = if rest.eq_ignore_ascii_case("no") { Some(f64::NAN) } else { rest.parse::<f64>().ok() };
        match (heights.get_mut(at), height) {
            (Some(to), Some(height)) => *to = height,
            _ => {
                return Err(wrong(format!(
                    "`{}` is no height within the rectangle",
                    super::header::shown(line)
                )));
            }
        }
    }
    let mut map = HeightFile::plain(columns, heights).upside_down();
    map.unit_um = Some(1.0);
    map.pitch_um = camera_res_m.map(|res| [UM * res; 2]);
    Ok(map)
}
