//! The fields of each format's document, with what the reader does with them: a change of the field shows it.

use super::files::{gsf, keyence, opd, plux, sdf_binary, sdf_text, singles, sur, tiff, x3p};
use super::{Done, Field, audit, replaced, set};
use Done::{Described, Refused, Used, Warned};

/// ISO 25178-71:2012 and 2017, table 2; the binary header of ISO-1.0.
#[test]
fn fields_of_binary_sdf() {
    const FIELDS: [Field; 14] = [
        ("version, another revision", |b| set(b, 5, b"3.0"), Refused("its revision is `ISO-3.0`")),
        ("ManufacID", |b| set(b, 8, b"\xB5-Optics"), Described),
        ("CreateDate", |b| set(b, 18, b"010120261200"), Described),
        ("ModDate", |b| set(b, 30, b"010120261200"), Described),
        ("NumPoints", |b| set(b, 42, &5_u16.to_le_bytes()), Refused("it ends within its contents")),
        ("NumProfiles", |b| set(b, 44, &2_u16.to_le_bytes()), Used),
        ("Xscale", |b| set(b, 46, &3e-7_f64.to_le_bytes()), Used),
        ("Yscale", |b| set(b, 54, &3e-7_f64.to_le_bytes()), Used),
        ("Zscale", |b| set(b, 62, &3e-9_f64.to_le_bytes()), Used),
        // The smallest step, negative where it is unknown: the numbers have their own.
        ("Zresolution", |b| set(b, 70, &1e-9_f64.to_le_bytes()), Described),
        ("Compression", |b| set(b, 78, &[1]), Refused("compressed (expected Compression 0)")),
        ("DataType", |b| set(b, 79, &[9]), Refused("its data type is 9")),
        ("CheckType", |b| set(b, 80, &[1]), Warned("checksum of this SDF file is not verified")),
        ("record 3, a free text", |b| b.extend(b"<Comment>none</Comment>"), Described),
    ];
    audit(&sdf_binary(b"bISO-1.0"), &FIELDS);
}

/// The same fields in a text; and the names that BCR-1.0 permits for codes, and its comments.
#[test]
fn fields_of_text_sdf() {
    const FIELDS: [Field; 15] = [
        ("version, another revision", |b| set(b, 5, b"7.0"), Refused("its revision is `BCR-7.0`")),
        ("ManufacID", |b| replaced(b, "sdf-test", "\u{b5}-Optics"), Described),
        ("CreateDate", |b| replaced(b, "251120260322", "010120261200"), Described),
        (
            "NumPoints",
            |b| replaced(b, "NumPoints = 4", "NumPoints = 5"),
            Refused("12 heights, and its header 15"),
        ),
        (
            "NumProfiles",
            |b| replaced(b, "NumProfiles = 3", "NumProfiles = x"),
            Refused("no number `NumProfiles`"),
        ),
        ("Xscale", |b| replaced(b, "Xscale = 5.0e-7", "Xscale = 6.0e-7"), Used),
        ("Yscale", |b| replaced(b, "Yscale = 5.0e-7", "Yscale = 6.0e-7"), Used),
        ("Zscale", |b| replaced(b, "Zscale = 1.0e-9", "Zscale = 2.0e-9"), Used),
        ("Zresolution", |b| replaced(b, "Zresolution = -1", "Zresolution = 1"), Described),
        ("Compression", |b| replaced(b, "Compression = 0", "Compression = RLL"), Refused("compressed")),
        ("Compression by name", |b| replaced(b, "Compression = 0", "Compression = NULL"), Described),
        ("DataType by name", |b| replaced(b, "DataType = 5", "DataType = INTEGER"), Described),
        ("DataType", |b| replaced(b, "DataType = 5", "DataType = 8"), Refused("its data type is 8")),
        ("CheckType", |b| replaced(b, "CheckType = 0", "CheckType = 1"), Warned("not verified")),
        ("comment", |b| replaced(b, "NumPoints = 4", "NumPoints = 4 ; along x"), Described),
    ];
    audit(sdf_text("aBCR-1.0").as_bytes(), &FIELDS);
}

/// ISO 25178-72:2017, records 1 to 4.
#[test]
fn fields_of_x3p() {
    let base = x3p::main_xml();
    const FIELDS: [(&str, &str, &str, Done); 20] = [
        ("Record1/Revision", "ISO5436 - 2000", "ISO25178 - 2017", Described),
        ("Record1/FeatureType, a profile", ">SUR<", ">PRF<", Refused("holds a profile")),
        ("Record1/FeatureType, points", ">SUR<", ">PCL<", Refused("a cloud of points")),
        (
            "Axes/CX/AxisType",
            "<CX><AxisType>I",
            "<CX><AxisType>A",
            Refused("along CX are not those of a grid"),
        ),
        (
            "Axes/CX/DataType, for absolute places",
            "<CX><AxisType>I</AxisType><DataType>D",
            "<CX><AxisType>I</AxisType><DataType>F",
            Described,
        ),
        ("Axes/CX/Increment", "<Increment>1e-6<", "<Increment>2e-6<", Used),
        (
            "Axes/CX/Offset, the place of the map",
            "<Offset>0</Offset></CX>",
            "<Offset>1</Offset></CX>",
            Described,
        ),
        (
            "Axes/CY/AxisType",
            "<CY><AxisType>I",
            "<CY><AxisType>A",
            Refused("along CY are not those of a grid"),
        ),
        ("Axes/CY/Increment", "<Increment>2e-6<", "<Increment>0<", Refused("the increment of CY is 0 m")),
        (
            "Axes/CZ/DataType",
            "<AxisType>A</AxisType><DataType>D",
            "<AxisType>A</AxisType><DataType>X",
            Refused("is `X`"),
        ),
        ("Axes/CZ/Increment", "<Increment>1e-9<", "<Increment>3e-9<", Used),
        ("Axes/CZ/Offset", "<Offset>0</Offset></CZ>", "<Offset>1e-6</Offset></CZ>", Used),
        (
            "Axes/Rotation",
            "</CZ>",
            "</CZ><Rotation><r11>-1</r11></Rotation>",
            Warned("the rotation of the axes"),
        ),
        (
            "Record2, about the measurement",
            "</Record1>",
            "</Record1><Record2><Date>2026</Date></Record2>",
            Described,
        ),
        (
            "Record3/MatrixDimension/SizeX",
            "<SizeX>3<",
            "<SizeX>4<",
            Refused("6 heights, and its dimensions 8"),
        ),
        ("Record3/MatrixDimension/SizeZ", "<SizeZ>1<", "<SizeZ>2<", Refused("several layers")),
        (
            "Record3/ListDimension, of points",
            "MatrixDimension",
            "ListDimension",
            Refused("no number Record3/MatrixDimension/SizeX"),
        ),
        (
            "Record3/DataLink/PointDataLink",
            "bindata/data.bin",
            "bindata/none.bin",
            Refused("bindata/none.bin"),
        ),
        (
            "Record3/DataLink/MD5ChecksumPointData, beside that of zip",
            "</DataLink>",
            "<MD5ChecksumPointData>0</MD5ChecksumPointData></DataLink>",
            Described,
        ),
        (
            "Record4/ChecksumFile, beside that of zip",
            "</Record3>",
            "</Record3><Record4><ChecksumFile>a</ChecksumFile></Record4>",
            Described,
        ),
    ];
    let whole = x3p::archive(&base, &[]);
    for (field, old, new, done) in FIELDS {
        assert!(base.contains(old), "{field}");
        super::check(field, &whole, &x3p::archive(&base.replace(old, new), &[]), done);
    }
    // DataLink/ValidPointsLink: a bit for each height, the lowest first.
    let linked =
        base.replace("</DataLink>", "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>");
    super::check(
        "all valid",
        &whole,
        &x3p::archive(&linked, &[("bindata/valid.bin", &[0b11_1111])]),
        Described,
    );
    let masked = x3p::archive(&linked, &[("bindata/valid.bin", &[0b10_1110])]);
    super::check("ValidPointsLink", &whole, &masked, Refused("2 of 6 heights are missing"));
}

/// Gwyddion's manual, "Gwyddion Simple Field (.gsf)".
#[test]
fn fields_of_gsf() {
    const FIELDS: [(&str, &str, &str, Done); 11] = [
        ("XRes", "XRes = 4", "XRes = 3", Refused("bytes of heights")),
        ("YRes", "YRes = 3", "YRes = y", Refused("no whole number YRes")),
        ("XReal", "XReal = 2e-6", "XReal = 4e-6", Used),
        ("YReal", "YReal = 1.5e-6", "YReal = -1", Refused("YReal is `-1`")),
        ("XReal, absent", "XReal = 2e-6\n", "", Warned("no XReal: 1 is taken")),
        ("XOffset, the place of the map", "Title = t", "Title = t\nXOffset = 3e-6", Described),
        ("YOffset, the place of the map", "Title = t", "Title = t\nYOffset = 3e-6", Described),
        ("Title", "Title = t", "Title = another", Described),
        ("XYUnits", "XYUnits = m", "XYUnits = um", Used),
        ("ZUnits", "ZUnits = m", "ZUnits = nm", Used),
        ("ZUnits, not of heights", "ZUnits = m", "ZUnits = V", Refused("ZUnits is `V`")),
    ];
    let head = "XRes = 4\nYRes = 3\nXReal = 2e-6\nYReal = 1.5e-6\nXYUnits = m\nZUnits = m\nTitle = t\n";
    for (field, old, new, done) in FIELDS {
        assert!(head.contains(old), "{field}");
        super::check(field, &gsf(head), &gsf(&head.replacen(old, new, 1)), done);
    }
}

/// The header of 512 bytes in the specification of MountainsMap's surface file.
#[test]
fn fields_of_sur() {
    const FIELDS: [Field; 37] = [
        ("signature", |b| set(b, 0, b"DIGITAL SARF"), Refused("not a map of heights")),
        ("format: PC or Macintosh", |b| set(b, 12, &[1, 0]), Refused("big-endian")),
        ("number of objects", |b| set(b, 14, &[2, 0]), Warned("further layers")),
        ("version", |b| set(b, 16, &[2, 0]), Described),
        ("type, a profile", |b| set(b, 18, &[1, 0]), Refused("holds a profile")),
        ("type, a series", |b| set(b, 18, &[5, 0]), Refused("holds a series of surfaces")),
        ("type, a coloured surface", |b| set(b, 18, &[13, 0]), Warned("further layers")),
        ("name of the object", |b| set(b, 20, b"other"), Described),
        ("name of the operator", |b| set(b, 50, b"other"), Described),
        ("size of P", |b| set(b, 80, &[1, 0]), Described),
        ("type of acquisition", |b| set(b, 82, &[1, 0]), Described),
        ("type of range", |b| set(b, 84, &[1, 0]), Described),
        // The second height is the smallest one less 2.
        ("special points", |b| set(b, 86, &[1, 0]), Refused("1 of 12 heights are missing")),
        ("absolute heights", |b| set(b, 88, &[1, 0]), Described),
        ("resolution of the gauge", |b| set(b, 90, &1_f32.to_le_bytes()), Described),
        ("bits per point", |b| set(b, 98, &[8, 0]), Refused("8 bits")),
        (
            "smallest number, for the mark of missing heights",
            |b| set(b, 100, &1_i32.to_le_bytes()),
            Described,
        ),
        ("largest number", |b| set(b, 104, &1_i32.to_le_bytes()), Described),
        ("points per line", |b| set(b, 108, &5_i32.to_le_bytes()), Refused("12 heights for 5 x 3")),
        ("lines", |b| set(b, 112, &(-3_i32).to_le_bytes()), Refused("its size is negative")),
        ("points in all", |b| set(b, 116, &13_i32.to_le_bytes()), Refused("13 heights for 4 x 3")),
        ("spacing of x", |b| set(b, 120, &1_f32.to_le_bytes()), Used),
        ("spacing of y", |b| set(b, 124, &1_f32.to_le_bytes()), Used),
        ("spacing of z", |b| set(b, 128, &0_f32.to_le_bytes()), Refused("the spacing of z is 0")),
        ("names of the axes", |b| set(b, 132, b"X"), Described),
        ("unit of the steps of x", |b| set(b, 180, b"mm"), Used),
        ("unit of the steps of z, not of heights", |b| set(b, 212, b"mV"), Refused("the unit of z is `mV`")),
        ("units in which x, y, z are shown", |b| set(b, 228, b"mm"), Described),
        ("ratios of these units", |b| set(b, 276, &9_f32.to_le_bytes()), Described),
        ("replica", |b| set(b, 288, &[1, 0]), Warned("of a replica")),
        ("inverted", |b| set(b, 290, &[1, 0]), Used),
        ("levelled", |b| set(b, 292, &[1, 0]), Described),
        ("date, time and duration", |b| set(b, 306, &[1; 18]), Described),
        ("size of the compressed data", |b| set(b, 324, &[9; 4]), Described),
        ("length of the comment", |b| set(b, 334, &[200, 0]), Refused("it ends within its contents")),
        ("client zone", |b| set(b, 338, &[7; 128]), Described),
        // A height that all have.
        ("offsets of x, y and z", |b| set(b, 466, &[0, 0, 128, 63]), Described),
    ];
    audit(&sur(false), &FIELDS);
}

/// The blocks that programs of Wyko write beside the heights.
#[test]
fn blocks_of_opd() {
    let base = opd(&[]);
    let text = |value: &[u8]| (5_i16, value.to_vec());
    let float = |value: f32| (7_i16, value.to_le_bytes().to_vec());
    let double = |value: f64| (8_i16, value.to_le_bytes().to_vec());
    let short = |value: i16| (6_i16, value.to_le_bytes().to_vec());
    let array = |values: &[u8]| (3_i16, [&[2, 0, 2, 0, 1, 0][..], values].concat());
    for (name, block, done) in [
        ("Wavelength", float(500.0), Used),
        ("Wavelength", double(500.0), Used),
        ("Wavelength", text(b"red"), Refused("Wavelength is not a number")),
        ("Mult", short(2), Used),
        ("Mult", short(0), Refused("Mult is 0")),
        ("Aspect", float(1.5), Warned("Aspect 1.5")),
        ("Pixel_size", float(0.002), Used),
        ("Title", text(b"a face"), Described),
        ("Note", text(b"none"), Described),
        ("Date", text(b"01/01/26"), Described),
        ("Magnification", float(20.0), Described),
        ("Intensity", array(&[1, 2, 3, 4]), Warned("not used: Intensity")),
        ("RAW_DATA", array(&[1, 2, 3]), Refused("bytes for 2 x 2")),
    ] {
        super::check(name, &base, &opd(&[(name, block)]), done);
    }
}

/// The parts of a file of a laser microscope of Keyence that lead to its heights.
#[test]
fn fields_of_keyence() {
    const FIELDS: [Field; 11] = [
        ("version", |b| set(b, 0, b"VK9_"), Refused("not a map of heights")),
        ("place of the conditions", |b| set(b, 12, &[255; 4]), Refused("it ends within its contents")),
        ("places of the pictures", |b| set(b, 16, &[255; 20]), Described),
        ("place of the heights", |b| set(b, 36, &[255; 4]), Refused("it ends within its contents")),
        ("length per pixel along x, pm", |b| set(b, 84 + 4 * 42, &7_u32.to_le_bytes()), Used),
        ("length per pixel along y, pm", |b| set(b, 84 + 4 * 43, &7_u32.to_le_bytes()), Used),
        ("length per digit of heights, pm", |b| set(b, 84 + 4 * 44, &[0; 4]), Refused("per step is 0")),
        ("width of the heights", |b| set(b, 400, &[200, 0, 0, 0]), Refused("another size than it states")),
        ("bits of the heights", |b| set(b, 408, &[24, 0, 0, 0]), Refused("24 bits")),
        ("compression of the heights", |b| set(b, 412, &[1, 0, 0, 0]), Refused("compressed")),
        ("range of the palette", |b| set(b, 420, &[1; 8]), Described),
    ];
    audit(&keyence(), &FIELDS);
}

/// The numbers of `index.xml` of Sensofar.
#[test]
fn fields_of_plux() {
    let xml = "<xml><GENERAL><DATE>2026</DATE><IMAGE_SIZE_X>4</IMAGE_SIZE_X><IMAGE_SIZE_Y>3</IMAGE_SIZE_Y><FOV_X>0.5</FOV_X>\
               <FOV_Y>0.5</FOV_Y></GENERAL></xml>";
    let base = plux(xml);
    for (field, old, new, done) in [
        ("DATE", "2026", "2025", Described),
        ("IMAGE_SIZE_X", "<IMAGE_SIZE_X>4", "<IMAGE_SIZE_X>5", Refused("it ends within its contents")),
        ("IMAGE_SIZE_Y", "<IMAGE_SIZE_Y>3", "<IMAGE_SIZE_Y>2", Refused("larger than the dimensions")),
        ("FOV_X, the distance along x", "<FOV_X>0.5", "<FOV_X>0.6", Used),
        ("FOV_Y, the distance along y", "<FOV_Y>0.5", "<FOV_Y>0", Refused("no number GENERAL/FOV_Y")),
    ] {
        super::check(field, &base, &plux(&xml.replacen(old, new, 1)), done);
    }
}

/// TIFF 6.0, baseline tags of grey pictures, and what profilometers and GDAL add.
#[test]
fn tags_of_tiff() {
    let base = tiff(32, 3, &singles(), &[]);
    let short = |text: &[u8; 4]| u32::from_le_bytes(*text);
    for (field, more, done) in [
        ("Orientation, at the top", (274, 3, 1, 1), Described),
        ("Orientation, another one", (274, 3, 1, 4), Refused("its Orientation is 4")),
        (
            "ImageDescription",
            (270, 2, 4, short(b"um=\0")),
            Warned("description of this TIFF file is not used"),
        ),
        // A fraction in the heights.
        ("XResolution", (282, 5, 1, 8), Warned("`pixel_um` is the distance")),
        ("ModelPixelScale of GeoTIFF", (33550, 12, 1, 8), Warned("`pixel_um` is the distance")),
        ("ResolutionUnit", (296, 3, 1, 3), Described),
        ("Software", (305, 2, 4, short(b"abc\0")), Described),
        ("DateTime, cut short", (306, 2, 4, short(b"202\0")), Described),
        ("GDAL_NODATA, another number", (42113, 2, 4, short(b"-9 \0")), Described),
        ("GDAL_NODATA", (42113, 2, 2, short(b"7\0\0\0")), Refused("1 of 12 heights are missing")),
        ("SamplesPerPixel", (277, 4, 1, 2), Refused("TIFF")),
        ("BitsPerSample", (258, 4, 1, 8), Refused("expected a grey picture of 16 or 32 bits")),
        (
            "ImageLength, which RowsPerStrip contradicts",
            (257, 4, 1, 90_000_000),
            Refused("inconsistent sizes"),
        ),
    ] {
        super::check(field, &base, &tiff(32, 3, &singles(), &[more]), done);
    }
    // ImageLength and RowsPerStrip that agree: the size is refused before memory is taken.
    let tall = tiff(32, 3, &singles(), &[(257, 4, 1, 90_000_000), (278, 4, 1, 90_000_000)]);
    super::check("ImageLength", &base, &tall, Refused("4 x 90000000 heights"));
    let map = super::read(base).unwrap();
    assert!(
        !map.is_picture && map.warnings.iter().any(|warning| warning.contains("um are taken")),
        "{:?}",
        map.warnings
    );
    assert_eq!(map.numbers[..5], [9.0, 10.0, 11.0, 12.0, 5.0]);
    let integers = super::read(tiff(16, 1, &singles()[..24], &[])).unwrap();
    assert!(integers.is_picture && integers.warnings.is_empty());
}
