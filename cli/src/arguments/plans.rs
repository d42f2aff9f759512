//! Of what computes a scenario many times: sweeps, searches, tolerance analyses.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{ScenarioArguments, Workers};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Sweep {
    #[command(subcommand)]
    pub(crate) command: Option<SweepCommand>,
    #[command(flatten)]
    pub(crate) run: Option<SweepRun>,
    // Not in `SweepRun`: clap does not find what is flattened into something optional.
    #[command(flatten)]
    pub(crate) wanted: SweepWanted,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SweepCommand {
    /// Join the parts of a sweep that were computed with --shard
    Merge(SweepMerge),
}

#[derive(Debug, Args)]
pub(crate) struct SweepRun {
    // Those of `ScenarioArguments` and `Workers`: flattened twice, clap would not find them beside a subcommand.
    /// The scenario (TOML), with a `[sweep]`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/ and the name of FILE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Set a key of the scenario, as for `papilio run`; what is swept comes after it
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Compute part K of N alone, for many machines: every N-th point
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Worker threads [default: one for each processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct SweepMerge {
    /// Folders with the journals of all parts
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,
    /// Folder for the table and figures [default: the first DIR]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) wanted: SweepWanted,
}

#[derive(Debug, Args)]
pub(crate) struct Tolerance {
    /// The scenario (TOML), with a `[tolerance]`
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/ and the name of FILE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Set a key of the scenario, e.g. tolerance.samples=65536; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Compute part K of N alone, for many machines: every N-th sample
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Also take what is done from the journals in this folder; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) merge: Vec<PathBuf>,
    /// Print the report as JSON on standard output; files are written as ever
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG, too
    #[arg(long)]
    pub(crate) png: bool,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// What a finished sweep gives besides `sweep.csv` and its figures as SVG.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct SweepWanted {
    /// Print all points as JSON on standard output; files are written as ever
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG, too
    #[arg(long)]
    pub(crate) png: bool,
    /// Write the table as Parquet, too
    #[arg(long)]
    pub(crate) parquet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Optimize {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Print what was found as JSON on standard output; files are written as ever
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG, too
    #[arg(long)]
    pub(crate) png: bool,
    /// Do not run the best design by the walk as well
    #[arg(long)]
    pub(crate) no_check: bool,
    /// Seed of the starts and the population, as optimize.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(crate) seed: Option<u64>,
    /// Search from part K of N of the places alone, for many machines
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Also take what is done from the journals in this folder; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) merge: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// `K/N` with 1 <= K <= N.
fn shard(text: &str) -> Result<(usize, usize), String> {
    let wrong = || "expected K/N with 1 <= K <= N, as 2/8".to_owned();
    let (k, n) = text.split_once('/').ok_or_else(wrong)?;
    let (k, n): (usize, usize) = (k.parse().map_err(|_| wrong())?, n.parse().map_err(|_| wrong())?);
    if (1..=n).contains(&k) && n <= 100_000 { Ok((k, n)) } else { Err(wrong()) }
}
