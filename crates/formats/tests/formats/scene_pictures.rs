//! Pictures of high dynamic range, OpenEXR and Radiance: which light becomes white.

use papilio_formats::{DataFile, RgbSpace, SourcePicture, Warned, read_picture, write_scene_exr};

use crate::light_maps::exr_of;

fn read(bytes: &[u8]) -> Result<Warned<SourcePicture>, String> {
    let file = DataFile { name: "scene".into(), bytes: bytes.to_vec() };
    read_picture(&file, &RgbSpace::srgb()).map_err(|error| error.to_string())
}

fn exr(columns: usize, pixels: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_scene_exr(&mut bytes, columns, pixels.len(), |at| pixels[at], Some(80.0)).unwrap();
    bytes
}

#[track_caller]
fn near(found: f32, expected: f64, tolerance: f64) {
    assert!((f64::from(found) - expected).abs() < tolerance, "{found} {expected}");
}

/// Grey of 4 and of 1/4, as many of each: their geometric mean is 1 and becomes 0.18, so that they are 0.72 and 0.045
/// on the curve, of which 0.72 is below its white of 1 (Reinhard et al. 2002, equation 4).
#[test]
fn light_of_a_scene_passes_the_published_curve() {
    let pixels: Vec<[f32; 3]> = (0..40).map(|k| [if k % 2 == 0 { 4.0 } else { 0.25 }; 3]).collect();
    let Warned { value, warnings } = read(&exr(8, &pixels)).unwrap();
    assert_eq!((value.columns(), value.rows()), (8, 5));
    let row = value.row(0);
    near(row[0][1], 0.72, 1e-6);
    near(row[1][1], 0.045, 1e-6);
    assert!(
        warnings.iter().any(|one| one.contains("has no white") && one.contains("1.000)")),
        "{warnings:?}"
    );
    // Ten times the light: the same picture.
    let more: Vec<[f32; 3]> = pixels.iter().map(|pixel| pixel.map(|value| 10.0 * value)).collect();
    near(read(&exr(8, &more)).unwrap().value.row(0)[0][1], 0.72, 1e-6);
    // A lamp: 1/1000 of the pixels may be brighter than white, and white is the brightest other light.
    let with_lamp: Vec<[f32; 3]> = (0..4000)
        .map(|k| if k == 7 { [1e4; 3] } else { [(f64::from(k) / 400.0 - 5.0).exp2() as f32; 3] })
        .collect();
    let found = read(&exr(100, &with_lamp)).unwrap().value.xyz();
    near(found[3995][1], 1.0, 0.01);
    assert!(found[7][1] > 1.0 && found[3999][1] >= found[3995][1]);
    assert!(
        found[1000..3999].windows(2).all(|pair| pair[1][1] >= pair[0][1]),
        "light tones keep their order"
    );
}

/// Hue: red, green and blue keep their ratios, so that x and y do not change.
#[test]
fn colours_of_a_scene_keep_their_chromaticity() {
    let pixels = [[3.0, 1.0, 0.5], [0.2, 0.3, 0.9], [0.05, 0.02, 0.01], [8.0, 8.0, 8.0]];
    let seen = read(&exr(4, &pixels)).unwrap().value.row(0);
    let matrix = RgbSpace::srgb().xyz_from_rgb().unwrap();
    for (pixel, seen) in pixels.iter().zip(seen) {
        let xyz =
            matrix.map(|row| row.iter().zip(pixel).map(|(m, value)| m * f64::from(*value)).sum::<f64>());
        let sum: f64 = xyz.iter().sum();
        let total: f32 = seen.iter().sum();
        (0..3).for_each(|k| near(seen[k] / total, xyz[k] / sum, 1e-5));
    }
}

/// Values up to 1 are those of a picture that has a white; negative ones are colours outside the primaries.
#[test]
fn pictures_with_a_white_are_kept() {
    let pixels = [[0.5, 0.25, 1.0], [1.0; 3], [0.0; 3], [-0.05, 0.4, 0.1]];
    let Warned { value, warnings } = read(&exr(2, &pixels)).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    near(value.row(0)[0][1], 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722, 1e-4);
    near(value.row(0)[1][2], 1.089, 1e-3);
    assert!(value.row(1)[1][0] < value.row(1)[1][1]);
    let wrong = read(&exr(2, &[[0.5; 3], [f32::NAN, 0.0, 0.0]])).unwrap_err();
    assert!(wrong.contains("pixel 2 in row 1 has a value that is not finite"), "{wrong}");
}

/// Opacity, by which the light of OpenEXR is multiplied already: the picture lies on white, as PNG does. Of red with a half, red's half and that of
/// white; in X, Y, Z and in grey, the same rule. Light of a scene passes the curve as if it were opaque.
#[test]
fn transparent_pixels_of_openexr_lie_on_white() {
    let opacity = |at: usize| [1.0, 0.5, 0.0, 1.0][at % 4];
    let red = |at: usize| opacity(at);
    let dark = |_: usize| 0.0;
    let found = |channels: &[(&str, &dyn Fn(usize) -> f32)]| {
        let Warned { value, warnings } = read(&exr_of(4, 1, channels)).unwrap();
        (value.row(0), warnings)
    };
    let (seen, warnings) = found(&[("A", &opacity), ("R", &red), ("G", &dark), ("B", &dark)]);
    assert_eq!(warnings, ["transparent pixels are composited over white, in linear light"]);
    let [red_xyz, white] = [[0.4124, 0.2126, 0.0193], [0.9505, 1.0, 1.0890]];
    for (at, seen) in seen.iter().enumerate() {
        let opaque = f64::from(opacity(at));
        (0..3).for_each(|k| near(seen[k], opaque * red_xyz[k] + (1.0 - opaque) * white[k], 1e-3));
    }
    let grey = |at: usize| 0.3 * opacity(at);
    let expected = [0.3, 0.65, 1.0, 0.3];
    let (seen, _) = found(&[("A", &opacity), ("Y", &grey)]);
    expected.iter().zip(&seen).for_each(|(expected, seen)| near(seen[1], *expected, 1e-6));
    let (seen, _) = found(&[("A", &opacity), ("X", &grey), ("Y", &grey), ("Z", &grey)]);
    near(seen[2][2], 1.0891, 1e-3);
    expected.iter().zip(&seen).for_each(|(expected, seen)| near(seen[1], *expected, 1e-6));
    // 4 and 1/4, of which half is covered: 0.72 and 0.045 on the curve.
    let scene = |at: usize| if at.is_multiple_of(2) { 4.0 } else { 0.25 * 0.5 };
    let cover = |at: usize| if at.is_multiple_of(2) { 1.0 } else { 0.5 };
    let (seen, warnings) = found(&[("A", &cover), ("Y", &scene)]);
    near(seen[0][1], 0.72, 1e-6);
    near(seen[1][1], 0.5 * 0.045 + 0.5, 1e-6);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    // Opaque pixels: no warning, and another layer's opacity is not that of the picture.
    let (_, warnings) = found(&[("A", &|_| 1.0), ("Y", &grey)]);
    assert!(warnings.is_empty(), "{warnings:?}");
    let (seen, warnings) = found(&[("matte.A", &opacity), ("Y", &grey)]);
    near(seen[2][1], 0.0, 1e-6);
    assert!(warnings[0].contains("matte.A are not used"), "{warnings:?}");
}

/// A Radiance picture of any size, here 3 x 1: mantissas and exponent by Ward's rule, its EXPOSURE divided out.
#[test]
fn radiance_pictures_are_read() {
    let pixel = |exponent: u8| [128, 128, 128, exponent];
    let bytes = [
        b"#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n".as_slice(),
        &[pixel(128), pixel(129), pixel(127)].concat(),
    ];
    // 128.5/256 = 0.502, 1.004 and 0.251, each over 2: 1 is white.
    let seen = read(&bytes.concat()).unwrap().value.row(0);
    for (seen, expected) in seen.iter().zip([0.502 / 2.0, 1.004 / 2.0, 0.251 / 2.0]) {
        near(seen[1], expected, 1e-3);
    }
    // A picture need not be twice as wide as high, a light map must.
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
    let wrong = read(huge).unwrap_err();
    assert!(wrong.contains("100000 x 100000 pixels"), "{wrong}");
}
