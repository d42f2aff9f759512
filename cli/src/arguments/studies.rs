//! Options of the studies, which compute a scenario many times: sweeps, searches, tolerance analyses.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{ScenarioArguments, Workers, seed, threads};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Sweep {
    #[command(subcommand)]
    pub(crate) command: Option<SweepCommand>,
    #[command(flatten)]
    pub(crate) run: Option<SweepRun>,
    // Not a part of `SweepRun`: clap does not find the flattened options of an optional group.
    #[command(flatten)]
    pub(crate) outputs: SweepOutputs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SweepCommand {
    /// Merge the shards of a sweep (computed with --shard) into one table and its figures
    Merge(SweepMerge),
}

#[derive(Debug, Args)]
pub(crate) struct SweepRun {
    // The options of `ScenarioArguments` and `Workers`, repeated: clap would not find them next to a
    // subcommand if they were flattened twice.
    /// Scenario file (TOML), with a `[sweep]` table unless --axis is given; - reads standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/NAME for NAME.toml]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Sweep a key over FROM:TO:STEP, or over values with commas between them:
    /// `--axis viewer.theta_deg=0:60:10`; can be repeated, for all combinations; instead of the axes of the file
    #[arg(long, value_name = "KEY=VALUES")]
    pub(crate) axis: Vec<String>,
    /// Change a key of the scenario before the values of the sweep are applied; can be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Store only these metrics of every point (a compact sweep, for many points):
    /// `--metrics contrast_ratio,white.Y`; sets sweep.metrics and sweep.figures
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) metrics: Vec<String>,
    /// Compute only shard K of N (every N-th point), to divide a sweep among machines
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Number of threads [default: one per processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct SweepMerge {
    /// Folders with the journals of all shards
    #[arg(value_name = "DIR", required = true)]
    pub(crate) folders: Vec<PathBuf>,
    /// Folder for the table and figures [default: the first DIR]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) outputs: SweepOutputs,
}

#[derive(Debug, Args)]
pub(crate) struct Tolerance {
    /// Scenario file (TOML) with a `[tolerance]` table; - reads standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/NAME for NAME.toml]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Change a key of the scenario, for example display.pixel.film.1.thickness_nm=12; can be repeated; paths
    /// of files are relative to the current folder
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Compute only shard K of N (every N-th sample), to divide an analysis among machines
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Also use the finished work in the journals of this folder; can be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) merge: Vec<PathBuf>,
    /// Print the result as JSON, and write the files too
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// Outputs of a finished sweep in addition to `sweep.csv` and its figures as SVG.
#[derive(Debug, Clone, Args)]
pub(crate) struct SweepOutputs {
    /// Write only these columns of sweep.csv: those of states.csv (`Y,L_star,Y_se`), or metrics of a view and
    /// of one state (`contrast_ratio,white.Y`) [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) columns: Vec<String>,
    /// Print the result as JSON, and write the files too
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Write the table as Parquet too
    #[arg(long)]
    pub(crate) parquet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Optimize {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Print the result as JSON, and write the files too
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Do not compute the best design with the Monte Carlo solver too
    #[arg(long)]
    pub(crate) no_check: bool,
    /// Seed of the starting points and populations; sets optimize.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    pub(crate) seed: Option<u64>,
    /// Use only shard K of N of the starting points, to divide a search among machines
    #[arg(long, value_name = "K/N", value_parser = shard, conflicts_with = "json")]
    pub(crate) shard: Option<(usize, usize)>,
    /// Also use the finished work in the journals of this folder; can be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) merge: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Args)]
pub(crate) struct FitCommand {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Measured spectra, colours or metrics (CSV, CGATS, CxF), in one or more files
    #[arg(value_name = "MEASURED", required = true)]
    pub(crate) measured: Vec<PathBuf>,
    /// Print the result as JSON, and write the files too
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// Parses `K/N` with 1 <= K <= N.
fn shard(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    let shard = numbers.filter(|(k, n): &(usize, usize)| (1..=*n).contains(k) && *n <= 100_000);
    shard.ok_or_else(|| {
        "expected K/N, shard K of N with 1 <= K <= N <= 100000: the shards of three machines are 1/3, 2/3 and 3/3".to_owned()
    })
}
