//! Files as laboratories have them, and the same files with one mistake each: what is read, and where the mistake is.
//!
//! The files are written by hand, with synthetic values, in the layout that each program writes. Wavelengths are from 380 to
//! 730 nm; reflectances are 0.1 to 0.6 (white) and 0.02 (black), lights rise eightfold, the film has n = 1.5 + 4000/nm^2 and
//! a k that falls from 0.01 to 0.

use papilio_colour::Standard;
use papilio_display::compare::{Quantity, StandardDeviation};
use papilio_formats::{
    DataFile, FormatError, PaletteTable, read_fractions, read_fractions_with_notes, read_index, read_light,
    read_light_with_notes, read_measured_panel, read_palette,
};

macro_rules! laboratory {
    ($name:literal) => {
        ($name, include_bytes!(concat!("laboratory/", $name)) as &[u8])
    };
}

/// What a file is read as.
#[derive(Clone, Copy)]
enum As {
    Palette,
    Fractions,
    Light,
    Index,
}

/// A file, what it is, a mistake (two texts), its line and column, and words of the message.
type Case = ((&'static str, &'static [u8]), As, [&'static str; 2], (usize, usize), &'static str);

const FILES: [Case; 13] = [
    (
        laboratory!("i1profiler.txt"),
        As::Palette,
        ["white\t0.1000", "white\t0.1x00"],
        (15, 9),
        "`0.1x00` of SPECTRAL_NM380",
    ),
    (
        laboratory!("colour.cxf"),
        As::Palette,
        [" Increment=\"10\"", ""],
        (9, 11),
        "has no StartWL and Increment",
    ),
    (
        laboratory!("lamp.sp"),
        As::Light,
        ["NUMBER_OF_SETS 1", "NUMBER_OF_SETS 2"],
        (58, 16),
        "NUMBER_OF_SETS is 2",
    ),
    (laboratory!("chart.ti3"), As::Palette, ["1.93 2.00", "1.93"], (29, 1), "are not rows of 44 fields"),
    (
        laboratory!("oceanview.txt"),
        As::Light,
        ["mode: Wavelengths", "mode: Raman Shifts"],
        (11, 13),
        "`Raman Shifts`",
    ),
    (laboratory!("asd.txt"), As::Fractions, ["\n400\t0.128571", "\n400\t"], (19, 1), "this row has 1 column"),
    (
        laboratory!("sekonic.csv"),
        As::Light,
        ["400[nm],0.0014", "400[nm],O.0014"],
        (101, 23),
        "`O.001400000` is not a number",
    ),
    (
        laboratory!("uprtek.xls"),
        As::Light,
        ["400nm\t0.518000", "400nm\tn/a"],
        (13, 7),
        "`n/a` stands for a missing value",
    ),
    (
        laboratory!("lamp.spdx"),
        As::Light,
        [" wavelength=\"400.0\"", ""],
        (16, 5),
        "an attribute `wavelength`",
    ),
    (
        laboratory!("spectramagic.csv"),
        As::Palette,
        [";11,43;", ";11,4a;"],
        (3, 13),
        "`11,4a` is not a number",
    ),
    (laboratory!("film.mat"), As::Index, ["\nNK", "\nCauchy"], (3, 1), "expected NK, or e1e2"),
    (laboratory!("film-e.mat"), As::Index, ["\n1.7000 ", "\n1.6000 "], (6, 1), "out of order"),
    (laboratory!("film.csv"), As::Index, ["Energie [eV]", "Energie [J]"], (1, 5), "Energie [J]"),
];

/// Decodes the encodings of these files.
fn text(bytes: &[u8]) -> String {
    match bytes {
        [0xFF, 0xFE, rest @ ..] => {
            let units: Vec<u16> = rest.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
            String::from_utf16(&units).unwrap()
        }
        _ => String::from_utf8(bytes.to_vec()).unwrap(),
    }
}

fn data(name: &str, bytes: &[u8]) -> DataFile {
    DataFile { name: name.to_owned(), bytes: bytes.to_vec() }
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found}, expected {expected}");
}

fn check(name: &str, file: &DataFile, read_as: As) -> Result<(), FormatError> {
    match read_as {
        As::Palette => {
            let PaletteTable::Spectra(states) = read_palette(file)?.value else {
                panic!("{name}: no spectra")
            };
            let [(white, of_white), (black, of_black)] = &states[..] else { panic!("{name}: {states:?}") };
            assert_eq!((white.as_str(), black.as_str()), ("white", "black"), "{name}");
            assert_eq!(of_white.range_nm(), (380.0, 730.0), "{name}");
            near(name, of_white.at(555.0).unwrap(), 0.35, 1e-4);
            near(name, of_black.at(555.0).unwrap(), 0.02, 1e-9);
        }
        As::Fractions => {
            let read = read_fractions(file)?;
            assert_eq!(read.range_nm(), (380.0, 730.0), "{name}");
            near(name, read.at(555.0).unwrap(), 0.35, 1e-4);
        }
        As::Light => {
            let read = read_light(file)?;
            near(name, read.at(555.0).unwrap() / read.at(380.0).unwrap(), 4.5, 1e-3);
            near(name, read.at(730.0).unwrap() / read.at(380.0).unwrap(), 8.0, 1e-3);
        }
        As::Index => {
            let index = read_index(file)?.index(500.0).unwrap();
            near(name, index.re, 1.516, 1e-4);
            near(name, index.im, 0.01 * 230.0 / 350.0, 1e-4);
        }
    }
    Ok(())
}

#[test]
fn files_of_laboratories_are_read() {
    for ((name, bytes), read_as, ..) in FILES {
        check(name, &data(name, bytes), read_as).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn wrong_files_of_laboratories_are_refused_at_their_place() {
    for ((name, bytes), read_as, [right, wrong], place, words) in FILES {
        let right_text = text(bytes);
        let wrong_text = right_text.replace(right, wrong);
        assert_ne!(right_text, wrong_text, "{name}");
        let error = check(name, &data(name, wrong_text.as_bytes()), read_as).expect_err(name);
        assert_eq!(error.place.line_column(), Some(place), "{name}: {error}");
        assert!(error.to_string().contains(words), "{name}: {error}");
    }
}

/// Values of an instrument that no reader of spectra accepts are refused at their place, too.
#[test]
fn values_out_of_range_are_refused_at_their_place() {
    let (name, bytes) = laboratory!("asd.txt");
    let wrong = text(bytes).replace("\n400\t0.128571", "\n400\t-0.128571");
    assert_eq!(read_fractions(&data(name, wrong.as_bytes())).unwrap_err().place.line_column(), Some((19, 5)));
    let (name, bytes) = laboratory!("lamp.sp");
    let wrong = text(bytes).replace(" 1.800000", " -1.800000");
    let error = read_light(&data(name, wrong.as_bytes())).unwrap_err();
    assert_eq!(error.place.line_column(), Some((60, 10)), "{error}");
    let (name, bytes) = laboratory!("i1profiler.txt");
    let wrong = text(bytes).replace("2\tblack", "2\twhite");
    let error = read_palette(&data(name, wrong.as_bytes())).unwrap_err();
    assert_eq!(error.place.line_column().map(|(line, _)| line), Some(16), "{error}");
}

/// The dark pixels of a spectrometer: noise below 380 nm becomes 0, and is noted. Per cent without a scale is noted.
#[test]
fn interpretations_are_noted() {
    let (name, bytes) = laboratory!("oceanview.txt");
    let read = read_light_with_notes(&data(name, bytes)).unwrap();
    assert!(
        read.warnings.iter().any(|note| note.contains("2 negative values are taken as 0")),
        "{:?}",
        read.warnings
    );
    let (name, bytes) = laboratory!("asd.txt");
    assert!(read_fractions_with_notes(&data(name, bytes)).unwrap().warnings.is_empty());
    let (name, bytes) = laboratory!("spectramagic.csv");
    let notes = read_palette(&data(name, bytes)).unwrap().warnings;
    assert!(notes.iter().any(|note| note.contains("read as per cent")), "{notes:?}");
}

/// A spectrometer writes one spectrum without a name: as that of a state, it has the name of its file.
#[test]
fn spectrum_without_a_name_has_that_of_its_file() {
    let (_, bytes) = laboratory!("oceanview.txt");
    let read = read_palette(&data("panel 17/white.txt", bytes)).unwrap();
    let PaletteTable::Spectra(states) = read.value else { panic!("no spectra") };
    assert_eq!(states.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["white"]);
    assert!(read.warnings.iter().any(|note| note.contains("called `white`")), "{:?}", read.warnings);
}

/// Colours of the 10 deg observer are kept as such, in CxF and in CGATS.
#[test]
fn observer_of_colours_is_read() {
    let (name, bytes) = laboratory!("colour-10-deg.cxf");
    let cgats = "CGATS.17\nWEIGHTING_FUNCTION \"ILLUMINANT, D65\"\nWEIGHTING_FUNCTION \"OBSERVER, 10 degree\"\nBEGIN_DATA_FORMAT\n\
                 SAMPLE_NAME LAB_L LAB_A LAB_B\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite 70.5 -1.2 3.4\nEND_DATA\n";
    for file in [data(name, bytes), data("lab.txt", cgats.as_bytes())] {
        let PaletteTable::Lab { colours, observer, .. } = read_palette(&file).unwrap().value else {
            panic!("spectra")
        };
        assert_eq!((colours[0].1.l, observer), (70.5, Some(Standard::Cie1964)), "{}", file.name);
        let notes = read_measured_panel(&file).unwrap().warnings;
        assert!(notes.iter().any(|note| note.contains("10 deg observer")), "{notes:?}");
    }
    let two = cgats.replace("10 degree", "2 degree");
    let PaletteTable::Lab { observer, .. } = read_palette(&data("lab.txt", two.as_bytes())).unwrap().value
    else {
        panic!("spectra")
    };
    assert_eq!(observer, Some(Standard::Cie1931));
}

/// Colours are those in the illuminant that the file states, in CxF and in the spellings of CGATS; spectra have none.
#[test]
fn illuminant_of_colours_is_read() {
    let cgats = |keywords: &str| {
        format!(
            "CGATS.17\n{keywords}\nBEGIN_DATA_FORMAT\nSAMPLE_NAME LAB_L LAB_A LAB_B\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite 70.5 -1.2 3.4\n\
             END_DATA\n"
        )
    };
    let cxf = "<CxF><Object Name=\"white\"><ColorValues><ColorCIELab ColorSpecification=\"c\"><L>70.5</L><A>-1.2</A><B>3.4</B></ColorCIELab>\
               </ColorValues></Object><ColorSpecification Id=\"c\"><TristimulusSpec><Illuminant>D50</Illuminant></TristimulusSpec>\
               </ColorSpecification></CxF>";
    for (text, stated) in [
        (
            cgats("WEIGHTING_FUNCTION \"ILLUMINANT, D50\"\nWEIGHTING_FUNCTION \"OBSERVER, 2 degree\""),
            Some("D50"),
        ),
        (cgats("ILLUMINATION_NAME \"D65\"\nOBSERVER \"2\""), Some("D65")),
        (
            cgats("MEASUREMENT_SOURCE \"Illumination=D50 ObserverAngle=2 degree WhiteBase=Abs Filter=no\""),
            Some("D50"),
        ),
        (cgats("ILLUMINATION_NAME \"F11\""), Some("FL11")),
        // The lamp of the instrument, and the illuminant of its colours.
        (
            cgats(
                "MEASUREMENT_SOURCE \"Illumination=A WhiteBase=Abs\"\nWEIGHTING_FUNCTION \"ILLUMINANT, D50\"",
            ),
            Some("D50"),
        ),
        (cgats("ILLUMINANT \"unknown\""), None),
        (cgats("ILLUMINANT \"D93\""), None),
        (cxf.to_owned(), Some("D50")),
    ] {
        let file = data("panel.txt", text.as_bytes());
        let PaletteTable::Lab { illuminant, .. } = read_palette(&file).unwrap().value else {
            panic!("spectra")
        };
        assert_eq!(illuminant.as_deref(), stated, "{text}");
        let notes = read_measured_panel(&file).unwrap().warnings;
        let is_noted = notes.iter().any(|note| note.contains("the colours of the file are those in "));
        assert_eq!(is_noted, stated.is_some(), "{text}: {notes:?}");
    }
    let spectra = cgats("ILLUMINANT \"D50\"")
        .replace("LAB_L LAB_A LAB_B", "SPEC_400 SPEC_500 SPEC_600")
        .replace("70.5 -1.2 3.4", "0.1 0.2 0.3");
    assert!(read_measured_panel(&data("panel.txt", spectra.as_bytes())).unwrap().warnings.is_empty());
}

/// What a file states of its spectra must be what it has.
#[test]
fn keywords_of_spectra_are_checked() {
    let (name, bytes) = laboratory!("lamp.sp");
    let right = text(bytes);
    let of = |key: &str| right.lines().find(|line| line.starts_with(key)).unwrap().to_owned();
    for (key, value) in [
        ("SPECTRAL_BANDS", "7"),
        ("SPECTRAL_END_NM", "9000"),
        ("SPECTRAL_START_NM", "1.5"),
        ("SPECTRAL_NORM", "0"),
    ] {
        let wrong = right.replace(&of(key), &format!("{key} \"{value}\""));
        assert_ne!(wrong, right);
        let error = read_light(&data(name, wrong.as_bytes())).unwrap_err();
        let (line, column) = error.place.line_column().unwrap();
        let expected = wrong.lines().position(|line| line.starts_with(key)).unwrap() + 1;
        assert_eq!((line, column), (expected, key.len() + 3), "{error}");
        assert!(error.to_string().contains(&format!("{key} is {value}")), "{error}");
    }
}

/// A sample alone without a name is that of its file, in Argyll's `.sp`, too.
#[test]
fn single_sample_of_argyll_has_the_name_of_its_file() {
    let sp = "SPECT\nMEAS_TYPE \"REFLECTIVE\"\nSPECTRAL_BANDS \"2\"\nSPECTRAL_NORM \"100\"\nNUMBER_OF_FIELDS 2\nBEGIN_DATA_FORMAT\nSPEC_400 SPEC_700\n\
              END_DATA_FORMAT\nNUMBER_OF_SETS 1\nBEGIN_DATA\n20 30\nEND_DATA\n";
    let read = read_measured_panel(&data("lab/white.sp", sp.as_bytes())).unwrap();
    assert_eq!(read.value[0].state, "white");
}

/// Rows of a light meter out of order or twice are an error; a second spectrum that begins again is not.
#[test]
fn rows_of_a_light_meter_are_in_order() {
    let rows = |nm: &[f64]| nm.iter().map(|nm| format!("Spectral Data {nm}[nm],0.5\n")).collect::<String>();
    let coarse: Vec<f64> = (0..12).map(|k| 380.0 + 20.0 * f64::from(k)).collect();
    let fine: Vec<f64> = (0..221).map(|k| 380.0 + f64::from(k)).collect();
    let read = |nm: &[f64]| read_light(&data("meter.csv", format!("Title,one\n{}", rows(nm)).as_bytes()));
    assert!(read(&[coarse.clone(), fine].concat()).is_ok());
    let mut swapped = coarse.clone();
    swapped.swap(5, 6);
    let mut doubled = coarse.clone();
    doubled.push(600.0);
    for (nm, line) in [(swapped, 8), (doubled, 14)] {
        let error = read(&nm).unwrap_err();
        assert_eq!(error.place.line_column().map(|place| place.0), Some(line), "{error}");
        assert!(error.to_string().contains("not above that of the row before"), "{error}");
    }
}

/// Wavelengths that a spectrum lacks are noted, and coarse steps are not.
#[test]
fn missing_wavelengths_are_noted() {
    let is_noted = |nm: &[u32]| {
        let rows: String = nm.iter().map(|nm| format!("white,{nm},0.5\n")).collect();
        let panel = data("panel.csv", format!("state,wavelength_nm,reflectance_factor\n{rows}").as_bytes());
        let light =
            data("light.csv", format!("wavelength_nm,value\n{}", rows.replace("white,", "")).as_bytes());
        let notes =
            [read_measured_panel(&panel).unwrap().warnings, read_light_with_notes(&light).unwrap().warnings];
        notes.map(|notes| notes.iter().any(|note| note.contains("no values between 480 and 630 nm")))
    };
    let steps = |from: u32, to: u32| (from..=to).step_by(10).collect::<Vec<u32>>();
    assert_eq!(is_noted(&[steps(380, 480), steps(630, 780)].concat()), [true; 2]);
    assert_eq!(is_noted(&[380, 480, 580, 680, 780]), [false; 2]);
    assert_eq!(is_noted(&[380, 780]), [false; 2]);
    assert_eq!(is_noted(&steps(380, 780)), [false; 2]);
}

/// XML that is damaged, or of another kind, is named as such, at its line.
#[test]
fn other_xml_is_named() {
    let cut = "<CxF>\n<Object Name=\"white\">\n<ColorValues>";
    let error = read_measured_panel(&data("cut.cxf", cut.as_bytes())).unwrap_err().to_string();
    assert!(error.contains("XML file cannot be used: it ends early or is damaged"), "{error}");
    let other = read_measured_panel(&data("a.svg", b"<svg/>")).unwrap_err();
    assert!(
        other.to_string().contains("its element is `svg`") && other.place.line_column() == Some((1, 1)),
        "{other}"
    );
}

/// German headers; names that differ in capital letters alone are one state; columns that are not read are named.
#[test]
fn tables_of_panels_are_read_with_care() {
    let read = |text: &str| read_measured_panel(&data("panel.csv", text.as_bytes()));
    let german = "Zustand;Wellenl\u{e4}nge [nm];Reflexionsgrad [%];standard_deviation\nwhite;400;13,2;0,3\nwhite;700;14;0,3\n";
    assert!(read(german).unwrap().value[0].standard_deviation.is_some());
    let error = read("state,X,Y,Z\nWhite,0.2,0.2,0.2\nwhite,0.3,0.3,0.3\n").unwrap_err();
    assert_eq!(error.place.line_column(), Some((3, 1)), "{error}");
    let notes = read("state,X,Y,Z,L,a,b\nwhite,0.2,0.2,0.2,52,0,0\n").unwrap().warnings;
    assert!(
        notes.iter().any(|note| note == "the columns L, a, b are not used: X, Y, Z are read"),
        "{notes:?}"
    );
    let notes =
        read("state,wavelength_nm,reflectance_factor,Y\nw,400,0.2,0.2\nw,700,0.2,0.2\n").unwrap().warnings;
    assert!(notes.iter().any(|note| note == "the column Y is not used: the spectra are read"), "{notes:?}");
    let index =
        papilio_formats::read_index_within(&data("film.csv", b"nm,n\n400,1.5\n700,1.5\n"), (400.0, 700.0));
    let index = index.unwrap();
    assert!(index.warnings.iter().any(|note| note.contains("no column of k")), "{:?}", index.warnings);
}

/// Returns the first value of the first spectrum of a panel, and the notes.
fn first_of_panel(name: &str, text: &str) -> (f64, Vec<String>) {
    let read = read_measured_panel(&data(name, text.as_bytes())).unwrap();
    let Quantity::Spectrum(spectrum) = &read.value[0].quantity else { panic!("{text}") };
    (spectrum.values()[0], read.warnings)
}

/// Per cent signs that have nothing to do with the values, and those that state their unit.
#[test]
fn only_titles_of_the_values_state_per_cent() {
    let values = "Sample,400 nm,550 nm,700 nm\nwhite,0.6,0.6,0.6\nblack,0.03,0.03,0.03\n";
    let titled = |title: &str| first_of_panel("panel.csv", &format!("{title}\n{values}")).0;
    for title in ["Instrument: CM-3600, UV 100 %", "Humidity: 45 %", "Fill factor (%),87"] {
        near(title, titled(title), 0.6, 1e-12);
    }
    for title in ["Reflectance (%)", "%R", "Unit: %", "Reflectance in %", "SCI, Reflectance %"] {
        near(title, titled(title), 0.006, 1e-12);
    }
    let beside = "Sample,Humidity (%),400 nm,550 nm,700 nm\nwhite,45,0.6,0.6,0.6\n";
    near("a column beside", first_of_panel("panel.csv", beside).0, 0.6, 1e-12);
    let own = "Sample,R_400 (%),R_550 (%),R_700 (%)\nwhite,0.6,0.6,0.6\n";
    near("columns of their own", first_of_panel("panel.csv", own).0, 0.006, 1e-12);
}

/// A display near the image of a lamp reflects more than a perfect white: 160 % are 1.6, whoever states the scale.
#[test]
fn per_cent_is_divided_once() {
    let wide = |title: &str, column: &str| {
        format!(
            "{title}Sample,{0},{1},{2}\nwhite,160,160,160\n",
            column.replace('#', "400"),
            column.replace('#', "550"),
            column.replace('#', "700")
        )
    };
    let cgats = |norm: &str, value: &str| {
        format!(
            "CGATS.17\n{norm}NUMBER_OF_FIELDS 4\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SPEC_400 SPEC_550 SPEC_700\nEND_DATA_FORMAT\n\
             NUMBER_OF_SETS 1\nBEGIN_DATA\nwhite {value} {value} {value}\nEND_DATA\n"
        )
    };
    for (name, text, notes) in [
        ("w.csv", wide("", "# nm"), 1),
        ("w.csv", wide("", "R_# (%)"), 0),
        ("w.csv", wide("Reflectance (%)\n", "# nm"), 0),
        ("w.txt", cgats("", "160"), 1),
        ("w.txt", cgats("SPECTRAL_NORM \"100\"\n", "160"), 0),
        ("w.txt", cgats("SPECTRAL_NORM \"1.0\"\n", "1.6"), 0),
    ] {
        let (found, all) = first_of_panel(name, &text);
        near(&text, found, 1.6, 1e-12);
        assert_eq!(all.iter().filter(|note| note.contains("per cent")).count(), notes, "{text}: {all:?}");
    }
}

/// Standard deviations have the unit of the values, unless they state their own.
#[test]
fn standard_deviations_keep_their_own_unit() {
    for (unit, written) in [(" (%)", "1"), (" (1)", "0.01"), ("", "1")] {
        let text = format!(
            "wavelength_nm,white,standard_deviation{unit}\n400,60,{written}\n550,60,{written}\n700,60,{written}\n"
        );
        let read = read_measured_panel(&data("panel.csv", text.as_bytes())).unwrap().value;
        let Some(StandardDeviation::Spectrum(found)) = &read[0].standard_deviation else { panic!("{text}") };
        near(&text, found.values()[0], 0.01, 1e-12);
    }
}

/// Angles of a light profile that reach pi/2 and state no unit; those of a few whole degrees, or with a unit, are read.
#[test]
fn profiles_that_are_probably_in_radians_are_refused() {
    let read = |text: &str| papilio_formats::read_profile(&data("room.csv", text.as_bytes()));
    let error = read("angle,radiance\n0,1\n0.5236,0.8\n1.0472,0.2\n1.5708,0\n").unwrap_err();
    assert!(error.to_string().contains("probably in radians"), "{error}");
    assert_eq!(error.place.line_column(), Some((5, 1)), "{error}");
    near("unit", read("angle (rad),radiance\n0,1\n0.5235987755982988,0.8\n").unwrap()[1].0, 30.0, 1e-9);
    for text in [
        "angle,radiance\n0,1\n1,0.5\n",
        "theta_deg,radiance\n0,1\n1.5,0.5\n",
        "angle,radiance\n0,1\n2.5,0.5\n",
    ] {
        assert!(read(text).is_ok(), "{text}");
    }
}

/// Rows of states and wavelengths follow the rule of columns of states: 45 is 45 %, 3 needs its unit, and the title of a wavelength may state it.
#[test]
fn rows_of_wavelengths_in_per_cent_are_divided() {
    let long = |unit: &str, value: &str| {
        let rows = ["400", "550", "700"].map(|nm| format!("white,0,{nm},{value}\n")).concat();
        let text = format!("state,theta_deg,wavelength_nm,reflectance_factor{unit}\n{rows}");
        read_measured_panel(&data("panel.csv", text.as_bytes())).map(|read| {
            let Quantity::Spectrum(spectrum) = &read.value[0].quantity else { panic!("{text}") };
            let notes = read.warnings.iter().filter(|note| note.contains("per cent")).count();
            (spectrum.values()[0], notes)
        })
    };
    for (unit, value, expected, notes) in [
        ("", "45", 0.45, 1),
        (" (%)", "45", 0.45, 0),
        (" (%)", "0.45", 0.0045, 0),
        ("", "1.2", 1.2, 0),
        (" (1)", "3", 3.0, 0),
    ] {
        let (found, noted) = long(unit, value).unwrap();
        near(&format!("{value}{unit}"), found, expected, 1e-12);
        assert_eq!(noted, notes, "{value}{unit}");
    }
    assert!(long("", "3").unwrap_err().to_string().contains("the values reach 3"));
    let own = "Sample,R_400 (1),R_550 (1),R_700 (1)\nwhite,0.6,0.6,0.6\n";
    near("a unit of 1", first_of_panel("panel.csv", own).0, 0.6, 1e-12);
}
