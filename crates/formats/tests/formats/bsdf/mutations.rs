//! Randomly damaged files are refused or read without a panic, and a measurement that was read can be
//! written.
//!
//! `PAPILIO_FUZZ_SECONDS` (default 0.2) is the time for each format, and `PAPILIO_FUZZ_SEED` (default 1) the
//! seed of the mutations.

use std::io::{Read, Write};
use std::time::{Duration, Instant};

use papilio_formats::{BsdfFormat, DataFile, read_bsdf, write_measurement};
use papilio_goniometry::Direction;
use papilio_testing::{laws, sized};

use super::samples;
use papilio_testing::Dice;

fn setting(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Fragments that are likely to reveal errors of the readers.
const PIECES: [&[u8]; 31] = [
    b"-1",
    b"nan",
    b"inf",
    b"1e999",
    b"1e300",
    b"1e-320",
    b"0",
    b"99999999999999999999",
    b",",
    b"\n",
    b"\t",
    b" ",
    b"{",
    b"}",
    b"<",
    b">",
    b"</",
    b"/>",
    b"\"",
    b"#",
    b"\xFF",
    b"\0",
    b"\r\n",
    b"1",
    b"XYZ",
    b"TIS",
    b"DataEnd",
    b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF",
    b"\0\0\0\0\0\0\xF0\x7F",
    b"4294967297",
    b"Asymmetrical4D",
];

fn mutated(bytes: &[u8], others: &[(&str, Vec<u8>)], numbers: &mut Dice) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + numbers.below(4) {
        let at = numbers.below(bytes.len() + 1);
        let end = (at + numbers.below(40)).min(bytes.len());
        match numbers.below(8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..at, bytes[at..end].to_vec())),
            3 => {
                let other = &others[numbers.below(others.len())].1;
                let from = numbers.below(other.len());
                let piece = other[from..(from + numbers.below(60)).min(other.len())].to_vec();
                drop(bytes.splice(at..end, piece));
            }
            4 | 5 if at < bytes.len() => bytes[at] = numbers.below(256) as u8,
            6 if at < bytes.len() => bytes[at] ^= 1 << numbers.below(8),
            _ => drop(bytes.splice(
                at..(at + numbers.below(3)).min(bytes.len()),
                PIECES[numbers.below(PIECES.len())].iter().copied(),
            )),
        }
    }
    bytes
}

/// Reads a file. A measurement that was read has values for all of its cells, can be evaluated, and can be
/// written and read again.
fn exercise(bytes: Vec<u8>, writes: bool) -> bool {
    let file = DataFile { name: "x".to_owned(), bytes };
    let read = match read_bsdf(&file) {
        Ok(read) => read.value,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    for part in &read.parts {
        assert_eq!(part.values.len(), part.channels.len() * part.geometry.cells());
        assert!(part.values.iter().all(|f| f.is_nan() || (*f >= 0.0 && f.is_finite())));
        for k in 0..20 {
            let (i, o) =
                (Direction::new(4.7 * f64::from(k), 33.0), Direction::new(60.0, 71.0 * f64::from(k)));
            assert!(part.evaluate(0, i, o).is_none_or(f64::is_finite));
            part.geometry.directions(k as usize);
        }
    }
    let formats = [BsdfFormat::Papilio, BsdfFormat::Radiant, BsdfFormat::Csv, BsdfFormat::Klems];
    for format in formats.into_iter().take(if writes { 4 } else { 1 }) {
        let mut bytes = Vec::new();
        if write_measurement(&mut bytes, format, &read).is_ok() {
            let again = read_bsdf(&DataFile { name: "again".to_owned(), bytes });
            assert!(
                again.is_ok() || read.parts.iter().all(|part| part.geometry.cells() == 0),
                "{format:?}: {again:?}"
            );
        }
    }
    true
}

/// Mutates the files of one format for the configured time.
fn mutate(name: &str) {
    let all = samples::all();
    let bytes = &all.iter().find(|(other, _)| *other == name).unwrap().1;
    // A tree takes seconds to be written as patches; the tests of exports do that every day.
    assert!(exercise(bytes.clone(), sized(name != "tree", true)));
    let mut numbers = Dice::new(setting("PAPILIO_FUZZ_SEED", 1.0) as u64, 0);
    let until = Instant::now() + Duration::from_secs_f64(setting("PAPILIO_FUZZ_SECONDS", 0.2));
    let mut good = 1_u64;
    // Files that can be read are mutated further, to reach deeper code.
    let mut seeds = vec![bytes.clone()];
    while Instant::now() < until {
        let bytes = mutated(&seeds[numbers.below(seeds.len())], &all, &mut numbers);
        // Writing takes far longer than reading.
        if bytes.len() < 20_000 && exercise(bytes.clone(), good.is_multiple_of(500)) {
            good += 1;
            let at = if seeds.len() < 100 { seeds.len() } else { 1 + numbers.below(99) };
            if at == seeds.len() { seeds.push(bytes) } else { seeds[at] = bytes }
        }
    }
}

macro_rules! formats {
    ($($name:ident),*) => { $(#[test] fn $name() { mutate(stringify!($name)); })* };
}

formats!(radiant, table, astm, klems, tree, rgl, papilio);

/// The checksums of an archive detect mutations of its arrays. Here an array is mutated and then packed
/// again.
#[test]
fn papilio_archive_with_mutated_arrays() {
    let seeds: Vec<Vec<(String, Vec<u8>)>> = samples::all()
        .into_iter()
        .map(|(_, bytes)| {
            let read = read_bsdf(&DataFile { name: "x".to_owned(), bytes }).unwrap().value;
            let mut archive = Vec::new();
            write_measurement(&mut archive, BsdfFormat::Papilio, &read).unwrap();
            unpacked(&archive)
        })
        .chain([unpacked(&samples::display())])
        .collect();
    let mut numbers = Dice::new(setting("PAPILIO_FUZZ_SEED", 1.0) as u64, 0);
    let until = Instant::now() + Duration::from_secs_f64(setting("PAPILIO_FUZZ_SECONDS", 0.2));
    while Instant::now() < until {
        let mut arrays = seeds[numbers.below(seeds.len())].clone();
        for _ in 0..1 + numbers.below(2) {
            let at = numbers.below(arrays.len());
            let bytes = &mut arrays[at].1;
            // Mostly after the header.
            let head = if numbers.below(4) == 0 { 0 } else { bytes.len().min(128) };
            let tail = bytes.split_off(head);
            bytes.extend(mutated(&tail, &[("", tail.clone())], &mut numbers));
        }
        exercise(packed(&arrays), numbers.below(2000) == 0);
    }
}

fn unpacked(archive: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(archive)).unwrap();
    (0..archive.len())
        .map(|k| {
            let mut entry = archive.by_index(k).unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            (entry.name().unwrap().into_owned(), bytes)
        })
        .collect()
}

fn packed(arrays: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        archive
            .start_file(
                name.as_str(),
                zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored),
            )
            .unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// Only header and length of the large format are mutated.
#[test]
fn merl() {
    let whole = samples::merl();
    let mut numbers = Dice::new(setting("PAPILIO_FUZZ_SEED", 1.0) as u64, 0);
    let until = Instant::now() + Duration::from_secs_f64(setting("PAPILIO_FUZZ_SECONDS", 0.2));
    while Instant::now() < until {
        let mut bytes = mutated(&whole[..200], &[("merl", whole[..100].to_vec())], &mut numbers);
        if numbers.below(20) == 0 {
            bytes.extend(&whole[bytes.len().min(200)..]);
        }
        exercise(bytes, false);
    }
}

#[test]
fn arbitrary_bytes_are_refused_or_read() {
    laws(
        300,
        |dice| dice.several(0..=1999, |dice| dice.below(256) as u8),
        |bytes| {
            exercise(bytes.clone(), true);
        },
    );
}

#[test]
fn arbitrary_text_is_refused_or_read() {
    let characters = "0123456789eE.,;{}<>/ \t\n#abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_-";
    laws(
        300,
        |dice| dice.text(characters, 400),
        |text| {
            exercise(text.clone().into_bytes(), true);
        },
    );
}
