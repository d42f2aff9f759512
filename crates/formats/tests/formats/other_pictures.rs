//! Pictures of formats that are not read: refused by their names, wherever a picture, a light map or heights
//! are read.

use papilio_formats::{
    DataFile, HAS_PNG, RgbSpace, picture_format, read_heights, read_light_map, read_picture,
};

/// First bytes of files as programs write them.
const FILES: [(&str, &[u8]); 18] = [
    ("WebP", b"RIFF\x24\0\0\0WEBPVP8 "),
    ("HEIC", b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"),
    ("HEIC", b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic"),
    ("AVIF", b"\0\0\0\x1cftypavif\0\0\0\0avifmif1"),
    ("GIF", b"GIF89a\x01\0\x01\0"),
    ("GIF", b"GIF87a\x01\0\x01\0"),
    ("BMP", b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0"),
    ("TIFF", b"II*\0\x08\0\0\0"),
    ("TIFF", b"MM\0*\0\0\0\x08"),
    ("JPEG XL", b"\xff\x0a\xfa\x1f"),
    ("JPEG 2000", b"\0\0\0\x0cjP  \x0d\x0a\x87\x0a"),
    ("Photoshop", b"8BPS\0\x01"),
    ("PDF", b"%PDF-1.7\n"),
    ("Portable Anymap", b"P6\n4 2\n255\n"),
    ("SVG", b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>"),
    ("SVG", b"\xEF\xBB\xBF<?xml version=\"1.0\"?>\n<!-- a drawing -->\n<svg width=\"8\"/>"),
    ("HTML", b"\n<!DOCTYPE html><html><body><svg/></body></html>"),
    ("Portable Float Map", b"PF\n4 2\n-1.0\n"),
];

#[test]
fn picture_of_another_format_is_refused_by_its_name_with_what_to_do() {
    for (name, bytes) in FILES {
        assert_eq!(picture_format(bytes), Some(name));
        let file = DataFile { name: "picture".into(), bytes: bytes.to_vec() };
        let picture = read_picture(&file, &RgbSpace::srgb()).unwrap_err().to_string();
        let is_read = HAS_PNG && name == "SVG";
        let map = read_light_map(&file).unwrap_err().to_string();
        let heights = read_heights(&file).unwrap_err().to_string();
        let wanted = format!(" {name} file, which is not supported");
        assert!(is_read || picture.contains(&wanted), "{picture}");
        assert!(picture.contains("convert it to PNG"), "{picture}");
        assert!(map.contains(&wanted) && map.contains("convert it to OpenEXR"), "{map}");
        // Heights are read from TIFF files.
        assert_eq!(heights.contains(&wanted), name != "TIFF", "{heights}");
        assert!(name == "TIFF" || heights.contains("export the heights"), "{heights}");
        assert_eq!(picture.contains("most compatible"), name == "HEIC");
    }
}

/// Each kind of picture that one reader takes is named by the others.
#[test]
fn picture_for_another_reader_is_refused_by_its_name() {
    let file = |bytes: &[u8]| DataFile { name: "picture".into(), bytes: bytes.to_vec() };
    let hdr = file(b"#?RADIANCE\n\n-Y 2 +X 4\n");
    let exr = file(b"\x76\x2f\x31\x01\x02\0\0\0");
    // Both are pictures, too, here cut off.
    for (picture, cut_off) in
        [(&hdr, "the file ends in row 1 of 2"), (&exr, "this OpenEXR file cannot be read")]
    {
        let error = read_picture(picture, &RgbSpace::srgb()).unwrap_err().to_string();
        assert!(error.contains(cut_off), "{error}");
    }
    for (bytes, name) in [(&b"\x89PNG\r\n\x1a\n"[..], "PNG"), (&b"\xff\xd8\xff\xe0"[..], "JPEG")] {
        let error = read_light_map(&file(bytes)).unwrap_err().to_string();
        assert!(error.contains(&format!(" {name} file, which is not supported")), "{error}");
    }
    // Letters that begin a name, and text.
    assert_eq!(picture_format(b"BMI,value\n1,2\n"), None);
    assert_eq!(picture_format(b"theta,radiance\n"), None);
}

/// The hint has a command that a reader can copy, for each format; the first picture of those that may have
/// several.
#[test]
fn hint_for_a_picture_of_another_format_has_a_command() {
    let hint = |bytes: &[u8]| {
        let file = DataFile { name: "picture".into(), bytes: bytes.to_vec() };
        read_picture(&file, &RgbSpace::srgb()).unwrap_err().to_string()
    };
    for (bytes, command) in [
        (&b"RIFF\x24\0\0\0WEBPVP8 "[..], "magick picture.webp picture.png"),
        (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic", "magick picture.heic picture.png; telephones"),
        (b"GIF89a\x01\0\x01\0", "magick 'picture.gif[0]' picture.png"),
        (b"8BPS\0\x01", "magick 'picture.psd[0]' picture.png"),
        (b"\xff\x0a\xfa\x1f", "magick picture.jxl picture.png"),
        (b"<html lang=\"en\">", "chromium --headless --window-size=800,480 --screenshot=page.png page.html"),
        (b"<svg/>", if HAS_PNG { "this SVG file cannot be drawn" } else { "this is an SVG file" }),
        (b"<svg/>", "rsvg-convert --width 800 drawing.svg --output drawing.png"),
    ] {
        assert!(hint(bytes).contains(command), "{}", hint(bytes));
    }
    assert!(hint(b"").contains("this file is empty"), "{}", hint(b""));
    // Tables of other programs in XML are no drawings.
    assert_eq!(picture_format(b"<?xml version=\"1.0\"?><WindowElement/>"), None);
}
