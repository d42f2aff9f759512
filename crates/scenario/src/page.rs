//! The lists of keys in `docs/scenario.md`, generated from the grammar.

use crate::describe::{
    File, Spectrum, crystal, diffuser, dispersion, display, environment, fit, image, layers, lighting,
    limits, matrix, measure, metrics, microgeometry, optimize, pattern, pixel, solver, sparkle, sweep,
    tolerance, viewer,
};
use crate::read::Table;
use crate::schema::{Default, Row, toml};

/// Begins the keys of a table in a page of documentation, and names the table.
const BEGIN: &str = "<!-- keys: ";
/// Begins the line that names the keys of other tables.
const ABOVE: &str = "As above: ";
/// Between the name of a table and those of others, separated by commas, whose keys it does not repeat.
const WITHOUT: &str = " without ";
/// Long phrases of messages, and the short ones of the values in the page.
const BRIEF: [(&str, &str); 16] = [
    (
        "the name of an illuminant, a spectrum file, { led_nm, width_nm }, or a list of such",
        "[a light](#the-spectrum-of-a-light)",
    ),
    ("a refractive index, { n, k }, a material or a file", "a material"),
    ("the name of a metric, as \"contrast_ratio\" or \"white.Y\"", "[a metric](metric-names.md)"),
    ("a number from 0 to 1, or a spectrum file", "a spectrum, 0 to 1"),
    ("a whole number from 0 to 9223372036854775807", "integer, 0 or more"),
    ("a whole number from ", "integer, "),
    ("a number from ", ""),
    ("a number above", "above"),
    (", at most ", " to "),
    ("a number", "number"),
    ("a list, each item ", "list: "),
    ("a table of names, each with ", "by name: "),
    ("a table; its keys depend on", "table by"),
    ("a table", "table"),
    ("true or false", "boolean"),
    ("a string", "string"),
];

/// Endings of keys that state a unit, and the unit of the value, which does not repeat it.
const UNITS: [(&str, &str); 9] = [
    ("_ev", " (eV)"),
    ("_nm", " (nm)"),
    ("_um", " (um)"),
    ("_mm", " (mm)"),
    ("_m", " (m)"),
    ("_deg", " (degrees)"),
    ("_lx", " (lx)"),
    ("_K", " (K)"),
    ("_years", " (years)"),
];

/// Every table of keys, by its name in the page.
#[rustfmt::skip]
pub(crate) fn tables() -> Vec<(&'static str, Vec<Row>)> {
    vec![
        ("scenario", File::rows()),
        ("spectrum", Spectrum::rows()),
        ("display", display::Display::rows()),
        ("display.front", display::FrontComponent::rows()),
        ("display.diffuser k-correlation", diffuser::KCorrelation::rows()),
        ("display.diffuser lambertian", diffuser::Lambertian::rows()),
        ("display.diffuser ward", diffuser::Ward::rows()),
        ("display.diffuser microgeometry", diffuser::FaceOfSurface::rows()),
        ("display.diffuser measured", diffuser::Measured::rows()),
        ("display.diffuser slab", diffuser::Slab::rows()),
        ("particles rayleigh", diffuser::Molecules::rows()),
        ("particles mie", diffuser::Spheres::rows()),
        ("display.diffuser.reflection", diffuser::Reflection::rows()),
        ("display.diffuser.reflection.below", diffuser::ReflectionBelow::rows()),
        ("display.glass", display::Glass::rows()),
        ("display.layers medium", layers::Medium::rows()),
        ("display.layers coating", layers::Coating::rows()),
        ("display.layers coating.film", layers::CoatingFilm::rows()),
        ("display.layers rough", layers::Rough::rows()),
        ("display.pixel film", pixel::FilmPixel::rows()),
        ("display.pixel film.film", pixel::FilmLayer::rows()),
        ("material cauchy", dispersion::Cauchy::rows()),
        ("material sellmeier", dispersion::Sellmeier::rows()),
        ("material sellmeier.terms", dispersion::SellmeierTermSpec::rows()),
        ("material oscillators", dispersion::Oscillators::rows()),
        ("material.terms lorentz", dispersion::Lorentz::rows()),
        ("material.terms drude", dispersion::Drude::rows()),
        ("material.terms gauss", dispersion::Gauss::rows()),
        ("material.terms tauc-lorentz", dispersion::TaucLorentz::rows()),
        ("display.pixel table", pixel::TablePixel::rows()),
        ("display.pixel uniform", pixel::UniformPixel::rows()),
        ("display.pixel measured", pixel::MeasuredPixel::rows()),
        ("display.pixel palette", pixel::PalettePixel::rows()),
        ("display.pixel liquid-crystal", crystal::CrystalPixel::rows()),
        ("display.pixel.stack polariser", crystal::Polariser::rows()),
        ("display.pixel.stack retarder", crystal::Retarder::rows()),
        ("display.pixel.stack cell", crystal::Cell::rows()),
        ("display.pixel.stack cell.states", crystal::UniformDirector::rows()),
        ("display.pixel.stack cholesteric", crystal::Cholesteric::rows()),
        ("display.pixel.stack film", crystal::IsotropicFilm::rows()),
        ("display.pixel.stack slab", crystal::Pane::rows()),
        ("display.pixel.measured_through", pixel::MeasuredThrough::rows()),
        ("display.matrix", matrix::Matrix::rows()),
        ("display.matrix.filter", matrix::Filter::rows()),
        ("lighting", lighting::Lighting::rows()),
        ("lighting.directed", lighting::Directed::rows()),
        ("lighting.directed.polarisation", lighting::LampPolarisation::rows()),
        ("lighting.environment ring", environment::Ring::rows()),
        ("lighting.environment cap", environment::Cap::rows()),
        ("lighting.environment profile", environment::Profile::rows()),
        ("lighting.environment sky", environment::Sky::rows()),
        ("lighting.environment map", environment::Map::rows()),
        ("lighting.environment map.regions", environment::Region::rows()),
        ("lighting.environment luminaire", environment::Luminaire::rows()),
        ("lighting.front_light", lighting::FrontLight::rows()),
        ("spectrum of a light", lighting::LightModel::rows()),
        ("viewer", viewer::Viewer::rows()),
        ("metrics", metrics::Metrics::rows()),
        ("metrics.appearance", metrics::Appearance::rows()),
        ("solver", solver::Solver::rows()),
        ("solver.target", solver::Target::rows()),
        ("measure", measure::Measure::rows()),
        ("pattern", pattern::Pattern::rows()),
        ("sparkle", sparkle::Sparkle::rows()),
        ("image", image::Image::rows()),
        ("surface", microgeometry::SurfaceFile::rows()),
        ("microgeometry flat", microgeometry::Flat::rows()),
        ("microgeometry caps", microgeometry::Caps::rows()),
        ("microgeometry height-map", microgeometry::HeightMap::rows()),
        ("microgeometry gaussian", microgeometry::Gaussian::rows()),
        ("microgeometry exponential", microgeometry::Exponential::rows()),
        ("microgeometry psd", microgeometry::Psd::rows()),
        ("microgeometry mesh", microgeometry::Mesh::rows()),
        ("microgeometry volume", microgeometry::Volume::rows()),
        ("microgeometry.coating mirror", microgeometry::MirrorCoating::rows()),
        ("microgeometry.coating metal", microgeometry::MetalCoating::rows()),
        ("microgeometry.coating film", microgeometry::FilmCoating::rows()),
        ("sweep", sweep::Sweep::rows()),
        ("optimize", optimize::Optimize::rows()),
        ("optimize.variables", optimize::Variable::rows()),
        ("optimize.conditions", optimize::Condition::rows()),
        ("optimize.objectives", optimize::Objective::rows()),
        ("optimize.constraints", optimize::Constraint::rows()),
        ("tolerance", tolerance::Tolerance::rows()),
        ("tolerance.keys", tolerance::Scattered::rows()),
        ("tolerance.keys normal", tolerance::Normal::rows()),
        ("tolerance.keys lognormal", tolerance::LogNormal::rows()),
        ("tolerance.keys uniform", tolerance::Uniform::rows()),
        ("tolerance.keys triangular", tolerance::Triangular::rows()),
        ("tolerance.keys choices", tolerance::Bins::rows()),
        ("tolerance.correlations", tolerance::Correlated::rows()),
        ("tolerance.limits", limits::Limit::rows()),
        ("fit", fit::Fit::rows()),
        ("fit.variables", fit::FitVariable::rows()),
        ("fit.variables.prior", fit::Prior::rows()),
    ]
}

/// Returns a page of documentation with the keys of the grammar: the list below `<!-- keys: NAME -->` is
/// replaced. `<!-- keys: NAME without OTHER, ... -->` names only the keys that one of the other tables has, too.
///
/// # Errors
/// If a table is unknown, or is missing in the page.
///
/// ```
/// let page = "# Appearance\n\n<!-- keys: metrics.appearance -->\n";
/// assert!(papilio_scenario::with_key_tables(page).unwrap_err().contains("lacks the table `scenario`"));
/// ```
pub fn with_key_tables(page: &str) -> Result<String, String> {
    let tables = tables();
    let (mut made, mut rest) = (String::new(), page);
    let mut seen = Vec::new();
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let (name, after) = after.split_once(" -->").ok_or("a marker has no end")?;
        let is_old =
            |line: &&str| line.trim().is_empty() || line.starts_with("- `") || line.starts_with(ABOVE);
        let old: usize = after.split_inclusive('\n').take_while(is_old).map(str::len).sum();
        let after = &after[old..];
        let lines = |name: &str| {
            let table = tables.iter().find(|(known, _)| *known == name);
            table
                .map(|(_, rows)| rows.iter().map(line).collect())
                .ok_or_else(|| format!("there is no table `{name}`"))
        };
        let (of, others) = name.split_once(WITHOUT).unwrap_or((name, ""));
        let others = others.split(", ").filter(|other| !other.is_empty());
        let shared = others.map(&lines).collect::<Result<Vec<Vec<String>>, _>>()?.concat();
        let (same, own): (Vec<String>, Vec<String>) =
            lines(of)?.into_iter().partition(|line| shared.contains(line));
        let same: Vec<&str> = same.iter().filter_map(|line| line.split('`').nth(1)).collect();
        let same = match same.as_slice() {
            [] => String::new(),
            // A whole table of many keys, from its first one to its last one.
            [first, .., last] if same.len() == shared.len() && same.len() > 5 => {
                format!("\n{ABOVE}`{first}` to `{last}`.\n")
            }
            keys => format!("\n{ABOVE}`{}`.\n", keys.join("`, `")),
        };
        seen.push(of);
        let head = if own.is_empty() { "" } else { "\n" };
        let gap = if after.is_empty() { "" } else { "\n" };
        made += &format!("{before}{BEGIN}{name} -->\n{head}{}{same}{gap}", own.concat());
        rest = after;
    }
    match tables.iter().find(|(name, _)| !seen.contains(name)) {
        Some((name, _)) => Err(format!("the page lacks the table `{name}`")),
        None => Ok(made + rest),
    }
}

/// An entry of a list of keys in Markdown: key, value, default, meaning.
fn line(row: &Row) -> String {
    let default = match &row.default {
        Default::Required => "required".to_owned(),
        Default::Value(value, None) => format!("`{}`", toml(value)),
        // The meaning of an empty list or table says more than its value.
        Default::Value(value, Some(words)) if matches!(toml(value).as_str(), "[]" | "{}") => words.clone(),
        Default::Value(value, Some(words)) => format!("`{}`, {words}", toml(value)),
        Default::Words(words) => words.clone(),
    };
    let value = BRIEF.iter().fold((row.on_page)(), |text, (long, brief)| text.replace(long, brief));
    let unit = UNITS.iter().find(|(ending, _)| row.key.ends_with(ending));
    let value = match unit {
        Some((_, unit)) => value.replace(unit, ""),
        None => value,
    };
    // Choices that have a meaning each stand after the meaning of the key.
    let (value, choices) = match value.find('`').filter(|_| value.contains("`: ")) {
        Some(start) => (value[..start].trim_end_matches(": ").to_owned(), format!(" {}.", &value[start..])),
        None => (without_brackets(value), String::new()),
    };
    let default = if default == "none" { String::new() } else { default };
    let brief: Vec<String> = [value, default].into_iter().filter(|text| !text.is_empty()).collect();
    let brief = brief.join("; ");
    let brief = if brief.is_empty() { brief } else { format!(" ({brief})") };
    format!("- `{}`{brief}: {}{choices}\n", row.key, row.doc)
}

/// A value without the brackets about its unit: the page has brackets about the value.
fn without_brackets(mut value: String) -> String {
    while let Some((number, rest)) = value.split_once(" (") {
        let (unit, rest) = rest.split_once(')').unwrap_or((rest, ""));
        value = format!("{number}, {unit}{rest}");
    }
    value
}
