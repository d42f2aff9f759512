//! Output of `papilio study sampling`: `study.csv`.

use std::io::{self, Write};

use papilio_display::StudyCurve;

/// Writes `study.csv`: one row per sampler, strategy and number of paths.
///
/// # Errors
/// Those of `out`.
pub fn write_study(out: impl Write, curves: &[StudyCurve]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["sampler", "scattering", "paths", "relative_error", "transport_s", "setup_s"])?;
    for curve in curves {
        for point in &curve.points {
            let numbers = [point.relative_error, point.transport_s, curve.setup_s].map(|v| v.to_string());
            let [error, transport, setup] = &numbers;
            let paths = point.paths.to_string();
            csv.write_record([curve.sampler.name(), curve.strategy.name(), &paths, error, transport, setup])?;
        }
    }
    csv.flush()
}
