//! Reports of `papilio diffuser`.

use std::fmt::Write;

use papilio_figures::Transmission;
use papilio_formats::words::{channel, percent, span, table};
use papilio_goniometry::{MeasuredPart, Parameter, RankedFit, ScatterMode};

/// Report of transmission spectra.
pub(super) fn spectra(spectra: &[Transmission]) -> String {
    let mut text = String::new();
    for spectrum in spectra {
        let largest = spectrum.share.iter().copied().fold(0.0, f64::max);
        let edge =
            spectrum.share.iter().zip(&spectrum.wavelength_nm).find(|(value, _)| **value >= 0.5 * largest);
        let (nm, edge) = (span(&spectrum.wavelength_nm), edge.map_or(f64::NAN, |(_, nm)| *nm));
        let _ = writeln!(
            text,
            "\nTransmission spectrum {}\n  wavelengths: {nm} nm; maximum {}; half of the maximum at {edge} nm",
            spectrum.name,
            percent(largest)
        );
    }
    text
}

/// Report of `papilio diffuser fit`.
pub(super) fn fit(name: &str, part: &MeasuredPart, fits: &[RankedFit]) -> String {
    let cells = fits.first().map_or(0, |ranked| ranked.fit.cells);
    let channel = part.channels.get(part.luminous()).map(channel).unwrap_or_default();
    let mut text = format!("{name}: {}, {channel}, {cells} cells\n\n", part.way.name());
    let mut rows = vec![["lobe", "display", "residual", "total"].map(str::to_owned).to_vec()];
    let mut parameters = String::new();
    for RankedFit { fit, score } in fits {
        let name = fit.model.kind.name();
        rows.push(vec![
            name.to_owned(),
            score.map_or("-".to_owned(), percent),
            percent(fit.relative_rms),
            percent(fit.total_error),
        ]);
        let each = fit.parameters.iter().map(|one| parameter(one, part.way));
        let each: Vec<String> = each.collect();
        let _ = writeln!(parameters, "  {name}: {}", each.join(", "));
    }
    text.push_str(&table(&rows));
    let is_known = fits.iter().any(|ranked| ranked.score.is_some());
    text.push_str(if is_known {
        "  display: largest deviation of the luminance of a mirror under the lobe from that under the data (best first),\n           \
         for light from and to measured directions\n"
    } else {
        "  display: deviation of the luminance of a mirror under the lobe; it needs several incidences, and the residual decides\n"
    });
    text.push_str(
        "  \
         residual: relative rms of (data - lobe) cos(theta)\n  \
         total: relative deviation of the sum over all cells\n\nparameters, with 95 % confidence intervals\n",
    );
    text.push_str(&parameters);
    let open = fits.iter().filter(|ranked| !ranked.fit.converged).map(|ranked| ranked.fit.model.kind.name());
    let open: Vec<&str> = open.collect();
    if !open.is_empty() {
        let _ = writeln!(text, "warning: the fit did not converge for {}", open.join(", "));
    }
    text
}

/// A parameter with its confidence interval.
fn parameter(parameter: &Parameter, way: ScatterMode) -> String {
    let [low, high] = parameter.interval;
    let end = if parameter.at_bound { " (at the end of its range)" } else { "" };
    let name = match (parameter.name, way.is_transmission()) {
        ("transmittance", false) => "reflectance".to_owned(),
        (name, _) => name.replace('_', "-"),
    };
    format!("{name} {} [{}, {}]{end}", short(parameter.value), short(low), short(high))
}

/// A number with five significant digits.
pub(super) fn short(value: f64) -> String {
    let decimals = (4.0 - value.abs().max(1e-300).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}
