//! Labels of keys and metrics: names in words, with units, for figures, tables, the page and Python.
//!
//! The words of a key come from its line in the grammar (`describe`), its unit from the ending of its name.
//! This file adds only what the place of a key in its scenario says: `of film layer 1`, `of the glass`.
//! Metrics have their labels in `papilio_display`.

use std::sync::OnceLock;

use papilio_display::{Label, label_from_name, metric_label, split_unit, uncapitalised};

use crate::describe::File;
use crate::describe::microgeometry::SurfaceFile;
use crate::page::tables;
use crate::path::KeyPath;
use crate::read::Table as _;
use crate::schema::Row;

/// What the items of lists, and tables whose keys need it, are called.
const PARTS: [(&str, &str); 22] = [
    ("display.pixel.film", "film layer"),
    ("display.pixel.substrate", "the substrate"),
    ("display.pixel.states", ""),
    ("display.pixel", ""),
    ("display.front", "front component"),
    ("display.diffuser", ""),
    ("display.glass.surface", "the glass surface"),
    ("display.glass", "the glass"),
    ("display.layers.film", "film"),
    ("display.layers", "layer"),
    ("lighting.directed", "directed source"),
    ("lighting.environment", "environment"),
    ("lighting.environment.regions", "region"),
    ("lighting.front_light", "the front light"),
    ("microgeometry.coating", "the facets"),
    ("sparkle", ""),
    ("image", "the picture"),
    ("optimize.variables", "variable"),
    ("optimize.constraints", "constraint"),
    ("optimize.objectives", "objective"),
    ("tolerance.keys", "tolerance"),
    ("fit.variables", "variable"),
];

/// Returns the label of a metric or of another number of a result (`white.Y`), or of a key of a scenario
/// (`display.pixel.film.1.thickness_nm`): the quantity in words, and its unit. A text that is neither is
/// returned as it is.
///
/// ```
/// use papilio_scenario::label;
///
/// assert_eq!(label("display.pixel.film.1.thickness_nm").to_string(), "Thickness of film layer 1 (nm)");
/// assert_eq!(label("viewer.theta_deg").to_string(), "Viewing angle (deg)");
/// assert_eq!(label("white.Y").to_string(), "Luminance factor Y of white");
/// ```
pub fn label(name: &str) -> Label {
    if let Some(rest) = name.strip_prefix("mean ") {
        let label = label(rest);
        return Label::new(format!("Mean of {}", uncapitalised(&label.quantity)), label.unit);
    }
    // Names of quantities in one of several views and conditions: "white.Y, view 1", "white.Y (indoor, view
    // 1)".
    let name = name.trim();
    let place = name.split_once(" (").map(|(name, place)| (name, place.trim_end_matches(')')));
    if let Some((name, place)) = place.or_else(|| name.split_once(", ")) {
        let label = label(name);
        return Label::new(format!("{}, {place}", label.quantity), label.unit);
    }
    let table = name.split_once('.').map_or("", |(table, _)| table);
    let is_key = File::rows().iter().chain(&SurfaceFile::rows()).any(|row| row.key == table);
    let found = if is_key { key_label(name) } else { metric_label(name).or_else(|| key_label(name)) };
    found.unwrap_or_else(|| Label::new(name, ""))
}

/// Returns the label of a variable of a study, by its name: the path of its key, or a name of the user's own,
/// which does not become the quantity of a key that happens to have the same name.
///
/// ```
/// use papilio_scenario::variable_label;
///
/// assert_eq!(variable_label("viewer.theta_deg").to_string(), "Viewing angle (deg)");
/// assert_eq!(variable_label("gap_nm").to_string(), "Gap (nm)");
/// assert_eq!(variable_label("n").to_string(), "n");
/// ```
pub fn variable_label(name: &str) -> Label {
    match name {
        path if path.contains('.') => label(path),
        // A letter is a symbol.
        letter if letter.chars().count() == 1 => Label::new(letter, ""),
        words => label_from_name(words),
    }
}

/// Returns the label of a key at a path; `None` for texts that are no paths.
fn key_label(path: &str) -> Option<Label> {
    let path = KeyPath::new(path);
    let keys: Vec<&str> = path.keys().collect();
    let is_plain = |key: &str| key.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    let is_key = |(number, key): (usize, &&str)| !key.is_empty() && (path.is_quoted(number) || is_plain(key));
    if keys.is_empty() || !keys.iter().enumerate().all(is_key) {
        return None;
    }
    if keys.len() == 1 {
        return of_any_table(keys[0]);
    }
    let known = Table::all();
    // The longest beginning that is a table, and the key in it; what follows are names of states, sub-pixels
    // and materials.
    let is_list = |at: usize| keys.len() > at + 2 && keys[at + 1].parse::<usize>().is_ok();
    let found = (1..keys.len()).rev().filter(|end| !is_list(*end)).find_map(|end| {
        let table = words(&keys[..end]);
        let row = known.iter().filter(|known| known.path == table).find_map(|known| known.label(keys[end]));
        Some((end, row?))
    });
    let (at, label) = found.unwrap_or_else(|| {
        let end = keys.len() - 1;
        (end, of_any_table(keys[end]).unwrap_or_else(|| label_from_name(keys[end])))
    });
    let (label, names) = with_names(label, &keys[..=at], &keys[at + 1..]);
    let named = names.iter().rev().fold(label, |label, name| label.of(name));
    let is_material = keys[at] == "substrate" && keys.len() > at + 1;
    let part = part_of(&keys[..at + usize::from(is_material)]);
    Some(part.map_or(named.clone(), |part| named.of(&part)))
}

/// Returns the label of a key with what follows it: another key (`gap_nm` of a state, `n` of a material)
/// replaces the quantity; the rest are names.
fn with_names(label: Label, keys: &[&str], rest: &[&str]) -> (Label, Vec<String>) {
    let mut label = label;
    let (key, table) = (keys.last().copied().unwrap_or_default(), words(keys));
    let of_table = |name: &str| {
        Table::all().iter().filter(|known| known.path == table).find_map(|known| known.label(name))
    };
    let mut names: Vec<String> = Vec::new();
    let is_material = MATERIALS.contains(&key);
    for (at, &name) in rest.iter().enumerate() {
        if is_material && name == "terms" && at + 1 < rest.len() {
            names.push(format!("term {}", rest[at + 1]));
            continue;
        }
        if let Some(inner) = of_model(name).filter(|_| is_material) {
            label = inner;
            continue;
        }
        let is_inner = matches!(name, "n" | "k" | "n_scale" | "k_scale") || !split_unit(name).1.is_empty();
        match of_table(name).or_else(|| of_any_table(name)).filter(|_| is_inner) {
            Some(inner) => label = inner,
            None if name.parse::<usize>().is_ok() => {}
            None => names.push(name.to_owned()),
        }
    }
    // States are described by the drive of their sub-pixels: the fraction of each in its own colour.
    if key == "states" && !names.is_empty() && label.quantity == "States" {
        label = Label::new("Driven fraction", "");
    }
    (label, names)
}

/// Keys whose values are materials.
const MATERIALS: [&str; 5] = ["material", "substrate", "index", "n_o", "n_e"];

/// Returns the label of a key of a model of dispersion.
fn of_model(key: &str) -> Option<Label> {
    let models =
        Table::all().iter().filter(|table| table.path == "material" || table.path == "material.terms");
    models.filter(|_| key != "n" && key != "k").find_map(|table| table.label(key))
}

/// Returns what the last list or table on the way to a key is called, with its index, counted from 0 as in keys.
fn part_of(keys: &[&str]) -> Option<String> {
    let mut found = None;
    for end in 1..=keys.len() {
        if keys[end - 1].parse::<usize>().is_ok() {
            continue;
        }
        let table = words(&keys[..end]);
        let Some((_, name)) = PARTS.iter().find(|(part, _)| *part == table) else { continue };
        let index = keys.get(end).and_then(|index| index.parse::<usize>().ok());
        let number = index.map_or_else(String::new, |index| format!(" {index}"));
        found = Some(format!("{name}{number}"));
    }
    found.filter(|name| !name.is_empty())
}

/// Joins keys to the path of a table, without indices.
fn words(keys: &[&str]) -> String {
    let keys: Vec<&str> = keys.iter().copied().filter(|key| key.parse::<usize>().is_err()).collect();
    keys.join(".")
}

/// A table of the grammar with its path, without indices.
struct Table {
    path: String,
    rows: Vec<Row>,
}

impl Table {
    /// All tables: `display.pixel film.film` is at `display.pixel.film`.
    fn all() -> &'static [Self] {
        static ALL: OnceLock<Vec<Table>> = OnceLock::new();
        let table = |(name, rows): (&str, Vec<Row>)| {
            let (path, kind) = name.split_once(' ').unwrap_or((name, ""));
            let inner = kind.split_once('.').map(|(_, inner)| format!(".{inner}")).unwrap_or_default();
            Self { path: format!("{path}{inner}"), rows }
        };
        ALL.get_or_init(|| tables().into_iter().map(table).collect())
    }

    fn label(&self, key: &str) -> Option<Label> {
        self.rows.iter().find(|row| row.key == key).map(Row::label)
    }
}

/// Returns the label of a key wherever it stands, if any table has it: tables with words of their own come
/// first.
fn of_any_table(key: &str) -> Option<Label> {
    let of_index = match key {
        "n" => "Refractive index n",
        "k" => "Extinction coefficient k",
        "n_scale" => "Factor of n",
        "k_scale" => "Factor of k",
        _ => "",
    };
    if !of_index.is_empty() {
        return Some(Label::new(of_index, ""));
    }
    let all: Vec<Label> = Table::all().iter().filter_map(|table| table.label(key)).collect();
    let plain = label_from_name(key);
    all.iter().find(|label| **label != plain).or(all.first()).cloned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_keys_say_quantity_unit_and_place() {
        for (path, expected) in [
            ("display.pixel.film.1.thickness_nm", "Thickness of film layer 1 (nm)"),
            ("display.pixel.film.0.material", "Material of film layer 0"),
            ("display.pixel.film.0.material.n", "Refractive index n of film layer 0"),
            ("display.pixel.film.0.material.n_scale", "Factor of n of film layer 0"),
            ("display.pixel.film.2.material.a", "Cauchy coefficient a of film layer 2"),
            ("display.pixel.film.2.material.b_um2", "Cauchy coefficient b of film layer 2 (µm²)"),
            ("display.pixel.film.0.material.terms.1.gap_ev", "Gap energy of term 1 of film layer 0 (eV)"),
            ("display.pixel.substrate.eps_inf", "High-energy permittivity of the substrate"),
            ("display.pixel.substrate", "Substrate"),
            ("display.pixel.substrate.k", "Extinction coefficient k of the substrate"),
            ("display.pixel.gap_nm.red", "Gap of red (nm)"),
            ("display.pixel.area.green", "Area fraction of green"),
            ("display.pixel.fill_factor", "Fill factor"),
            ("display.pixel.reflectance.white", "Reflectance of white"),
            ("display.pixel.states.teal.green.gap_nm", "Gap of green of teal (nm)"),
            ("display.pixel.stack.2.states.white.volts", "Voltage of white (V)"),
            ("display.pixel.stack.2.states.white.tilt_deg", "Tilt of white (deg)"),
            ("display.pixel.stack.2.pitch_um", "Natural pitch (µm)"),
            ("display.pixel.stack.2.K22_pN", "K22 (pN)"),
            ("display.diffuser.haze", "Haze"),
            ("display.diffuser.total_transmittance", "Total transmittance"),
            ("display.glass.thickness_mm", "Thickness of the glass (mm)"),
            ("display.glass.index", "Refractive index of the glass"),
            ("display.front.0.reflectance", "Reflectance of front component 0"),
            ("display.layers.2.haze", "Haze of layer 2"),
            ("display.layers.0.film.1.thickness_nm", "Thickness of film 1 (nm)"),
            ("microgeometry.coating.reflectance", "Reflectance of the facets"),
            ("microgeometry.azimuth_deg", "Steps of azimuth (deg)"),
            ("lighting.preset", "Lighting preset"),
            ("lighting.diffuse", "Diffuse fraction"),
            ("lighting.illuminance_lx", "Illuminance (lx)"),
            ("lighting.directed.0.theta_deg", "Inclination of directed source 0 (deg)"),
            ("lighting.directed.1.share", "Light fraction of directed source 1"),
            ("lighting.environment.0.sun_elevation_deg", "Sun elevation of environment 0 (deg)"),
            ("lighting.spectrum.daylight_K", "Colour temperature of daylight (K)"),
            ("viewer.theta_deg", "Viewing angle (deg)"),
            ("viewer.age_years", "Age of the reader (years)"),
            ("mean white.Y", "Mean of luminance factor Y of white"),
            ("white.luminance_cd_m2 (indoor, view 1)", "Luminance of white, indoor, view 1 (cd/m²)"),
            ("white.Y, view 1", "Luminance factor Y of white, view 1"),
            ("red from u'v' 0.4, 0.5", "red from u'v' 0.4, 0.5"),
            ("thickness_nm", "Thickness (nm)"),
        ] {
            assert_eq!(label(path).to_string(), expected, "{path}");
        }
    }

    /// Every key of the grammar has a label in words.
    #[test]
    fn every_key_has_a_label_in_words() {
        for table in Table::all() {
            for row in &table.rows {
                let path = format!("{}.0.{}", table.path, row.key);
                let label = label(&path).to_string();
                assert!(!label.contains('_') && !label.contains('.'), "{path}: {label}");
            }
        }
    }
}
