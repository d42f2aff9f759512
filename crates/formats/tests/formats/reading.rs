//! Readers of tables and indices: accepted files, and errors with their places.

use papilio_formats::{
    DataFile, FormatError, PixelTable, Problem, is_name, read_fractions, read_index, read_index_within,
    read_light, read_pixel_table, read_spectrum,
};
use papilio_spectra::{Grid, material};

fn file(text: &str) -> DataFile {
    DataFile { name: "data.csv".to_owned(), bytes: text.as_bytes().to_vec() }
}

fn place<T: std::fmt::Debug>(result: Result<T, FormatError>) -> (Option<(usize, usize)>, Problem) {
    let error = result.unwrap_err();
    (error.place.line_column(), error.problem)
}

fn is_of_page(problem: &Problem) -> bool {
    problem.to_string().contains("this page of refractiveindex.info cannot be read")
}

#[test]
fn spectrum_with_any_separator_header_or_order_is_read() {
    for text in [
        "400,1\n500,3\n",
        "# c\nnm;R\r\n400;1\r\n500;3\r\n",
        "\u{feff}nm R\n400 1\n500 3",
        "400\t1\n\n500\t3",
        "500,3\n400,1\n",
    ] {
        assert_eq!(read_spectrum(&file(text)).unwrap().at(450.0).unwrap(), 2.0, "{text:?}");
    }
}

#[test]
fn malformed_spectrum_is_an_error_with_its_place() {
    let bad = |text: &str| place(read_spectrum(&file(text)));
    assert_eq!(bad("nm,R\n400,1\n500,NaN\n"), (Some((3, 5)), Problem::NotFinite { found: "NaN".to_owned() }));
    assert_eq!(bad("400,1\n500,x\n"), (Some((2, 5)), Problem::NotANumber { found: "x".to_owned() }));
    assert_eq!(bad("400,1\n400,2\n"), (Some((2, 1)), Problem::OutOfOrder { nm: 400.0, before: 400.0 }));
    assert!(matches!(bad("400,1\n500,1,2\n"), (Some((2, 1)), Problem::Columns { found: 3, .. })));
    // Descending wavelengths are accepted, but not a change of direction.
    assert_eq!(
        bad("500,1\n400,2\n450,3\n"),
        (Some((3, 1)), Problem::OutOfOrder { nm: 450.0, before: 400.0 })
    );
    assert_eq!(bad("0.5,1\n0.4,2\n"), (None, Problem::Micrometres));
    assert_eq!(bad("0.4,1\n0.5,2\n"), (None, Problem::Micrometres));
    assert_eq!(bad(""), (None, Problem::TooFew { rows: 0 }));
    assert_eq!(bad("nm,R\n400,1\n"), (None, Problem::TooFew { rows: 1 }));
    assert!(matches!(bad("-400,1\n500,1\n"), (Some((1, 1)), Problem::OutOfRange { .. })));
}

#[test]
fn error_message_shows_the_line_and_a_hint() {
    let error = read_spectrum(&file("400,1\n500,1e999\n")).unwrap_err();
    let expected = "error: `1e999` is not a finite number\n --> data.csv:2:5\n  |\n2 | 500,1e999\n  |     ^^^^^ \
                    expected a finite number\n  = help: remove the row, or enter its value";
    assert_eq!(error.to_string(), expected);
}

/// A header contains no number: a first row with a typing error is an error, not a header.
#[test]
fn first_row_with_a_typing_error_is_not_a_header() {
    let bad = |text: &str| place(read_spectrum(&file(text)));
    let mistyped = Problem::NotANumber { found: "36O".to_owned() };
    assert_eq!(bad("36O,0.9\n380,1\n780,1\n"), (Some((1, 1)), mistyped));
    assert_eq!(bad(",0.5\n380,1\n780,1\n"), (Some((1, 1)), Problem::EmptyCell));
    assert_eq!(bad("380,1\n500,\n780,1\n"), (Some((2, 5)), Problem::EmptyCell));
}

#[test]
fn wrong_number_of_columns_or_rows_has_a_hint() {
    let shown = |text: &str| read_spectrum(&file(text)).unwrap_err().to_string();
    assert!(
        shown("380\n").contains("this row has 1 column\n") && shown("380\n").contains("separate the columns")
    );
    assert!(shown("380,1,2\n").contains("remove the additional columns"));
    assert!(shown("380,1\n").contains("too few rows of data") && shown("380,1\n").contains("at least two"));
    assert!(shown("380,\"1\n").contains("the quotation marks of this cell do not match"));
}

#[test]
fn value_out_of_range_is_an_error_with_its_place() {
    let fractions = |text: &str| place(read_fractions(&file(text)));
    let (at, problem) = fractions("nm,R\n380,0.1\n780,20\n");
    assert!(matches!(problem, Problem::OutOfRange { what: "the fraction", value: 20.0, .. }));
    assert_eq!(at, Some((3, 5)));
    let light = |text: &str| place(read_light(&file(text)));
    assert!(matches!(light("380,1\n780,-2\n"), (Some((2, 5)), Problem::OutOfRange { value: -2.0, .. })));
    assert!(matches!(light("380,1\n780,2e30\n"), (Some((2, 5)), Problem::OutOfRange { .. })));
    assert!(matches!(light("380,1e-31\n780,1e-40\n"), (None, Problem::OutOfRange { .. })));
    assert_eq!(read_light(&file("380,0\n780,1e-30\n")).unwrap().values(), [0.0, 1e-30]);
}

#[test]
fn negative_k_is_an_error_with_the_sign_convention() {
    let page = "DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1 -2\n      0.5 2 -3\n";
    for text in ["400,2,-1\n600,3,-1\n", page] {
        let error = read_index(&file(text)).unwrap_err().to_string();
        assert!(error.contains("n + ik") && error.contains("change the sign"), "{error}");
    }
}

#[test]
fn index_table_with_or_without_k_is_read() {
    let index = read_index(&file("nm,n,k\n400,2,0.2\n600,3,0.4\n")).unwrap().index(500.0).unwrap();
    assert!((index.re - 2.5).abs() < 1e-12 && (index.im - 0.3).abs() < 1e-12);
    assert_eq!(read_index(&file("400,2\n600,3\n")).unwrap().index(600.0).unwrap().im, 0.0);
    assert!(matches!(
        place(read_index(&file("400,2,1\n600,3,-1\n"))),
        (Some((2, 7)), Problem::OutOfRange { .. })
    ));
    assert!(matches!(place(read_index(&file("400,2,1\n600,3\n"))), (Some((2, 1)), Problem::Columns { .. })));
}

const SELLMEIER: &str = "# CC0
REFERENCES: |
    Malitson 1965
DATA:
  - type: formula 1
    wavelength_range: 0.21 6.7
    coefficients: 0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161
  - type: tabulated k
    data: |
        0.3 0.0
        0.9 0.06
  - type: formula n2
    coefficients: 1
";

/// The formula of the page is the built-in SiO2 (n_d 1.458464, Malitson 1965); k comes from the second entry.
#[test]
fn page_with_formula_and_table_is_read() {
    let page = read_index(&file(SELLMEIER)).unwrap();
    assert_eq!(page.range_nm(), (300.0, 900.0));
    let index = page.index(587.5618).unwrap();
    assert!((index.re - 1.458464).abs() < 1e-6);
    assert!((index.im - 0.06 * 287.5618 / 600.0).abs() < 1e-12);
    assert_eq!(index.re, material("SiO2").unwrap().index(587.5618).unwrap().re);
}

#[test]
fn page_with_a_table_or_a_single_coefficient_is_read() {
    let page = "DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1 2\n      0.5 2 3\n";
    let index = read_index(&file(page)).unwrap().index(450.0).unwrap();
    assert!((index.re - 1.5).abs() < 1e-12 && (index.im - 2.5).abs() < 1e-12);
    let falling = "DATA:\n  - type: tabulated nk\n    data: |\n      0.5 2 3\n      0.4 1 2\n";
    assert_eq!(read_index(&file(falling)).unwrap(), read_index(&file(page)).unwrap());
    let constant = "DATA:\n - type: \"formula 5\"\n   range: 0.3 0.9\n   coefficients: 1.5\n";
    assert_eq!(read_index(&file(constant)).unwrap().index(500.0).unwrap().re, 1.5);
}

/// Pages as other programs rewrite them: different quotes and order, rows in quotes, folded text.
#[test]
fn page_in_equivalent_yaml_is_read_equally() {
    let page = "DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1 2\n      0.5 2 3\n";
    let read = read_index(&file(page)).unwrap();
    for same in [
        "REFERENCES: 'a: b # c'\nDATA:\n- data: '0.4 1 2\n\n    0.5 2 3\n\n    '\n  type: tabulated nk\nSPECS:\n  - a\n",
        "DATA: # rows\n-   name: x\n    more:\n    - {a: b}\n    type: \"tabulated nk\" # um\n    data: \"0.4 1 2\\n0.5\\\n        \\ 2 3\\n\"\n",
        "---\nDATA:\r\n# two rows\r\n- type: 'tabulated nk'\r\n\r\n  data: |-\r\n    0.4 1 2\r\n\r\n    0.5 2 3\r\n...\r\n",
        "DATA:\n-\n  type: tabulated\n    nk\n  data: >2\n      0.4 1 2\n\n      0.5 2 3\n# end\n",
    ] {
        assert_eq!(read_index(&file(same)).unwrap_or_else(|e| panic!("{same}: {e}")), read, "{same}");
    }
}

#[test]
fn page_with_malformed_yaml_is_an_error_with_its_place() {
    for (text, place_of) in [
        ("DATA: 5\n", (1, 7)),
        ("DATA:\n  type: formula 1\n", (2, 3)),
        ("DATA:\n  - type: formula 1\n    type: formula 2\n", (3, 5)),
        ("DATA:\n  - type: formula 1\n      data: |\n   coefficients: 1\n", (4, 4)),
        ("DATA:\n  - type: tabulated nk\n\tdata: |\n      0.4 1 2\n", (3, 1)),
        ("DATA:\n  - type: tabulated nk\n    data: [0.4, 1, 2]\n", (3, 11)),
        ("DATA:\n  - type: tabulated nk\n    data: \"0.4 1 2\n", (3, 11)),
        ("DATA:\n  - type: tabulated nk\n    data: | 0.4 1 2\n", (3, 11)),
        ("DATA:\n  - type: tabulated nk\n    rows\n", (3, 5)),
        ("DATA:\n  - data: |\n      0.4 1 2\n", (2, 3)),
        ("DATA:\n  - type: tabulated nk\nDATA:\n", (3, 1)),
    ] {
        let (at, problem) = place(read_index(&file(text)));
        assert!(is_of_page(&problem) && at == Some(place_of), "{text}: {at:?} {problem:?}");
    }
}

#[test]
fn page_with_invalid_data_is_an_error_with_its_place() {
    let bad = |text: String| place(read_index(&file(&text)));
    let wrong = bad(SELLMEIER.replace("0.9 0.06", "0.9 nan"));
    assert_eq!(wrong, (Some((11, 9)), Problem::NotFinite { found: "nan".to_owned() }));
    let wrong = bad(SELLMEIER.replace("formula 1\n", "formula 12\n"));
    assert_eq!(
        (wrong.0, wrong.1.to_string()),
        (Some((5, 11)), "`formula 12` is not a known type of optical data".to_owned())
    );
    let wrong = bad(SELLMEIER.replace("0.9 0.06", "0.9 0.06 3"));
    assert!(matches!(wrong, (Some((11, 9)), Problem::Columns { found: 3, .. })));
    assert!(is_of_page(&bad(SELLMEIER.replace("    wavelength_range: 0.21 6.7\n", "")).1));
    assert!(is_of_page(&bad("DATA:\n  - [\n".to_owned()).1));
    assert_eq!(bad("DATA: []\n".to_owned()).1.to_string(), "no entry of `DATA` holds the refractive index n");
}

/// Faults of a page that do not affect 400 to 700 nm become notes, and the data end before them; faults that
/// do remain errors. Values are linear in wavelength, so that any correct result has n = nm/400.
#[test]
fn page_with_faults_outside_the_wanted_wavelengths_is_read_with_notes() {
    let page = |kind: &str, rows: &str| {
        let rows: String = rows.split(';').map(|row| format!("      {}\n", row.trim())).collect();
        format!("DATA:\n  - type: tabulated {kind}\n    data: |\n{rows}")
    };
    let within = |text: &str| read_index_within(&file(text), (400.0, 700.0));
    let sound = "0.36 0.9; 0.40 1.0; 0.60 1.5; 0.80 2.0";
    assert_eq!(within(&page("n", sound)).unwrap().warnings, Vec::<String>::new());
    assert_eq!(within(&page("n", sound)).unwrap().value, read_index(&file(&page("n", sound))).unwrap());
    for (rows, line) in [
        // Repeated, below and above; unsorted; negative.
        ("0.36 0.9; 0.36 0.8; 0.40 1.0; 0.60 1.5; 0.80 2.0", 5),
        ("0.36 0.9; 0.40 1.0; 0.60 1.5; 0.80 2.0; 0.90 2.2; 0.90 2.1", 9),
        ("0.36 0.9; 0.40 1.0; 0.60 1.5; 0.80 2.0; 0.90 2.2; 0.85 2.1; 0.95 2", 9),
        ("0.30 0.1; 0.36 -0.9; 0.40 1.0; 0.60 1.5; 0.80 2.0", 5),
        ("0.90 2; 0.90 2.2; 0.80 2.0; 0.60 1.5; 0.40 1.0; 0.36 0.9", 5),
        // A repeated neighbour of the wanted wavelengths with equal values.
        ("0.36 0.9; 0.36 0.9; 0.60 1.5; 0.80 2.0", 5),
    ] {
        let text = page("n", rows);
        assert!(read_index(&file(&text)).is_err(), "{rows}");
        let read = within(&text).unwrap();
        assert!((read.value.index(450.0).unwrap().re - 450.0 / 400.0).abs() < 1e-12, "{rows}");
        let [note] = &read.warnings[..] else { panic!("{rows}: {:?}", read.warnings) };
        assert!(note.contains(&format!("line {line}:")) && note.contains("400 to 700 nm"), "{rows}: {note}");
    }
    for (rows, line) in [
        ("0.36 0.9; 0.50 1.25; 0.50 1.3; 0.60 1.5; 0.80 2.0", 6),
        ("0.36 0.9; 0.60 1.5; 0.50 1.25; 0.80 2.0", 6),
        ("0.36 0.9; 0.50 -1.25; 0.60 1.5; 0.80 2.0", 5),
        // The neighbour of 400 nm is repeated or negative.
        ("0.36 0.9; 0.36 0.8; 0.60 1.5; 0.80 2.0", 5),
        ("0.30 0.75; 0.36 -0.9; 0.60 1.5; 0.80 2.0", 5),
        // The neighbour of 700 nm is repeated or out of order.
        ("0.36 0.9; 0.60 1.5; 0.80 2.0; 0.80 2.1", 7),
        ("0.36 0.9; 0.60 1.5; 0.80 2.0; 0.79 2.1; 0.9 2", 7),
    ] {
        let error = within(&page("n", rows)).unwrap_err();
        assert_eq!(error.place.line_column().map(|(line, _)| line), Some(line), "{rows}: {error}");
    }
}

/// The message about a faulty k of a formula page has its row; two entries for n are an error only if both
/// have wanted wavelengths.
#[test]
fn page_with_faulty_k_or_two_entries_for_n_is_read_where_unaffected() {
    let page = SELLMEIER.replace("0.9 0.06", "0.9 0.06\n        2.4 -0.0000138");
    let (at, problem) = place(read_index(&file(&page)));
    assert_eq!(at, Some((12, 9)));
    assert!(matches!(problem, Problem::OutOfRange { what: "k", value: -0.0000138, .. }), "{problem:?}");
    let read = read_index_within(&file(&page), (400.0, 700.0)).unwrap();
    assert!((read.value.index(587.5618).unwrap().re - 1.458464).abs() < 1e-6);
    assert!(
        read.warnings[0].contains("line 12") && read.warnings[0].contains("k was read"),
        "{:?}",
        read.warnings
    );
    let two = "DATA:\n - type: formula 5\n   wavelength_range: 1.0 2.0\n   coefficients: 1.6\n - type: formula 5\n   wavelength_range: 0.3 0.9\n   coefficients: 1.5\n";
    assert!(read_index(&file(two)).is_err());
    let read = read_index_within(&file(two), (400.0, 700.0)).unwrap();
    assert_eq!((read.value.index(500.0).unwrap().re, read.warnings.len()), (1.5, 1));
    let (at, _) = place(read_index_within(&file(&two.replace("1.0 2.0", "0.6 2.0")), (400.0, 700.0)));
    assert_eq!(at.map(|(line, _)| line), Some(5));
}

const PIXEL: &str = "state,theta_deg,wavelength_nm,reflectance
white,30,400,0.3
white,0,400,0.1
white,0,500,0.2
white,30,500,0.4
\"dim, grey\",0,400,0
\"dim, grey\",0,500,0.5
\"dim, grey\",30,400,1
\"dim, grey\",30,500,1
";

#[test]
fn pixel_table_in_any_order_reads_back() {
    let table = read_pixel_table(&file(PIXEL)).unwrap();
    assert_eq!(
        (table.theta_deg.as_slice(), table.wavelength_nm.as_slice()),
        (&[0.0, 30.0][..], &[400.0, 500.0][..])
    );
    assert_eq!(table.states[0], ("white".to_owned(), vec![0.1, 0.2, 0.3, 0.4]));
    assert_eq!(table.states[1].0, "dim, grey");
    let grid = Grid::new(400.0, 500.0, 50.0).unwrap();
    let spectra = table.spectra(0, &grid).unwrap();
    assert!((spectra[1][1] - 0.35).abs() < 1e-12);
    let mut text = Vec::new();
    table.write(&mut text).unwrap();
    assert_eq!(read_pixel_table(&DataFile { name: "again".to_owned(), bytes: text }).unwrap(), table);
}

#[test]
fn numbers_of_a_pixel_table_read_back_bit_for_bit() {
    let values: Vec<f64> = (0..12).map(|i| f64::from(i).sqrt() / 7.3).collect();
    let table = PixelTable {
        theta_deg: vec![0.0, 0.1 + 0.2, 90.0],
        phi_deg: Vec::new(),
        wavelength_nm: vec![380.0, 1e3 / 2.3, 500.0, 780.0],
        states: vec![("a".to_owned(), values)],
    };
    let mut text = Vec::new();
    table.write(&mut text).unwrap();
    assert_eq!(read_pixel_table(&DataFile { name: "t".to_owned(), bytes: text }).unwrap(), table);
}

/// A table with any permitted name of a state reads back.
#[test]
fn pixel_table_with_unusual_names_reads_back() {
    let names =
        ["#1", "# c", "q\"x\"", "\"", "\"\"", "a, b", "a; b", "it's 5\"", "a\tb", " white ", "white", "0"];
    let states = names.map(|name| (name.to_owned(), vec![0.25, 0.5]));
    let write = |states: &[(String, Vec<f64>)]| {
        let table = PixelTable {
            theta_deg: vec![0.0],
            phi_deg: Vec::new(),
            wavelength_nm: vec![400.0, 500.0],
            states: states.to_vec(),
        };
        let mut bytes = Vec::new();
        table.write(&mut bytes).unwrap();
        (table, DataFile { name: "t".to_owned(), bytes })
    };
    for state in &states {
        let (table, file) = write(std::slice::from_ref(state));
        match is_name(&state.0) {
            true => assert_eq!(read_pixel_table(&file).unwrap(), table),
            false => {
                assert_eq!(place(read_pixel_table(&file)), (Some((2, place_of(&file))), Problem::BadName))
            }
        }
    }
    let good: Vec<_> = states.into_iter().filter(|(name, _)| is_name(name)).collect();
    assert_eq!(good.len(), 10);
    let (table, file) = write(&good);
    assert_eq!(read_pixel_table(&file).unwrap(), table);
}

/// Returns the column of the first name below the header: after its quote, if it has one.
fn place_of(file: &DataFile) -> usize {
    let text = file.text().unwrap();
    1 + usize::from(text.lines().nth(1).unwrap().starts_with('"'))
}

#[test]
fn comments_of_a_pixel_table_are_skipped() {
    let commented =
        format!("# made, by, a, tool\n{}", PIXEL.replace("white,0,400", "# half way\nwhite,0,400"));
    assert_eq!(read_pixel_table(&file(&commented)).unwrap(), read_pixel_table(&file(PIXEL)).unwrap());
    let mistyped = PIXEL.replace("white,0,400", "#white,0,4OO");
    assert_eq!(place(read_pixel_table(&file(&mistyped))).0, Some((3, 10)));
    let empty = PIXEL.replace("white,0,400,0.1", "white,0,400,");
    assert_eq!(place(read_pixel_table(&file(&empty))), (Some((3, 13)), Problem::EmptyCell));
}

#[test]
fn malformed_pixel_table_is_an_error_with_its_place() {
    let bad = |from: &str, to: &str| place(read_pixel_table(&file(&PIXEL.replace(from, to))));
    let stated = |(place, problem): (_, Problem)| (place, problem.to_string());
    let header = "this is not the header of a pixel table".to_owned();
    assert_eq!(stated(bad(",reflectance", "")), (Some((1, 1)), header));
    assert_eq!(
        bad("0,500,0.2", "0,500,nan"),
        (Some((4, 13)), Problem::NotFinite { found: "nan".to_owned() })
    );
    let range = bad("0,500,0.2", "0,500,20");
    assert!(matches!(range, (Some((4, 13)), Problem::OutOfRange { what: "reflectance", value: 20.0, .. })));
    let hole = "state `white` has no row for 0 deg and 500 nm".to_owned();
    assert_eq!(stated(bad("white,0,500,0.2\n", "")), (None, hole));
    let twice = "state `white` at 0 deg and 400 nm has two rows".to_owned();
    assert_eq!(stated(bad("white,0,500,0.2", "white,0,400,0.1")), (Some((4, 1)), twice));
    let (_, normal) = bad(",0,", ",5,");
    assert_eq!(normal.to_string(), "the smallest angle is 5 deg");
    assert!(matches!(bad("30,400,0.3", "91,400,0.3"), (Some((2, 7)), Problem::OutOfRange { .. })));
    assert_eq!(place(read_pixel_table(&file(""))).1, Problem::TooFew { rows: 0 });
    assert_eq!(
        place(read_pixel_table(&file("state,theta_deg,wavelength_nm,reflectance\n"))).1,
        Problem::TooFew { rows: 0 }
    );
}

/// The time for a line of separators is proportional to its length, and the memory is small.
#[test]
fn long_line_of_separators_is_refused_quickly() {
    for byte in [b' ', b',', b';', b'"', b'\t', b'#'] {
        let bytes = [&b"1 "[..], &vec![byte; papilio_testing::sized(1 << 18, 4 << 20)], b" 1"].concat();
        let file = DataFile { name: "x".to_owned(), bytes };
        assert!(
            read_spectrum(&file).is_err() && read_pixel_table(&file).is_err() && read_index(&file).is_err()
        );
    }
}

/// Every single-byte change of a valid file is read or refused, with a short message.
#[test]
fn table_with_a_changed_byte_never_panics() {
    for good in [SELLMEIER, PIXEL, "nm,n,k\n400,2,0.2\n600,3,0.4\n"] {
        for at in 0..good.len() {
            // Each day three at each place, in turn.
            let all = [0, b'\n', b'"', b',', b'-', b'9', b':', b'e', 0xFF];
            for byte in papilio_testing::everyday(3, all.into_iter().cycle().skip(2 * at).take(all.len())) {
                let mut bytes = good.as_bytes().to_vec();
                bytes[at] = byte;
                let file = DataFile { name: "x".to_owned(), bytes };
                for shown in [
                    read_index(&file).err().map(|e| e.to_string()),
                    read_spectrum(&file).err().map(|e| e.to_string()),
                    read_pixel_table(&file).err().map(|e| e.to_string()),
                ] {
                    assert!(shown.is_none_or(|text| text.len() < 2000));
                }
            }
        }
    }
}

/// The CSV that refractiveindex.info offers: two blocks, wavelengths in um, which may differ.
#[test]
fn download_of_refractiveindex_info_is_read() {
    let text = "wl,n\n0.4,2\n0.6,3\n\nwl,k\n0.4,1\n0.5,2\n0.7,4\n";
    let index = read_index(&file(text)).unwrap();
    let at = index.index(500.0).unwrap();
    assert!((at.re - 2.5).abs() < 1e-12 && (at.im - 2.0).abs() < 1e-12, "{at}");
    assert!(index.index(650.0).is_err(), "n ends at 600 nm");
    assert_eq!(read_index(&file("wl,n\n0.4,1.5\n0.6,1.5\n")).unwrap().index(500.0).unwrap().im, 0.0);
    // Wavelengths that are in fact in nm.
    assert!(
        (read_index(&file("wl,n\n400,1.5\n600,1.7\n")).unwrap().index(500.0).unwrap().re - 1.6).abs() < 1e-12
    );
    let bad = |from: &str, to: &str| place(read_index(&file(&text.replacen(from, to, 1))));
    assert!(matches!(bad("0.6,3", "0.6,-3"), (Some((3, 5)), Problem::OutOfRange { what: "n", .. })));
    assert!(matches!(bad("0.6,3", "0.4,3"), (Some((3, 1)), Problem::OutOfOrder { .. })));
    assert!(matches!(bad("0.6,3", "0.6,3,1"), (Some((3, 1)), Problem::Columns { found: 3, .. })));
    assert!(matches!(bad("wl,k", "wl,n"), (Some((5, 1)), problem) if is_of_page(&problem)));
    assert!(matches!(bad("wl,n\n0.4,2\n0.6,3\n\n", ""), (None, problem) if is_of_page(&problem)));
    assert!(matches!(bad("0.4,2\n", ""), (Some((1, 1)), Problem::TooFew { rows: 1 })));
}
