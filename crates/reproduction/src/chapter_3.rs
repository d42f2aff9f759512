//! Chapter 3: the input of the simulation, measured diffusers and the pixel.

use papilio_display::pixel::scan;
use papilio_display::scene::AngleMedium;
use papilio_figures::{
    PixelScan, ScatterCurve, Scattering, Transmission, pixel_scan, scattering, spectra_over, transmission,
};
use papilio_formats::{DataFile, LARGEST_BSDF_FILE, read_bsdf, read_fractions};
use papilio_goniometry::{Fill, Measurement, Shape};
use papilio_optics::Beta;

use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, number, off};

/// Legend of figure 3.8: inclinations in air and (in brackets in the figure) in the glass, degrees.
const INCIDENCES_DEG: [(f64, f64); 16] = [
    (0.0, 0.0),
    (5.0, 3.3),
    (10.0, 6.6),
    (15.0, 9.9),
    (20.0, 13.2),
    (25.0, 16.4),
    (30.0, 19.5),
    (35.0, 22.5),
    (40.0, 25.4),
    (45.0, 28.1),
    (50.0, 30.7),
    (55.0, 33.1),
    (60.0, 35.3),
    (65.0, 37.2),
    (70.0, 38.8),
    (75.0, 40.1),
];

pub(crate) fn sections(bench: &Bench<'_>) -> Result<Vec<Section>, ReproductionError> {
    Ok(vec![measured_lobe(bench)?, transmissions(bench)?, scale_factor(bench)?, pixel_angles(bench)?])
}

/// Reads a measurement that is shipped with the report.
pub(crate) fn measurement(bench: &Bench<'_>, name: &str) -> Result<Measurement, ReproductionError> {
    let file = DataFile::open_within(&bench.path(name), name, LARGEST_BSDF_FILE)?;
    Ok(read_bsdf(&file)?.value)
}

/// Returns the luminous channel of a measurement as a smooth lobe.
pub(crate) fn shape(measurement: &Measurement) -> Result<Shape, ReproductionError> {
    let part = measurement.parts.first();
    let shape = part.and_then(|part| Shape::of_part(part, part.luminous(), Fill::Tail));
    shape.ok_or_else(|| ReproductionError::Sample("the measurement has no lobe".to_owned()))
}

/// Returns a lobe in the plane of incidence, as pairs of inclination (degrees) and value.
pub(crate) fn in_plane(shape: &Shape, incidence: usize, from_deg: f64) -> Vec<(f64, f64)> {
    let from = from_deg.to_radians().sin();
    let value = |to: f64| shape.value(incidence, Beta { x: to.to_radians().sin() - from, y: 0.0 });
    (-180..=180).map(|k| 0.5 * f64::from(k)).map(|to| (to, value(to))).collect()
}

/// Figure 3.8.
fn measured_lobe(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let measurement = measurement(bench, "data/H78.bsdf")?;
    let shape = shape(&measurement)?;
    let curves = shape.incidences_deg().enumerate().map(|(k, from)| ScatterCurve {
        name: None,
        incidence_deg: from,
        points: false,
        values: in_plane(&shape, k, from),
    });
    let figure =
        Scattering { quantity: "BTDF (1/sr)".to_owned(), curves: curves.collect(), maps: Vec::new() };
    let mut snell = Table::new(&["in air (deg)", "in glass, thesis", "in glass, here"]);
    for (air, glass) in INCIDENCES_DEG {
        let inside = (air.to_radians().sin() / 1.5).asin().to_degrees();
        snell.row([air.to_string(), format!("{glass:.1}"), format!("{inside:.1}")]);
    }
    let peak = shape.value(0, Beta { x: 0.0, y: 0.0 });
    let mut peaks = Table::new(&["", "thesis", "here", "difference"]);
    peaks.row(["peak at normal incidence (1/sr)", "14.5", &number(peak, 3), &off(14.5, peak)]);
    Ok(Section::new("figure-3-8", "Figure 3.8: measured BTDF of a haze 78 diffuser")
        .figure(
            scattering(&figure, "H78, simulated measurement with an imaging sphere"),
            "Synthetic data: a k-correlation lobe of 78 % haze, measured by a simulated instrument with the thesis's grid \
             (2 by 10 deg) and a blur of 0.048 in direction cosines.",
        )
        .table(peaks)
        .say(
            "The thesis's peak was read from its figure. A lobe with this peak has a haze of at least 88 % by the 2.5 deg \
             rule. Haze and peak agree if the instrument has a blur of 0.048, which our instrument has, too. Displays must \
             be computed with the lobe itself, not with its blurred measurement.",
        )
        .say("The angles in brackets in the legend of the thesis's figure are those in glass of index 1.5:")
        .table(snell))
}

/// Figure 3.10.
fn transmissions(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let mut spectra = Vec::new();
    for haze in ["65", "78", "81"] {
        let name = format!("data/H{haze}-transmission.csv");
        let spectrum = read_fractions(&DataFile::open(&bench.path(&name), &name)?)?;
        spectra.push(Transmission {
            name: format!("Haze {haze}"),
            wavelength_nm: spectrum.wavelengths_nm().to_vec(),
            share: spectrum.values().to_vec(),
        });
    }
    let percent = |spectrum: &Transmission, nm: f64| {
        let index = spectrum.wavelength_nm.iter().position(|w| *w >= nm);
        index.map_or(f64::NAN, |index| 100.0 * spectrum.share[index])
    };
    let mut table = Table::new(&["", "380 nm, %", "420 nm, %", "550 nm, %"]);
    for spectrum in &spectra {
        let cells = [380.0, 420.0, 550.0].map(|nm| number(percent(spectrum, nm), 3));
        table.row(std::iter::once(spectrum.name.clone()).chain(cells));
    }
    Ok(Section::new("figure-3-10", "Figure 3.10: transmission of various diffusers at normal viewing angle")
        .figure(
            transmission(&spectra, ""),
            "Synthetic data from one formula, so that the three curves coincide. The thesis's curves decrease in the same \
             way from 420 to 380 nm; the thesis does not print their values.",
        )
        .table(table))
}

/// Figure 3.12.
fn scale_factor(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let with = bench.run("measured-diffused", &[])?;
    let without = bench.run("measured-diffused", &["display.diffuser.normalise=none"])?;
    let truth = bench.run("measured-truth", &[])?;
    let mut table = Table::new(&["Y", "true lobe", "with k", "difference", "without k", "difference"]);
    for state in ["white", "red", "green", "blue", "black"] {
        let [true_y, k, no_k] =
            [&truth, &with, &without].map(|result| of(first(result), state, |v| Some(v.Y)));
        let cells = [number(true_y, 4), number(k, 4), off(true_y, k), number(no_k, 4), off(true_y, no_k)];
        table.row(std::iter::once(state.to_owned()).chain(cells));
    }
    let shown = [("with k", &with), ("without k", &without), ("true lobe", &truth)];
    Ok(Section::new("figure-3-12", "Figure 3.12: impact of incident angle dependent scale factor")
        .figure(
            spectra_over(&shown, "H78 from its measured file"),
            "Reflectance factors in diffuse light at 8 deg: the BTDF from two instruments with and without the scale factor \
             k (eq. 3-10, 3-11), and the true lobe, which takes the place of the thesis's measured panel.",
        )
        .table(table)
        .say(
            "In the thesis, the model without k is too bright for all colours, and the model with k agrees better. Here, the \
             model without k is too dark, because the values in the file already include the transmittance of the \
             diffuser, and the transmittance spectrum applies it again. In both cases, k takes the level from the total \
             transmittance of the instrument, so that white agrees. The colours keep an error that k cannot correct, the \
             blur of the instrument (instrument_blur removes it).",
        ))
}

/// Figure 3.13.
fn pixel_angles(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let mut scene = bench.resolve("reference-pixel", &["spectrum.step_nm=5"])?.scene;
    scene.solver.angle_medium = AngleMedium::Glass;
    let scan = scan(&scene, &[8.0, 20.0, 30.0, 40.0])?;
    let chosen: Vec<&(String, Vec<f64>)> =
        scan.states.iter().filter(|(name, _)| ["red", "green", "blue"].contains(&name.as_str())).collect();
    let names: Vec<String> = chosen.iter().map(|(name, _)| name.clone()).collect();
    let reflectance: Vec<f64> = chosen.iter().flat_map(|(_, values)| values.iter().copied()).collect();
    let figure = PixelScan {
        states: &names,
        medium: "glass",
        theta_deg: &scan.theta_deg,
        wavelength_nm: &scan.wavelength_nm,
        reflectance: &reflectance,
    };
    Ok(Section::new("figure-3-13", "Figure 3.13: SPD of pixel reflectance with angle scanning").figure(
        pixel_scan(&figure, "The reference pixel"),
        "Reflectance of the states at 8, 20, 30 and 40 deg in glass: with increasing angle, the spectra shift to the blue. \
         The thesis's program for the pixel is not public; ours is a film stack fitted to the peaks of its bare panel.",
    ))
}
