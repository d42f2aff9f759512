//! Small synthetic files of each format, for tests and as seeds of mutations.

use papilio_display::{BrdfGrid, BrdfState, BrdfTable};
use papilio_formats::{BsdfFormat, BsdfSource, write_bsdf, write_measurement};
use papilio_goniometry::HalfAngleGrid;

use super::read;

pub(super) const RADIANT: &str = include_str!("small.txt");

pub(super) const TABLE: &str = "\
# sample: film
theta_i,phi_i,theta_o,phi_o,wavelength,value
0,0,0,0,500,1
0,0,10,0,500,2
0,0,0,0,450,3
0,0,10,0,450,
";

pub(super) const ASTM: &str = "\
SAMPLE film 7
INSTRUMENT goniometer
NUM_POINTS 3
VARS theta_i,phi_i,theta_s,phi_s,R,550nm
0.5235987755982988,3.141592653589793,0.5235987755982988,0,1.5,2
0.5235987755982988,3.141592653589793,2.617993877991494,0,.5,1e-3
0,0,0,0,7,8
";

/// A scan at normal incidence.
pub(super) const SCAN: &str = "# sample: film\ntheta_deg,btdf\n0,4\n5,3\n10,2\n45,0.5\n90,0\n";

/// A list of FRED: light along the normal, and from 30 deg, without the direction back to the light.
pub(super) const FRED: &str = "\
type bsdf_data
format angles=deg bsdf=value scale=2
0\t0
0\t0\t5
30 0 3
30 90 3
30 180 3
30 0
0 0 2
30 0 9
30 90 1
";

/// An XML file with three patches: one about the normal, two beyond 45 deg, centred on azimuths 0 and 180.
pub(super) fn klems(structure: &str, blocks: &[(&str, &str, &str)]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- a <comment> -->\n<WindowElement xmlns=\"a > b\">\n<Optical><Layer>\n\
         <Material><Name>blind</Name></Material>\n<DataDefinition>\
         <IncidentDataStructure>{structure}</IncidentDataStructure>\n<AngleBasis>\
         <AngleBasisName>own</AngleBasisName>\n\
         <AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>\
         <UpperTheta>45</UpperTheta></ThetaBounds></AngleBasisBlock>\n\
         <AngleBasisBlock><Theta>67</Theta><nPhis>2</nPhis><ThetaBounds><LowerTheta>45</LowerTheta>\
         <UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis></DataDefinition>\n"
    );
    for (spectrum, direction, values) in blocks {
        text += &format!(
            "<WavelengthData><Wavelength unit=\"Integral\">{spectrum}</Wavelength>\n<WavelengthDataBlock>\n\
             <WavelengthDataDirection>{direction}</WavelengthDataDirection>\n\
             <ColumnAngleBasis>own</ColumnAngleBasis><RowAngleBasis>own</RowAngleBasis>\n\
             <AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF</ScatteringDataType>\n\
             <ScatteringData>\n{values}\n</ScatteringData></WavelengthDataBlock></WavelengthData>\n"
        );
    }
    text + "</Layer></Optical></WindowElement>\n"
}

pub(super) const MATRIX: &str = "1, 2, 3,\n4 5 6\n7,8,9,";

pub(super) const TREE_3: &str = "{ {1} {2} {3} {4} {5} {6} {7} {0 1 2 3, 4 5 6 7} }";

/// Returns an RGL file with these fields (name, type, shape, bytes).
pub(super) fn tensors(fields: &[(&str, u8, &[u64], Vec<u8>)]) -> Vec<u8> {
    let header: usize = fields.iter().map(|(name, _, shape, _)| 13 + name.len() + 8 * shape.len()).sum();
    let mut offset = 18 + header;
    let mut head = b"tensor_file\0\x01\x00".to_vec();
    head.extend((fields.len() as u32).to_le_bytes());
    let mut data: Vec<u8> = Vec::new();
    for (name, kind, shape, bytes) in fields {
        head.extend((name.len() as u16).to_le_bytes());
        head.extend(name.as_bytes());
        head.extend((shape.len() as u16).to_le_bytes());
        head.push(*kind);
        head.extend((offset as u64).to_le_bytes());
        shape.iter().for_each(|length| head.extend(length.to_le_bytes()));
        offset += bytes.len();
        data.extend(bytes);
    }
    head.extend(data);
    head
}

pub(super) fn singles(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// An RGL file with two wavelengths. The density of visible normals increases with theta, the values with the
/// first coordinate.
pub(super) fn rgl() -> Vec<u8> {
    tensors(&[
        ("description", 1, &[4], b"film".to_vec()),
        ("phi_i", 10, &[1], singles(&[0.0])),
        ("theta_i", 10, &[2], singles(&[0.0, 1.5])),
        ("ndf", 10, &[2, 2], singles(&[3.0; 4])),
        ("sigma", 10, &[2, 2], singles(&[0.5; 4])),
        ("vndf", 10, &[1, 2, 2, 2], singles(&[0.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0, 2.0])),
        ("luminance", 10, &[1, 2, 2, 2], singles(&[1.0; 8])),
        ("wavelengths", 10, &[2], singles(&[500.0, 600.0])),
        (
            "spectra",
            10,
            &[1, 2, 2, 2, 2],
            singles(&[0.0, 1.0, 0.0, 1.0, 5.0, 5.0, 5.0, 5.0, 0.0, 1.0, 0.0, 1.0, 5.0, 5.0, 5.0, 5.0]),
        ),
        ("jacobian", 1, &[1], vec![1]),
    ])
}

/// A MERL file. The numbers of each plane increase from cell to cell; the first cell was not measured.
pub(super) fn merl() -> Vec<u8> {
    let header = [90_u32, 90, 180].map(u32::to_le_bytes);
    // Without optimisation, millions of bytes that are added one by one take a second.
    let mut plane = vec![0; 8 * HalfAngleGrid.cells()];
    for (cell, bytes) in plane.as_chunks_mut().0.iter_mut().enumerate() {
        let value = if cell == 0 { -1.0 } else { cell as f64 };
        *bytes = value.to_le_bytes();
    }
    [header.as_flattened(), &plane.repeat(3)].concat()
}

/// A Radiant table in Papilio's own format.
pub(super) fn papilio() -> Vec<u8> {
    let mut bytes = Vec::new();
    write_measurement(&mut bytes, BsdfFormat::Papilio, &read(RADIANT)).unwrap();
    bytes
}

/// All files except MERL, which has 35 MB.
pub(super) fn all() -> Vec<(&'static str, Vec<u8>)> {
    let tree = [("Visible", "Transmission Front", TREE_3), ("CIE-X", "Transmission Front", "{3}")];
    vec![
        ("radiant", RADIANT.into()),
        ("table", TABLE.into()),
        ("astm", ASTM.into()),
        ("klems", klems("Columns", &[("Visible", "Reflection Back", MATRIX)]).into()),
        ("tree", klems("TensorTree3", &tree).into()),
        ("rgl", rgl()),
        ("papilio", papilio()),
    ]
}

/// The BSDF of a display: 2 inclinations of the light, 3 of the viewer, 2 azimuths, 2 wavelengths, 2 states.
pub(super) fn display() -> Vec<u8> {
    let axis = |count: u32| (0..count).map(|k| 10.0 * f64::from(k)).collect::<Vec<_>>();
    let state = |first: f32, name: &str| BrdfState {
        name: name.to_owned(),
        brdf: (0..24).map(|k| first + k as f32).collect(),
        specular: vec![0.0; 4],
        directional_hemispherical: vec![0.0; 4],
    };
    let table = BrdfTable {
        grid: BrdfGrid {
            theta_i_deg: axis(2),
            phi_i_deg: Vec::new(),
            theta_o_deg: axis(3),
            dphi_deg: vec![0.0, 180.0],
        },
        wavelength_nm: vec![500.0, 600.0],
        states: vec![state(0.0, "white"), state(100.0, "black")],
        nodes: 32,
        discretisation_error: 1e-4,
        row_errors: Default::default(),
    };
    let mut bytes = Vec::new();
    let source = BsdfSource { papilio: "0.1.0", title: "panel", hash: "abc" };
    write_bsdf(&mut bytes, &source, &table).unwrap();
    bytes
}
