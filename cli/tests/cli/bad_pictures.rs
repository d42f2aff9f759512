//! Pictures that `papilio image` is given by mistake: an answer says what the file is and what to do. Unusual ones
//! (transparent, CMYK, 16 bit, animated) are tested with their reader.

use std::fs;
use std::path::Path;
use std::process::Output;

use papilio_formats::write_rgb_png;

use crate::common::{papilio_command as papilio, scenario, stderr};

fn image(folder: &Path, name: &str, bytes: &[u8]) -> Output {
    let file = folder.join(name);
    fs::write(&file, bytes).unwrap();
    let size = ["--set", "display.matrix.pixels=[8,6]", "--json"];
    papilio().arg("image").arg(scenario("six-ink")).arg(&file).args(size).output().unwrap()
}

#[test]
fn pictures_that_are_not_read_say_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    // The header of a grey picture of 9000 x 9000 pixels, with its checksum, and where its pixels begin.
    let huge =
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x23\x28\0\0\x23\x28\x08\0\0\0\0\x48\xbe\x2d\x66\0\0\0\0IDAT";
    let mut whole = Vec::new();
    write_rgb_png(&mut whole, 8, &[[90, 40, 10]; 48], false).unwrap();
    for (name, bytes, parts) in [
        ("a.webp", &b"RIFF\x24\0\0\0WEBPVP8X"[..], &["a WebP file", "magick picture.webp picture.png"][..]),
        (
            "a.heic",
            b"\0\0\0\x18ftypheic\0\0\0\0mif1heic",
            &["a HEIC file", "picture.heic", "most compatible"],
        ),
        (
            "a.jpg",
            b"\0\0\0\x1cftypavif\0\0\0\0avifmif1",
            &["an AVIF file", "magick picture.avif picture.png"],
        ),
        ("a.html", b"<!DOCTYPE html><html></html>", &["an HTML file", "chromium --headless"]),
        ("empty.png", b"", &["this file is empty", "a PNG, JPEG"]),
        ("huge.png", huge, &["9000 x 9000 pixels", "64 million", "magick picture.png -resize 4000x4000"]),
        (
            "cut.png",
            &whole[..whole.len() / 2],
            &["ends before its picture is complete", "copy or download it again"],
        ),
    ] {
        let output = image(folder.path(), name, bytes);
        let answer = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {answer}");
        assert!(answer.contains(name) && output.stdout.is_empty(), "{name}: {answer}");
        parts.iter().for_each(|part| assert!(answer.contains(part), "{part}: {answer}"));
    }
}

/// Black and white only, on a display whose black is coloured: refused at the key, and nothing is written.
#[test]
fn neutrals_of_a_coloured_black_are_refused_at_their_key() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = papilio()
        .args([
            "image",
            "scenarios/indoor.toml",
            "scenarios/data/chelsea.png",
            "--set",
            "spectrum.step_nm=20",
        ])
        .args(["--set", "image.neutrals=\"black-and-white\"", "--out", out.to_str().unwrap()])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("`black`, is coloured") && said.contains("--set #2:1:16"), "{said}");
    assert!(!out.join("states.png").exists());
}
