//! Light maps: readers, errors, and arbitrary bytes.
use std::io::Cursor;

use exr::prelude::*;
use papilio_formats::{DataFile, LightMap, MapColour, read_light_map};

pub(crate) fn read(bytes: &[u8]) -> std::result::Result<LightMap, String> {
    let file = DataFile { name: "room.hdr".into(), bytes: bytes.to_vec() };
    read_light_map(&file).map_err(|error| error.to_string())
}

pub(crate) fn header(lines: &str, height: usize, width: usize) -> Vec<u8> {
    format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes()
}

/// A picture of 8 rows with run-length encoding by component, as most programs write it.
fn in_runs(pixel: impl Fn(usize, usize) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = header("", 8, 16);
    for row in 0..8 {
        bytes.extend([2, 2, 0, 16]);
        for component in 0..4 {
            // Four equal pixels as a run, twelve literally.
            let value = |column: usize| pixel(row, column)[component];
            bytes.extend([128 + 4, value(0), 12]);
            bytes.extend((4..16).map(value));
        }
    }
    bytes
}

fn plain(pixel: impl Fn(usize, usize) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = header("", 8, 16);
    (0..128).for_each(|k| bytes.extend(pixel(k / 16, k % 16)));
    bytes
}

#[test]
fn picture_with_or_without_runs_is_read_equally() {
    let pixel = |row: usize, column: usize| {
        let column = if column < 4 { 0 } else { column };
        [10 * row as u8 + 3, 7 * column as u8, 200, 128 + (column % 3) as u8]
    };
    let map = read(&in_runs(pixel)).unwrap();
    assert_eq!(map, read(&plain(pixel)).unwrap());
    assert_eq!((map.width, map.height), (16, 8));
    assert_eq!(
        map.channels.iter().map(|c| c.colour).collect::<Vec<_>>(),
        [MapColour::Red, MapColour::Green, MapColour::Blue]
    );
    // (mantissa + 1/2)/256 2^(exponent - 128).
    assert_eq!(map.channels[2].radiance[0], 200.5 / 256.0);
    assert_eq!(map.channels[0].radiance[17], 13.5 / 256.0);
}

#[test]
fn picture_with_exposure_is_divided_by_it() {
    let body = [128, 128, 128, 129].repeat(8);
    let of = |lines: &str| read(&[header(lines, 2, 4), body.clone()].concat()).unwrap();
    let (plain, exposed) = (of(""), of("EXPOSURE=2.0\nEXPOSURE=2\nCOLORCORR=1 0.5 2\n"));
    for (channel, by) in [(0, 4.0), (1, 2.0), (2, 8.0)] {
        assert_eq!(plain.channels[channel].radiance[3], by * exposed.channels[channel].radiance[3]);
    }
}

#[test]
fn malformed_picture_is_refused_with_its_reason() {
    let body = [128; 32];
    for (bytes, wanted) in [
        (b"P6\n4 2\n".to_vec(), "this is a Portable Anymap file"),
        (b"any text".to_vec(), "neither a Radiance picture"),
        (header("", 4, 4), "4 x 4 pixels"),
        (header("", 3, 6), "6 x 3 pixels"),
        (header("", 4_000_000_000, 8_000_000_000), "8000000000 x 4000000000 pixels"),
        (header("", 2, 4), "the file ends in row 1 of 2"),
        ([header("", 2, 4), body[..20].to_vec()].concat(), "the file ends in row 2 of 2"),
        (header("EXPOSURE=0\n", 2, 4), "line 2 of the header: its EXPOSURE"),
        (header("COLORCORR=1 2\n", 2, 4), "line 2 of the header: its COLORCORR"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_cmyk\n\n-Y 2 +X 4\n".to_vec(), "its FORMAT is not"),
        (b"#?RADIANCE\n\n+Y 2 +Y 4\n".to_vec(), "scanlines of this file have the order `+Y 2 +Y 4`"),
        (b"#?RADIANCE\n\n-Y two +X 4\n".to_vec(), "scanlines of this file have the order"),
        (b"#?RADIANCE\n".to_vec(), "it has no newline within 2048 bytes; expected an empty line"),
        (
            b"#?RADIANCE\n-Y 2 +X 4\n".to_vec(),
            "line 2 of the header: the size of the picture; expected an empty line",
        ),
        ([b"#?RADIANCE\n".to_vec(), vec![b'x'; 100_000]].concat(), "it has no newline"),
        ([header("", 8, 16), vec![2, 2, 0, 16, 255, 1, 1]].concat(), "the data of row 1 do not match"),
        ([header("", 2, 4), vec![1, 1, 1, 3]].concat(), "the data of row 1 do not match"),
    ] {
        let error = read(&bytes).unwrap_err();
        assert!(error.contains(wanted) && error.contains("room.hdr"), "{wanted}: {error}");
    }
}

/// Returns an OpenEXR file with these channels.
pub(crate) fn exr_of(width: usize, height: usize, channels: &[(&str, &dyn Fn(usize) -> f32)]) -> Vec<u8> {
    let channel = |(name, value): &(&str, &dyn Fn(usize) -> f32)| {
        let samples = FlatSamples::F32((0..width * height).map(value).collect());
        AnyChannel::new(*name, samples)
    };
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels.iter().map(channel).collect();
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn openexr_map_of_colours_or_wavelengths_is_read() {
    let value = |k: usize| k as f32 + 0.25;
    let rgb =
        read(&exr_of(8, 4, &[("R", &value), ("G", &|_| 2.0), ("B", &|_| 3.0), ("A", &|_| 1.0)])).unwrap();
    assert_eq!(rgb.channels[0].radiance[9], 9.25);
    assert_eq!(rgb.channels.len(), 3);
    let grey = read(&exr_of(8, 4, &[("Y", &value)])).unwrap();
    assert_eq!(grey.channels[0].colour, MapColour::Grey);
    let spectral = [
        ("S0.700,000nm", &value as &dyn Fn(usize) -> f32),
        ("S0.400,000nm", &|_| 1.0),
        ("S0.550,5nm", &value),
    ];
    let spectral = read(&exr_of(8, 4, &spectral)).unwrap();
    let nm: Vec<_> = spectral.channels.iter().map(|channel| channel.colour).collect();
    assert_eq!(nm, [400.0, 550.5, 700.0].map(MapColour::Wavelength));
}

#[test]
fn malformed_openexr_map_is_refused_with_its_reason() {
    let one = |_: usize| 1.0;
    let good = exr_of(8, 4, &[("R", &one), ("G", &one), ("B", &one)]);
    for (bytes, wanted) in [
        (exr_of(8, 8, &[("R", &one), ("G", &one), ("B", &one)]), "8 x 8 pixels"),
        (exr_of(8, 4, &[("R", &one), ("G", &one)]), "has the channels G, R"),
        (
            exr_of(8, 4, &[("R", &|k| if k == 9 { f32::NAN } else { 1.0 }), ("G", &one), ("B", &one)]),
            "channel R of pixel 2 in row 2 is NaN",
        ),
        (exr_of(8, 4, &[("Y", &|k| if k == 8 { -1.0 } else { 1.0 })]), "channel Y of pixel 1 in row 2 is -1"),
        (exr_of(8, 4, &[("Y", &|_| f32::INFINITY)]), "is inf"),
        (good[..good.len() - 20].to_vec(), "cannot be read"),
        (good[..40].to_vec(), "cannot be read"),
    ] {
        let error = read(&bytes).unwrap_err();
        assert!(error.contains(wanted), "{wanted}: {error}");
    }
}

/// Files with arbitrary changes are read or refused.
#[test]
fn light_map_with_changed_bytes_never_panics() {
    let one = |k: usize| k as f32;
    let good = [
        in_runs(|row, column| [row as u8, column as u8, 9, 130]),
        exr_of(8, 4, &[("R", &one), ("G", &one), ("B", &one)]),
    ];
    let mut dice = papilio_testing::Dice::new(1, 0);
    for good in good {
        for _ in 0..2000 {
            let mut bytes = good.clone();
            for _ in 0..1 + dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = dice.below(256) as u8;
            }
            bytes.truncate(bytes.len() - dice.below(2) * dice.below(bytes.len()));
            let _ = read(&bytes);
        }
    }
}
