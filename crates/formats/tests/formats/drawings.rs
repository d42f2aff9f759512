//! Drawings (SVG) as pictures.

use papilio_formats::{DataFile, RgbSpace, read_picture};

fn read(svg: &str) -> Result<(Vec<[f64; 3]>, [usize; 2], String), String> {
    let file = DataFile { name: "drawing.svg".into(), bytes: svg.as_bytes().to_vec() };
    let read = read_picture(&file, &RgbSpace::srgb()).map_err(|error| error.to_string())?;
    let picture = read.value;
    let size = [picture.columns(), picture.rows()];
    let mut pixels = Vec::new();
    for row in 0..size[1] {
        pixels.extend(picture.row(row).iter().map(|xyz| xyz.map(f64::from)));
    }
    Ok((pixels, size, read.warnings.join("\n")))
}

const HEAD: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"480\">";

/// Flat inks of sRGB at their own size, pixel by pixel; X, Y, Z of sRGB's red are those of IEC 61966-2-1.
#[test]
fn drawing_has_its_own_size_and_colours_over_white() {
    let (pixels, size, warnings) =
        read(&format!("{HEAD}<rect x=\"100\" width=\"200\" height=\"480\" fill=\"#f00\"/></svg>")).unwrap();
    assert_eq!(size, [800, 480]);
    assert!(warnings.contains("800 x 480 pixels") && !warnings.contains("Roboto"), "{warnings}");
    let red = [0.4124, 0.2126, 0.0193];
    for (at, [x, y, z]) in pixels.iter().enumerate() {
        let is_red = (100..300).contains(&(at % 800));
        let [u, v, w] = if is_red { red } else { [0.9505, 1.0, 1.089] };
        assert!((x - u).abs() < 1e-3 && (y - v).abs() < 1e-3 && (z - w).abs() < 1e-3, "{at}: {x} {y} {z}");
    }
}

/// An icon of 24 px becomes a whole multiple of it. Half-transparent black over white is sRGB's grey of 50 %, as in browsers.
#[test]
fn small_drawing_is_enlarged_and_transparency_is_that_of_browsers() {
    let icon = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 24 12\"><rect width=\"24\" height=\"12\" opacity=\"0.5\"/></svg>";
    let (pixels, size, _) = read(icon).unwrap();
    assert_eq!(size, [1200, 600]);
    // sRGB 127.5/255 decodes to 0.2140.
    assert!(pixels.iter().all(|[_, y, _]| (y - 0.2140).abs() < 0.003), "{:?}", pixels[0]);
}

#[test]
fn text_is_drawn_whatever_its_font_and_what_is_left_out_is_said() {
    let text = "<text x=\"20\" y=\"200\" font-size=\"180\" font-family=\"Comic Sans MS\">IIII</text>";
    let (pixels, _, warnings) = read(&format!("{HEAD}{text}</svg>")).unwrap();
    let black = pixels.iter().filter(|[_, y, _]| *y < 0.01).count();
    assert!(black > 5_000 && warnings.contains("Roboto"), "{black} {warnings}");
    let (_, _, warnings) =
        read(&format!("{HEAD}<rect width=\"9\" height=\"9\"/><image href=\"a.png\"/><foreignObject/></svg>"))
            .unwrap();
    assert!(warnings.contains("pictures in this drawing") && warnings.contains("HTML in"), "{warnings}");
}

/// Letters that Roboto lacks are named, each once; those of other elements, and those that it has, are not.
#[test]
fn letters_that_are_left_out_are_named() {
    let square = "<title>\u{6f22}</title><rect width=\"9\" height=\"9\"/>";
    let drawn =
        |text: &str| read(&format!("{HEAD}{square}<text x=\"20\" y=\"90\">{text}</text></svg>")).unwrap().2;
    let warnings = drawn("\u{417}\u{434} \u{3a9} \u{4f60}\u{597d}, \u{4f60}<tspan>\u{1f600}!</tspan>");
    assert!(warnings.contains("left out: \u{4f60} \u{597d} \u{1f600} (draw them as paths"), "{warnings}");
    let whole = drawn("e\u{301} \u{e9} \u{417} \u{3a9}\t\n");
    assert!(!whole.contains("left out"), "{whole}");
    let nothing = read(&format!("{HEAD}<text x=\"20\" y=\"90\">\u{4f60}</text></svg>"));
    let said = nothing.map_or_else(|error| error, |(.., warnings)| warnings);
    assert!(said.contains('\u{4f60}') && said.contains("Roboto"), "{said}");
}

#[test]
fn drawing_that_needs_too_much_is_refused() {
    let huge = HEAD.replace("800", "80000").replace("480", "48000");
    assert!(
        read(&format!("{huge}<rect width=\"9\" height=\"9\"/></svg>"))
            .unwrap_err()
            .contains("64 million pixels")
    );
    let (open, close) =
        ("<g opacity=\"0.5\"><rect width=\"4000\" height=\"4000\"/>".repeat(40), "</g>".repeat(40));
    let deep = HEAD.replace("800", "4000").replace("480", "4000");
    let error = read(&format!("{deep}{open}{close}</svg>")).unwrap_err();
    assert!(error.contains("MB at a time") && error.contains("rsvg-convert"), "{error}");
    for wrong in
        ["<svg width=\"8\"", "<svg/>", "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"0\" height=\"5\"/>"]
    {
        assert!(read(wrong).unwrap_err().contains("this SVG file cannot be drawn"), "{wrong}");
    }
    // Deep texts end in an error, not in the program.
    let deep = format!("{HEAD}{}{}</svg>", "<g>".repeat(200_000), "</g>".repeat(200_000));
    assert!(read(&deep).is_err());
    let bomb: String = (1..12)
        .map(|k| format!("<g id=\"g{k}\">{}</g>", format!("<use href=\"#g{}\"/>", k - 1).repeat(10)))
        .collect();
    let _ = read(&format!("{HEAD}<rect id=\"g0\" width=\"1\" height=\"1\"/>{bomb}</svg>"));
}
