//! One surface in every format: the same map, the right way up. And formats that are named and not read.

use papilio_formats::HeightFile;
use papilio_testing::Dice;

use super::files::{gsf, keyence, opd, plux, sdf_binary, sdf_text, sur, zip};
use super::read;

const GSF: &str = "XRes = 4\nYRes = 3\nXReal = 2e-6\nYReal = 1.5e-6\nXYUnits = m\nZUnits = m\n";
const PLUX: &str = "<xml><GENERAL><IMAGE_SIZE_X>4</IMAGE_SIZE_X><IMAGE_SIZE_Y>3</IMAGE_SIZE_Y><FOV_X>0.5</FOV_X><FOV_Y>0.5</FOV_Y></GENERAL></xml>";

/// The surface in all formats that state its size and unit.
pub(crate) fn all() -> Vec<(&'static str, Vec<u8>)> {
    let keyence_packed = [b"VK6\0\0\0\0\0".to_vec(), zip(&[("Vk4File", &keyence())])].concat();
    vec![
        ("BCR-1.0 in text", sdf_text("aBCR-1.0").into()),
        ("ISO-1.0 in text", sdf_text("aISO-1.0").into()),
        ("ISO-2.0 in text", sdf_text("AISO-2.0").into()),
        ("BCR-1.0", sdf_binary(b"bBCR-1.0")),
        ("ISO-1.0", sdf_binary(b"bISO-1.0")),
        ("ISO-2.0", sdf_binary(b"bISO-2.0")),
        ("GSF", gsf(GSF)),
        ("SUR", sur(false)),
        ("SUR, compressed", sur(true)),
        ("OPD", opd(&[])),
        ("VK4", keyence()),
        ("VK6", keyence_packed),
        ("PLUX", plux(PLUX)),
    ]
}

#[test]
fn one_surface_is_the_same_map_in_every_format() {
    let from_below = [9.0, 10.0, 11.0, 12.0, 5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 4.0];
    for (format, bytes) in all() {
        let map = read(bytes).unwrap_or_else(|error| panic!("{format}: {error}"));
        assert_eq!(map.columns, 4, "{format}");
        let (pitch, unit) = (map.pitch_um.unwrap(), map.unit_um.unwrap());
        assert!(pitch.iter().all(|pitch| (pitch - 0.5).abs() < 1e-7), "{format}: {pitch:?}");
        for (found, nm) in map.numbers.iter().zip(from_below) {
            assert!((1e3 * unit * found - nm).abs() < 1e-5 * nm, "{format}: {:?}", map.numbers);
        }
    }
}

/// The marks of missing heights of the revisions of SDF: the smallest number of a type in ISO, the largest in
/// BCR, or `BAD`.
#[test]
fn marks_of_missing_heights_in_sdf_are_those_of_the_revision() {
    let with = |word: &[u8], height: i16| {
        let mut bytes = sdf_binary(word);
        let end = bytes.len();
        bytes[end - 2..].copy_from_slice(&height.to_le_bytes());
        read(bytes)
    };
    let missing =
        |found: Result<HeightFile, String>| found.is_err_and(|error| error.contains("1 of 12 heights"));
    for iso in [b"bISO-1.0", b"bISO-2.0"] {
        assert!(missing(with(iso, i16::MIN)) && with(iso, 20).is_ok());
    }
    assert!(missing(with(b"bBCR-1.0", i16::MAX)) && with(b"bBCR-1.0", 20).is_ok());
    for (word, mark) in [("aISO-1.0", "BAD"), ("aISO-2.0", "bad"), ("aBCR-1.0", "32767"), ("aBCR-1.0", "BAD")]
    {
        assert!(missing(read(sdf_text(word).replace(" 12", &format!(" {mark}")).into())), "{word} {mark}");
    }
}

/// NumPy arrays in both orders and byte orders, of all types; the single array of an archive.
#[test]
fn arrays_are_read_in_any_order() {
    let npy = |kind: &str, is_fortran: &str, data: &[u8]| {
        let head = format!("{{'descr': '{kind}', 'fortran_order': {is_fortran}, 'shape': (2, 3), }}\n");
        [&b"\x93NUMPY\x01\x00"[..], &(head.len() as u16).to_le_bytes(), head.as_bytes(), data].concat()
    };
    let by_rows = [1_u8, 2, 3, 4, 5, 6];
    let by_columns = [1_u8, 4, 2, 5, 3, 6];
    let data =
        |bytes: fn(u8) -> Vec<u8>, order: [u8; 6]| -> Vec<u8> { order.into_iter().flat_map(bytes).collect() };
    type ToBytes = fn(u8) -> Vec<u8>;
    let types: [(&str, ToBytes); 12] = [
        ("<f8", |n| f64::from(n).to_le_bytes().to_vec()),
        (">f8", |n| f64::from(n).to_be_bytes().to_vec()),
        ("<f4", |n| f32::from(n).to_le_bytes().to_vec()),
        (">f4", |n| f32::from(n).to_be_bytes().to_vec()),
        // 1, 2, 3 to 6 as numbers of 16 bits.
        ("<f2", |n| {
            [0x3c00_u16, 0x4000, 0x4200, 0x4400, 0x4500, 0x4600][usize::from(n) - 1].to_le_bytes().to_vec()
        }),
        ("<i8", |n| i64::from(n).to_le_bytes().to_vec()),
        (">i4", |n| i32::from(n).to_be_bytes().to_vec()),
        ("<i2", |n| i16::from(n).to_le_bytes().to_vec()),
        ("|i1", |n| vec![n]),
        ("|u1", |n| vec![n]),
        (">u2", |n| u16::from(n).to_be_bytes().to_vec()),
        ("<u4", |n| u32::from(n).to_le_bytes().to_vec()),
    ];
    let expected = [4.0, 5.0, 6.0, 1.0, 2.0, 3.0];
    for (kind, bytes) in types {
        for (order, is_fortran) in [(by_rows, "False"), (by_columns, "True")] {
            let map = read(npy(kind, is_fortran, &data(bytes, order))).unwrap();
            assert_eq!((map.columns, &map.numbers[..]), (3, &expected[..]), "{kind} {is_fortran}");
        }
    }
    let array = npy("<f8", "False", &data(types[0].1, by_rows));
    assert_eq!(read(zip(&[("heights.npy", &array)])).unwrap().numbers, expected);
    for (bytes, words) in [
        (zip(&[("a.npy", &array), ("b.npy", &array)]), "this .npz file cannot be used: it has 2 arrays"),
        (npy("<c16", "False", &[0; 96]), "its numbers are <c16"),
        (npy("<f8", "False", &[0; 40]), "too few or too many"),
        (zip(&[("readme.txt", b"text")]), "not a map of heights in a supported format"),
        (zip(&[("[Content_Types].xml", b"<a/>")]), "this is an Office document"),
    ] {
        let found = read(bytes).unwrap_err();
        assert!(found.contains(words) && !found.contains("X3P file"), "{words}\n{found}");
    }
}

#[test]
fn formats_that_are_not_read_are_named_with_what_to_export() {
    for (bytes, words) in [
        (&b"\x89HDF\r\n\x1a\n\0\0\0"[..], "an HDF5 file, such as .datx of Zygo"),
        (b"\x88\x1b\x03\x6f\0\0", "a MetroPro .dat file of Zygo"),
        (b"GWYPGWYO", "a .gwy file of Gwyddion"),
        (b"AliconaImaging\0", "an .al3d file of Alicona"),
        (b"VCA DATA\x01\0\0\x55", "an .opdx file of Bruker"),
        (b"\\*File list\r\n\\Version: 1", "a Nanoscope file"),
        (b"\xff\xd8\xff\xe0\0\x10JFIF", "this is a JPEG file"),
        (b"BM\x36\0\0\0\0\0\0\0\x36\0\0\0", "this is a BMP file"),
        (b"II+\0\x08\0\0\0", "this one is a BigTIFF file"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an OLE document"),
    ] {
        let found = read(bytes.to_vec()).unwrap_err();
        assert!(found.contains(words) && found.contains("help:"), "{words}\n{found}");
    }
}

/// No change of a few bytes makes a reader panic, take memory that the file does not have, or give a height
/// that is no number.
#[test]
fn damaged_files_of_all_formats_are_errors() {
    let mut dice = Dice::new(0x4e1f, 0);
    let texts: [&[u8]; 3] = [
        b"# Width: 2.0 um\n# Height: 1 um\n# Value units: nm\n1,5 2 3 4\n5 6 7 8\n",
        b"x,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n2,0,3\n2,1,3\n",
        b"Zygo XYZ Data File - Format 1\na\nb\n0 0 2 2\nc\nd\ne\n0 0 0 0 0 0 5e-7 0\n#\n0 0 1\n1 0 2\n0 1 3\n1 1 4\n#\n",
    ];
    let whole = all().into_iter().map(|(_, bytes)| bytes).chain(texts.map(<[u8]>::to_vec));
    for bytes in whole {
        for _ in 0..300 {
            let mut bytes = bytes.clone();
            if dice.below(4) == 0 {
                bytes.truncate(dice.below(bytes.len()));
            }
            for _ in 0..dice.below(5) {
                let at = dice.below(bytes.len().max(1));
                if let Some(byte) = bytes.get_mut(at) {
                    // Bits, extremes, and what means something in texts.
                    *byte =
                        [dice.bits() as u8, 0, 255, b',', b'-', b'9', b'\n', *byte ^ (1 << dice.below(8))]
                            [dice.below(8)];
                }
            }
            match read(bytes) {
                Ok(map) => assert!(map.numbers.iter().all(|number| number.is_finite()) && map.columns >= 2),
                Err(error) => assert!(!error.contains("the decoder failed"), "{error}"),
            }
        }
    }
}

/// Units of points in a row below the names of the columns are those behind the names.
#[test]
fn units_of_points_may_stand_in_a_row_of_their_own() {
    let points = "0,0,1\n1,0,2\n0,1,3\n1,1,4\n2,0,3\n2,1,3\n";
    let map = |head: &str| read(format!("{head}\n{points}").into_bytes()).unwrap();
    let behind = map("x (mm),y (mm),z (nm)");
    assert_eq!((behind.pitch_um, behind.unit_um), ([1000.0, 1000.0].into(), Some(1e-3)));
    for head in ["x,y,z\nmm,mm,nm", "x,y,z\n(mm),(mm),(nm)", "x,y,z\n[mm],[mm],[nm]"] {
        let below = map(head);
        assert_eq!((below.pitch_um, below.unit_um), (behind.pitch_um, behind.unit_um), "{head}");
        assert_eq!(below.numbers, behind.numbers, "{head}");
    }
}
