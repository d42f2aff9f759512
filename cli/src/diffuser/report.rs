//! What `papilio diffuser` prints.

use std::fmt::Write;

use papilio_figures::Transmission;
use papilio_formats::words::{channel, percent, span, table};
use papilio_goniometry::{Parameter, Part, Ranked};

/// A line for each transmission spectrum.
pub(super) fn spectra(spectra: &[Transmission]) -> String {
    let mut text = String::new();
    for one in spectra {
        let largest = one.share.iter().copied().fold(0.0, f64::max);
        let edge = one.share.iter().zip(&one.wavelength_nm).find(|(share, _)| **share >= 0.5 * largest);
        let (nm, edge) = (span(&one.wavelength_nm), edge.map_or(f64::NAN, |(_, nm)| *nm));
        let _ = writeln!(
            text,
            "\nTransmission spectrum {}\n  wavelengths: {nm} nm; at most {}; half of that is reached at {edge} nm",
            one.name,
            percent(largest)
        );
    }
    text
}

/// What `papilio diffuser fit` prints.
pub(super) fn fit(name: &str, part: &Part, fits: &[Ranked]) -> String {
    let cells = fits.first().map_or(0, |ranked| ranked.fit.cells);
    let channel = part.channels.get(part.luminous()).map(channel).unwrap_or_default();
    let mut text = format!("{name}: {}, {channel}, {cells} cells\n\n", part.way.name());
    let mut rows = vec![["lobe", "display", "residual", "total"].map(str::to_owned).to_vec()];
    let mut parameters = String::new();
    for Ranked { fit, score } in fits {
        let name = fit.model.kind().name();
        rows.push(vec![
            name.to_owned(),
            score.map_or("-".to_owned(), percent),
            percent(fit.relative_rms),
            percent(fit.total_error),
        ]);
        let each: Vec<String> = fit.parameters.iter().map(parameter).collect();
        let _ = writeln!(parameters, "  {name}: {}", each.join(", "));
    }
    text.push_str(&table(&rows));
    text.push_str(
        "  display: luminance through the lobe and back over a mirror, largest deviation from the data's (best first),\n           \
         of light from and to directions that were measured\n  \
         residual: rms of (data - lobe) cos(theta), relative; total: of all cells\n\nparameters, with 95 % intervals\n",
    );
    text.push_str(&parameters);
    if fits.iter().any(|ranked| !ranked.fit.converged) {
        text.push_str("warning: a search did not come to rest\n");
    }
    text
}

fn parameter(found: &Parameter) -> String {
    let [low, high] = found.interval;
    let end = if found.at_bound { " (end of its range)" } else { "" };
    format!("{} {} [{}, {}]{end}", found.name.replace('_', "-"), short(found.value), short(low), short(high))
}

/// Five digits.
pub(super) fn short(value: f64) -> String {
    let decimals = (4.0 - value.abs().max(1e-300).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}
