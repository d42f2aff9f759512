//! The reader of tables: names and units of columns, their order, separators, decimal marks, encodings; files
//! of instruments.

use papilio_formats::{
    DataFile, FormatError, PaletteTable, Problem, read_bsdf_file, read_density, read_fractions,
    read_fractions_with_notes, read_index, read_light, read_light_with_notes, read_measured_panel,
    read_palette, read_pixel_table, read_profile, read_spectrum, read_windows,
};
use papilio_goniometry::ScatterMode;
use papilio_testing::{Dice, laws};

fn file(text: impl AsRef<[u8]>) -> DataFile {
    DataFile { name: "data.csv".to_owned(), bytes: text.as_ref().to_vec() }
}

fn close(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-12 * one.abs().max(other.abs())
}

/// How a text file is written.
#[derive(Debug)]
struct Style {
    /// Order of the columns.
    order: Vec<usize>,
    separator: &'static str,
    decimal_comma: bool,
    encoding: usize,
    line_end: &'static str,
    quotes: bool,
    comment: bool,
    title: bool,
}

impl Style {
    fn any(dice: &mut Dice, columns: usize) -> Self {
        let mut order: Vec<usize> = (0..columns).collect();
        for k in (1..columns).rev() {
            order.swap(k, dice.below(k + 1));
        }
        let (separator, decimal_comma) = [
            (",", false),
            (";", false),
            (";", true),
            ("\t", true),
            ("\t", false),
            (" ; ", true),
            (", ", false),
        ][dice.below(7)];
        Self {
            order,
            separator,
            decimal_comma,
            encoding: dice.below(5),
            line_end: ["\n", "\r\n", "\r"][dice.below(3)],
            quotes: dice.below(3) == 0,
            comment: dice.below(2) == 0,
            title: dice.below(4) == 0,
        }
    }

    /// Writes the rows, of which the first holds the names.
    fn write(&self, rows: &[Vec<String>]) -> DataFile {
        let cell = |row: usize, text: &str| {
            let is_number = row > 0 && text.parse::<f64>().is_ok();
            let text = if is_number && self.decimal_comma { text.replace('.', ",") } else { text.to_owned() };
            // A decimal comma in a column is only one if others are not separated by commas.
            if self.quotes { format!("\"{text}\"") } else { text }
        };
        let mut text = String::new();
        if self.comment {
            text += &format!("# measured at 20 \u{b0}C, n, k{}", self.line_end);
        }
        if self.title {
            text += &format!("Report of the laboratory{}", self.line_end);
        }
        for (k, row) in rows.iter().enumerate() {
            let cells: Vec<String> = self.order.iter().map(|column| cell(k, &row[*column])).collect();
            text += &(cells.join(self.separator) + self.line_end);
        }
        let bytes = match self.encoding {
            0 => text.into_bytes(),
            1 => [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
            2 => [b"\xFF\xFE".to_vec(), text.encode_utf16().flat_map(u16::to_le_bytes).collect()].concat(),
            3 => [b"\xFE\xFF".to_vec(), text.encode_utf16().flat_map(u16::to_be_bytes).collect()].concat(),
            // Latin-1: all characters are below 0x100.
            _ => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect(),
        };
        DataFile { name: "any.csv".to_owned(), bytes }
    }
}

/// Names of the column of wavelengths, and the value in the unit of the name.
type FromNm = fn(f64) -> f64;

const WAVELENGTHS: [(&str, FromNm); 9] = [
    ("wavelength_nm", |nm| nm),
    ("Wavelength (um)", |nm| nm / 1000.0),
    ("lambda / \u{b5}m", |nm| nm / 1000.0),
    ("WL [\u{c5}]", |nm| nm * 10.0),
    ("nm", |nm| nm),
    ("wavelength_m", |nm| nm * 1e-9),
    // hc = 1239.841984332 eV nm by the SI of 2019, c = 299792458 m/s.
    ("Energy (eV)", |nm| 1_239.841_984_332_002_6 / nm),
    ("wavenumber", |nm| 1e7 / nm),
    ("frequency_THz", |nm| 299_792.458 / nm),
];

/// The order of the columns, separators, decimal marks, units and encodings change no value of n and k.
#[test]
fn index_table_in_any_style_has_the_same_values() {
    laws(
        300,
        |dice| {
            let nodes: Vec<[f64; 3]> = (0..3 + dice.below(4))
                .map(|k| [380.0 + 97.0 * k as f64, dice.between(0.1, 5.0), dice.between(0.0, 4.0)])
                .collect();
            (nodes, dice.below(WAVELENGTHS.len()), dice.below(2) == 0, Style::any(dice, 3))
        },
        |(nodes, unit, is_permittivity, style)| {
            let (name, convert) = WAVELENGTHS[*unit];
            let names = if *is_permittivity { ["eps1", "eps2"] } else { ["n", "k"] };
            let mut rows = vec![[name, names[0], names[1]].map(str::to_owned).to_vec()];
            for [nm, n, k] in nodes {
                let pair = if *is_permittivity { [n * n - k * k, 2.0 * n * k] } else { [*n, *k] };
                rows.push([convert(*nm), pair[0], pair[1]].map(|v| format!("{v}")).to_vec());
            }
            let index = read_index(&style.write(&rows)).unwrap_or_else(|error| panic!("{error}"));
            for [nm, n, k] in nodes {
                let (first, last) = index.range_nm();
                let found = index.index(nm.clamp(first, last)).unwrap();
                // A root of a permittivity loses digits where n is much larger than k, and by rounding of the
                // wavelength.
                let tolerance = if *is_permittivity { 1e-10 } else { 1e-11 };
                assert!(
                    (found.re - n).abs() < tolerance && (found.im - k).abs() < tolerance,
                    "{found} at {nm}"
                );
            }
        },
    );
}

/// A spectrum of fractions in any style, in per cent too.
#[test]
fn spectrum_in_any_style_has_the_same_values() {
    laws(
        200,
        |dice| {
            let values = dice.several(3..=6, |dice| dice.between(0.0, 1.0));
            (values, dice.below(6), dice.below(7), Style::any(dice, 2))
        },
        |(values, name, unit, style)| {
            let (named, factor) = [
                ("reflectance", 1.0),
                ("R (%)", 100.0),
                ("%T", 100.0),
                ("Transmittance [per cent]", 100.0),
                ("absorptance_percent", 100.0),
                ("value", 1.0),
            ][*name];
            let (wavelength, convert) = WAVELENGTHS[*unit];
            let mut rows = vec![vec![wavelength.to_owned(), named.to_owned()]];
            let nm = |k: usize| 400.0 + 50.0 * k as f64;
            rows.extend(
                values
                    .iter()
                    .enumerate()
                    .map(|(k, v)| vec![convert(nm(k)).to_string(), (v * factor).to_string()]),
            );
            let read = read_fractions(&style.write(&rows)).unwrap_or_else(|error| panic!("{error}"));
            for (k, value) in values.iter().enumerate() {
                assert!(close(read.values()[k], *value), "{} {value}", read.values()[k]);
            }
        },
    );
}

/// Right values of the material of the tests of others: n = 2.35, k = 0.01 between 2.4 and 2.3.
#[test]
fn columns_are_read_by_their_names() {
    for text in [
        "nm,k,n\n380,0.01,2.4\n780,0.01,2.3\n",
        "# nm k n\n380 0.01 2.4\n780 0.01 2.3\n",
        "# made by hand\n# k, n, nm\n0.01,2.4,380\n0.01,2.3,780\n",
        "wavelength,k,n\nnm,-,-\n380,0.01,2.4\n780,0.01,2.3\n",
        "wl,k,n\n0.38,0.01,2.4\n0.78,0.01,2.3\n",
        "Wellenl\u{e4}nge;Brechungsindex;Extinktionskoeffizient\n380;2,4;0,01\n780;2,3;0,01\n",
        "Material: Cr\nDate: 2024-05-01\nWavelength (nm)\tn\tk\n380\t2.4\t0.01\n780\t2.3\t0.01\n",
        "lambda,n,k,comment\n380,2.4,0.01,ok\n780,2.3,0.01,\"a, b\"\n",
        "nm,n,k,\n380,2.4,0.01,\n780,2.3,0.01,\n",
        "Wavelength(nm),n\n380,2.4\n780,2.3\n\nWavelength(nm),k\n380,0.01\n780,0.01\n",
        "sep=;\nnm;n;k\n380;2,4;0,01\n780;2,3;0,01\n",
    ] {
        let index = read_index(&file(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        let at = index.index(580.0).unwrap();
        assert!((at.re - 2.35).abs() < 1e-12 && (at.im - 0.01).abs() < 1e-12, "{text}: {at}");
    }
}

/// The three tables at the beginning of docs/tables.md are the same.
#[test]
fn tables_of_the_documentation_are_the_same() {
    let page = include_str!("../../../../docs/tables.md");
    let blocks: Vec<&str> =
        page.split("```csv\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(blocks.len(), 3);
    for block in blocks {
        let index = read_index(&file(block)).unwrap_or_else(|error| panic!("{error}"));
        // The photon energies have twelve digits.
        let nm = index.range_nm();
        assert!((nm.0 - 380.0).abs() < 1e-6 && (nm.1 - 780.0).abs() < 1e-6, "{nm:?}");
        let at = index.index(580.0).unwrap();
        assert!((at.re - 2.35).abs() < 1e-9 && (at.im - 0.01).abs() < 1e-9, "{at}");
    }
}

/// For each kind of table: a column that it does not have, a unit of another quantity, a quantity twice and
/// one that is missing are refused with their place, and the message names the column.
#[test]
fn column_that_is_not_understood_is_refused_by_its_name() {
    type Read = fn(&DataFile) -> Result<(), FormatError>;
    const N: Read = |file| read_index(file).map(drop);
    const FRACTION: Read = |file| read_fractions(file).map(drop);
    const LIGHT: Read = |file| read_light(file).map(drop);
    const PROFILE: Read = |file| read_profile(file).map(drop);
    const DENSITY: Read = |file| read_density(file).map(drop);
    const PIXEL: Read = |file| read_pixel_table(file).map(drop);
    const WINDOWS: Read = |file| read_windows(file).map(drop);
    const PANEL: Read = |file| read_measured_panel(file).map(drop);
    const BSDF: Read = |file| read_bsdf_file(file, None).map(drop);
    let cases: [(Read, &str, &str, (usize, usize)); 28] = [
        (N, "nm,n,foo", "`foo`", (1, 6)),
        (N, "nm,n,k,alpha", "absorption coefficient", (1, 8)),
        (N, "wavelength (furlong),n,k", "`furlong`", (1, 1)),
        (N, "Energy,n,k", "states no unit", (1, 1)),
        (N, "wavelength_eV,n,k_nm", "another quantity", (1, 17)),
        (N, "nm,n,index", "both name", (1, 6)),
        (N, "nm,k", "a required column is missing", (1, 1)),
        (N, "# nm, eps1, k", "a required column is missing", (1, 3)),
        (N, "nm,R,T", "`R`", (1, 4)),
        (FRACTION, "nm,absorbance", "absorbance", (1, 4)),
        (FRACTION, "nm,n", "refractive index", (1, 4)),
        (FRACTION, "nm,R,T", "both name", (1, 6)),
        (FRACTION, "nm,my sample", "`my sample`", (1, 4)),
        (FRACTION, "nm,R (dB)", "`dB`", (1, 4)),
        (LIGHT, "nm,irradiance (umol/m2/s/nm)", "umol", (1, 4)),
        (LIGHT, "energy_eV,power", "photon energy", (1, 1)),
        (LIGHT, "nm,luminance", "`luminance`", (1, 4)),
        (PROFILE, "theta (gon),radiance", "`gon`", (1, 1)),
        (PROFILE, "theta_deg,candela", "`candela`", (1, 11)),
        (DENSITY, "frequency_per_um,rms", "`rms`", (1, 18)),
        (PIXEL, "state,theta_deg,wavelength_nm,reflectance,phi_i", "the azimuth of the light", (1, 43)),
        (PIXEL, "state,theta_deg,wavelength_nm,absorbance", "absorbance", (1, 31)),
        (WINDOWS, "name,x0,y0,width,height", "`width`", (1, 12)),
        (PANEL, "state,theta_deg,wavelength_nm,reflektance", "`reflektance`", (1, 31)),
        (PANEL, "state,L (D50),a,b", "`D50`", (1, 7)),
        (BSDF, "theta_i,phi_i,theta_o,phi_o,luminance", "`luminance`", (1, 29)),
        (BSDF, "theta_i (gon),phi_i,theta_o,phi_o,brdf", "`gon`", (1, 1)),
        (PROFILE, "theta (grad),radiance", "100 gon are 90 deg", (1, 1)),
    ];
    for (read, header, words, place) in cases {
        let count = header.split(',').count();
        let row = |first: &str| [&[first][..], &vec!["0.5"; count - 1]].concat().join(",");
        let text = format!("{header}\n{}\n{}\n", row("400"), row("500"));
        let error = read(&file(&text)).unwrap_err();
        assert!(error.to_string().contains(words), "{header}: {error}");
        assert_eq!(error.place.line_column(), Some(place), "{header}: {error}");
    }
}

/// Wavelengths that were converted from 380 to 780 nm in steps of 10 nm to energies and frequencies, with the
/// constants of 2018 CODATA.
#[test]
fn rounded_energies_are_the_wavelengths_that_were_meant() {
    let nm: Vec<f64> = (38..=78).map(|k| 10.0 * f64::from(k)).collect();
    for (name, constant) in [
        ("Energy (eV)", 1_239.841_984),
        ("Energy (eV)", 1239.84),
        ("frequency/THz", 299_792.458),
        ("cm-1", 1e7),
    ] {
        for digits in [4, 5, 6, 9, 12] {
            let rows: Vec<String> = nm
                .iter()
                .map(|nm| {
                    // With its exponent, which alone states how many digits of 2.632e4 count.
                    let value = format!("{:.*e}", digits - 1, constant / nm);
                    format!("{value},{},0.001", 2.0 + 1e5 / nm / nm)
                })
                .collect();
            let read = read_index(&file(format!("{name},n,k\n{}\n", rows.join("\n")))).unwrap();
            assert_eq!(read.range_nm(), (380.0, 780.0), "{name}, {digits} digits");
            for at in &nm {
                assert!(
                    (read.index(*at).unwrap().re - (2.0 + 1e5 / at / at)).abs() < 1e-12,
                    "{name}, {digits} digits, {at} nm"
                );
            }
        }
    }
    // Energies in steps of 0.05 eV are what they are.
    let rows: Vec<String> = (30..70).map(|k| format!("{:.2},1.5", 0.05 * f64::from(k))).collect();
    let read = read_index(&file(format!("Energy (eV),n\n{}\n", rows.join("\n")))).unwrap();
    assert!((read.range_nm().0 - 1_239.841_984 / 3.45).abs() < 1e-4, "{:?}", read.range_nm());
}

/// A unit that is written is not asked for: the message lists those that are accepted.
#[test]
fn refused_unit_lists_the_accepted_ones() {
    for (header, says) in [
        ("wavelength (cm),n", "the accepted units are nm, um"),
        ("frequency (GHz),n", "THz or Hz"),
        ("nm,n (%)", "remove what is in brackets"),
    ] {
        let error = read_index(&file(format!("{header}\n400,1.5\n500,1.4\n"))).unwrap_err().to_string();
        assert!(error.contains(says) && !error.contains("write the unit in brackets"), "{error}");
    }
    let read = |header: &str, first: &str| {
        read_index(&file(format!("{header}\n{first},1.5\n5e14,1.4\n"))).map(|index| index.range_nm())
    };
    let (least, most) = read("frequency (Hz),n(lambda)", "6e14").unwrap();
    assert!((least - 499.654_097).abs() < 1e-5 && (most - 599.584_916).abs() < 1e-5, "{least} {most}");
    let error = read_index(&file("wavelength (nm),n\n0.38,1.5\n0.78,1.4\n")).unwrap_err().to_string();
    assert!(error.contains("micrometres") && error.contains("state the unit in the header"), "{error}");
}

/// X, Y, Z of white that have Y = 100 by their scale, as reflectances in per cent.
#[test]
fn tristimulus_values_of_the_scale_of_100_are_read_with_a_note() {
    use papilio_display::compare::Quantity;
    let read = read_measured_panel(&file("state,X,Y,Z\nwhite,26.1,27.4,28.2\nblack,0.5,0.6,0.7\n")).unwrap();
    let Quantity::Xyz(white) = &read.value[0].quantity else { panic!("{:?}", read.value[0]) };
    assert!(close(white.x, 0.261) && close(white.y, 0.274) && close(white.z, 0.282));
    assert!(read.warnings.iter().any(|note| note.contains("per cent")), "{:?}", read.warnings);
    let fractions = read_measured_panel(&file("state,X,Y,Z\nwhite,0.261,0.274,0.282\n")).unwrap();
    let Quantity::Xyz(white) = &fractions.value[0].quantity else { panic!("{:?}", fractions.value[0]) };
    assert!(close(white.y, 0.274) && fractions.warnings.is_empty(), "{:?}", fractions.warnings);
}

/// A panel that reflects like a mirror has Y of 2, a dark one of 2 per cent: between 1.5 and 10 the unit must
/// be stated.
#[test]
fn values_that_may_be_fractions_or_per_cent_need_their_unit() {
    use papilio_display::compare::Quantity;
    let table = |unit: &str, y: &str| {
        file(format!("state,X{unit},Y{unit},Z{unit}\nwhite,{y},{y},{y}\nblack,0.5,0.6,0.7\n"))
    };
    let white = |unit: &str, y: &str| {
        let read = read_measured_panel(&table(unit, y)).unwrap();
        let Quantity::Xyz(white) = &read.value[0].quantity else { panic!("{:?}", read.value[0]) };
        (white.y, read.warnings.len())
    };
    for y in ["1.6", "2.1", "9.9"] {
        let error = read_measured_panel(&table("", y)).unwrap_err();
        assert_eq!(error.place.line_column().map(|place| place.0), Some(1), "{error}");
        let error = error.to_string();
        assert!(error.contains(&format!("the values reach {y}")) && error.contains("`Y (%)`"), "{error}");
        let value: f64 = y.parse().unwrap();
        assert_eq!(white(" (1)", y), (value, 0));
        assert!(close(white(" (%)", y).0, 0.01 * value));
    }
    assert_eq!((white("", "1.4"), white(" (1)", "27.4")), ((1.4, 0), (27.4, 0)));
    let (y, notes) = white("", "27.4");
    assert!(close(y, 0.274) && notes == 1);
    // Spectra of states in columns.
    let spectra = |unit: &str, white: &str| {
        let text = format!("wavelength_nm,white{unit},black{unit}\n400,{white},0.1\n700,{white},0.1\n");
        read_measured_panel(&file(text)).map(|read| match &read.value[0].quantity {
            Quantity::Spectrum(spectrum) => spectrum.at(500.0).unwrap(),
            other => panic!("{other:?}"),
        })
    };
    assert!(spectra("", "2.5").unwrap_err().to_string().contains("the values reach 2.5"));
    assert!(close(spectra(" (1)", "2.5").unwrap(), 2.5) && close(spectra("", "25").unwrap(), 0.25));
}

/// Scans are read as all tables: uncertainties and remarks are left out with a note, everything else is
/// refused by its name.
#[test]
fn scan_with_further_columns_and_relative_units_is_read() {
    let part = Some(ScatterMode::FrontTransmission);
    let rows = ["0,100", "10,50", "20,20", "40,5"];
    let scan = |header: &str, more: &str| {
        let rows: Vec<String> = rows.iter().map(|row| format!("{row}{more}")).collect();
        file(format!("{header}\n{}\n", rows.join("\n")))
    };
    let plain = read_bsdf_file(&scan("theta_deg,btdf", ""), None).unwrap().measurement.parts;
    for (header, more, note) in [
        ("theta_deg,btdf,error", ",1", "`error` is not used"),
        ("theta_deg,btdf,comment,error", ",a,1", "`comment` is not used"),
        ("theta_deg,btdf (a.u.)", "", "relative units"),
        ("theta_deg,btdf (counts)", "", "relative units"),
    ] {
        let read = read_bsdf_file(&scan(header, more), None).unwrap();
        assert_eq!(read.measurement.parts, plain, "{header}");
        assert!(read.notes.iter().any(|all| all.contains(note)), "{header}: {:?}", read.notes);
    }
    for name in ["intensity", "counts"] {
        let read = read_bsdf_file(&scan(&format!("theta_deg,{name}"), ""), part).unwrap();
        assert_eq!(read.measurement.parts, plain, "{name}");
        let table = format!("theta_i,phi_i,theta_o,phi_o,{name}\n0,0,0,0,4\n0,0,40,0,1\n");
        let read = read_bsdf_file(&file(table), part).unwrap();
        assert_eq!(read.measurement.parts[0].values, [4.0, 1.0], "{name}");
        assert!(read.notes.iter().any(|note| note.contains("relative units")), "{:?}", read.notes);
    }
    for (header, more, says, column) in [
        ("theta_deg,btdf,foo", ",1", "`foo`", 16),
        ("theta_deg,btdf (dB)", "", "`dB`", 11),
        ("theta (gon),btdf", "", "`gon`", 1),
    ] {
        for part in [None, part] {
            let error = read_bsdf_file(&scan(header, more), part).unwrap_err();
            assert!(error.to_string().contains(says), "{header}: {error}");
            assert_eq!(error.place.line_column(), Some((1, column)), "{header}: {error}");
        }
    }
}

#[test]
fn missing_value_is_refused_with_its_place() {
    for (mark, problem) in [
        ("", Problem::EmptyCell),
        ("N/A", Problem::MissingValue { found: "N/A".to_owned() }),
        ("-", Problem::MissingValue { found: "-".to_owned() }),
        ("NaN", Problem::NotFinite { found: "NaN".to_owned() }),
    ] {
        let error = read_fractions(&file(format!("nm,R\n400,0.1\n500,{mark}\n600,0.2\n"))).unwrap_err();
        assert_eq!((error.place.line_column(), error.problem), (Some((3, 5)), problem));
    }
    let error = read_index(&file("400,2,0.1\n500,2,-999\n")).unwrap_err();
    assert_eq!(error.place.line_column(), Some((2, 7)), "{error}");
}

/// Points and commas in the same file contradict each other.
#[test]
fn mixed_decimal_marks_are_refused() {
    for text in ["nm;R\n400;0,1\n500;0.2\n", "nm;R\n400;1.000,5\n500;0,2\n", "nm,R\n400,0,1\n500,0,2\n"] {
        let error = read_fractions(&file(text)).unwrap_err().to_string();
        assert!(error.contains("decimal"), "{text}: {error}");
    }
}

/// Values of a photograph or another binary file are no text.
#[test]
fn binary_file_is_refused() {
    let error = read_index(&file(b"\xFF\xD8\xFF\xE0\x00\x10JFIF")).unwrap_err();
    assert_eq!(error.problem, Problem::NotText);
}

/// A Lambertian 0.2: f = 0.2 / pi in all directions, whatever the names, units, order and separators of the
/// columns.
#[test]
fn bsdf_table_in_any_style_is_the_same() {
    const NAMES: [([&str; 5], bool); 4] = [
        (["Theta_i (deg)", "Phi_i (deg)", "Theta_o (deg)", "Phi_o (deg)", "BRDF (1/sr)"], false),
        (["theta_in_rad", "phi_in_rad", "theta_out_rad", "phi_out_rad", "brdf"], true),
        (["AOI [\u{b0}]", "phiIn", "theta_s", "phi_s", "BRDF [sr^-1]"], false),
        (["thetaI", "phiI", "thetaO", "phiO", "f_r"], false),
    ];
    let angles: Vec<[f64; 4]> = [0.0, 30.0, 60.0]
        .into_iter()
        .flat_map(|i| {
            [0.0, 15.0, 75.0, 90.0]
                .into_iter()
                .flat_map(move |o| [0.0, 90.0, 180.0, 270.0].map(|p| [i, 0.0, o, p]))
        })
        .collect();
    let plain: String = angles
        .iter()
        .map(|[a, b, c, d]| format!("{a},{b},{c},{d},{}\n", 0.06 + a * 1e-4 + c * 1e-5 + d * 1e-6))
        .collect();
    let plain = read_bsdf_file(&file(format!("theta_i,phi_i,theta_o,phi_o,brdf\n{plain}")), None)
        .unwrap()
        .measurement
        .parts;
    laws(
        100,
        |dice| (dice.below(NAMES.len()), Style::any(dice, 5)),
        |(names, style)| {
            let (names, in_radians) = NAMES[*names];
            let mut rows = vec![names.map(str::to_owned).to_vec()];
            for of_row in &angles {
                let value = 0.06 + of_row[0] * 1e-4 + of_row[2] * 1e-5 + of_row[3] * 1e-6;
                let written = of_row.map(|angle| if in_radians { angle.to_radians() } else { angle });
                rows.push(written.iter().chain([&value]).map(f64::to_string).collect());
            }
            let read = read_bsdf_file(&style.write(&rows), None).unwrap_or_else(|error| panic!("{error}"));
            let [part] = &read.measurement.parts[..] else { panic!("{:?}", read.measurement.parts) };
            assert_eq!(part.way, plain[0].way);
            assert_eq!((&part.geometry, &part.values), (&plain[0].geometry, &plain[0].values));
        },
    );
}

#[test]
fn bsdf_table_whose_angles_may_be_radians_is_refused_without_a_unit() {
    let rows = "0,0,0.5,0,1\n0,0,1.5708,3.14159,1\n0,0,1,5.75959,1\n";
    let unstated =
        read_bsdf_file(&file(format!("theta_i,phi_i,theta_o,phi_o,brdf\n{rows}")), None).unwrap_err();
    assert_eq!(unstated.problem, Problem::Radians);
    assert_eq!(read_bsdf_file(&file(rows), None).unwrap_err().problem, Problem::Radians);
    for unit in ["deg", "rad"] {
        let header = format!("theta_i ({unit}),phi_i ({unit}),theta_o ({unit}),phi_o ({unit}),brdf");
        assert!(read_bsdf_file(&file(format!("{header}\n{rows}")), None).is_ok());
    }
    let scan = "angle,btdf\n0,1\n0.5,0.5\n1.5,0\n";
    assert_eq!(read_bsdf_file(&file(scan), None).unwrap_err().problem, Problem::Radians);
}

/// A scan of a German instrument; 1.5708 rad are 90 deg.
#[test]
fn scan_with_decimal_commas_or_in_radians_is_read() {
    let plain = read_bsdf_file(&file("theta_deg,btdf\n0,4\n45,2.5\n90,0\n"), None).unwrap().measurement;
    for text in [
        "Winkel;BTDF\n0;4\n45;2,5\n90;0\n",
        "BTDF (1/sr)\tAngle (\u{b0})\n4\t0\n2.5\t45\n0\t90\n",
        "angle_rad,btdf\n0,4\n0.785398,2.5\n1.5708,0\n",
        "Sample: D80\nOperator: n. n.\nangle (deg),BTDF\n0,4\n45,2.5\n90,0\n",
    ] {
        let read = read_bsdf_file(&file(text), None).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(read.measurement.parts, plain.parts, "{text}");
    }
}

/// One palette in all forms that instruments write.
#[test]
fn palette_in_any_form_is_the_same() {
    let long = "state,wavelength_nm,reflectance_factor\nwhite,400,0.5\nwhite,550,0.6\nwhite,700,0.7\nblack,400,0.02\nblack,550,0.03\nblack,700,0.04\n";
    let plain = read_palette(&file(long)).unwrap().value;
    let cgats = "CGATS.17\nORIGINATOR \"x\"\nNUMBER_OF_FIELDS 5\nBEGIN_DATA_FORMAT\nSAMPLE_ID SAMPLE_NAME SPECTRAL_NM400 SPECTRAL_NM550 SPECTRAL_NM700\nEND_DATA_FORMAT\n\nNUMBER_OF_SETS 2\nBEGIN_DATA\n1 \"white\" 0.5 0.6 0.7\n2 black 0.02 0.03 0.04\nEND_DATA\n";
    let argyll = "CTI3   \n\nDESCRIPTOR \"Argyll\"\nKEYWORD \"SPECTRAL_NORM\"\nSPECTRAL_BANDS \"3\"\nSPECTRAL_START_NM \"400.0\"\nSPECTRAL_END_NM \"700.0\"\nSPECTRAL_NORM \"100.0\"\nNUMBER_OF_FIELDS 4\nBEGIN_DATA_FORMAT\nSAMPLE_ID SPEC_400 SPEC_550 SPEC_700\nEND_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n\"white\" 50 60 70\n\"black\" 2 3 4\nEND_DATA\n";
    let pairs = "ISO28178\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SPECTRAL_NM SPECTRAL_PCT SPECTRAL_NM SPECTRAL_PCT SPECTRAL_NM SPECTRAL_PCT\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite 400 50 550 60 700 70\nblack 400 2 550 3 700 4\nEND_DATA\n";
    let cxf = r#"<?xml version="1.0" encoding="UTF-8"?>
<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core"><cc:Resources><cc:ObjectCollection>
<cc:Object ObjectType="Standard" Name="white" Id="1"><cc:ColorValues>
<cc:ReflectanceSpectrum ColorSpecification="CS1" StartWL="400">0.5 0.6 0.7</cc:ReflectanceSpectrum></cc:ColorValues></cc:Object>
<cc:Object ObjectType="Standard" Name="black" Id="2"><cc:ColorValues>
<cc:ReflectanceSpectrum ColorSpecification="CS1" StartWL="400">0.02 0.03 0.04</cc:ReflectanceSpectrum></cc:ColorValues></cc:Object>
</cc:ObjectCollection><cc:ColorSpecificationCollection><cc:ColorSpecification Id="CS1"><cc:MeasurementSpec>
<cc:WavelengthRange StartWL="400" Increment="150"/></cc:MeasurementSpec></cc:ColorSpecification></cc:ColorSpecificationCollection>
</cc:Resources></cc:CxF>"#;
    for text in [
        "reflectance (%);Sample;Wavelength (um)\n50;white;0,4\n60;white;0,55\n70;white;0,7\n2;black;0,4\n3;black;0,55\n4;black;0,7\n",
        "wavelength_nm,white,black\n400,0.5,0.02\n550,0.6,0.03\n700,0.7,0.04\n",
        "nm;white (%);black (%)\n400;50;2\n550;60;3\n700;70;4\n",
        "nm\twhite\tblack\n400\t50\t2\n550\t60\t3\n700\t70\t4\n",
        "Sample,400 nm,550 nm,700 nm\nwhite,50,60,70\nblack,2,3,4\n",
        "Name;R_400;R_550;R_700\nwhite;0,5;0,6;0,7\nblack;0,02;0,03;0,04\n",
        "Spectrophotometer 1.0,,,\nDate,2024,,\n,400,550,700\nwhite,50,60,70\nblack,2,3,4\n",
        cgats,
        argyll,
        pairs,
        cxf,
    ] {
        let read = read_palette(&file(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        let (PaletteTable::Spectra(read), PaletteTable::Spectra(plain)) = (&read.value, &plain) else {
            panic!("{text}")
        };
        assert_eq!(read.len(), plain.len(), "{text}");
        for ((name, one), (other_name, other)) in read.iter().zip(plain) {
            assert_eq!(name, other_name, "{text}");
            let near =
                |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(*a, *b));
            assert!(
                near(one.wavelengths_nm(), other.wavelengths_nm()) && near(one.values(), other.values()),
                "{text}"
            );
        }
    }
    let lab = read_palette(&file("Sample;b*;L*;a*\nwhite;1,5;68;-0,5\n")).unwrap().value;
    let PaletteTable::Lab { colours: lab, observer: None, illuminant: None } = lab else { panic!("{lab:?}") };
    assert_eq!((lab[0].1.l, lab[0].1.a, lab[0].1.b), (68.0, -0.5, 1.5));
}

/// A light in all forms that instruments write: 1 at 400 nm, 3 at 500 nm, in any scale.
#[test]
fn light_of_any_instrument_is_read() {
    let ocean = "SpectraSuite Data File\n++++++++\nDate: Mon\nIntegration Time (usec): 100000 (USB2E7196)\nNumber of Sampled Component Spectra: 1\n>>>>>Begin Processed Spectral Data<<<<<\n400.00\t100.0\n500.00\t300.0\n>>>>>End Processed Spectral Data<<<<<\n";
    let oceanview = "Data from lamp.txt Node\n\nDate: Mon\nXAxis mode: Wavelengths\nNumber of Pixels in Spectrum: 2\n>>>>>Begin Spectral Data<<<<<\n400,00\t0,1\n500,00\t0,3\n";
    let sp = "SPECT  \n\nORIGINATOR \"Argyll CMS\"\nMEAS_TYPE \"EMISSION\"\nSPECTRAL_BANDS \"2\"\nSPECTRAL_START_NM \"400.000000\"\nSPECTRAL_END_NM \"500.000000\"\nSPECTRAL_NORM \"1.000000\"\nNUMBER_OF_FIELDS 3\nBEGIN_DATA_FORMAT\nSAMPLE_ID SPEC_400 SPEC_500\nEND_DATA_FORMAT\nNUMBER_OF_SETS 1\nBEGIN_DATA\n1 11.0 33.0\nEND_DATA\n";
    let spdx = "<?xml version=\"1.0\"?>\n<IESTM2714 xmlns=\"iestm2714\" version=\"1.0\"><Header><Description>LED</Description></Header>\n<SpectralDistribution><SpectralQuantity>irradiance</SpectralQuantity>\n<SpectralData wavelength=\"400.0\">0.2</SpectralData><SpectralData wavelength=\"500.0\">0.6</SpectralData></SpectralDistribution></IESTM2714>";
    let meter = |step: usize| -> String {
        (400..=500)
            .step_by(step)
            .map(|nm| format!("Spectral Data {nm}[nm],{}\n", (nm as f64 - 350.0) / 1e4))
            .collect()
    };
    let sekonic = format!(
        "Date Saved,2024/05/01 10:00\nTitle,lamp\nIlluminance [lx],500\nPeak Wavelength [nm],500\n{}{}",
        meter(5),
        meter(1)
    );
    for text in [
        "wavelength_nm,relative_power\n400,1\n500,3\n",
        "400 1\n500 3\n",
        "Irradiance (W/m\u{b2}/nm);nm\n0,01;400\n0,03;500\n",
        ocean,
        oceanview,
        sp,
        spdx,
        &sekonic,
        "nm,counts\n400,1000\n500,3000\n",
    ] {
        let light = read_light(&file(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(light.range_nm(), (400.0, 500.0), "{text}");
        assert!(close(light.at(450.0).unwrap() / light.at(400.0).unwrap(), 2.0), "{text}");
    }
    for (text, words) in [
        (oceanview.replace("Wavelengths", "Raman Shifts"), "Raman Shifts"),
        (spdx.replace("irradiance", "reflectance"), "holds a reflectance"),
        (sp.replace("NUMBER_OF_SETS 1", "NUMBER_OF_SETS 2"), "NUMBER_OF_SETS"),
        (sp.replace("1 11.0 33.0", "1 11.0"), "rows of 3 fields"),
    ] {
        let error = read_light(&file(&text)).unwrap_err().to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
    assert!(read_fractions(&file(sp)).unwrap_err().to_string().contains("holds a light"));
}

/// The noise of a dark signal is taken as 0, and noted; larger negative values are refused.
#[test]
fn small_negative_values_are_noise() {
    let read = read_light_with_notes(&file("nm,power\n350,-0.5\n400,-0.001\n500,3\n600,1\n")).unwrap();
    assert_eq!(read.value.values(), [0.0, 0.0, 3.0, 1.0]);
    assert!(read.warnings[0].contains("2 negative values are taken as 0"), "{:?}", read.warnings);
    let read = read_fractions_with_notes(&file("nm,R\n400,-0.004\n500,0.3\n")).unwrap();
    assert_eq!((read.value.values(), read.warnings.len()), (&[0.0, 0.3][..], 1));
    for text in ["nm,R\n400,0.1\n500,-0.1\n", "nm,R\n400,0.1\n500,1.2\n"] {
        assert_eq!(read_fractions(&file(text)).unwrap_err().place.line_column(), Some((3, 5)));
    }
}

#[test]
fn small_tables_are_read_by_names_in_any_order() {
    let profile = [(0.0, 1.0), (60.0, 0.5)];
    for text in [
        "radiance,theta_deg\n1,0\n0.5,60\n",
        "Luminance;Winkel\n1;0\n0,5;60\n",
        "angle_rad,radiance\n0,1\n1.0471975512,0.5\n",
    ] {
        assert_eq!(read_profile(&file(text)).unwrap(), profile, "{text}");
    }
    let density = read_density(&file("psd (nm4),frequency (1/mm)\n1e12,10\n5e11,20\n")).unwrap();
    assert!(
        close(density[0][0], 0.01) && close(density[0][1], 1.0) && close(density[1][1], 0.5),
        "{density:?}"
    );
    let pixel = "wavelength_um;reflectance_percent;state;angle (\u{b0})\n0,4;10;white;0\n0,5;20;white;0\n";
    let plain = "state,theta_deg,wavelength_nm,reflectance\nwhite,0,400,0.1\nwhite,0,500,0.2\n";
    assert_eq!(read_pixel_table(&file(pixel)).unwrap(), read_pixel_table(&file(plain)).unwrap());
    assert_eq!(read_spectrum(&file("R,nm\n0.1,400\n0.3,500\n")).unwrap().at(450.0).unwrap(), 0.2);
}

/// No text makes a reader panic: names, units and keywords of all formats in any order.
#[test]
fn arbitrary_words_never_panic() {
    const WORDS: [&str; 33] = [
        "wavelength",
        "(nm)",
        "n",
        "k",
        ",",
        ";",
        "\t",
        "\n",
        "\n",
        "\"",
        "400",
        "0,5",
        "0.5",
        "-1",
        "%",
        "theta_i",
        "BEGIN_DATA",
        "BEGIN_DATA_FORMAT\n",
        "END_DATA_FORMAT\n",
        "\nEND_DATA\n",
        "SPEC_400",
        "SPEC_500",
        "<CxF>",
        "</CxF>",
        ">>>>>Begin Spectral Data<<<<<\n",
        "Text conversion of header file\n",
        "\nnm\nNK\n",
        ".asd",
        "Spectral Data 380[nm]",
        "#",
        "state",
        "nan",
        "[",
    ];
    laws(
        400,
        |dice| dice.several(0..=40, |dice| WORDS[dice.below(WORDS.len())]).concat(),
        |text| {
            let file = file(text);
            let _ = (read_index(&file), read_fractions(&file), read_light(&file), read_palette(&file));
            let _ = (
                read_measured_panel(&file),
                read_profile(&file),
                read_bsdf_file(&file, None),
                read_pixel_table(&file),
            );
        },
    );
}
