//! What is done with each field of the formats of light maps: Radiance pictures and OpenEXR.

use std::io::Cursor;

use exr::prelude::*;
use papilio_formats::MapColour;

use crate::light_maps::{exr_of, header, read};

/// What is done with each line of Radiance's header (Radiance file formats, G. Ward), for a map of one
/// colour: its note, or the beginning of its error.
#[test]
fn each_line_of_a_radiance_header_is_used_or_named() {
    for (line, wanted) in [
        ("EXPOSURE=2\n", Ok("")),
        ("COLORCORR=1 2 3\n", Ok("")),
        ("PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n", Ok("")),
        (
            "PRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.3333 0.3333\n",
            Ok("converted from the primaries"),
        ),
        ("PRIMARIES=0.64 0.33\n", Err("PRIMARIES are not eight numbers")),
        ("PIXASPECT=1\n", Ok("")),
        ("PIXASPECT=2\n", Ok("PIXASPECT is not used")),
        ("GAMMA=2.2\n", Ok("GAMMA is not used")),
        ("VIEW=-vth -vh 180\n", Ok("VIEW=-vth -vh 180 is not used")),
        ("SOFTWARE=any\n", Ok("")),
    ] {
        let bytes = [header(line, 8, 16), [128, 100, 90, 129].repeat(128)].concat();
        match (read(&bytes), wanted) {
            (Ok(map), Ok("")) => assert!(map.notes.is_empty(), "{line}: {:?}", map.notes),
            (Ok(map), Ok(wanted)) => assert!(map.notes[0].contains(wanted), "{line}: {:?}", map.notes),
            (Err(error), Err(wanted)) => assert!(error.contains(wanted), "{line}: {error}"),
            (found, _) => panic!("{line}: {found:?}"),
        }
    }
}

/// Primaries of an OpenEXR file count: green light has another luminance in Rec. 2020.
#[test]
fn chromaticities_of_openexr_are_used() {
    let bytes = exr_of_attributes(&|_, attributes| {
        let at = exr::math::Vec2;
        attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
            red: at(0.708, 0.292),
            green: at(0.17, 0.797),
            blue: at(0.131, 0.046),
            white: at(0.3127, 0.329),
        });
    });
    let map = read(&bytes).unwrap();
    let y: f32 =
        map.channels.iter().zip([0.2126, 0.7152, 0.0722]).map(|(c, weight)| weight * c.radiance[3]).sum();
    // 10, 10, 0 by ITU-R BT.2020: 0.2627 and 0.6780.
    assert!((y - 9.407).abs() < 5e-3, "{y}");
    assert!(map.notes[0].contains("32 of 32 pixels are outside the gamut of sRGB"), "{:?}", map.notes);
    assert!(read(&exr_of_attributes(&|_, _| ())).unwrap().notes.is_empty());
}

/// The eight orders of scanlines hold the same picture: the first axis is the slow one; -Y runs down, +X to
/// the right.
#[test]
fn each_order_of_scanlines_is_read() {
    let pixel = |row: usize, column: usize| [(10 * row + column + 100) as u8, 128, 128, 129];
    let wanted = read(&{
        let mut bytes = header("", 4, 8);
        (0..32).for_each(|k| bytes.extend(pixel(k / 8, k % 8)));
        bytes
    })
    .unwrap();
    for (y, rows) in [("-Y", [0, 1, 2, 3]), ("+Y", [3, 2, 1, 0])] {
        for (x, columns) in [("+X", [0, 1, 2, 3, 4, 5, 6, 7]), ("-X", [7, 6, 5, 4, 3, 2, 1, 0])] {
            let mut by_rows = format!("#?RADIANCE\n\n{y} 4 {x} 8\n").into_bytes();
            for row in rows {
                columns.iter().for_each(|column| by_rows.extend(pixel(row, *column)));
            }
            assert_eq!(read(&by_rows).unwrap(), wanted, "{y} {x}");
            let mut by_columns = format!("#?RADIANCE\n\n{x} 8 {y} 4\n").into_bytes();
            for column in columns {
                rows.iter().for_each(|row| by_columns.extend(pixel(*row, column)));
            }
            assert_eq!(read(&by_columns).unwrap(), wanted, "{x} {y}");
        }
    }
}

/// X, Y and Z in cd/m2: D65 white of 179 cd/m2 is red, green and blue of 1.
#[test]
fn picture_in_x_y_z_is_converted() {
    // (mantissa + 1/2)/256 2^(exponent - 128): X 170.13, Y 179, Z 194.9 by the chromaticity 0.3127, 0.3290.
    let mantissa = |value: f64| (value - 0.5).round() as u8;
    let pixel = [mantissa(170.13), mantissa(179.0), mantissa(194.9), 136];
    let bytes = [b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 4\n".as_slice(), &pixel.repeat(8)].concat();
    let map = read(&bytes).unwrap();
    assert!(map.channels.iter().all(|channel| (channel.radiance[5] - 1.0).abs() < 0.01), "{map:?}");
    assert!(map.notes[0].contains("X, Y and Z are taken in cd/m2"), "{:?}", map.notes);
}

type Change<'a> =
    &'a dyn Fn(&mut exr::meta::header::LayerAttributes, &mut exr::meta::header::ImageAttributes);

/// An OpenEXR file of 8 x 4 pixels with red, green and blue of 10, 10, 0, and these attributes.
fn exr_of_attributes(change: Change<'_>) -> Vec<u8> {
    let channel = |(name, value): (&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![value; 32]));
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> =
        [("R", 10.0), ("G", 10.0), ("B", 0.0)].into_iter().map(channel).collect();
    let layer =
        Layer::new((8, 4), LayerAttributes::default(), Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    change(&mut image.layer_data.attributes, &mut image.attributes);
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// What is done with each attribute of OpenEXR (*Standard attributes*, openexr.com): red of the first pixel
/// of 10, and its note.
#[test]
fn each_attribute_of_openexr_is_used_or_named() {
    use exr::math::Vec2;
    use exr::meta::attribute::{EnvironmentMap, IntegerBounds};
    fn text(text: &str) -> Option<Text> {
        Some(Text::from(text))
    }
    let changes: Vec<(&str, Change<'_>, f32, &str)> = vec![
        ("none", &|_, _| (), 10.0, ""),
        (
            "displayWindow",
            &|_, image| image.display_window.size = Vec2(9, 4),
            10.0,
            "the display window is no map",
        ),
        (
            "dataWindow",
            &|layer, _| layer.layer_position = Vec2(0, 2),
            0.0,
            "the rest is dark, and pixels outside are not used",
        ),
        (
            "dataWindow, a part",
            &|_, image| image.display_window = IntegerBounds { position: Vec2(-2, -2), size: Vec2(16, 8) },
            0.0,
            "which is the whole sphere: the rest is dark",
        ),
        (
            "dataWindow, larger",
            &|_, image| image.display_window = IntegerBounds { position: Vec2(2, 1), size: Vec2(4, 2) },
            10.0,
            "pixels outside are not used",
        ),
        ("pixelAspectRatio", &|_, image| image.pixel_aspect = 2.0, 10.0, "pixelAspectRatio 2 is not used"),
        (
            "whiteLuminance",
            &|layer, _| layer.white_luminance = Some(358.0),
            20.0,
            "its values of 1 are 358 cd/m2",
        ),
        (
            "whiteLuminance of nothing",
            &|layer, _| layer.white_luminance = Some(0.0),
            10.0,
            "whiteLuminance 0 is not used",
        ),
        (
            "adoptedNeutral",
            &|layer, _| layer.adopted_neutral = Some(Vec2(0.34, 0.36)),
            10.0,
            "adoptedNeutral 0.34, 0.36 is not used",
        ),
        ("envmap", &|layer, _| layer.environment_map = Some(EnvironmentMap::LatitudeLongitude), 10.0, ""),
        (
            "colorInteropID",
            &|layer, _| {
                layer.other.insert(
                    Text::from("colorInteropID"),
                    exr::meta::attribute::AttributeValue::Text(Text::from("lin_ap1_scene")),
                );
            },
            10.0,
            "colorInteropID lin_ap1_scene is not used",
        ),
        // These describe how the picture was made, or how to show it.
        ("screenWindowCenter", &|layer, _| layer.screen_window_center = Vec2(0.5, 0.5), 10.0, ""),
        ("screenWindowWidth", &|layer, _| layer.screen_window_width = 2.0, 10.0, ""),
        ("owner", &|layer, _| layer.owner = text("me"), 10.0, ""),
        ("comments", &|layer, _| layer.comments = text("none"), 10.0, ""),
        ("capDate", &|layer, _| layer.capture_date = text("2024"), 10.0, ""),
        ("expTime", &|layer, _| layer.exposure = Some(0.01), 10.0, ""),
        ("aperture", &|layer, _| layer.aperture = Some(8.0), 10.0, ""),
        ("isoSpeed", &|layer, _| layer.iso_speed = Some(100.0), 10.0, ""),
        ("focus", &|layer, _| layer.focus = Some(1.0), 10.0, ""),
        ("xDensity", &|layer, _| layer.horizontal_density = Some(72.0), 10.0, ""),
        ("longitude", &|layer, _| layer.longitude = Some(8.0), 10.0, ""),
        ("wrapmodes", &|layer, _| layer.wrap_mode_name = text("black"), 10.0, ""),
        ("renderingTransform", &|layer, _| layer.rendering_transform_name = text("x"), 10.0, ""),
        (
            "originalDataWindow",
            &|layer, _| {
                layer.original_data_window = Some(IntegerBounds { position: Vec2(0, 0), size: Vec2(8, 4) })
            },
            10.0,
            "",
        ),
    ];
    for (name, change, wanted, note) in changes {
        let map = read(&exr_of_attributes(change)).unwrap();
        assert_eq!(map.channels[0].radiance[0], wanted, "{name}");
        let notes = map.notes.join("; ");
        assert!(if note.is_empty() { notes.is_empty() } else { notes.contains(note) }, "{name}: {notes}");
    }
    let cube = exr_of_attributes(&|layer, _| layer.environment_map = Some(EnvironmentMap::Cube));
    assert!(read(&cube).unwrap_err().contains("this cube has 8 x 4 pixels"));
}

/// A part of the sphere keeps its place: 8 x 4 pixels at 2, 2 of 16 x 8.
#[test]
fn data_window_has_its_place_in_the_display_window() {
    use exr::math::Vec2;
    use exr::meta::attribute::IntegerBounds;
    let map = read(&exr_of_attributes(&|layer, image| {
        layer.layer_position = Vec2(12, -3);
        image.display_window = IntegerBounds { position: Vec2(10, -5), size: Vec2(16, 8) };
    }))
    .unwrap();
    assert_eq!((map.width, map.height), (16, 8));
    for (k, value) in map.channels[0].radiance.iter().enumerate() {
        let lit = (2..6).contains(&(k / 16)) && (2..10).contains(&(k % 16));
        assert_eq!(*value, if lit { 10.0 } else { 0.0 }, "{k}");
    }
}

/// Parts, layers, sample types, line orders, tiles and compressions change how the values are stored, not the
/// values.
#[test]
fn values_of_openexr_do_not_depend_on_their_storage() {
    let value = |k: usize| (k % 7 + 1) as f32;
    let samples = |kind: usize, by: f32| match kind {
        0 => FlatSamples::F16((0..32).map(|k| f16::from_f32(by * value(k))).collect()),
        1 => FlatSamples::F32((0..32).map(|k| by * value(k)).collect()),
        _ => FlatSamples::U32((0..32).map(|k| (by * value(k)) as u32).collect()),
    };
    let layer = |name: &str, prefix: &str, kind: usize, encoding: Encoding| {
        let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = [("R", 1.0), ("G", 2.0), ("B", 3.0)]
            .into_iter()
            .map(|(name, by)| AnyChannel::new(&*format!("{prefix}{name}"), samples(kind, by)))
            .collect();
        Layer::new((8, 4), LayerAttributes::named(name), encoding, AnyChannels::sort(channels))
    };
    let check = |bytes: &[u8], note: &str, what: &str| {
        let map = read(bytes).unwrap_or_else(|error| panic!("{what}: {error}"));
        for (channel, by) in map.channels.iter().zip([1.0, 2.0, 3.0]) {
            let right = channel.radiance.iter().enumerate().all(|(k, found)| *found == by * value(k));
            assert!(right, "{what}: {channel:?}");
        }
        let notes = map.notes.join("; ");
        assert!(if note.is_empty() { notes.is_empty() } else { notes.contains(note) }, "{what}: {notes}");
    };
    let orders = [LineOrder::Increasing, LineOrder::Decreasing];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    for kind in 0..3 {
        for line_order in orders {
            for compression in compressions {
                for blocks in [Blocks::ScanLines, Blocks::Tiles(exr::math::Vec2(3, 2))] {
                    let encoding = Encoding { compression, blocks, line_order };
                    let image = Image::from_layer(layer("map", "", kind, encoding));
                    let mut bytes = Cursor::new(Vec::new());
                    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
                    check(
                        &bytes.into_inner(),
                        "",
                        &format!("{kind} {line_order:?} {compression:?} {blocks:?}"),
                    );
                }
            }
        }
    }
    let fast = Encoding::FAST_LOSSLESS;
    let parts = |layers: Vec<Layer<AnyChannels<FlatSamples>>>| {
        let attributes = exr::meta::header::ImageAttributes::with_size((8, 4));
        let layers: Layers<AnyChannels<FlatSamples>> = layers.into_iter().collect();
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layers(attributes, layers).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    let mut depth = layer("depth", "", 1, fast);
    depth.channel_data.list.truncate(1);
    let several = parts(vec![depth, layer("map", "", 1, fast), layer("other", "", 1, fast)]);
    check(&several, "its parts depth, other are not used", "several parts");
    let named = parts(vec![layer("map", "beauty.", 1, fast)]);
    check(&named, "", "a layer");
    let mut two = layer("map", "", 1, fast);
    let mut both = two.channel_data.list;
    both.extend(layer("map", "sky.", 1, fast).channel_data.list);
    two.channel_data = AnyChannels::sort(both);
    check(&parts(vec![two]), "its channels sky.B, sky.G, sky.R are not used", "two layers");
}

/// Y, (R - Y)/Y and (B - Y)/Y of sRGB, X, Y and Z of D65, and luminance alone are the same white and red.
#[test]
fn luminance_with_chroma_and_x_y_z_are_colours() {
    // Red of 2: Y = 2 x 0.2126.
    let y = 2.0 * 0.212_639_f32;
    let chroma = exr_of(8, 4, &[("Y", &|_| y), ("RY", &|_| (2.0 - y) / y), ("BY", &|_| -1.0)]);
    let map = read(&chroma).unwrap();
    for (channel, wanted) in map.channels.iter().zip([2.0, 0.0, 0.0]) {
        assert!((channel.radiance[3] - wanted).abs() < 1e-4, "{map:?}");
    }
    let xyz = exr_of(8, 4, &[("X", &|_| 0.950_456), ("Y", &|_| 1.0), ("Z", &|_| 1.089_058)]);
    let map = read(&xyz).unwrap();
    assert!(map.channels.iter().all(|channel| (channel.radiance[3] - 1.0).abs() < 1e-3), "{map:?}");
    assert!(map.notes.contains(&"its X, Y and Z are converted to sRGB".to_owned()), "{:?}", map.notes);
    let grey = read(&exr_of(8, 4, &[("Y", &|_| 1.0)])).unwrap();
    assert_eq!((grey.channels.len(), grey.channels[0].colour), (1, MapColour::Grey));
}

/// Six faces of different values: the middle of each is where OpenEXR's convention puts it, and gradients run
/// as it says. +Z is the middle of the map, +X to the left, +Y up.
#[test]
fn faces_of_a_cube_have_their_directions() {
    use exr::meta::attribute::EnvironmentMap;
    let face = 8;
    let channel = |name: &str, value: &dyn Fn(usize, usize, usize) -> f32| {
        let at = |k: usize| value(k / (face * face), k / face % face, k % face);
        AnyChannel::new(name, FlatSamples::F32((0..6 * face * face).map(at).collect()))
    };
    // The number of the face, and rows and columns within it.
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = [
        channel("R", &|number, _, _| number as f32 + 1.0),
        channel("G", &|_, row, _| row as f32),
        channel("B", &|_, _, column| column as f32),
    ]
    .into_iter()
    .collect();
    let attributes =
        LayerAttributes { environment_map: Some(EnvironmentMap::Cube), ..LayerAttributes::default() };
    let layer =
        Layer::new((face, 6 * face), attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    let map = read(&bytes.into_inner()).unwrap();
    assert_eq!((map.width, map.height), (32, 16));
    let at = |channel: usize, right: f64, up: f64| {
        let (row, column) = (((0.5 - up / 180.0) * 16.0) as usize, ((0.5 + right / 360.0) * 32.0) as usize);
        map.channels[channel].radiance[row * 32 + column]
    };
    for (right, up, number) in [
        (3.0, 3.0, 5.0),
        (-87.0, 3.0, 1.0),
        (93.0, 3.0, 2.0),
        (177.0, 3.0, 6.0),
        (3.0, 87.0, 3.0),
        (3.0, -87.0, 4.0),
    ] {
        assert_eq!(at(0, right, up), number, "{right} {up}");
    }
    // On the sides, rows run down, and columns to the right as seen from inside.
    for middle in [0.0, -90.0, 90.0, 170.0] {
        assert!(at(1, middle + 3.0, 25.0) < at(1, middle + 3.0, -25.0), "{middle}");
    }
    for middle in [0.0, -90.0, 90.0] {
        assert!(at(2, middle - 25.0, 3.0) < at(2, middle + 25.0, 3.0), "{middle}");
    }
}
