//! The texts of the figures of all commands: labels in words, and no two of an axis on top of each other.

use std::fs;
use std::path::Path;

use crate::common::{COARSE, files, papilio, place, scenario, stderr};
use crate::{optimize, sweep, tolerance};

/// A text of a figure: its position, size, anchor and content.
struct Written {
    x: f64,
    y: f64,
    size: f64,
    anchor: String,
    is_upright: bool,
    content: String,
}

/// Returns the value of an attribute of an element.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let start = element.find(&format!(" {name}=\""))? + name.len() + 3;
    element[start..].split('"').next()
}

/// Returns all texts of a figure.
fn written(svg: &str) -> Vec<Written> {
    let number = |element: &str, name: &str| attribute(element, name).unwrap().parse::<f64>().unwrap();
    let one = |element: &str| {
        let (attributes, content) = element.split_once('>').unwrap();
        Written {
            x: number(attributes, "x"),
            y: number(attributes, "y"),
            size: number(attributes, "font-size"),
            anchor: attribute(attributes, "text-anchor").unwrap_or("start").to_owned(),
            is_upright: attributes.contains("rotate("),
            content: content.split("</text>").next().unwrap().to_owned(),
        }
    };
    svg.split("<text").skip(1).map(one).collect()
}

/// Returns the horizontal extent of a text, with the narrowest letters.
fn extent(text: &Written) -> (f64, f64) {
    let width = 0.5 * text.size * text.content.chars().filter(|c| c.is_ascii()).count() as f64;
    match text.anchor.as_str() {
        "middle" => (text.x - width / 2.0, text.x + width / 2.0),
        "end" => (text.x - width, text.x),
        _ => (text.x, text.x + width),
    }
}

fn check(folder: &Path) -> usize {
    let figures = files(folder).into_iter().filter(|(name, _)| name.ends_with(".svg"));
    let mut count = 0;
    for (name, bytes) in figures {
        count += 1;
        let svg = String::from_utf8(bytes).unwrap();
        let texts = written(&svg);
        for text in &texts {
            let content = &text.content;
            assert!(!content.contains('_'), "{name}: a raw name: {content}");
            let dotted = content.char_indices().any(|(at, c)| {
                let [before, after] =
                    [content[..at].chars().next_back(), content[at + c.len_utf8()..].chars().next()];
                c == '.' && [before, after].iter().all(|c| c.is_some_and(char::is_alphabetic))
            });
            assert!(!dotted, "{name}: a dotted path: {content}");
            assert!(!content.contains("(logarithmic)"), "{name}: {content}");
        }
        let numbers: Vec<&Written> = texts
            .iter()
            .filter(|text| {
                !text.is_upright && text.content.chars().all(|c| c.is_numeric() || ".-×⁻".contains(c))
            })
            .collect();
        for (k, one) in numbers.iter().enumerate() {
            for other in &numbers[k + 1..] {
                let (a, b) = (extent(one), extent(other));
                let overlap = one.y == other.y && a.0 < b.1 && b.0 < a.1;
                assert!(!overlap, "{name}: {} and {} collide", one.content, other.content);
            }
        }
    }
    count
}

/// Runs a command on a text, and checks its figures.
fn check_command(command: &[&str], text: &str, more: &[&str]) -> usize {
    let (_folder, file, out) = place(text);
    let output = papilio(&[command, &[&file, "--out", &out], more].concat());
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
    check(Path::new(&out))
}

#[test]
fn labels_of_all_figures_are_in_words_and_do_not_collide() {
    let text = |name: &str| fs::read_to_string(scenario(name)).unwrap();
    let run = ["--cone", "--set", "metrics.gamut_volume=true", "--set", "viewer.theta_deg=[0,20]"];
    let run = [&run[..], &COARSE[..]].concat();
    let two_aims = format!("{}{}", optimize::SCENARIO, optimize::SECOND_AIM);
    let drawn = check_command(&["run"], &text("indoor"), &run)
        + check_command(&["run"], &text("epaper"), &[])
        + check_command(&["pixel"], &text("indoor"), &[])
        + check_command(&["sweep"], sweep::SCENARIO, &[])
        + check_command(&["optimize"], &two_aims, &["--no-check"])
        + check_command(&["tolerance"], tolerance::SCENARIO, &[])
        + check_command(&["study", "sampling"], &text("indoor"), &["--paths", "8192"]);
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/data/H65.bsdf");
    let data = data.to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    for command in [&["diffuser", "inspect"][..], &["diffuser", "fit", "--model", "ward"]] {
        let output = papilio(&[command, &[data, "--out", out]].concat());
        assert!(output.status.success(), "{command:?}: {}", stderr(&output));
    }
    assert!(drawn + check(folder.path()) > 30, "{drawn}");
}
