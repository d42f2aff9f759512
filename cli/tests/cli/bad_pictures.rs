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

/// A picture of 2 x 2 pixels that are half transparent.
const TRANSPARENT: &[u8] =
    b"\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x02\x00\x00\x00\x02\x08\
      \x06\x00\x00\x00\x72\xb6\x0d\x24\x00\x00\x00\x1d\x49\x44\x41\x54\x78\x01\x01\x12\x00\xed\xff\x00\x1e\
      \x1e\x80\x78\x78\x1e\x80\x78\x00\x1e\x78\x80\x78\x78\x78\x80\x78\x32\x00\x06\x39\x3f\x4d\x97\x9d\x00\
      \x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

/// What is printed of a picture is in its file, too: its own warnings, and those of the scenario.
#[test]
fn warnings_are_printed_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("half.png");
    fs::write(&file, TRANSPARENT).unwrap();
    let out = folder.path().join("out");
    let output = papilio()
        .args([
            "image".as_ref(),
            scenario("six-ink").as_os_str(),
            file.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ])
        .args(["--set", "image.halftone=\"ordered\"", "--set", "image.kernel=\"stucki\""])
        .output()
        .unwrap();
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    let written: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("image.json")).unwrap()).unwrap();
    let warnings = written["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), said.matches("warning: ").count(), "{said}");
    for part in ["composited over white", "image.kernel has no effect"] {
        assert!(warnings.iter().any(|one| one.as_str().unwrap().contains(part)), "{part}: {warnings:?}");
    }
}

/// What a folder contains besides pictures is named in one line, and so is what it contains instead of them.
#[test]
fn folders_say_what_is_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let photographs = folder.path().join("photographs");
    fs::create_dir_all(photographs.join("more")).unwrap();
    fs::write(photographs.join("moving.gif"), b"GIF89a").unwrap();
    fs::write(photographs.join(".hidden"), b"").unwrap();
    let shown = || {
        let out = folder.path().join("out");
        let mut command = papilio();
        command.args(["image".as_ref(), scenario("six-ink").as_os_str(), photographs.as_os_str()]);
        stderr(&command.args(["--out".as_ref(), out.as_os_str()]).output().unwrap())
    };
    let empty = shown();
    assert!(
        empty.contains("contains no picture\n  = note: it contains more (a folder), moving.gif\n"),
        "{empty}"
    );
    fs::write(photographs.join("half.png"), TRANSPARENT).unwrap();
    let said = shown();
    let line = ": more (a folder), moving.gif: pictures are files that end in .png, .jpg";
    assert!(said.contains("note: skipped in ") && said.contains(line) && !said.contains("hidden"), "{said}");
    assert!(
        said.contains("warning: at 1 of 1 pictures: ") && said.contains("composited over white"),
        "{said}"
    );
}

/// A display without two states, or without contrast between them: refused at the pixel.
#[test]
fn states_that_show_no_picture_are_refused_at_the_pixel() {
    let folder = tempfile::tempdir().unwrap();
    let [file, picture] = ["s.toml", "half.png"].map(|name| folder.path().join(name));
    fs::write(&picture, TRANSPARENT).unwrap();
    for (reflectance, words) in [
        ("{ white = 0.8 }", "a picture cannot be shown by a single state"),
        ("{ white = 0.8, black = 0.8 }", "no picture is seen in this light and view"),
    ] {
        let text = format!(
            "title = \"Flat\"\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {reflectance}\n\
             [lighting]\npreset = \"office\"\n"
        );
        fs::write(&file, text).unwrap();
        let output = papilio().arg("image").args([&file, &picture]).output().unwrap();
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        for part in [words, "s.toml:2:", "[display.pixel]", "expected ", "= help: "] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
    let output = papilio()
        .args(["image".as_ref(), picture.as_os_str()])
        .args(["--on", "six-ink", "--set", "lighting.spectrum=\"LED-B1\"", "--set"])
        .arg("display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.5 } }")
        .output()
        .unwrap();
    let said = stderr(&output);
    assert!(said.contains("by a single state") && said.contains(" --> --"), "{said}");
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
