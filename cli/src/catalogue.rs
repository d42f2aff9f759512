//! `papilio materials` and `papilio illuminants`: lists of the named ones; the numbers and a figure of one.

use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_formats::write_file;
use papilio_scenario::Diagnostic;
use papilio_scenario::{
    IlluminantEntry, IlluminantSheet, LiquidCrystalEntry, MaterialEntry, MaterialSheet, illuminant_sheet,
    illuminants, liquid_crystals, material_sheet, materials, materials_called, materials_like,
};
use serde::Serialize;

use crate::arguments::Catalogue;
use crate::{Failure, output, print_message};

/// Wavelengths of the table on the terminal, nm.
const SHOWN_NM: [f64; 9] = [380.0, 400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 780.0];

/// Runs `papilio materials`.
pub(crate) fn list_materials(arguments: &Catalogue) -> Result<(), Failure> {
    let Some(name) = &arguments.name else {
        let (all, crystals) = (materials(), liquid_crystals());
        let other = ("liquid_crystals", serde_json::json!(crystals), crystal_rows(&crystals));
        return all_with(arguments, "materials", &all, &material_rows(&all), Some(other));
    };
    let crystals = crystals_like(name);
    match material_sheet(name) {
        Ok(sheet) => {
            let files = material_files(&sheet);
            one_of(arguments, "materials", &sheet, &sheet.entry.name, &material_text(&sheet), &files)
        }
        Err(unknown) => {
            let like = materials_like(name);
            let some: Vec<MaterialEntry> =
                materials().into_iter().filter(|entry| like.contains(&entry.name.as_str())).collect();
            let of_crystals = crystal_rows(&crystals);
            if some.is_empty() && crystals.is_empty() {
                return Err(failure(unknown));
            }
            if some.is_empty() {
                return all_of(arguments, "liquid_crystals", &crystals, &of_crystals);
            }
            if !materials_called(name).is_empty() {
                let hint = unknown.hint.unwrap_or_default();
                print_message(&format!("note: {}: {hint}", unknown.message));
            }
            let other = ("liquid_crystals", serde_json::json!(crystals), of_crystals);
            let other = Some(other).filter(|_| !crystals.is_empty());
            all_with(arguments, "materials", &some, &material_rows(&some), other)
        }
    }
}

/// Returns the liquid crystal of a name, or those whose description contains a word.
fn crystals_like(word: &str) -> Vec<LiquidCrystalEntry> {
    let word = word.to_lowercase();
    let is_like = |entry: &LiquidCrystalEntry| {
        entry.name.to_lowercase() == word || word.chars().count() > 2 && entry.what.contains(&word)
    };
    liquid_crystals().into_iter().filter(is_like).collect()
}

/// Runs `papilio illuminants`.
pub(crate) fn list_illuminants(arguments: &Catalogue) -> Result<(), Failure> {
    let Some(name) = &arguments.name else {
        let all = illuminants();
        return all_of(arguments, "illuminants", &all, &illuminant_rows(&all));
    };
    let sheet = match illuminant_sheet(name) {
        Ok(sheet) => sheet,
        Err(unknown) => {
            let word = name.to_lowercase();
            let like: Vec<IlluminantEntry> = illuminants()
                .into_iter()
                .filter(|entry| word.chars().count() > 2 && entry.what.to_lowercase().contains(&word))
                .collect();
            if like.is_empty() {
                return Err(failure(unknown));
            }
            return all_of(arguments, "illuminants", &like, &illuminant_rows(&like));
        }
    };
    let plain = |name: &str| name.to_lowercase().replace(['-', '_', ' '], "");
    if plain(name) != plain(&sheet.entry.name) {
        print_message(&format!("note: {name} is taken as {}", sheet.entry.name));
    }
    let files = illuminant_files(&sheet);
    one_of(arguments, "illuminants", &sheet, &sheet.entry.name, &illuminant_text(&sheet), &files)
}

fn failure(unknown: Diagnostic) -> Failure {
    let hint = unknown.hint.map_or_else(String::new, |hint| format!("\n  = help: {hint}"));
    Failure::Input(format!("{}{hint}", unknown.message))
}

/// A table: titles, then rows; the last column is text.
type Rows = Vec<Vec<String>>;

/// Prints a list, and writes it as CSV if `--out` is given.
fn all_of<T: Serialize>(
    arguments: &Catalogue,
    kind: &str,
    entries: &[T],
    rows: &Rows,
) -> Result<(), Failure> {
    all_with(arguments, kind, entries, rows, None)
}

/// Does the same with a second list below: its kind, entries and rows.
fn all_with<T: Serialize>(
    arguments: &Catalogue,
    kind: &str,
    entries: &[T],
    rows: &Rows,
    other: Option<(&str, serde_json::Value, Rows)>,
) -> Result<(), Failure> {
    let mut stdout = crate::terminal::stdout();
    if arguments.json {
        let mut all = serde_json::json!({ kind: entries });
        if let Some((kind, entries, _)) = &other {
            all[*kind] = entries.clone();
        }
        serde_json::to_writer_pretty(&mut stdout, &all).map_err(std::io::Error::from)?;
        writeln!(stdout)?;
    } else {
        stdout.write_all(aligned(rows).as_bytes())?;
        if let Some((_, _, rows)) = &other {
            write!(stdout, "\n{}", aligned(rows))?;
        }
        // A liquid crystal has no sheet of its own.
        if kind != "liquid_crystals" {
            let one = kind.trim_end_matches('s');
            writeln!(stdout, "\npapilio {kind} NAME: source, numbers and a figure of one {one}")?;
        }
    }
    stdout.flush()?;
    if let Some(folder) = &arguments.out {
        let mut files = vec![(format!("{kind}.csv"), csv(rows))];
        files.extend(other.map(|(kind, _, rows)| (format!("{kind}.csv"), csv(&rows))));
        write_all(folder, &files)?;
    }
    Ok(())
}

/// Prints one sheet, and writes its table and figure: to `out/KIND`, unless `--out` or `--json` is given.
fn one_of<T: Serialize>(
    arguments: &Catalogue,
    kind: &str,
    sheet: &T,
    name: &str,
    text: &str,
    [table, figure]: &[String; 2],
) -> Result<(), Failure> {
    let default = (!arguments.json).then(|| PathBuf::from("out").join(kind));
    let folder = arguments.out.clone().or(default);
    if let Some(folder) = &folder {
        output::check(folder)?;
    }
    let mut stdout = crate::terminal::stdout();
    if arguments.json {
        serde_json::to_writer_pretty(&mut stdout, sheet).map_err(std::io::Error::from)?;
        writeln!(stdout)?;
    } else {
        stdout.write_all(text.as_bytes())?;
    }
    stdout.flush()?;
    let file = name.replace(':', "-");
    folder.map_or(Ok(()), |folder| {
        write_all(&folder, &[(format!("{file}.csv"), table.clone()), (format!("{file}.svg"), figure.clone())])
    })
}

fn write_all(folder: &Path, files: &[(String, String)]) -> Result<(), Failure> {
    output::check(folder)?;
    output::make_folder(folder)?;
    for (name, text) in files {
        write_file(&folder.join(name), |out| out.write_all(text.as_bytes()))?;
    }
    output::print_written(folder, &files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
    Ok(())
}

/// A table with aligned columns: numbers to the right, first and last column to the left.
fn aligned(rows: &Rows) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |c: usize| rows.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (c, cell) in row.iter().enumerate() {
            let _ = match c {
                0 => write!(line, "{cell:<0$}", widths[c]),
                _ if c + 1 == columns => write!(line, "  {cell}"),
                _ => write!(line, "  {cell:>0$}", widths[c]),
            };
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn csv(rows: &Rows) -> String {
    let cell = |cell: &String| {
        if cell.contains([',', '"']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    rows.iter().map(|row| row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n").collect()
}

fn range(range: Option<[f64; 2]>) -> String {
    range.map_or("all".to_owned(), |[first, last]| format!("{first:.0} to {last:.0}"))
}

/// k, which may be very small: `2.3e-7`.
fn small(k: f64) -> String {
    if k == 0.0 || k >= 1e-3 { format!("{k:.4}") } else { format!("{k:.1e}") }
}

fn material_rows(entries: &[MaterialEntry]) -> Rows {
    let titles = ["name", "n (550 nm)", "k (550 nm)", "data (nm)", "what"].map(str::to_owned).to_vec();
    let row = |entry: &MaterialEntry| {
        let (n, k) = (format!("{:.4}", entry.n_550), small(entry.k_550));
        vec![entry.name.clone(), n, k, range(entry.measured_nm), entry.what.clone()]
    };
    std::iter::once(titles).chain(entries.iter().map(row)).collect()
}

fn crystal_rows(entries: &[LiquidCrystalEntry]) -> Rows {
    let titles = ["liquid crystal", "n_o (550 nm)", "n_e (550 nm)", "data (nm)", "what"];
    let row = |entry: &LiquidCrystalEntry| {
        let [n_o, n_e] = [entry.n_o_550, entry.n_e_550].map(|n| format!("{n:.4}"));
        let what = format!("{}: {}", entry.what, entry.source);
        vec![entry.name.clone(), n_o, n_e, range(Some(entry.measured_nm)), what]
    };
    std::iter::once(titles.map(str::to_owned).to_vec()).chain(entries.iter().map(row)).collect()
}

fn material_text(sheet: &MaterialSheet) -> String {
    let entry = &sheet.entry;
    let mut text = format!("{}: {}\n\nsource: {}\n", entry.name, entry.what, entry.source);
    if let (Some(page), Some(licence)) = (&entry.page, &entry.licence) {
        let _ = writeln!(text, "page: {page} ({licence})");
    }
    let _ = writeln!(text, "data: {} nm", range(entry.measured_nm));
    if entry.range_nm != entry.measured_nm {
        let _ = writeln!(
            text,
            "usable: {} nm (beyond the data a formula is continued, or the last value is used)",
            range(entry.range_nm)
        );
    }
    let titles = ["wavelength (nm)", "n", "k"].map(str::to_owned).to_vec();
    let at = |nm: &f64| {
        let i = sheet.wavelength_nm.iter().position(|known| known == nm)?;
        Some(vec![format!("{nm}"), format!("{:.4}", sheet.n[i]), small(sheet.k[i])])
    };
    let rows: Rows = std::iter::once(titles).chain(SHOWN_NM.iter().filter_map(at)).collect();
    let _ = write!(text, "\n{}", aligned(&rows));
    let base = entry.name.split(':').next().unwrap_or_default();
    let others: Vec<String> = materials()
        .into_iter()
        .map(|other| other.name)
        .filter(|name| *name != entry.name && name.split(':').next() == Some(base))
        .collect();
    if !others.is_empty() {
        let _ = writeln!(text, "\nother data: {}", others.join(", "));
    }
    text
}

fn material_files(sheet: &MaterialSheet) -> [String; 2] {
    let rows = sheet.wavelength_nm.iter().zip(sheet.n.iter().zip(&sheet.k));
    let table: String = rows.map(|(nm, (n, k))| format!("{nm},{n},{k}\n")).collect();
    let curve = |name: &str, group: usize, values: &[f64]| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(group),
        dashed: false,
        marks: false,
        points: sheet.wavelength_nm.iter().copied().zip(values.iter().copied()).collect(),
    };
    let figure = Chart {
        x: "Wavelength (nm)".to_owned(),
        y: "Refractive index n, extinction coefficient k".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves: vec![curve("n", 2, &sheet.n), curve("k", 0, &sheet.k)],
    };
    let title = format!("{}: {}", sheet.entry.name, sheet.entry.what);
    [format!("wavelength_nm,n,k\n{table}"), chart(&figure, &title)]
}

fn illuminant_rows(entries: &[IlluminantEntry]) -> Rows {
    let titles = ["name", "x", "y", "CCT (K)", "Duv", "Ra", "lm/W", "what"].map(str::to_owned).to_vec();
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let row = |entry: &IlluminantEntry| {
        vec![
            entry.name.clone(),
            format!("{:.4}", entry.x),
            format!("{:.4}", entry.y),
            or_dash(entry.cct_K.map(|cct| format!("{cct:.0}"))),
            or_dash(entry.duv.map(|duv| format!("{duv:.4}"))),
            or_dash(entry.Ra.map(|ra| format!("{ra:.0}"))),
            format!("{:.0}", entry.lm_per_W),
            entry.what.clone(),
        ]
    };
    std::iter::once(titles).chain(entries.iter().map(row)).collect()
}

fn illuminant_text(sheet: &IlluminantSheet) -> String {
    let entry = &sheet.entry;
    let mut text = format!("{}: {}\n\nsource: {}\n", entry.name, entry.what, entry.source);
    if let Some(step) = entry.table_step_nm {
        let _ = writeln!(text, "table: 380 to 780 nm, every {step} nm, linear between");
    }
    let _ = writeln!(
        text,
        "CIE 1931 x {:.5}, y {:.5}; CIE 1976 u' {:.5}, v' {:.5} (380 to 780 nm)",
        entry.x, entry.y, entry.u_prime, entry.v_prime
    );
    if let (Some(cct), Some(duv)) = (entry.cct_K, entry.duv) {
        let _ = writeln!(text, "correlated colour temperature {cct:.0} K, Duv {duv:.4}");
    }
    if let Some(ra) = entry.Ra {
        let _ = writeln!(text, "general colour rendering index Ra {ra:.1}");
    }
    let _ = writeln!(text, "luminous efficacy of the radiation {:.1} lm/W", entry.lm_per_W);
    text
}

fn illuminant_files(sheet: &IlluminantSheet) -> [String; 2] {
    let points: Vec<(f64, f64)> =
        sheet.wavelength_nm.iter().copied().zip(sheet.relative_power.iter().copied()).collect();
    let table: String = points.iter().map(|(nm, value)| format!("{nm},{value}\n")).collect();
    let curve = ChartCurve { name: String::new(), hue: Hue::Group(2), dashed: false, marks: false, points };
    let figure = Chart {
        x: "Wavelength (nm)".to_owned(),
        y: "Relative power per nm".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves: vec![curve],
    };
    let title = format!("{}: {}", sheet.entry.name, sheet.entry.what);
    [format!("wavelength_nm,relative_power\n{table}"), chart(&figure, &title)]
}
