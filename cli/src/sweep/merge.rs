//! `papilio sweep merge`: merges the shards of a sweep.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use papilio_formats::{SweepHead, SweepPoint};

use super::{check_columns, finish, journal, light};
use crate::arguments::SweepMerge;
use crate::{Failure, output};

/// Merges the journals of shards, and writes the table and figures of the sweep.
pub(super) fn merge(arguments: &SweepMerge) -> Result<(), Failure> {
    check_columns(&arguments.outputs.columns)?;
    let mut head: Option<(PathBuf, SweepHead)> = None;
    let mut points: BTreeMap<usize, SweepPoint> = BTreeMap::new();
    for folder in &arguments.folders {
        for (path, journal) in journal::read_all(folder)? {
            one_sweep(&mut head, &path, journal.head, |a, b| a == b)?;
            points.extend(journal.lines.into_iter().filter_map(|point| Some((point.point?, point))));
        }
    }
    let folders = arguments.folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>();
    let Some((_, head)) = head else {
        if light::merged(arguments)? {
            return Ok(());
        }
        return Err(Failure::Input(format!(
            "there is no journal of a sweep in {}\n  = help: expected folders of `papilio sweep FILE --shard K/N --out DIR`",
            folders.join(", ")
        )));
    };
    complete(head.points(), |point| points.contains_key(&point))?;
    let out = folder(arguments)?;
    let points: Vec<&SweepPoint> = (0..head.points()).filter_map(|point| points.get(&point)).collect();
    finish(out, &head, &[], &points, &arguments.outputs)
}

/// Stores the head of the first journal; fails if the head of another one differs.
pub(super) fn one_sweep(
    first: &mut Option<(PathBuf, SweepHead)>,
    path: &Path,
    own: Option<SweepHead>,
    same: impl Fn(&SweepHead, &SweepHead) -> bool,
) -> Result<(), Failure> {
    match (first, own) {
        (Some((first, head)), Some(own)) if !same(head, &own) => Err(Failure::Input(format!(
            "{} and {} belong to different sweeps\n  = help: specify only folders with shards of one sweep",
            first.display(),
            path.display()
        ))),
        (first @ None, Some(own)) => {
            *first = Some((path.to_owned(), own));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Fails if points are missing.
pub(super) fn complete(points: usize, is_done: impl Fn(usize) -> bool) -> Result<(), Failure> {
    let missing: Vec<usize> = (0..points).filter(|point| !is_done(*point)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{} of {points} points are missing: {}\n  = help: run the shards that contain them (shard K of N has the points K-1, K-1+N, \
         ...)",
        missing.len(),
        ranges(&missing)
    )))
}

/// Folder for the merged results.
pub(super) fn folder(arguments: &SweepMerge) -> Result<&Path, Failure> {
    let out = arguments.out.as_ref().unwrap_or(&arguments.folders[0]);
    output::check(out)?;
    output::make_folder(out)?;
    Ok(out)
}

/// Numbers as ranges, for example `0-3, 7, 9-10`; only the first twelve ranges.
fn ranges(numbers: &[usize]) -> String {
    const MOST: usize = 12;
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let text =
        |(from, to): &(usize, usize)| if from == to { from.to_string() } else { format!("{from}-{to}") };
    let shown: Vec<String> = ranges.iter().take(MOST).map(text).collect();
    shown.join(", ") + if ranges.len() > MOST { ", ..." } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_points_are_printed_as_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2, 5, 7-8");
    }
}
