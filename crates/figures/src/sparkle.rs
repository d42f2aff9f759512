//! Sparkle: the pixels below a random face as grey squares, and pixel power deviation against the parameters
//! of the face.

use papilio_display::spatial::{SparkleMap, SparkleResult, SparkleRow};

use crate::chart::{Chart, ChartCurve, Hue, chart};
use crate::style::{INK, fixed, with_error};
use crate::svg::{Stroke, Svg, Text, hex, shortened};

/// Maps in a figure, and pixels along the sides of a map.
const MAPS: usize = 4;
const SIDE: usize = 24;
/// Width of a map and of the space to the next, px.
const SIZE: f64 = 216.0;
const SPACE: f64 = 28.0;
/// Linear light of a pixel of mean light: a grey of CIE lightness 53 on the screen.
const MEAN: f64 = 0.214;

/// Returns all figures of `papilio sparkle` with their names: pixels below the faces, and the deviation
/// against a parameter of the face.
pub fn of_sparkle(result: &SparkleResult, title: &str) -> Vec<(String, String)> {
    let maps = ("sparkle".to_owned(), maps(result, title));
    [maps].into_iter().chain(curves(result, title).map(|svg| ("ppd".to_owned(), svg))).collect()
}

/// Draws pixels of equal state below random faces for up to four rows, which together have the smallest and
/// the largest deviation; light is relative to the mean, without the blur of the eye. A scale bar has the
/// length of ten pixels.
fn maps(result: &SparkleResult, title: &str) -> String {
    let shown = shown(result);
    let width = 40.0 + (SIZE + SPACE) * shown.len().max(2) as f64;
    let mut svg = Svg::new(width, SIZE + 104.0).titled(title);
    for (place, (row, map)) in shown.into_iter().enumerate() {
        let left = 24.0 + (SIZE + SPACE) * place as f64;
        draw(&mut svg, map, left);
        let name = format!("PPD {} %", with_error(100.0 * row.ppd, Some(100.0 * row.standard_error), 2));
        svg.text((left, SIZE + 34.0), &name, Text::new(13.0, INK).strong());
        let face =
            format!("correlation {} μm, gap {} mm", fixed(row.correlation_um, 1), fixed(row.gap_mm, 2));
        svg.text((left, SIZE + 51.0), &shortened(&face, SIZE, 12.0), Text::new(12.0, INK));
        let view = format!("view {} deg", fixed(row.theta_deg, 0));
        svg.text((left, SIZE + 67.0), &view, Text::new(12.0, INK));
        if place == 0 {
            let bar = 10.0 * SIZE / SIDE as f64;
            let y = SIZE + 84.0;
            svg.line((left, y), (left + bar, y), &Stroke::solid(INK, 2.0));
            let length = format!("10 pixels, {} μm", fixed(10.0 * result.pitch_um[0], 0));
            svg.text((left + bar + 8.0, y + 4.0), &length, Text::new(11.0, INK));
        }
    }
    svg.finish()
}

/// Rows between the smallest and the largest deviation.
fn shown(result: &SparkleResult) -> Vec<(&SparkleRow, &SparkleMap)> {
    let mut all: Vec<_> = result.rows.iter().zip(&result.maps).collect();
    if all.len() > MAPS {
        all.sort_by(|a, b| a.0.ppd.total_cmp(&b.0.ppd));
        let last = all.len() - 1;
        all = (0..MAPS).map(|k| all[(k * last) / (MAPS - 1)]).collect();
    }
    all
}

fn draw(svg: &mut Svg, map: &SparkleMap, left: f64) {
    let rows = map.values.len() / map.columns.max(1);
    let size = SIZE / SIDE as f64;
    for row in 0..rows.min(SIDE) {
        for column in 0..map.columns.min(SIDE) {
            let at = (left + column as f64 * size, 16.0 + (SIDE - 1 - row) as f64 * size);
            let grey = hex([encoded(MEAN * map.values[row * map.columns + column]); 3]);
            // A little larger than the pixel, so that no gaps are seen between neighbours.
            svg.rect(at, (size + 0.3, size + 0.3), 0.0, &grey, "none");
        }
    }
}

/// sRGB value of linear light.
fn encoded(linear: f64) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let encoded = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

/// Draws the deviation against the correlation length, or against the gap if only that varies; `None` if
/// there is nothing to compare. Circles are rays through random faces, lines the matrix term in closed form.
fn curves(result: &SparkleResult, title: &str) -> Option<String> {
    let by_length = varies(result, |row| row.correlation_um);
    if !by_length && !varies(result, |row| row.gap_mm) {
        return None;
    }
    let x = |row: &SparkleRow| if by_length { row.correlation_um } else { row.gap_mm };
    let same = |a: &SparkleRow, b: &SparkleRow| {
        (a.theta_deg, a.phi_deg) == (b.theta_deg, b.phi_deg) && (!by_length || a.gap_mm == b.gap_mm)
    };
    let mut curves = Vec::new();
    let is_single = result.rows.chunk_by(same).count() == 1;
    for (number, group) in result.rows.chunk_by(same).enumerate() {
        let first = &group[0];
        let [all, matrix] = match by_length {
            _ if is_single => ["all".to_owned(), "matrix term".to_owned()],
            true => {
                [String::new(), format!("{} mm, {}\u{b0}", fixed(first.gap_mm, 2), fixed(first.theta_deg, 0))]
            }
            false => [String::new(), format!("{}\u{b0}", fixed(first.theta_deg, 0))],
        };
        let mut curve = |name: String, marks: bool, points: Vec<(f64, f64)>| {
            curves.push(ChartCurve { name, hue: Hue::Group(number), dashed: false, marks, points });
        };
        curve(all, true, group.iter().map(|row| (x(row), 100.0 * row.ppd)).collect());
        let closed = |row: &SparkleRow| (x(row), row.ppd_closed_form.map_or(f64::NAN, |ppd| 100.0 * ppd));
        curve(matrix, false, group.iter().map(closed).collect());
    }
    let x =
        if by_length { "Correlation length of the face (μm)" } else { "Distance of face and pixels (mm)" };
    let y = "Pixel power deviation (%)";
    let figure = Chart { x: x.to_owned(), y: y.to_owned(), logarithmic: false, at_least: vec![0.0], curves };
    Some(chart(&figure, title))
}

/// True if a number differs between rows.
fn varies(result: &SparkleResult, of: impl Fn(&SparkleRow) -> f64) -> bool {
    result.rows.windows(2).any(|pair| of(&pair[0]) != of(&pair[1]))
}
