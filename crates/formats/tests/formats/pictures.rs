//! Pictures: kinds of files, their colour spaces, errors, arbitrary bytes, writers.

mod samples;

use std::time::{Duration, Instant};

use exr::prelude::{ReadChannels, ReadLayers};
use papilio_formats::{
    DataFile, RgbSpace, SourcePicture, Warned, read_picture, write_indexed_png, write_rgb_png,
    write_scene_exr,
};
use papilio_testing::Dice;

use samples::{Jpeg, Png, Table, exif, profile, srgb_profile};

fn read(bytes: &[u8]) -> Result<Warned<SourcePicture>, String> {
    let file = DataFile { name: "photo.png".into(), bytes: bytes.to_vec() };
    read_picture(&file, &RgbSpace::srgb()).map_err(|error| error.to_string())
}

/// The first pixel.
fn first(bytes: &[u8]) -> [f32; 3] {
    read(bytes).unwrap().value.row(0)[0]
}

#[track_caller]
fn assert_near(found: [f32; 3], wanted: [f32; 3], tolerance: f32) {
    let differs = found.iter().zip(wanted).any(|(found, wanted)| (found - wanted).abs() > tolerance);
    assert!(!differs, "{found:?} instead of {wanted:?}");
}

const D65: [f32; 3] = [0.95046, 1.0, 1.08906];

/// IEC 61966-2-1; SMPTE EG 432-1; ITU-R BT.2020: X, Y, Z of red, and Y of the others.
#[test]
fn colour_spaces_have_their_published_primaries() {
    for (space, red, [green, blue]) in [
        (RgbSpace::srgb(), [0.4124, 0.2126, 0.0193], [0.7152, 0.0722]),
        (RgbSpace::display_p3(), [0.4866, 0.2290, 0.0], [0.6917, 0.0793]),
        (RgbSpace::rec_2020(), [0.6370, 0.2627, 0.0], [0.6780, 0.0593]),
    ] {
        let matrix = space.xyz_from_rgb().unwrap();
        for k in 0..3 {
            assert!((matrix[k][0] - red[k]).abs() < 1e-4, "{}: {matrix:?}", space.name);
            let white: f64 = matrix[k].iter().sum();
            assert!((white - f64::from(D65[k])).abs() < 1e-4, "{}", space.name);
        }
        assert!((matrix[1][1] - green).abs() < 1e-4 && (matrix[1][2] - blue).abs() < 1e-4, "{}", space.name);
        assert_eq!(
            RgbSpace::named(&space.name.to_lowercase().replace(". ", "-").replace(' ', "-")),
            Some(space)
        );
    }
    // A white of its own becomes D65: ProPhoto's is D50.
    let other = RgbSpace { white: [0.3457, 0.3585], ..RgbSpace::srgb() };
    let matrix = other.xyz_from_rgb().unwrap();
    assert!((0..3).all(|k| (matrix[k].iter().sum::<f64>() - f64::from(D65[k])).abs() < 1e-4));
    assert_eq!(RgbSpace { primaries: [[0.3, 0.3]; 3], ..RgbSpace::srgb() }.xyz_from_rgb(), None);
}

#[test]
fn png_of_each_depth_and_kind_has_its_light() {
    let middle = D65.map(|value| 0.21586 * value);
    // 128 of 255, 8 of 15, 2 of 3, 1 of 1, 32896 of 65535.
    for (depth, row, light) in [
        (8, vec![128], 0.21586),
        (16, vec![128, 128], 0.21586),
        (4, vec![0x80], 0.24620),
        (2, vec![0x80], 0.40198),
        (1, vec![0x80], 1.0),
    ] {
        let png = Png::new([1, 1], depth, 0).data(&[0], &row);
        assert_near(first(&png), D65.map(|value| light * value), 1e-4);
    }
    let rgb = Png::new([1, 1], 8, 2);
    assert_near(first(&rgb.data(&[0], &[128, 128, 128])), middle, 1e-4);
    assert_near(first(&rgb.data(&[0], &[255, 0, 0])), [0.41239, 0.21264, 0.01933], 1e-4);
    let sixteen = Png::new([1, 1], 16, 2).data(&[0], &[255, 255, 0, 0, 0, 0]);
    assert_near(first(&sixteen), [0.41239, 0.21264, 0.01933], 1e-4);
    let palette = Png::new([2, 1], 1, 3).chunk(b"PLTE", &[0, 0, 0, 255, 0, 0]).data(&[0], &[0x80]);
    assert_near(first(&palette), [0.41239, 0.21264, 0.01933], 1e-4);
}

/// Half of red over white: the mean of their light.
#[test]
fn png_with_transparency_is_composited_over_white_in_linear_light() {
    let half = [0.68143, 0.60632, 0.55420];
    let rgba = Png::new([1, 1], 16, 6).data(&[0], &[255, 255, 0, 0, 0, 0, 0x80, 0]);
    let picture = read(&rgba).unwrap();
    assert_near(picture.value.row(0)[0], half, 1e-4);
    assert!(picture.warnings[0].contains("composited over white"), "{:?}", picture.warnings);
    let opaque = Png::new([1, 1], 8, 6).data(&[0], &[255, 0, 0, 255]);
    assert!(read(&opaque).unwrap().warnings.is_empty());
    let grey = Png::new([1, 1], 8, 4).data(&[0], &[128, 0]);
    assert_near(first(&grey), D65, 1e-4);
    let palette = Png::new([1, 1], 8, 3).chunk(b"PLTE", &[255, 0, 0]).chunk(b"tRNS", &[0]).data(&[0], &[0]);
    assert_near(first(&palette), D65, 1e-4);
    let key = Png::new([2, 1], 8, 2).chunk(b"tRNS", &[0, 1, 0, 2, 0, 3]).data(&[0], &[1, 2, 3, 255, 0, 0]);
    let row = read(&key).unwrap().value.row(0);
    assert_near(row[0], D65, 1e-4);
    assert_near(row[1], [0.41239, 0.21264, 0.01933], 1e-4);
}

/// The third edition of PNG: cICP before iCCP before sRGB before gAMA and cHRM.
#[test]
fn png_colour_space_is_the_first_stated_one() {
    let red = [255, 128, 0];
    let gamma = 50_000_u32.to_be_bytes();
    let wide: Vec<u8> = [31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600]
        .into_iter()
        .flat_map(u32::to_be_bytes)
        .collect();
    let profile = [&b"x\0\0"[..], &samples::zlib(&profile([0.0; 3], &[1.0]))].concat();
    let with = |chunks: &[(&[u8; 4], &[u8])]| {
        let png = chunks.iter().fold(Png::new([1, 1], 8, 2), |png, (name, data)| png.chunk(name, data));
        read(&png.data(&[0], &red)).unwrap()
    };
    let (cicp, iccp, srgb) = ((b"cICP", &[12, 13, 0, 1][..]), (b"iCCP", &profile[..]), (b"sRGB", &[0][..]));
    let (gama, chrm) = ((b"gAMA", &gamma[..]), (b"cHRM", &wide[..]));
    for (chunks, space) in [
        (vec![chrm, gama, srgb, iccp, cicp], "P3"),
        (vec![chrm, gama, iccp], "Test profile"),
        (vec![chrm, gama, srgb], "sRGB"),
        (vec![chrm, gama], "gamma 2.000 with primaries of its own"),
        (vec![gama], "gamma 2.000"),
        (vec![], "sRGB"),
    ] {
        assert_eq!(with(&chunks).value.space(), space);
    }
    // Rec. 2020 with gamma 2: 128/255 of green is 0.25197.
    let xyz = with(&[chrm, gama]).value.row(0)[0];
    assert_near(xyz, [0.63696 + 0.25197 * 0.14462, 0.26270 + 0.25197 * 0.67800, 0.25197 * 0.02807], 2e-4);
    // Unusable statements are ignored with a warning: an unknown code, a profile that is none, primaries on a
    // line.
    for chunk in [(b"cICP", &[2, 2, 0, 1][..]), (b"cHRM", &[0; 32][..])] {
        let picture = with(&[chunk]);
        assert_eq!((picture.value.space(), picture.warnings.len()), ("sRGB", 1), "{:?}", picture.warnings);
    }
}

#[test]
fn icc_profile_of_srgb_is_srgb() {
    let data: Vec<u8> = (0..=255).flat_map(|k: u8| [k, 255 - k, k / 2]).collect();
    let plain = read(&Png::new([256, 1], 8, 2).data(&[0], &data)).unwrap().value.row(0);
    let tagged = [&b"x\0\0"[..], &samples::zlib(&srgb_profile())].concat();
    let tagged = Png::new([256, 1], 8, 2).chunk(b"iCCP", &tagged).data(&[0], &data);
    for (tagged, plain) in read(&tagged).unwrap().value.row(0).into_iter().zip(plain) {
        assert_near(tagged, plain, 5e-4);
    }
}

/// Light of sRGB.
fn srgb_light(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// A picture of many colours with a profile, and without.
fn with_and_without(profile: &[u8]) -> [Vec<[f32; 3]>; 2] {
    let data: Vec<u8> = (0..=255).flat_map(|k: u8| [k, 255 - k, k / 2]).collect();
    let profile = [&b"x\0\0"[..], &samples::zlib(profile)].concat();
    let tagged = read(&Png::new([256, 1], 8, 2).chunk(b"iCCP", &profile).data(&[0], &data)).unwrap();
    assert!(tagged.warnings.is_empty(), "{:?}", tagged.warnings);
    let plain = read(&Png::new([256, 1], 8, 2).data(&[0], &data)).unwrap();
    [tagged.value.row(0), plain.value.row(0)]
}

/// sRGB as tables of all kinds: X, Y, Z are linear in light, so that two nodes along each axis are exact.
#[test]
fn icc_tables_of_srgb_are_srgb() {
    let columns = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.71410]];
    let colour = |rgb: &[f64]| {
        [0, 1, 2].map(|row| (0..3).map(|k| columns[k][row] * rgb[k]).sum::<f64>() * 32768.0 / 65535.0)
    };
    // Numbers of 8 bits are in steps of 0.008 of X, Y, Z, and dark sRGB in steps of 0.004.
    for (table, most) in
        [(Table::Lut8, 0.012), (Table::Lut16, 1e-3), (Table::AToB, 1e-3), (Table::Matrix, 1e-3)]
    {
        let profile = samples::table_profile(table, [b"RGB ", b"XYZ "], srgb_light, colour);
        let [tagged, plain] = with_and_without(&profile);
        for (tagged, plain) in tagged.into_iter().zip(plain) {
            assert_near(tagged, plain, most);
        }
    }
}

/// Numbers that are L*, a*, b*: those of versions 2 and 4 differ.
#[test]
fn icc_tables_may_have_lab() {
    for (table, most) in [(Table::Lut8, 0.02), (Table::Lut16, 1e-4), (Table::AToB, 1e-4)] {
        let [scale, zero] = if table == Table::Lut16 { [65280.0, 256.0 * 255.0] } else { [65535.0, 65535.0] };
        let colour =
            |lab: &[f64]| [lab[0] * scale / 65535.0, lab[1] * zero / 65535.0, lab[2] * zero / 65535.0];
        let profile = samples::table_profile(table, [b"RGB ", b"Lab "], |value| value, colour);
        // L* = 50.196, a* = 20, b* = -30 by the formulas of CIE 15, adapted by Bradford's matrix from ICC's
        // white to D65. Little CMS 2.19 gives the same sRGB: 133, 109, 171.
        let data = [128, 148, 98];
        let tagged = [&b"x\0\0"[..], &samples::zlib(&profile)].concat();
        let picture = read(&Png::new([1, 1], 8, 2).chunk(b"iCCP", &tagged).data(&[0], &data)).unwrap();
        assert_near(picture.value.row(0)[0], [0.22505, 0.18796, 0.40973], most);
    }
}

/// Inks by a table: C, M, Y, K as Adobe's programs write them, and as Y, Cb, Cr, K. At the nodes Little CMS
/// 2.19 gives the same sRGB; between them it interpolates in tetrahedra, and the specification leaves the
/// choice.
#[test]
fn cmyk_has_the_colours_of_its_profile() {
    let inks = |inks: &[f64]| {
        let [c, m, y, k] = [inks[0], inks[1], inks[2], inks[3]];
        let white = [0.9642, 1.0, 0.8249];
        let left = [[0.85, 0.5, 0.05], [0.75, 0.7, 0.02], [0.2, 0.6, 0.8]];
        [0, 1, 2].map(|q| {
            let paper = white[q] * (1.0 - left[q][0] * c) * (1.0 - left[q][1] * m) * (1.0 - left[q][2] * y);
            paper * (1.0 - 0.95 * k)
        })
    };
    let colour = |of: &[f64]| inks(of).map(|value| value * 32768.0 / 65535.0);
    for table in [Table::Lut16, Table::AToB] {
        let profile = samples::table_profile(table, [b"CMYK", b"XYZ "], |value| value, colour);
        let of = |block: [u8; 4], adobe: u8| -> [f32; 3] {
            let jpeg = Jpeg { adobe: Some(adobe), profile: profile.clone(), ..Jpeg::new(4, &[block]) };
            let picture = read(&jpeg.bytes()).unwrap();
            assert!(picture.warnings.is_empty(), "{:?}", picture.warnings);
            picture.value.row(0)[0]
        };
        // C 0.2, M 0.6, Y 0.4, K 0.1: inverted 204, 102, 153, 229.5.
        let stored = [204, 102, 153, 230];
        let given = stored.map(|stored: u8| 1.0 - f64::from(stored) / 255.0);
        let [x, y, z] = inks(&given);
        // Bradford's matrix from ICC's white to D65, by a separate program.
        let expected = [
            0.955513 * x - 0.023073 * y + 0.063309 * z,
            -0.028325 * x + 1.009943 * y + 0.021054 * z,
            0.012329 * x - 0.020535 * y + 1.330714 * z,
        ];
        let expected = expected.map(|value| value as f32);
        assert_near(of(stored, 0), expected, 2e-3);
        // Y, Cb, Cr of the complements 51, 153, 102.
        assert_near(of([117, 120, 81, 230], 2), expected, 0.01);
        // Paper.
        assert_near(of([255; 4], 0), D65, 2e-3);
    }
    let without = read(&Jpeg { adobe: Some(0), ..Jpeg::new(4, &[[255, 0, 0, 255]]) }.bytes()).unwrap();
    assert!(without.warnings[0].contains("it has no ICC profile"), "{:?}", without.warnings);
}

/// A damaged table is ignored, with a warning, wherever it ends.
#[test]
fn damaged_icc_tables_are_ignored() {
    for table in [Table::Lut8, Table::Lut16, Table::AToB] {
        let profile =
            samples::table_profile(table, [b"RGB ", b"XYZ "], srgb_light, |rgb| [rgb[0], rgb[1], rgb[2]]);
        for length in (37..profile.len()).step_by(37) {
            let tagged = [&b"x\0\0"[..], &samples::zlib(&profile[..length])].concat();
            let picture =
                read(&Png::new([1, 1], 8, 2).chunk(b"iCCP", &tagged).data(&[0], &[1, 2, 3])).unwrap();
            assert!(picture.warnings.iter().any(|text| text.contains("it is ignored")), "{length}");
        }
    }
}

#[test]
fn png_of_high_dynamic_range_or_narrow_range_is_refused() {
    for (code, wanted) in
        [([9, 16, 0, 1], "(cICP 9 16 0 1) is not supported"), ([1, 13, 0, 0], "cICP 1 13 0 0")]
    {
        let error = read(&Png::new([1, 1], 8, 2).chunk(b"cICP", &code).data(&[0], &[0, 0, 0])).unwrap_err();
        assert!(
            error.contains(wanted) && error.contains("photo.png") && error.contains("white is 1"),
            "{error}"
        );
    }
}

/// PNG permits the matrix coefficients 0 only.
#[test]
fn png_with_matrix_coefficients_is_refused_with_its_reason() {
    let png = |matrix: u8| Png::new([1, 1], 8, 2).chunk(b"cICP", &[1, 13, matrix, 1]).data(&[0], &[255; 3]);
    assert!(read(&png(0)).is_ok());
    let error = read(&png(5)).unwrap_err();
    for part in
        ["(cICP 1 13 5 1)", "expected the matrix coefficients 0", "red, green and blue", "ICC profile"]
    {
        assert!(error.contains(part), "{error}");
    }
}

/// A wrong checksum: of the pixels an error, of a chunk that states colours a warning; both name the chunk.
#[test]
fn png_with_a_wrong_checksum_says_which() {
    let good = Png::new([1, 1], 8, 2).chunk(b"gAMA", &50_000_u32.to_be_bytes()).data(&[0], &[128; 3]);
    let with_changed = |name: &[u8; 4], length: usize| {
        let mut bytes = good.clone();
        let at = bytes.windows(4).position(|four| four == name).unwrap();
        bytes[at + 4 + length] ^= 1;
        bytes
    };
    let length = samples::zlib(&[0, 128, 128, 128]).len();
    let error = read(&with_changed(b"IDAT", length)).unwrap_err();
    assert!(error.contains("cannot be decoded: the checksum of its chunk IDAT is wrong"), "{error}");
    // Half of 255 with the gamma 2 of the chunk, and with sRGB's function.
    assert_near(first(&good), D65.map(|value| value * 0.252), 2e-3);
    let ignored = read(&with_changed(b"gAMA", 4)).unwrap();
    assert!(
        ignored.warnings[0].contains("the checksum of its chunk gAMA is wrong"),
        "{:?}",
        ignored.warnings
    );
    assert_near(ignored.value.row(0)[0], D65.map(|value| value * 0.2159), 1e-3);
}

#[test]
fn animation_has_its_first_picture() {
    let frame = |number: u32| {
        let numbers: Vec<u8> = [number, 1, 1, 0, 0].into_iter().flat_map(u32::to_be_bytes).collect();
        [numbers, vec![0, 1, 0, 10, 0, 0]].concat()
    };
    let second = [1_u32.to_be_bytes().to_vec(), samples::zlib(&[0, 0])].concat();
    let png = Png::new([1, 1], 8, 0).chunk(b"acTL", &[0, 0, 0, 2, 0, 0, 0, 0]).chunk(b"fcTL", &frame(0));
    let png = png.data_and(&[0], &[255], &[(b"fcTL", &frame(1)), (b"fdAT", &second)]);
    let picture = read(&png).unwrap();
    assert_near(picture.value.row(0)[0], D65, 1e-4);
    assert!(picture.warnings[0].contains("animation of 2 frames; the first"), "{:?}", picture.warnings);
}

/// A palette of 4 bytes is one colour and a part of the next. The decoder fails on it, and must not take the
/// program with it.
#[test]
fn png_with_a_broken_palette_is_an_error_of_its_file() {
    let chunk = |name: &[u8; 4], data: &[u8]| {
        let named = [&name[..], data].concat();
        let crc = named.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(
                crc ^ u32::from(*byte),
                |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
            )
        });
        [&(data.len() as u32).to_be_bytes()[..], &named, &(!crc).to_be_bytes()].concat()
    };
    let pixels = [0x78, 0x9c, 0x63, 0x60, 0x60, 0x64, 0x60, 0x60, 0x04, 0x00, 0x00, 0x0b, 0x00, 0x03];
    let png = [
        &b"\x89PNG\r\n\x1a\n"[..],
        &chunk(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, 8, 3, 0, 0, 0]),
        &chunk(b"PLTE", &[1, 2, 3, 4]),
        &chunk(b"IDAT", &pixels),
        &chunk(b"IEND", &[]),
    ]
    .concat();
    let wrong = read(&png).unwrap_err();
    assert!(wrong.contains("PNG"), "{wrong}");
}

#[test]
fn picture_of_an_unsupported_size_is_refused_before_it_is_decoded() {
    for (size, wanted) in
        [([8001, 8000], "8001 x 8000 pixels"), ([u32::MAX >> 1; 2], "2147483647 x 2147483647")]
    {
        let error = read(&Png::new(size, 16, 6).data(&[0], &[0])).unwrap_err();
        assert!(error.contains(wanted) && error.contains("64 million"), "{error}");
    }
    let jpeg = Jpeg { size: [65_535, 65_535], ..Jpeg::grey(&[0]) }.bytes();
    assert!(read(&jpeg).unwrap_err().contains("65535 x 65535 pixels"), "{}", read(&jpeg).unwrap_err());
    // A file that is too small for its picture.
    let small = [
        Png::new([8000, 8000], 8, 0).data(&[0], &[0]),
        Jpeg { size: [8000, 8000], ..Jpeg::grey(&[0]) }.bytes(),
    ];
    for bytes in small {
        let error = read(&bytes).unwrap_err();
        assert!(error.contains("file ends before its picture is complete"), "{error}");
    }
    assert!(
        read(b"GIF89a").unwrap_err().contains("OpenEXR (.exr) or Radiance (.hdr) file"),
        "{}",
        read(b"GIF89a").unwrap_err()
    );
}

#[test]
fn jpeg_of_each_kind_of_colour_has_its_light() {
    let grey = read(&Jpeg::grey(&[128]).bytes()).unwrap().value;
    assert_eq!((grey.columns(), grey.rows()), (8, 8));
    assert_near(grey.row(7)[7], D65.map(|value| 0.21586 * value), 2e-3);
    // Y, Cb, Cr of red: 76.245, 84.97, 255.5.
    let red = [0.41239, 0.21264, 0.01933];
    let ycc = Jpeg { adobe: Some(1), ..Jpeg::new(3, &[[76, 85, 255, 0]]) }.bytes();
    assert_near(first(&ycc), red, 0.01);
    // Inverted inks, as Adobe's programs write them: C 0, M 1, Y 1, K 0.
    let cmyk = Jpeg { adobe: Some(0), ..Jpeg::new(4, &[[255, 0, 0, 255]]) }.bytes();
    assert_near(first(&cmyk), red, 0.01);
    assert!(read(&cmyk).unwrap().warnings[0].contains("CMYK"));
    let ycck = Jpeg { adobe: Some(2), ..Jpeg::new(4, &[[179, 171, 0, 255]]) }.bytes();
    assert_near(first(&ycck), red, 0.01);
    let tagged = Jpeg { profile: profile([0.0; 3], &[2.0]), ..Jpeg::grey(&[128]) }.bytes();
    assert_eq!(read(&tagged).unwrap().value.space(), "Test profile");
    assert_near(first(&tagged), D65.map(|value| 0.25197 * value), 2e-3);
}

/// A picture of 2 x 1 blocks, black and white, by the orientation of EXIF: columns, and whether the first
/// pixel is white.
#[test]
fn jpeg_orientation_of_exif_is_applied() {
    for (orientation, columns, is_white_first) in [
        (1, 16, false),
        (2, 16, true),
        (3, 16, true),
        (4, 16, false),
        (5, 8, false),
        (6, 8, false),
        (7, 8, true),
        (8, 8, true),
        (0, 16, false),
        (9, 16, false),
    ] {
        let jpeg = Jpeg { size: [16, 8], exif: exif(orientation), ..Jpeg::grey(&[0, 255]) }.bytes();
        let picture = read(&jpeg).unwrap().value;
        let last = picture.row(picture.rows() - 1);
        assert_eq!(picture.columns(), columns, "{orientation}");
        assert_eq!(picture.row(0)[0][1] > 0.5, is_white_first, "{orientation}");
        assert_eq!(last[last.len() - 1][1] > 0.5, !is_white_first, "{orientation}");
        assert_eq!(picture.xyz().len(), 128);
    }
    // Vertical and horizontal mirrors and turns differ within a square.
    let square = |orientation| {
        let jpeg = Jpeg { size: [16, 16], exif: exif(orientation), ..Jpeg::grey(&[0, 80, 160, 255]) }.bytes();
        let picture = read(&jpeg).unwrap().value;
        [(0, 0), (8, 0), (0, 8), (8, 8)].map(|(x, y)| (picture.row(y)[x][1] * 10.0).round() as i32)
    };
    let [a, b, c, d] = square(1);
    assert!(a < b && b < c && c < d);
    let others =
        [[b, a, d, c], [d, c, b, a], [c, d, a, b], [a, c, b, d], [c, a, d, b], [d, b, c, a], [b, d, a, c]];
    for (orientation, wanted) in (2..).zip(others) {
        assert_eq!(square(orientation), wanted, "{orientation}");
    }
}

/// Small files of all kinds.
fn good() -> Vec<Vec<u8>> {
    let dice = &mut Dice::new(5, 0);
    let mut noise = |count: usize| (0..count).map(|_| dice.below(256) as u8).collect::<Vec<u8>>();
    let tagged = [&b"x\0\0"[..], &samples::zlib(&srgb_profile())].concat();
    vec![
        Png::new([5, 3], 8, 2).chunk(b"iCCP", &tagged).data(&[0, 1, 4], &noise(45)),
        Png::new([5, 3], 16, 6).chunk(b"eXIf", &exif(6)).data(&[2, 3, 4], &noise(120)),
        Png::new([9, 2], 2, 3).chunk(b"PLTE", &noise(12)).data(&[0, 0], &noise(6)),
        Jpeg { exif: exif(6), profile: srgb_profile(), ..Jpeg::new(3, &[[76, 85, 255, 0]]) }.bytes(),
        Jpeg { adobe: Some(2), ..Jpeg::new(4, &[[76, 85, 255, 9]]) }.bytes(),
        Jpeg { size: [24, 8], ..Jpeg::grey(&[0, 80, 200]) }.bytes(),
    ]
}

#[test]
fn picture_that_is_cut_off_is_refused() {
    for bytes in good() {
        assert!(read(&bytes).is_ok(), "{:?}", read(&bytes));
        // What comes after the pixels (the end of a PNG file) may lack.
        for length in 0..bytes.len() - 16 {
            let error = read(&bytes[..length]).unwrap_err();
            assert!(error.contains("photo.png"), "{error}");
        }
    }
}

#[test]
fn picture_with_changed_bytes_never_panics_and_is_refused_in_words() {
    let mut dice = Dice::new(6, 0);
    // `cargo xtask full` sets a duration.
    let seconds =
        std::env::var("PAPILIO_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(0.0);
    let until = Instant::now() + Duration::from_secs_f64(seconds);
    let good = good();
    let mut rounds = 0;
    while rounds == 0 || Instant::now() < until {
        rounds += 1;
        for number in 0..400 * good.len() {
            let mut bytes = good[number / 400].clone();
            for _ in 0..1 + dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = dice.below(256) as u8;
            }
            // Checksums of PNG would hide most changes.
            let bytes = if dice.one_in(4) { bytes } else { samples::with_checksums(bytes) };
            match read(&bytes) {
                Ok(picture) => assert_eq!(picture.value.row(0).len(), picture.value.columns()),
                // Messages are sentences, without structures of the decoders.
                Err(error) => assert!(!error.contains(['{', '}', '"']), "{error}"),
            }
        }
    }
}

#[test]
fn written_pictures_are_read_with_their_colours() {
    let pixels: Vec<[u8; 3]> = (0..35).map(|k| [7 * k, 255 - 3 * k, k]).collect();
    for is_display_p3 in [false, true] {
        let mut bytes = Vec::new();
        write_rgb_png(&mut bytes, 7, &pixels, is_display_p3).unwrap();
        let picture = read(&bytes).unwrap().value;
        assert_eq!((picture.columns(), picture.rows()), (7, 5));
        assert_eq!(picture.space(), if is_display_p3 { "P3" } else { "sRGB" });
        let plain = Png::new([7, 5], 8, 2).data(&[0; 5], pixels.as_flattened());
        assert_eq!(picture.xyz() == read(&plain).unwrap().value.xyz(), !is_display_p3);
    }
    let palette = [[0, 0, 0], [255, 255, 255], [200, 30, 30]];
    let states: Vec<u8> = (0..35).map(|k| k % 3).collect();
    let mut bytes = Vec::new();
    write_indexed_png(&mut bytes, 7, &states, &palette).unwrap();
    let colours: Vec<u8> = states.iter().flat_map(|state| palette[usize::from(*state)]).collect();
    assert_eq!(
        read(&bytes).unwrap().value.xyz(),
        read(&Png::new([7, 5], 8, 2).data(&[0; 5], &colours)).unwrap().value.xyz()
    );
    assert!(write_indexed_png(&mut bytes, 7, &states, &palette[..2]).is_err());
    assert!(write_rgb_png(&mut bytes, 8, &pixels, false).is_err());
}

#[test]
fn written_scene_has_its_light_and_its_white() {
    let pixels: Vec<[f32; 3]> = (0..32).map(|k| [k as f32, -0.25, 1e4]).collect();
    let mut bytes = Vec::new();
    write_scene_exr(&mut bytes, 8, pixels.len(), |at| pixels[at], Some(120.5)).unwrap();
    let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = read.first_valid_layer().all_attributes().from_buffered(std::io::Cursor::new(bytes)).unwrap();
    assert_eq!(image.layer_data.attributes.white_luminance, Some(120.5));
    let channel = |name: &str| {
        let found = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
        found.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    assert_eq!(channel("R"), pixels.iter().map(|pixel| pixel[0]).collect::<Vec<_>>());
    assert_eq!((channel("G")[31], channel("B")[0]), (-0.25, 1e4));
    assert!(write_scene_exr(&mut Vec::new(), 5, pixels.len(), |at| pixels[at], None).is_err());
}
