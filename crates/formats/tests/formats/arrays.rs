//! Conoscopic maps and BSDFs as arrays and tables, read by a small independent reader of the formats.

use papilio_display::result::ReferenceWhite;
use papilio_display::{
    BrdfGrid, BrdfState, BrdfTable, ConeLight, ConeResult, ConeState, ConeView, RowErrors,
};
use papilio_formats::{
    BsdfSource, CONE_QUANTITIES, ConeFile, write_bsdf, write_cone_csv, write_cone_npy, write_json,
};

/// An array: type, shape, bytes.
struct Array<'a> {
    descr: String,
    shape: Vec<usize>,
    data: &'a [u8],
}

impl<'a> Array<'a> {
    /// Reads an array according to NumPy's description of the format.
    fn read(bytes: &'a [u8]) -> Self {
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((10 + length) % 64, 0, "data are aligned");
        let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
        assert!(header.ends_with('\n') && header.contains("'fortran_order': False"));
        let between = |start: &str, end: &str| {
            let (_, rest) = header.split_once(start).unwrap();
            rest.split_once(end).unwrap().0.to_owned()
        };
        let shape = between("'shape': (", ")");
        let shape = shape.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().unwrap());
        Self { descr: between("'descr': '", "'"), shape: shape.collect(), data: &bytes[10 + length..] }
    }

    fn numbers(&self) -> Vec<f64> {
        let count: usize = self.shape.iter().product();
        let numbers: Vec<f64> = match self.descr.as_str() {
            "<f8" => self.data.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect(),
            "<f4" => self.data.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()).into()).collect(),
            other => panic!("{other} is not a numeric type"),
        };
        assert_eq!(numbers.len(), count);
        numbers
    }

    fn texts(&self) -> Vec<String> {
        let width: usize = self.descr.strip_prefix("<U").unwrap().parse().unwrap();
        let text = |bytes: &[u8]| {
            let codes = bytes.chunks(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()));
            codes.take_while(|code| *code != 0).map(|code| char::from_u32(code).unwrap()).collect()
        };
        let texts: Vec<String> = self.data.chunks(4 * width).map(text).collect();
        assert_eq!(texts.len(), self.shape.iter().product::<usize>());
        texts
    }
}

/// Returns the uncompressed files of a zip archive, found through its central directory (PKWARE's APPNOTE,
/// 4.3).
fn unzip(bytes: &[u8]) -> Vec<(String, &[u8])> {
    let two = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let four = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let end = (0..bytes.len() - 21).rev().find(|at| &bytes[*at..at + 4] == b"PK\x05\x06").unwrap();
    let (count, mut at) = (two(end + 10), four(end + 16));
    let mut files = Vec::new();
    for _ in 0..count {
        assert_eq!(&bytes[at..at + 4], b"PK\x01\x02");
        assert_eq!(two(at + 10), 0, "stored");
        let (size, name, local) = (four(at + 20), two(at + 28), four(at + 42));
        let text = std::str::from_utf8(&bytes[at + 46..at + 46 + name]).unwrap().to_owned();
        let start = local + 30 + two(local + 26) + two(local + 28);
        files.push((text, &bytes[start..start + size]));
        at += 46 + name + two(at + 30) + two(at + 32);
    }
    files
}

/// A map of 3 inclinations, 2 azimuths and 2 states, with Y = 10 x view + state.
fn cone() -> ConeResult {
    let view = |k: usize| ConeView {
        contrast_ratio: (k > 0).then_some(k as f64),
        gamut_percent_srgb: Some(1.0 / 3.0),
        gamut_percent_ebu: None,
        states: (0..2)
            .map(|s| ConeState {
                reflectance_factor_y: (10 * k + s) as f64,
                luminance_cd_m2: 0.1,
                u_prime: Some(0.2),
                v_prime: Some(0.3),
                uv_shift: (s == 0).then_some(0.4),
                lab: Some(papilio_colour::Lab { l: 50.0, a: -1.5, b: 2.5 }),
                delta_e_2000: (s == 0).then_some(3.5),
                delta_e_1976: None,
            })
            .collect(),
    };
    ConeResult {
        theta_deg: vec![0.0, 10.0, 20.0],
        phi_deg: vec![0.0, 90.0],
        reference_deg: [8.0, 90.0],
        reference_white: ReferenceWhite::Display,
        states: vec!["white, bright".to_owned(), "black".to_owned()],
        views: (0..6).map(view).collect(),
        views_deg: vec![[8.0, 0.0]],
        lights: vec![ConeLight { theta_deg: -20.0, phi_deg: 0.0, radius_deg: 0.25 }],
        nodes: 64,
        discretisation_error: 3e-5,
        row_errors: RowErrors::default(),
        warnings: vec![],
    }
}

#[test]
fn cone_array_has_the_axes_theta_phi_state_and_quantity() {
    let mut bytes = Vec::new();
    write_cone_npy(&mut bytes, &cone()).unwrap();
    let array = Array::read(&bytes);
    assert_eq!((array.descr.as_str(), array.shape.as_slice()), ("<f8", &[3, 2, 2, 13][..]));
    let numbers = array.numbers();
    let at = |theta: usize, phi: usize, state: usize, quantity: &str| {
        let quantity = CONE_QUANTITIES.iter().position(|name| *name == quantity).unwrap();
        numbers[((theta * 2 + phi) * 2 + state) * 13 + quantity]
    };
    // View 4 of the map is theta 1, phi 1: theta varies fastest there.
    assert_eq!((at(1, 1, 0, "Y"), at(1, 1, 1, "Y"), at(2, 0, 0, "Y")), (40.0, 41.0, 20.0));
    assert_eq!((at(1, 1, 0, "contrast_ratio"), at(1, 1, 0, "uv_shift")), (4.0, 0.4));
    assert!(at(0, 0, 0, "contrast_ratio").is_nan() && at(0, 0, 1, "uv_shift").is_nan());
    assert!(at(2, 1, 0, "gamut_percent_ebu").is_nan());
    assert_eq!(at(2, 1, 0, "gamut_percent_srgb"), 1.0 / 3.0);
    assert_eq!((at(2, 1, 0, "L_star"), at(2, 1, 1, "a_star"), at(0, 0, 1, "b_star")), (50.0, -1.5, 2.5));
    assert!(at(0, 0, 1, "delta_E_2000_with_angle").is_nan());
    assert_eq!(at(0, 0, 0, "delta_E_2000_with_angle"), 3.5);
}

#[test]
fn cone_table_has_a_row_for_each_direction_and_state() {
    let mut bytes = Vec::new();
    write_cone_csv(&mut bytes, &cone()).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "theta_deg,phi_deg,state,Y,luminance_cd_m2,u_prime,v_prime,uv_shift,contrast_ratio,gamut_percent_srgb,gamut_percent_ebu,\
         L_star,a_star,b_star,delta_E_2000_with_angle,delta_E_1976_with_angle"
    );
    assert_eq!(lines.len(), 13);
    assert_eq!(lines[1], "0,0,\"white, bright\",0,0.1,0.2,0.3,0.4,,0.3333333333333333,,50,-1.5,2.5,3.5,");
    assert_eq!(lines[10], "10,90,black,41,0.1,0.2,0.3,,4,0.3333333333333333,,50,-1.5,2.5,,");
}

/// If an error is permitted, the last column holds the error of each row.
#[test]
fn cone_with_a_permitted_error_has_an_error_column() {
    let mut cone = cone();
    let relative = (0..12).map(|row| f64::from(row) / 100.0).collect();
    cone.row_errors = RowErrors { relative, target: 1e-3, allowed: None };
    let refused = cone.clone().allowing(None).unwrap_err().to_string();
    assert!(refused.contains("theta 20 deg, phi 90 deg, state black (1.10e-1)"), "{refused}");
    let cone = cone.allowing(Some(0.2)).unwrap();
    let mut bytes = Vec::new();
    write_cone_csv(&mut bytes, &cone).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].ends_with(",delta_E_1976_with_angle,error"));
    assert_eq!(lines[10], "10,90,black,41,0.1,0.2,0.3,,4,0.3333333333333333,,50,-1.5,2.5,,,0.09");
    let mut bytes = Vec::new();
    write_cone_npy(&mut bytes, &cone).unwrap();
    let array = Array::read(&bytes);
    assert_eq!(array.shape, [3, 2, 2, 14]);
    assert_eq!(array.numbers()[((2 + 1) * 2 + 1) * 14 + 13], 0.09);
    let mut bytes = Vec::new();
    write_json(&mut bytes, &ConeFile::new("0.1.0", "abc", &cone)).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(json["quantities"][13], "error");
}

#[test]
fn cone_json_describes_the_axes_of_the_array() {
    let (cone, mut bytes) = (cone(), Vec::new());
    write_json(&mut bytes, &ConeFile::new("0.1.0", "abc", &cone)).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let lengths = json["axes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|axis| json[axis.as_str().unwrap()].as_array().unwrap().len());
    assert_eq!(lengths.collect::<Vec<_>>(), [3, 2, 2, 13]);
    assert_eq!(json["directed"][0]["theta_deg"], -20.0);
    assert_eq!(json["solver"]["discretisation_error"], 3e-5);
}

/// A table of 2 x 3 x 4 directions and 5 wavelengths, whose values increase with the index.
fn table() -> BrdfTable {
    let axis = |count: u32| (0..count).map(|k| 10.0 * f64::from(k)).collect::<Vec<_>>();
    let state = |s: usize, name: &str| BrdfState {
        name: name.to_owned(),
        brdf: (0..120).map(|k| (1000 * s + k) as f32 + 0.5).collect(),
        specular: (0..10).map(|k| (1000 * s + k) as f64 / 3.0).collect(),
        directional_hemispherical: (0..10).map(|k| (2000 * s + k) as f64 / 3.0).collect(),
    };
    BrdfTable {
        grid: BrdfGrid {
            theta_i_deg: axis(2),
            phi_i_deg: Vec::new(),
            theta_o_deg: axis(3),
            dphi_deg: axis(4),
        },
        wavelength_nm: axis(5),
        states: vec![state(0, "white"), state(1, "\u{9ed2} & b")],
        nodes: 32,
        discretisation_error: 1e-4,
        row_errors: RowErrors::default(),
    }
}

const SOURCE: BsdfSource<'_> = BsdfSource { papilio: "0.1.0", title: "A \"title\" \u{394}", hash: "abc" };

#[test]
fn bsdf_archive_reads_back() {
    let mut bytes = Vec::new();
    write_bsdf(&mut bytes, &SOURCE, &table()).unwrap();
    let files = unzip(&bytes);
    let array = |name: &str| {
        let wanted = format!("{name}.npy");
        Array::read(files.iter().find(|(name, _)| *name == wanted).unwrap().1)
    };
    assert_eq!(array("theta_o_deg").numbers(), [0.0, 10.0, 20.0]);
    assert_eq!(array("wavelength_nm").shape, [5]);
    assert_eq!(array("state").texts(), ["white", "\u{9ed2} & b"]);
    let brdf = array("brdf");
    assert_eq!(brdf.shape, [2, 2, 3, 4, 5]);
    // State 1, theta_i 1, theta_o 0, dphi 2, wavelength 4.
    let at = ((3 * 4) + 2) * 5 + 4;
    assert_eq!(brdf.numbers()[120 + at], 1000.0 + at as f64 + 0.5);
    assert_eq!(array("specular").shape, [2, 2, 5]);
    assert_eq!(array("specular").numbers()[13], 1003.0 / 3.0);
    assert_eq!(array("directional_hemispherical").numbers()[13], 2003.0 / 3.0);
    let about = array("about");
    assert!(about.shape.is_empty());
    let about: serde_json::Value = serde_json::from_str(&about.texts()[0]).unwrap();
    assert_eq!((&about["format"], &about["version"]), (&"papilio-bsdf".into(), &1.into()));
    assert_eq!(about["title"], SOURCE.title);
    assert_eq!(files.len(), 9);
}

/// If an error is permitted, an array holds the error of each row.
#[test]
fn bsdf_with_a_permitted_error_has_an_error_array() {
    let mut table = table();
    let relative = (0..48).map(|row| f64::from(row) / 100.0).collect();
    table.row_errors = RowErrors { relative, target: 1e-3, allowed: None };
    let refused = table.clone().allowing(None).unwrap_err().to_string();
    assert!(refused.contains("theta_i 10 deg, theta_o 20 deg, dphi 30 deg (4.70e-1)"), "{refused}");
    let mut bytes = Vec::new();
    write_bsdf(&mut bytes, &SOURCE, &table.allowing(Some(0.5)).unwrap()).unwrap();
    let files = unzip(&bytes);
    let error = Array::read(files.iter().find(|(name, _)| *name == "error.npy").unwrap().1);
    assert_eq!((error.shape.as_slice(), error.numbers()[47]), (&[2, 2, 3, 4][..], 0.47));
}

/// Equal tables give equal bytes: the archive holds no date.
#[test]
fn bsdf_archive_is_reproducible_and_wrong_lengths_are_refused() {
    let write = |table: &BrdfTable| {
        let mut bytes = Vec::new();
        write_bsdf(&mut bytes, &SOURCE, table).map(|()| bytes)
    };
    assert_eq!(write(&table()).unwrap(), write(&table()).unwrap());
    let mut short = table();
    short.states[1].brdf.pop();
    assert!(write(&short).is_err());
}
