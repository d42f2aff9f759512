//! Transport time of the Monte Carlo solver on one core:
//! `cargo bench -p papilio-validation --bench transport`.
//!
//! The output has a line for each scenario: CPU time, median of 21 runs, to 0.1 % in every bin of every
//! state, and to 0.1 % in Y of only one state; then long runs. Transport consists of the paths and the
//! spectra from them; the tables of the pixel's reflectance and the preparation before the first path have
//! their own columns. The last lines are lower bounds of the time of a path under diffuse light on this
//! machine.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "a benchmark")]

use std::hint::black_box;
use std::sync::atomic::AtomicBool;

use papilio_display::{Control, Cost, cost};
use papilio_sampling::{SampleStream, Sampler};
use papilio_validation::monte_carlo_scenario;
use pulp::{Arch, Simd, WithSimd};

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const RUNS: u64 = 21;

const ONE_STATE: &str = "display.pixel.states={ white = { red = 1.0, green = 1.0, blue = 1.0 } }";
const NO_OTHERS: &str = "display.pixel.default_states=false";

fn main() {
    println!(
        "{:<10}{:<8}{:<22}{:>9}{:>12}{:>12}{:>11}{:>11}{:>11}{:>11}",
        "", "", "", "paths", "transport", "tracing", "spectra", "set-up", "tables", "ns a path"
    );
    for name in ["overcast", "indoor", "sunny"] {
        for strategy in ["kernel", "guided"] {
            let scattering = format!("solver.scattering={strategy}");
            line(name, strategy, "every bin of 8 states", (0.001, true), &[&scattering]);
            line(name, strategy, "Y of one state", (0.001, false), &[&scattering, ONE_STATE, NO_OTHERS]);
        }
    }
    // Long runs, in which the preparation is negligible.
    let [diffuse, _] = ["overcast", "indoor"].map(|name| {
        let long_run = line(name, "kernel", "Y to 0.001 %", (1e-5, false), &[]);
        line(name, "kernel", "first passes only", (1e-5, false), &["solver.approximation=single-pass"]);
        long_run
    });
    let least = bounds();
    println!(
        "a path of the long run of overcast takes {diffuse:.1}: {:.2} of the largest lower bound",
        least / diffuse
    );
}

/// Minimum work of a path. Its first pass has random numbers (field, direction); multiplications and
/// additions, counted in the source; roots (field, direction, cosine) and a division; the bytes in which its
/// look-up is stored, and its fraction of those of the sums of a panel and of the table of the fraction that
/// leaves. One of `GOES_ON` paths continues (measured with `overcast`). It has two look-ups of 16 nodes with
/// four spectra of 81 wavelengths, mixtures of them for eight states, and four sums and six products of all
/// states.
const NUMBERS: usize = 4;
const ROOTS: usize = 3;
const GOES_ON: f64 = 220.0;
const ALL_STATES: f64 = 8.0 * 81.0;
const LOOK_UP: f64 = 16.0 * 4.0 * 81.0;
const OPERATIONS: f64 = 219.0 + (2.0 * (2.0 * LOOK_UP + 8.0 * ALL_STATES) + 14.0 * ALL_STATES) / GOES_ON;
const BYTES: f64 = 8.0 * (4.0 + 8.0 + 4.0) + 8.0 * (2.0 * LOOK_UP + 8.0 * ALL_STATES) / GOES_ON;

/// Prints the lower bounds of the time of a path, each as if nothing else took any time, and returns the
/// largest, ns.
fn bounds() -> f64 {
    let numbers = best(|| Arch::new().dispatch(Draws)) / DRAWS as f64;
    let multiply_adds = best(|| Arch::new().dispatch(MultiplyAdds)) / Arch::new().dispatch(Lanes);
    let roots = best(|| Arch::new().dispatch(Roots)) / Arch::new().dispatch(Lanes);
    let bytes = vec![1.0; (1 << 16) + 8];
    // Reads across the boundaries of cache lines are slower.
    let aligned = &bytes[bytes.as_ptr().align_offset(64)..][..1 << 16];
    let reads = best(|| Arch::new().dispatch(Reads(aligned))) / READINGS as f64;
    let bounds = [
        (format!("{NUMBERS} numbers of Sobol points"), numbers),
        (format!("{OPERATIONS:.0} operations, as multiply-adds"), 0.5 * OPERATIONS * multiply_adds),
        (format!("{ROOTS} roots and a division"), roots),
        (format!("{BYTES:.0} bytes, as reads from the second cache"), BYTES * reads / 8.0 / (1 << 16) as f64),
    ];
    println!("\nlower bounds, ns a path, each as if nothing else took any time:");
    bounds.iter().for_each(|(what, seconds)| println!("  {what:<43}{:>6.2}", 1e9 * seconds));
    1e9 * bounds.iter().map(|(_, seconds)| *seconds).fold(0.0, f64::max)
}

/// Returns the shortest time of many runs, seconds.
fn best(mut work: impl FnMut() -> f64) -> f64 {
    let run = |_| {
        let started = cpu_seconds();
        black_box(work());
        cpu_seconds() - started
    };
    (0..200).map(run).fold(f64::INFINITY, f64::min)
}

const DRAWS: u64 = 1 << 14;

struct Draws;

impl WithSimd for Draws {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
        let mut sums = [0.0; 64];
        for first in (0..DRAWS).step_by(64) {
            for number in 0..NUMBERS {
                let of: [f64; 64] = numbers.batch(first, 0, number);
                sums.iter_mut().zip(of).for_each(|(sum, number)| *sum += number);
            }
        }
        sums.iter().sum()
    }
}

/// Number of multiply-adds of [`MultiplyAdds`].
struct Lanes;

impl WithSimd for Lanes {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        (CHAINS * ROUNDS * S::F64_LANES) as f64
    }
}

/// Number of times that all bytes are read.
const READINGS: usize = 8;

/// Number of simultaneous chains of multiply-adds, and length of each.
const CHAINS: usize = 12;
const ROUNDS: usize = 1 << 15;

struct MultiplyAdds;

impl WithSimd for MultiplyAdds {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let factor = simd.splat_f64s(black_box(0.999));
        let mut sums = [simd.splat_f64s(black_box(1.0)); CHAINS];
        for _ in 0..ROUNDS {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(*sum, factor, factor);
            }
        }
        sums.iter().map(|sum| simd.reduce_sum_f64s(*sum)).sum()
    }
}

/// The roots and the division of as many paths as [`MultiplyAdds`] has multiply-adds.
struct Roots;

impl WithSimd for Roots {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let one = simd.splat_f64s(black_box(1.0));
        let mut values = [simd.splat_f64s(black_box(2.0)); CHAINS];
        for _ in 0..ROUNDS {
            for value in &mut values {
                let mut root = simd.div_f64s(one, *value);
                for _ in 0..ROOTS {
                    root = simd.sqrt_f64s(root);
                }
                *value = root;
            }
        }
        values.iter().map(|value| simd.reduce_sum_f64s(*value)).sum()
    }
}

/// Reads of half a mebibyte, several times.
struct Reads<'a>(&'a [f64]);

impl WithSimd for Reads<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let mut sums = [0.0; 64];
        for _ in 0..READINGS {
            for chunk in self.0.as_chunks::<64>().0 {
                (0..64).for_each(|k| sums[k] += chunk[k]);
            }
        }
        sums.iter().sum()
    }
}

/// Prints a line of the table, and returns the time of a path, ns.
fn line(name: &str, strategy: &str, aim: &str, target: (f64, bool), overrides: &[&str]) -> f64 {
    let mut scene = monte_carlo_scenario(name, overrides).unwrap().scene;
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let costs: Vec<Cost> = (0..RUNS)
        .map(|seed| {
            // The number of rounds depends on the seed.
            scene.solver.seed = seed;
            cost(&scene, target, &cpu_seconds, &control).unwrap()
        })
        .collect();
    let ms = |of: &dyn Fn(&Cost) -> f64| {
        let mut values: Vec<f64> = costs.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        1e3 * values[values.len() / 2]
    };
    let ns_a_path = 1e6 * ms(&|cost| cost.tracing_s / cost.paths as f64);
    println!(
        "{name:<10}{strategy:<8}{aim:<22}{:>9.0}{:>9.2} ms{:>9.2} ms{:>8.2} ms{:>8.2} ms{:>8.2} ms{:>11.0}",
        1e-3 * ms(&|cost| cost.paths as f64),
        ms(&|cost| cost.tracing_s + cost.spectra_s),
        ms(&|cost| cost.tracing_s),
        ms(&|cost| cost.spectra_s),
        ms(&|cost| cost.setup_s),
        ms(&|cost| cost.tables_s),
        ns_a_path,
    );
    ns_a_path
}

/// Returns the CPU time of this thread, on systems that report it.
#[cfg(unix)]
fn cpu_seconds() -> f64 {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_THREAD_CPUTIME_ID).unwrap();
    time.tv_sec() as f64 + 1e-9 * time.tv_nsec() as f64
}

#[cfg(not(unix))]
fn cpu_seconds() -> f64 {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed().as_secs_f64()
}
