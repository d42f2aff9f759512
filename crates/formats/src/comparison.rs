//! Output files of a comparison with a measured panel: `comparison.csv`, `comparison-spectra.csv`.

use std::io::{self, Write};

use papilio_display::compare::{Colour, Comparison};

use crate::result::cell;

/// A column of colour values: its name and its accessor.
type Column = (&'static str, fn(&Colour) -> Option<f64>);

const COLUMNS: [Column; 10] = [
    ("X", |c| Some(c.X)),
    ("Y", |c| Some(c.Y)),
    ("Z", |c| Some(c.Z)),
    ("u_prime", |c| c.u_prime),
    ("v_prime", |c| c.v_prime),
    ("L_star", |c| c.L_star),
    ("a_star", |c| c.a_star),
    ("b_star", |c| c.b_star),
    ("contrast", |c| c.contrast),
    ("peak_nm", |c| c.peak_nm),
];

/// Writes `comparison.csv`: one row per state and direction. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_comparison(out: impl Write, all: &Comparison) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let mut header = ["theta_deg", "phi_deg", "state"].map(str::to_owned).to_vec();
    for (name, _) in COLUMNS {
        header.extend([format!("{name}_simulated"), format!("{name}_measured")]);
    }
    let differences = [
        "delta_E_2000",
        "distance_uv",
        "difference_Y",
        "mean_difference",
        "rms_difference",
        "largest_difference",
    ];
    header.extend(differences.map(str::to_owned));
    header.extend(["largest_at_nm", "z_rms", "within_2"].map(str::to_owned));
    csv.write_record(&header)?;
    for one in &all.states {
        let mut row = vec![one.theta_deg.to_string(), one.phi_deg.to_string(), one.state.clone()];
        for (_, get) in COLUMNS {
            row.extend([cell(get(&one.simulated)), cell(get(&one.measured))]);
        }
        let spectrum = one.spectrum.as_ref();
        row.extend([
            cell(one.delta_E_2000),
            cell(one.distance_uv),
            cell(Some(one.difference_Y)),
            cell(spectrum.map(|spectrum| spectrum.mean_difference)),
            cell(spectrum.map(|spectrum| spectrum.rms_difference)),
            cell(spectrum.map(|spectrum| spectrum.largest_difference)),
            cell(spectrum.map(|spectrum| spectrum.largest_at_nm)),
            cell(one.agreement.map(|all| all.z_rms)),
            cell(one.agreement.map(|all| all.within_2)),
        ]);
        csv.write_record(&row)?;
    }
    csv.flush()
}

/// Writes `comparison-spectra.csv`: one row per state, direction and wavelength at which both a simulated and
/// a measured value exist.
///
/// # Errors
/// Those of `out`.
pub fn write_compared_spectra(out: impl Write, all: &Comparison) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "state",
        "wavelength_nm",
        "simulated",
        "measured",
        "simulated_deviation",
        "measured_deviation",
        "z",
    ])?;
    for one in &all.states {
        let Some(spectrum) = &one.spectrum else { continue };
        let both = spectrum.simulated.iter().zip(&spectrum.measured);
        for (bin, (nm, (simulated, measured))) in spectrum.wavelength_nm.iter().zip(both).enumerate() {
            let numbers = [one.theta_deg, one.phi_deg].map(|angle| angle.to_string());
            let [theta, phi] = numbers;
            csv.write_record([
                theta,
                phi,
                one.state.clone(),
                nm.to_string(),
                simulated.to_string(),
                measured.to_string(),
                cell(spectrum.simulated_deviation.get(bin).copied()),
                cell(spectrum.measured_deviation.get(bin).copied()),
                cell(one.z.get(bin).copied()),
            ])?;
        }
    }
    csv.flush()
}

/// Writes `comparison-metrics.csv`: one row per measured metric that has a counterpart.
///
/// # Errors
/// Those of `out`.
pub fn write_compared_metrics(out: impl Write, all: &Comparison) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "metric",
        "simulated",
        "measured",
        "simulated_deviation",
        "measured_deviation",
        "z",
    ])?;
    for one in &all.metrics {
        csv.write_record([
            one.theta_deg.to_string(),
            one.phi_deg.to_string(),
            one.metric.clone(),
            one.simulated.to_string(),
            one.measured.to_string(),
            one.simulated_deviation.to_string(),
            cell(one.measured_deviation),
            cell(one.z),
        ])?;
    }
    csv.flush()
}
