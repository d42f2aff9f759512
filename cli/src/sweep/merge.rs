//! `papilio sweep merge`: parts that were computed apart, as one sweep.

use std::collections::BTreeMap;
use std::path::PathBuf;

use papilio_formats::{SweepHead, SweepPoint};

use super::{finish, journal};
use crate::arguments::SweepMerge;
use crate::{Failure, output};

/// Joins the journals of parts into the sweep's table and figures.
pub(super) fn merge(arguments: &SweepMerge) -> Result<(), Failure> {
    let mut head: Option<(PathBuf, SweepHead)> = None;
    let mut points: BTreeMap<usize, SweepPoint> = BTreeMap::new();
    for folder in &arguments.folders {
        for (path, journal) in journal::read_all(folder)? {
            let Some(own) = journal.head else { continue };
            match &head {
                Some((first, head)) if *head != own => {
                    return Err(Failure::Input(format!(
                        "{} and {} are of two sweeps\n  = help: give the folders of one sweep's parts",
                        first.display(),
                        path.display()
                    )));
                }
                Some(_) => {}
                None => head = Some((path, own)),
            }
            points.extend(journal.lines.into_iter().filter_map(|point| Some((point.point?, point))));
        }
    }
    let folders = arguments.folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>();
    let Some((_, head)) = head else {
        return Err(Failure::Input(format!("there is no journal of a sweep in {}", folders.join(", "))));
    };
    let missing: Vec<usize> = (0..head.points()).filter(|point| !points.contains_key(point)).collect();
    if !missing.is_empty() {
        return Err(Failure::Input(format!(
            "{} of {} points are not done: {}\n  = help: run the parts that they belong to (part K of N has points K-1, K-1+N, ...)",
            missing.len(),
            head.points(),
            ranges(&missing)
        )));
    }
    let out = arguments.out.as_ref().unwrap_or(&arguments.folders[0]);
    output::check(out)?;
    output::make_folder(out)?;
    let points: Vec<&SweepPoint> = (0..head.points()).filter_map(|point| points.get(&point)).collect();
    finish(out, &head, &points, arguments.wanted)
}

/// `0-3, 7, 9-10`; the first few.
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
    fn missing_points_are_named_in_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2, 5, 7-8");
    }
}
