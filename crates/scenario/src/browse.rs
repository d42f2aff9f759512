//! The named materials and illuminants, described for people: lists, and a sheet with the numbers of one.

use papilio_colour::{LUMENS_PER_WATT, Observer, colour_temperature, rendering_index};
use papilio_diagnostics::Diagnostic;
use papilio_spectra::{
    Dispersion, Grid, IlluminantInfo, LIQUID_CRYSTAL_RANGE_NM, MaterialInfo, Spectrum, illuminant,
    illuminant_info, illuminant_name, illuminant_names, liquid_crystal, liquid_crystal_names, material,
    material_info, material_names, materials_called,
};
use schemars::JsonSchema;
use serde::Serialize;

use crate::mistake;

/// Licence of the refractiveindex.info database.
const DATABASE_LICENCE: &str = "refractiveindex.info database, CC0 1.0";
/// Wavelength at which lists state n and k, nm.
const LISTED_NM: f64 = 550.0;
/// Range of the numbers of a sheet, nm.
const DRAWN_NM: (f64, f64) = (300.0, 1100.0);
const DRAWN_STEP_NM: f64 = 5.0;

/// A named material.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MaterialEntry {
    /// Name in scenarios.
    pub name: String,
    /// Substance and sample.
    pub what: String,
    /// Authors and publication.
    pub source: String,
    /// Page of the refractiveindex.info database; null for other sources.
    pub page: Option<String>,
    /// Licence of the numbers; null for constants and models from publications.
    pub licence: Option<String>,
    /// First and last wavelength of the data, nm; null for a constant.
    pub measured_nm: Option<[f64; 2]>,
    /// First and last wavelength that may be used, nm; null for a constant.
    pub range_nm: Option<[f64; 2]>,
    /// n at 550 nm.
    pub n_550: f64,
    /// k at 550 nm.
    pub k_550: f64,
}

/// A named material with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MaterialSheet {
    /// The material.
    #[serde(flatten)]
    pub entry: MaterialEntry,
    /// Wavelengths, nm: every 5 nm of its range within 300 to 1100 nm.
    pub wavelength_nm: Vec<f64>,
    /// Refractive index at each of them.
    pub n: Vec<f64>,
    /// Extinction coefficient at each of them.
    pub k: Vec<f64>,
}

/// A named liquid crystal.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LiquidCrystalEntry {
    /// Name in scenarios.
    pub name: String,
    /// Kind and temperature.
    pub what: String,
    /// Authors and publication.
    pub source: String,
    /// Licence of the numbers.
    pub licence: String,
    /// First and last wavelength of the data, nm; the formula is used beyond, with a note.
    pub measured_nm: [f64; 2],
    /// Ordinary index at 550 nm.
    pub n_o_550: f64,
    /// Extraordinary index at 550 nm.
    pub n_e_550: f64,
}

/// A CIE illuminant.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own symbols: K, Ra")]
pub struct IlluminantEntry {
    /// Name in the spelling of the CIE.
    pub name: String,
    /// The lamp or light.
    pub what: String,
    /// Publication.
    pub source: String,
    /// Step of its table, nm; null for equal energy.
    pub table_step_nm: Option<u32>,
    /// CIE 1931 x, from 380 to 780 nm.
    pub x: f64,
    /// CIE 1931 y.
    pub y: f64,
    /// CIE 1976 u'.
    pub u_prime: f64,
    /// CIE 1976 v'.
    pub v_prime: f64,
    /// Correlated colour temperature, K; null farther than 0.05 in CIE 1960 u, v from all black bodies.
    pub cct_K: Option<f64>,
    /// Distance from the black body of this temperature in CIE 1960 u, v; positive: greenish.
    pub duv: Option<f64>,
    /// General colour rendering index (CIE 13.3-1995).
    pub Ra: Option<f64>,
    /// Luminous efficacy of the radiation between 380 and 780 nm, lm/W.
    pub lm_per_W: f64,
}

/// A CIE illuminant with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct IlluminantSheet {
    /// The illuminant.
    #[serde(flatten)]
    pub entry: IlluminantEntry,
    /// Wavelengths, nm: those of its table.
    pub wavelength_nm: Vec<f64>,
    /// Relative power at each of them, per nm.
    pub relative_power: Vec<f64>,
}

/// Returns all named materials in alphabetical order.
pub fn materials() -> Vec<MaterialEntry> {
    let infos = material_names().iter().filter_map(|name| material_info(name).ok());
    let entries = infos.filter_map(|info| Some(material_entry(&info, &material(info.name).ok()?)));
    let mut entries: Vec<MaterialEntry> = entries.collect();
    entries.sort_by_cached_key(|entry| entry.name.to_lowercase());
    entries
}

/// Returns all named liquid crystals.
pub fn liquid_crystals() -> Vec<LiquidCrystalEntry> {
    let entry = |name: &str| {
        let [n_o_550, n_e_550] = liquid_crystal(name)?.indices(LISTED_NM);
        let (first, last) = LIQUID_CRYSTAL_RANGE_NM;
        Some(LiquidCrystalEntry {
            name: name.to_owned(),
            what: "nematic liquid crystal at 25 deg C".to_owned(),
            source: "J. Li, C. H. Wen, S. Gauza, R. Lu, S. T. Wu, J. Disp. Technol. 1, 51-61 (2005)"
                .to_owned(),
            licence: DATABASE_LICENCE.to_owned(),
            measured_nm: [first, last],
            n_o_550,
            n_e_550,
        })
    };
    liquid_crystal_names().filter_map(entry).collect()
}

/// Returns the material of this name, with its numbers.
///
/// # Errors
/// For an unknown name, with names that were probably meant.
pub fn material_sheet(name: &str) -> Result<MaterialSheet, Diagnostic> {
    let unknown = || mistake::unknown_material_name(name);
    let name = material_names().iter().find(|known| known.eq_ignore_ascii_case(name)).ok_or_else(unknown)?;
    let (info, dispersion) = (material_info(name), material(name));
    let (info, dispersion) = (info.map_err(|_| unknown())?, dispersion.map_err(|_| unknown())?);
    let (first, last) = dispersion.range_nm();
    let first = (first.max(DRAWN_NM.0) / DRAWN_STEP_NM).ceil() * DRAWN_STEP_NM;
    let last = (last.min(DRAWN_NM.1) / DRAWN_STEP_NM).floor() * DRAWN_STEP_NM;
    let steps = ((last - first) / DRAWN_STEP_NM) as u32;
    let wavelength_nm: Vec<f64> = (0..=steps).map(|i| first + DRAWN_STEP_NM * f64::from(i)).collect();
    let index: Vec<_> = wavelength_nm.iter().filter_map(|nm| dispersion.index(*nm).ok()).collect();
    Ok(MaterialSheet {
        entry: material_entry(&info, &dispersion),
        n: index.iter().map(|index| index.re).collect(),
        k: index.iter().map(|index| index.im).collect(),
        wavelength_nm,
    })
}

/// Returns the names of the materials that a word describes, or whose name or description contains it.
pub fn materials_like(word: &str) -> Vec<&'static str> {
    let called = materials_called(word);
    if !called.is_empty() {
        return called;
    }
    let word = word.to_lowercase();
    let has_word = |name: &&&str| {
        let what = material_info(name).map_or("", |info| info.what);
        name.to_lowercase().contains(&word) || what.to_lowercase().contains(&word)
    };
    material_names().iter().filter(has_word).copied().collect()
}

/// Returns all CIE illuminants.
pub fn illuminants() -> Vec<IlluminantEntry> {
    let infos = illuminant_names().iter().filter_map(|name| illuminant_info(name));
    infos.filter_map(illuminant_entry).collect()
}

/// Returns the illuminant of this name or alias, with its table.
///
/// # Errors
/// For an unknown name, with names that were probably meant.
pub fn illuminant_sheet(name: &str) -> Result<IlluminantSheet, Diagnostic> {
    let unknown = || mistake::unknown_light_name(name);
    let info = illuminant_name(name).and_then(illuminant_info).ok_or_else(unknown)?;
    let grid = table_grid(info).ok_or_else(unknown)?;
    Ok(IlluminantSheet {
        entry: illuminant_entry(info).ok_or_else(unknown)?,
        wavelength_nm: grid.wavelengths_nm(),
        relative_power: illuminant(info.name, &grid).map_err(|_| unknown())?.to_vec(),
    })
}

/// Replaces the tables of materials, illuminants and old names in a page of documentation: the text between `<!-- materials -->`
/// and `<!-- end of materials -->`, and the same of `illuminants` and `old names`. `None` if an end is missing.
pub fn with_catalogue_tables(page: &str) -> Option<String> {
    let mut page = page.to_owned();
    let tables = [
        ("materials", material_table()),
        ("illuminants", illuminant_table()),
        ("old names", crate::renamed::table()),
    ];
    for (kind, table) in tables {
        let (begin, end) = (format!("<!-- {kind} -->\n"), format!("<!-- end of {kind} -->"));
        if let Some((before, rest)) = page.split_once(&begin) {
            let (_, after) = rest.split_once(&end)?;
            page = format!("{before}{begin}{table}{end}{after}");
        }
    }
    Some(page)
}

fn material_table() -> String {
    let line = |entry: MaterialEntry| {
        let k = if entry.k_550 >= 5e-4 { format!(", {:.3}", entry.k_550) } else { String::new() };
        format!("- `{}`: {:.3}{k}; {}\n", entry.name, entry.n_550, entry.what)
    };
    materials().into_iter().map(line).collect()
}

fn illuminant_table() -> String {
    let mut text = String::new();
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.0}"));
    // Neighbours with the same description share an item.
    for same in illuminants().chunk_by(|one, next| one.what == next.what) {
        let joined = |cell: &dyn Fn(&IlluminantEntry) -> String| -> String {
            same.iter().map(cell).collect::<Vec<_>>().join(", ")
        };
        let names = joined(&|entry| format!("`{}`", entry.name));
        let (cct, ra) = (joined(&|entry| number(entry.cct_K)), joined(&|entry| number(entry.Ra)));
        text += &format!("- {names}: {cct} K, Ra {ra}; {}\n", same[0].what);
    }
    text
}

fn table_grid(info: IlluminantInfo) -> Option<Grid> {
    Grid::new(380.0, 780.0, f64::from(info.step_nm.max(1))).ok()
}

fn material_entry(info: &MaterialInfo, dispersion: &Dispersion) -> MaterialEntry {
    let index = dispersion.index(LISTED_NM).ok();
    let range = |(first, last): (f64, f64)| last.is_finite().then_some([first, last]);
    MaterialEntry {
        name: info.name.to_owned(),
        what: info.what.to_owned(),
        source: info.source.to_owned(),
        page: info.page.map(str::to_owned),
        licence: info.page.map(|_| DATABASE_LICENCE.to_owned()),
        measured_nm: range(info.measured_nm),
        range_nm: range(info.range_nm),
        n_550: index.map_or(f64::NAN, |index| index.re),
        k_550: index.map_or(f64::NAN, |index| index.im),
    }
}

fn illuminant_entry(info: IlluminantInfo) -> Option<IlluminantEntry> {
    let grid = Grid::new(380.0, 780.0, 1.0).ok()?;
    let light: Spectrum = illuminant(info.name, &grid).ok()?;
    let xyz = Observer::new(&grid).ok()?.xyz(&light);
    let (xy, uv) = (xyz.chromaticity()?, xyz.uv_prime()?);
    let temperature = colour_temperature(&light, &grid);
    Some(IlluminantEntry {
        name: info.name.to_owned(),
        what: info.what.to_owned(),
        source: info.source.to_owned(),
        table_step_nm: (info.step_nm > 0).then_some(info.step_nm),
        x: xy.x,
        y: xy.y,
        u_prime: uv.u,
        v_prime: uv.v,
        cct_K: temperature.map(|t| t.cct_k),
        duv: temperature.map(|t| t.duv),
        Ra: rendering_index(&light, &grid),
        lm_per_W: LUMENS_PER_WATT * xyz.y / light.iter().sum::<f64>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_an_entry_and_a_sheet() {
        let materials = materials();
        assert_eq!(materials.len(), material_names().len());
        for entry in materials {
            let sheet = material_sheet(&entry.name).unwrap();
            assert_eq!(
                (sheet.n.len(), sheet.k.len()),
                (sheet.wavelength_nm.len(), sheet.wavelength_nm.len())
            );
            let at = sheet.wavelength_nm.iter().position(|nm| *nm == 550.0).unwrap();
            assert_eq!((sheet.n[at], sheet.k[at]), (entry.n_550, entry.k_550), "{}", entry.name);
            assert_eq!(sheet.entry, entry);
        }
        let illuminants = illuminants();
        assert_eq!(illuminants.len(), illuminant_names().len());
        for entry in illuminants {
            let sheet = illuminant_sheet(&entry.name).unwrap();
            assert_eq!(sheet.relative_power.len(), sheet.wavelength_nm.len());
            assert_eq!(sheet.entry, entry);
        }
    }

    #[test]
    fn sheets_are_found_by_other_spellings_and_words() {
        assert_eq!(material_sheet("tio2").unwrap().entry.name, "TiO2");
        assert_eq!(illuminant_sheet("tl84").unwrap().entry.name, "FL11");
        let oxides = materials_like("oxide");
        assert!(
            ["ITO", "TiO2", "Ta2O5", "SiO", "AlOx"].iter().all(|name| oxides.contains(name)),
            "{oxides:?}"
        );
        assert!(!oxides.contains(&"MgF2"));
        assert_eq!(materials_like("Aluminum"), ["Al", "Al:BB", "Al:McPeak"]);
        assert!(materials_like("unobtainium").is_empty());
        let hint = |error: Diagnostic| error.hint.unwrap_or_default();
        assert!(hint(material_sheet("Aluminium").unwrap_err()).contains("`Al`"));
        assert!(hint(illuminant_sheet("D93").unwrap_err()).contains("daylight_K = 9305"));
    }
}
