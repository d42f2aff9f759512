//! Chapter 3: what goes into the simulation: the measured diffusers and the pixel.

use papilio_display::pixel::scan;
use papilio_display::scene::AngleMedium;
use papilio_figures::{
    PixelScan, ScatterCurve, Scattering, Transmission, pixel_scan, scattering, spectra_over, transmission,
};
use papilio_formats::{DataFile, LARGEST_BSDF_FILE, read_bsdf, read_shares};
use papilio_goniometry::{Fill, Measurement, Shape};
use papilio_optics::Beta;

use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, number, off};

/// Figure 3.8's legend: inclinations in air and, in brackets, in the glass, degrees.
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

/// A shipped measurement.
pub(crate) fn measurement(bench: &Bench<'_>, name: &str) -> Result<Measurement, ReproductionError> {
    let file = DataFile::open_within(&bench.path(name), name, LARGEST_BSDF_FILE)?;
    Ok(read_bsdf(&file)?.value)
}

/// A measurement's luminous channel as a smooth lobe.
pub(crate) fn shape(measurement: &Measurement) -> Result<Shape, ReproductionError> {
    let part = measurement.parts.first();
    let shape = part.and_then(|part| Shape::of_part(part, part.luminous(), Fill::Tail));
    shape.ok_or_else(|| ReproductionError::Sample("it has no lobe".to_owned()))
}

/// A lobe in the plane of incidence: inclination and value.
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
            scattering(&figure, "H78 as a virtual imaging sphere sees it"),
            "Synthetic: a k-correlation lobe of 78 % haze, seen by an instrument of the thesis's grid (2 by 10 deg) and of \
             a blur of .048 in direction cosines.",
        )
        .table(peaks)
        .say(
            "The thesis's peak is read off its figure. A lobe of that peak has a haze of at least 88 % by the 2.5 deg \
             rule; haze and peak agree if the instrument blurs by .048, and so does ours. A display must be computed \
             with the lobe itself, not with its blurred picture.",
        )
        .say("The angles in brackets in its legend are those in glass of index 1.5:")
        .table(snell))
}

/// Figure 3.10.
fn transmissions(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let mut spectra = Vec::new();
    for haze in ["65", "78", "81"] {
        let name = format!("data/H{haze}-transmission.csv");
        let spectrum = read_shares(&DataFile::open(&bench.path(&name), &name)?)?;
        spectra.push(Transmission {
            name: format!("Haze {haze}"),
            wavelength_nm: spectrum.wavelengths_nm().to_vec(),
            share: spectrum.values().to_vec(),
        });
    }
    let share = |spectrum: &Transmission, nm: f64| {
        let at = spectrum.wavelength_nm.iter().position(|w| *w >= nm);
        at.map_or(f64::NAN, |at| 100.0 * spectrum.share[at])
    };
    let mut table = Table::new(&["", "380 nm, %", "420 nm, %", "550 nm, %"]);
    for spectrum in &spectra {
        let cells = [380.0, 420.0, 550.0].map(|nm| number(share(spectrum, nm), 3));
        table.row(std::iter::once(spectrum.name.clone()).chain(cells));
    }
    Ok(Section::new("figure-3-10", "Figure 3.10: transmission of various diffusers at normal viewing angle")
        .figure(
            transmission(&spectra, ""),
            "Synthetic, and one formula for all three: they lie on each other. The thesis's have the same drop from 420 \
             to 380 nm; its numbers are not printed.",
        )
        .table(table))
}

/// Figure 3.12.
fn scale_factor(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let with = bench.run("measured-diffused", &[])?;
    let without = bench.run("measured-diffused", &["display.diffuser.normalise=none"])?;
    let truth = bench.run("measured-truth", &[])?;
    let mut table = Table::new(&["Y", "true lobe", "with k", "off", "without k", "off"]);
    for state in ["white", "red", "green", "blue", "black"] {
        let [true_y, k, no_k] =
            [&truth, &with, &without].map(|result| of(first(result), state, |v| Some(v.Y)));
        let cells = [number(true_y, 4), number(k, 4), off(true_y, k), number(no_k, 4), off(true_y, no_k)];
        table.row(std::iter::once(state.to_owned()).chain(cells));
    }
    let shown = [("with k", &with), ("without k", &without), ("true lobe", &truth)];
    Ok(Section::new("figure-3-12", "Figure 3.12: impact of incident angle dependent scale factor")
        .figure(
            spectra_over(&shown, "H78 from its file"),
            "Reflectance factors in diffuse light at 8 deg: the two-instrument BTDF with and without the scale factor k \
             (eq. 3-10, 3-11), and the lobe that was measured, which stands for the thesis's measured panel.",
        )
        .table(table)
        .say(
            "In the thesis the model without k is too bright for all colours and the one with k agrees better. Here the one \
             without k is too dark, for a plain reason: the file's values hold the film's level already, and the \
             transmission spectrum holds it once more. Either way k takes the level from the instrument's total: white \
             agrees. The colours keep what k cannot mend, the instrument's blur (instrument_blur removes it).",
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
        "The states' reflectance at 8, 20, 30 and 40 deg in glass: with the angle the spectra go to the blue. The \
         thesis's pixel tool is closed; ours is a film stack fitted to its bare peaks.",
    ))
}
