//! Lists of all metrics: names, units, definitions.

use std::collections::BTreeMap;
use std::fmt::Write;

use papilio_display::gloss::GlossMetrics;
use papilio_display::image::ImageMetrics;
use papilio_display::metric_label;
use papilio_display::result::{StateValues, ViewMetrics};
use papilio_display::scene::Metric;
use papilio_display::spatial::{CrosstalkMetrics, SharpnessMetrics, SparkleMetrics, SpatialScalars};
use schemars::schema_for;

use super::cell;

/// Names that differ in one or more words only, `{...}`, and what they all are: one row of a table.
const FAMILIES: [(&str, &str); 19] = [
    (
        "gamut_percent_{srgb,ebu,ntsc,dci_p3}",
        "Gamut area of the red, green and blue states in u'v', % of the standard's.",
    ),
    (
        "coverage_percent_{srgb,ebu,ntsc,dci_p3}",
        "Gamut coverage: fraction of the standard's triangle in u'v' that the display covers, %.",
    ),
    (
        "gamut_percent_{srgb,ebu,ntsc,dci_p3}_xy",
        "Gamut area in CIE 1931 xy, % of the standard's; of NTSC, the \"NTSC\" of data sheets.",
    ),
    ("coverage_percent_{srgb,ebu,ntsc,dci_p3}_xy", "Gamut coverage in CIE 1931 xy, %."),
    (
        "reading_surrogate_age_{20,50,75}",
        "Reading performance of a reader of this age in years, 0 to 1: a surrogate calibrated on Feng 2012, table 5.3; null outside its range.",
    ),
    ("{X,Y,Z}", "Relative tristimulus values; Y is the luminance factor."),
    ("{x,y}", "CIE 1931 chromaticity."),
    ("{u,v}_prime", "CIE 1976 u', v'."),
    ("{a,b}_star", "CIELAB a*, b*."),
    ("{u,v}_star", "CIELUV u*, v*, relative to the illuminant's white."),
    (
        "line_contrast_{white,black}_{1,2,4}_{x,y}",
        "Contrast of a line of this colour, of 1, 2 or 4 pixels, across x or y.",
    ),
    (
        "f50_{x,y}_per_mm",
        "Spatial frequency along x or y at which the modulation transfer is first 0.5, cycles per mm.",
    ),
    ("mtf_nyquist_{x,y}", "Modulation transfer along x or y at the Nyquist frequency of the pixels."),
    ("edge_10_90_{x,y}_um", "Width of an edge along x or y from 10 to 90 %, um."),
    ("r{50,90}_um", "Radius about the view's own ray with 50 or 90 % of the light, um."),
    ("sqri_jnd_{x,y}", "Square-root integral (Barten 1990) along x or y, just noticeable differences."),
    (
        "{patch,stripe_1,line_1,text}_gamut_percent_srgb",
        "Gamut area in u'v' of a uniform page, of stripes of one pixel, of a single line of one pixel and of text, % of sRGB.",
    ),
    (
        "{patch,stripe_1,line_1,text}_contrast_ratio",
        "Y of the white page over Y of the same figures in black.",
    ),
    (
        "{patch,stripe_1,line_1,text}_contrast_ratio_via_pixel",
        "The same without the images of the room in flat faces.",
    ),
];

/// The members of a family.
fn members(pattern: &str) -> Vec<String> {
    let Some((before, rest)) = pattern.split_once('{') else { return vec![pattern.to_owned()] };
    let (words, after) = rest.split_once('}').unwrap();
    let after = members(after);
    let of_word = |word: &str| after.iter().map(|end| format!("{before}{word}{end}")).collect::<Vec<_>>();
    words.split(',').flat_map(of_word).collect()
}

/// The family of a name among `names`, if they contain all of it: its pattern, what its members are, and
/// whether the name is the first.
fn family(name: &str, names: &[&str]) -> Option<(&'static str, &'static str, bool)> {
    let is_complete = |all: &[String]| all.iter().all(|member| names.contains(&member.as_str()));
    FAMILIES.into_iter().find_map(|(pattern, meaning)| {
        let all = members(pattern);
        let is_member = all.iter().any(|member| member == name) && is_complete(&all);
        let first = names.iter().find(|name| all.iter().any(|member| member == *name));
        is_member.then(|| (pattern, meaning, first == Some(&name)))
    })
}

/// Tables of metrics, by what computes them.
pub(super) fn tables() -> String {
    let documented = documented();
    let mut text = String::new();
    for source in [None, Some("mtf"), Some("crosstalk"), Some("sparkle"), Some("gloss"), Some("image")] {
        for is_of_view in [true, false] {
            let all: Vec<&str> = Metric::ALL
                .iter()
                .filter(|metric| metric.source().command() == source && metric.is_of_view() == is_of_view)
                .map(|metric| metric.name())
                .collect();
            if all.is_empty() {
                continue;
            }
            let command = source.unwrap_or("run");
            let what = if is_of_view { "metrics of a view" } else { "metrics of a state, as `white.NAME`" };
            let _ = writeln!(text, "\n### papilio {command}: {what}\n");
            for name in &all {
                match family(name, &all) {
                    Some((pattern, meaning, true)) => text += &row(pattern, &members(pattern), meaning),
                    Some(_) => {}
                    None => {
                        let meaning =
                            documented.get(*name).unwrap_or_else(|| panic!("`{name}` is not documented"));
                        text += &row(name, &[(*name).to_owned()], meaning);
                    }
                }
            }
        }
    }
    text
}

fn row(name: &str, members: &[String], meaning: &str) -> String {
    let unit = |name: &String| {
        // A metric of a state has its label there.
        let label = metric_label(name).unwrap_or_else(|| panic!("`{name}` has no label"));
        if label.unit.is_empty() { "1".to_owned() } else { label.unit.to_string() }
    };
    let units: Vec<String> = members.iter().map(unit).collect();
    let is_one = units.iter().all(|unit| *unit == units[0]);
    let unit = if is_one { &units[0] } else { "%" };
    let unit = if unit == "1" { String::new() } else { format!(" ({unit})") };
    format!("- `{name}`{unit}: {}\n", cell(meaning))
}

/// Documentation of all metrics, by name.
fn documented() -> BTreeMap<String, String> {
    let tables = [
        schema_for!(ViewMetrics),
        schema_for!(StateValues),
        schema_for!(SharpnessMetrics),
        schema_for!(SpatialScalars),
        schema_for!(CrosstalkMetrics),
        schema_for!(SparkleMetrics),
        schema_for!(GlossMetrics),
        schema_for!(ImageMetrics),
    ];
    let mut found = BTreeMap::new();
    for table in tables {
        for (name, field) in table.to_value()["properties"].as_object().into_iter().flatten() {
            let text = field["description"].as_str().unwrap_or_default().to_owned();
            found.insert(name.clone(), text);
        }
    }
    found
}
