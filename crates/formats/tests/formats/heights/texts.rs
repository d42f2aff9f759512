//! Texts of heights: what programs export, and what is refused by its name.

use papilio_formats::HeightFile;

use super::read;

/// Heights 1 to 12 in three rows of four, from the lowest row on.
const HEIGHTS: [f64; 12] = [9.0, 10.0, 11.0, 12.0, 5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 4.0];

fn latin1(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
}

fn utf16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xFEFF).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

fn is_the_surface(name: &str, map: &HeightFile, pitch_um: Option<[f64; 2]>, unit_um: Option<f64>) {
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    assert_eq!((map.columns, &map.numbers[..]), (4, &HEIGHTS[..]), "{name}");
    match (map.pitch_um, pitch_um) {
        (Some([x, y]), Some([a, b])) => assert!(close(x, a) && close(y, b), "{name}: {x} {y}"),
        (found, expected) => assert_eq!(found, expected, "{name}"),
    }
    match (map.unit_um, unit_um) {
        (Some(found), Some(expected)) => assert!(close(found, expected), "{name}: {found}"),
        (found, expected) => assert_eq!(found, expected, "{name}"),
    }
}

/// Headers of programs, encodings, separators and decimal commas. Sizes are those of all heights: 2 um over
/// 4, 1.5 um over 3.
#[test]
fn texts_with_headers_are_read_with_their_sizes_and_units() {
    let gwyddion = "# Channel: Topography\n# Width: 2.0 \u{b5}m\n# Height: 1.5 \u{b5}m\n# Value units: nm\n1\t2\t3\t4\n5\t6\t7\t8\n9\t10\t11\t12\n";
    let german = "# Kanal: H\u{f6}he\n# Breite: 2,0 \u{b5}m\n# H\u{f6}he: 1500 nm\n# Einheiten: nm\n1,0\t2,0\t3,0\t4,0\n5\t6\t7\t8\n9\t10\t11\t12\n";
    let spip = "# File Format = ASCII\n# x-pixels = 4\n# y-pixels = 3\n# x-length = 2000\n# y-length = 1500\n# x-unit = nm\n# y-unit = nm\n\
                # z-unit = nm\n# Start of Data:\n1 2 3 4\n5 6 7 8\n9 10 11 12\n";
    let nova = "File Format = ASCII\nNX = 4\nNY = 3\nScale X = 0.5\nScale Y = 0.5\nUnit X = um\nUnit Data = nm\nStart of Data :\n1 2 3 4\n5 6 7 8\n\
                9 10 11 12\n";
    let esri = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 0.5\nNODATA_value -9999\n1 2 3 4\n5 6 7 8\n9 10 11 12\n";
    let cells = "Pixel Size,0.5,um\nColumns,4\nRows,3\nUnit Z,nm\n1,2,3,4\n5,6,7,8\n9,10,11,12\n";
    let commas =
        "Width (mm): 0,002\nHeight (mm): 0,0015\nZ unit: \u{c5}\n1,0;2,0;3,0;4,0;\n5;6;7;8\n9;10;11;12";
    let blanks = "X Pixels 4\nY Pixels 3\n1,0 2,00 3 4\n5,0 6 7 8\r\n9 10 11 12";
    let one_column: String = (1..=12).map(|k| format!("{k}\n")).collect();
    let wrapped = format!("columns = 4\nrows = 3\npitch = 0.5 um\n{one_column}");
    let half = Some([0.5, 0.5]);
    for (name, bytes, pitch_um, unit_um) in [
        ("Gwyddion", gwyddion.as_bytes().to_vec(), half, Some(1e-3)),
        ("Gwyddion in Latin-1", latin1(gwyddion), half, Some(1e-3)),
        ("Gwyddion in UTF-16", utf16(gwyddion), half, Some(1e-3)),
        ("Gwyddion in German", latin1(german), half, Some(1e-3)),
        ("SPIP", spip.as_bytes().to_vec(), half, Some(1e-3)),
        ("Nova", nova.as_bytes().to_vec(), half, Some(1e-3)),
        ("ESRI", esri.as_bytes().to_vec(), half, None),
        ("cells", cells.as_bytes().to_vec(), half, Some(1e-3)),
        ("decimal commas", latin1(commas), half, Some(1e-4)),
        ("decimal commas and blanks", blanks.as_bytes().to_vec(), None, None),
        ("a single column", wrapped.into_bytes(), half, None),
        ("rows alone", b"\xEF\xBB\xBF1, 2, 3, 4\r5, 6, 7, 8\r9, 10, 11, 12\r".to_vec(), None, None),
    ] {
        is_the_surface(
            name,
            &read(bytes).unwrap_or_else(|error| panic!("{name}: {error}")),
            pitch_um,
            unit_um,
        );
    }
    // A length without a unit is taken in um, and said to be.
    assert!(read(esri.into()).unwrap().warnings[0].contains("without a unit"));
    let noted = read(nova.replace("NX =", "Scanned by hand\nNX =").into()).unwrap();
    assert!(noted.warnings[0].contains("`Scanned by hand`"), "{:?}", noted.warnings);
}

/// Points in any order, with or without names and units.
#[test]
fn lists_of_points_are_put_on_their_grid() {
    let row = |at: usize| (0.5 * (at % 4) as f64, 0.5 * (at / 4) as f64, HEIGHTS[at]);
    let order = [3, 11, 0, 7, 5, 1, 2, 10, 8, 4, 9, 6];
    let list = |format: fn((f64, f64, f64)) -> String| order.map(row).map(format).concat();
    let plain = list(|(x, y, z)| format!("{x} {y} {z}\n"));
    let commas = list(|(x, y, z)| format!("{x:.4};{y:.4};{z:.4}\n").replace('.', ","));
    let named = format!(
        "Z (nm),I,X [mm],Y [mm]\n{}",
        list(|(x, y, z)| format!("{z},0.3,{},{}\n", 1e-3 * x, 1e-3 * y))
    );
    let half = Some([0.5, 0.5]);
    for (name, text, unit_um) in [
        ("plain", plain.clone(), None),
        ("comment", format!("# x y z\n{plain}"), None),
        ("decimal commas", format!("x_um;y_um;z_nm\n{commas}"), Some(1e-3)),
        ("named columns in any order", named, Some(1e-3)),
        ("Gwyddion", format!("# Channel: h\n# Lateral units: um\n# Value units: nm\n{plain}"), Some(1e-3)),
        // A stage that is off by a few per cent of a step.
        ("jitter", plain.replacen("1.5 0 ", "1.52 0.01 ", 1), None),
    ] {
        let map = read(text.into_bytes()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let pitch_um = if name == "jitter" { map.pitch_um } else { half };
        is_the_surface(name, &map, pitch_um, unit_um);
        assert!(map.warnings[0].contains("12 points x, y, z"), "{:?}", map.warnings);
    }
    for (text, expected) in [
        (plain.replacen("1.5 0 ", "1.5 7.3 ", 1), "not on a regular grid"),
        (plain.replacen("1.5 0 ", "1.0 0 ", 1), "two points at x 1, y 0"),
        (plain.replacen("1.5 0 12\n", "", 1), "1 of 12 heights are missing"),
        ("0 0 1\n1 1 2\n2 2 3\n3 3 4\n4 4 5\n5 5 6\n".to_owned(), "do not fill a grid of 6 x 6"),
        ("0 0 1\n1 0 2\n2 0 3\n3 0 4\n".to_owned(), "all points have the same y"),
        (
            "x,y,intensity\n0,0,1\n1,0,1\n0,1,1\n1,1,1\n".to_owned(),
            "the columns of this table are `x`, `y`, `intensity`",
        ),
        ("0 1\n1 2\n2 3\n3 4\n4 5\n".to_owned(), "as a profile x, z has"),
    ] {
        let found = read(text.into_bytes()).unwrap_err();
        assert!(found.contains(expected), "{expected}\n{found}");
    }
}

#[test]
fn zygo_and_wyko_texts_are_read() {
    let zygo = "Zygo XYZ Data File - Format 1\n1 9 1 90 0 \"a date\"\n0 0 0 0 0 0\n10 20 4 3\n\"\"\n\"\"\n\"\"\n0 0.5 6.328e-07 0 1 0 5e-07 0\n\
                a\nb\nc\nd\ne\n#\n";
    let points: String = (0..12).map(|at| format!("{} {} {}\n", 10 + at % 4, 20 + at / 4, at + 1)).collect();
    let map = read(format!("{zygo}{points}#\n").into()).unwrap();
    is_the_surface("Zygo", &map, Some([0.5, 0.5]), Some(1.0));
    let missing = format!("{zygo}{}#\n", points.replace("11 21 6", "11 21 No Data"));
    assert!(read(missing.into()).unwrap_err().contains("1 of 12 heights are missing"));
    let outside = format!("{zygo}{}#\n", points.replace("11 21 6", "19 21 6"));
    assert!(read(outside.into()).unwrap_err().contains("no place within the rectangle"));

    // A line for each place along x, from the lowest y.
    let lines = "9 5 1\n10 6 2\n11 7 3\n12 8 4\n";
    let wyko = |flag: u8| {
        format!(
            "Wyko ASCII Data File Format 0 {flag} 1\nX Size\t4\nY Size\t3\nBlock Name\tType\tLength\tValue\nWavelength\t7\t4\t500\nAspect\t7\t4\t1\n\
             Mult\t7\t4\t2\nPixel_size\t7\t4\t0.0005\nRAW_DATA\t3\t54\n{lines}"
        )
    };
    is_the_surface("Wyko", &read(wyko(1).into()).unwrap(), Some([0.5, 0.5]), Some(1e-3));
    is_the_surface("Wyko in wavelengths", &read(wyko(0).into()).unwrap(), Some([0.5, 0.5]), Some(0.25));
    let bad = wyko(1).replace("10 6 2", "10 Bad 2");
    assert!(read(bad.into()).unwrap_err().contains("1 of 12 heights are missing"));
}

#[test]
fn what_a_text_says_and_is_not_understood_is_refused() {
    let rows = "1 2 3 4\n5 6 7 8\n9 10 11 12\n";
    for (head, expected) in [
        ("# Value units: V\n", "`V` is not a unit of length"),
        ("# Width: two um\n", "a number above 0 is expected"),
        ("Z magnification scale: 3\n", "is not understood, and seems to state a size, a scale or a unit"),
        ("# Bit2nm = 0.1\n", "is not understood"),
        ("columns = 5\n", "the header states 5 columns, and the rows have 4"),
        ("columns = 4\nrows = 4\n", "the header states 4 x 4 heights, and the file has 12"),
    ] {
        let found = read(format!("{head}{rows}").into()).unwrap_err();
        assert!(
            found.contains(expected) && (found.contains("map:1:") || head.starts_with('c')),
            "{expected}\n{found}"
        );
    }
    let found = read(b"1 2 3\n4 five 6\n".to_vec()).unwrap_err();
    assert!(found.contains("map:2:3"), "{found}");
}

/// Every convention for heights that were not measured is counted, and none is taken as a height.
#[test]
fn missing_heights_are_refused_with_their_number() {
    let rows = |cell: &str| format!("1.5;2;3;4\n5;{cell};7;8\n9;10;11;12\n").into_bytes();
    for cell in [
        "NaN",
        "nan",
        "BAD",
        "",
        "No Data",
        "NODATA",
        "N/A",
        "null",
        "inf",
        "-inf",
        "-",
        "***",
        "-9999",
        "-9999.0",
        "-32768",
        "32767",
        "2147483647",
        "1e38",
        "-3.4028235e38",
        "1.70141e38",
    ] {
        let found = read(rows(cell)).unwrap_err();
        assert!(found.contains("1 of 12 heights are missing"), "{cell}: {found}");
    }
    // Heights like any other, and the number that the file declares.
    read(rows("-12")).unwrap();
    let declared = [b"nodata_value: 6.0\n".to_vec(), rows("6")].concat();
    assert!(read(declared).unwrap_err().contains("1 of 12 heights are missing"));
}
