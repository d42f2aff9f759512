//! Chapter 2: a diffuser of glass bumps (figures 2.11, 2.12), and the same as a plane with a BSDF (figure
//! 2.15).

use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_microgeometry::{ByRays, Kernel, MOST_SLOPE, Measurement, MicrogeometryError, Side, Total};
use papilio_scenario::SurfaceScenario;

use crate::displays::{Bench, ReproductionError, of, write_example};
use crate::report::{Section, Table, fixed, number};

/// The surface: millions of hemispheres side by side on 20 mm2 are 2 to 4.5 um apart.
const HEMISPHERES: &str = "hemispheres.toml";

/// Glass with hemispheres above a mirror, and paper, in a lamp above.
const DISPLAY: &str = r#"# Feng 2012, figure 2.12: a diffuser of glass hemispheres above a display, in a lamp above it.
title = "Glass with hemispheres above a mirror"

[[display.layers]]
kind = "diffuser"
model = "microgeometry"
surface = "hemispheres.toml"
rays = 6400

[[display.layers]]
kind = "medium"
index = 1.5

[display.pixel]
model = "uniform"
kind = "mirror"
reflectance = { white = 0.5, black = 0 }

[lighting]
illuminance_lx = 500
spectrum = "E"
[[lighting.directed]]
theta_deg = 0
radius_deg = 2
share = 1

[viewer]
theta_deg = [0, 45]
"#;

/// Rays for each inclination and each band: an error of about 0.002 in the totals.
const RAYS: &str = "microgeometry.rays=6400";

/// Distances of the diffuser from the display, mm.
const DISTANCES_MM: [f64; 2] = [100.0, 0.1];

/// Figures 2.11, 2.12 and 2.15.
pub(crate) fn sections(bench: &Bench<'_>) -> Result<Vec<Section>, ReproductionError> {
    write_example(&format!("surfaces/{HEMISPHERES}"), &bench.path(HEMISPHERES))?;
    bench.write("bumps.toml", DISPLAY)?;
    let surface = SurfaceScenario::load(&bench.path(HEMISPHERES), &[RAYS.to_owned()])?.resolve()?;
    let stop = || bench.control().stop.load(std::sync::atomic::Ordering::Relaxed);
    let measurement = Measurement { waves_nm: vec![450.0, 550.0, 650.0], ..surface.measurement };
    let findings = measurement.measured(None, &stop, &|| {})?;
    let (Some(ByRays { totals, kernel, .. }), Some(waves)) = (findings.rays, findings.waves) else {
        return Err(MicrogeometryError::Interrupted.into());
    };

    let mut shares = Table::new(&[
        "light from above, inclination (deg)",
        "reflected (%)",
        "transmitted, seen under a flat face (%)",
        "transmitted and trapped there (%)",
    ]);
    for total in totals.iter().filter(|total| total.from == Side::Above && total.theta_deg % 15.0 == 0.0) {
        shares.row([
            total.theta_deg.to_string(),
            fixed(100.0 * total.reflected.value, 2),
            fixed(100.0 * (total.transmitted.value - total.transmitted_beyond.value), 2),
            fixed(100.0 * total.transmitted_beyond.value, 2),
        ]);
    }
    let mut orders = Table::new(&[
        "wavelength (nm)",
        "first order of a grid of 4.5 um (deg)",
        "straight through by waves (%)",
        "haze by waves (%)",
        "haze by rays (%)",
    ]);
    let haze = totals.first().map_or(f64::NAN, |total| total.haze.value);
    for (one, through) in waves.along_normal() {
        orders.row([
            one.wavelength_nm.to_string(),
            fixed((1e-3 * one.wavelength_nm / 4.5).asin().to_degrees(), 2),
            fixed(100.0 * through.regular.value, 2),
            fixed(100.0 * through.haze.value, 1),
            fixed(100.0 * haze, 1),
        ]);
    }
    Ok(vec![
        Section::new("figure-2-11", "Figure 2.11: hemispherical glass bumps")
            .say(
                "A dense grid of hemispheres of glass (index 1.5), touching each other, with flat glass between them. Rays are followed \
                 through all orders of facets, from both sides: papilio gonio scenarios/hemispheres.toml. The thesis prints no numbers.",
            )
            .figure(spread(&totals), "Where the light goes, against its inclination: back, into the glass in directions that exist in air, and into those that a flat face traps.")
            .table(shares)
            .say(format!(
                "Millions of bumps on 20 mm\u{b2} are 2 to 4.5 um apart. Rays are wrong for a regular grid of such a pitch: it \
                 diffracts into orders several degrees apart, in another direction for each colour, which the thesis's rays do not show. \
                 A thin phase screen has these orders, but does not hold either at the rims of hemispheres (rms slope {}, more than \
                 {MOST_SLOPE}). Rays describe bumps at random places, or of more than about 63 um.",
                fixed(waves.slope_rms, 2)
            ))
            .table(orders),
        looks(bench, &kernel)?,
        plane(bench, &totals)?,
    ])
}

/// Curves of the totals against inclination.
fn spread(totals: &[Total]) -> String {
    let curve = |name: &str, hue: usize, of: fn(&Total) -> f64| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(hue),
        dashed: false,
        marks: false,
        points: totals
            .iter()
            .filter(|total| total.from == Side::Above)
            .map(|total| (total.theta_deg, 100.0 * of(total)))
            .collect(),
    };
    let figure = Chart {
        x: "Inclination of the light (deg)".to_owned(),
        y: "Light (%)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0, 100.0],
        curves: vec![
            curve("reflected", 0, |total| total.reflected.value),
            curve("seen below", 1, |total| total.transmitted.value - total.transmitted_beyond.value),
            curve("trapped", 2, |total| total.transmitted_beyond.value),
        ],
    };
    chart(&figure, "")
}

/// Figure 2.12: brightness from 0 and 45 deg, and blur by the distance of the diffuser.
fn looks(bench: &Bench<'_>, kernel: &Kernel) -> Result<Section, ReproductionError> {
    let white = |set: &[&str]| -> Result<[f64; 2], ReproductionError> {
        let result = bench.run("bumps", set)?;
        Ok([0, 1].map(|view| of(&result.views[view], "white", |values| Some(values.Y))))
    };
    let bumps = white(&[])?;
    let flat = white(&["display.layers.0={ kind = \"fresnel\" }"])?;
    let mut table = Table::new(&["luminance factor, lamp at 0 deg", "flat glass", "with bumps", "thesis"]);
    for (view, found) in
        [("(1) seen from 0 deg", "darker"), ("(2) seen from 45 deg", "brighter")].iter().enumerate()
    {
        table.row([found.0.to_owned(), number(flat[view], 4), number(bumps[view], 4), found.1.to_owned()]);
    }
    let beta = kernel.median_beta();
    let tangent = beta / (1.0 - beta * beta).sqrt();
    let mut blur = Table::new(&[
        "distance of the diffuser (mm)",
        "half of the light lands farther away than (mm)",
        "thesis",
    ]);
    for (mm, found) in DISTANCES_MM.iter().zip(["(3) blurred", "(4) hardly blurred"]) {
        blur.row([mm.to_string(), number(mm * tangent, 3), found.to_owned()]);
    }
    Ok(Section::new("figure-2-12", "Figure 2.12: a diffuser of bumps above a display")
        .say(
            "Above a mirror-like display in a lamp above it, the diffuser scatters light away from the mirror image, and to \
             where there was none. papilio run scenarios/bumps.toml; flat glass: --set display.layers.0='{ kind = \"fresnel\" }'.",
        )
        .table(table)
        .say(format!(
            "Half of the light along the normal leaves the bumps at |beta| above {}. At a distance from the display it lands \
             that much farther away: a diffuser of 5 mm at 100 mm shows nothing of what is below it.",
            fixed(beta, 3)
        ))
        .table(blur))
}

/// Figure 2.15: the bumps as a plane with a BSDF, compared with the rays themselves.
fn plane(bench: &Bench<'_>, totals: &[Total]) -> Result<Section, ReproductionError> {
    let angles = [0.0, 30.0, 60.0, 75.0];
    let views = format!("viewer.theta_deg={angles:?}");
    let result = bench.run("bumps", &[&views, "lighting.directed=[]", "lighting.diffuse=1"])?;
    let mut table =
        Table::new(&["inclination (deg)", "reflectance by rays (%)", "of the plane (%)", "difference"]);
    for (view, deg) in result.views.iter().zip(angles) {
        let rays = totals.iter().find(|total| total.from == Side::Above && total.theta_deg == deg);
        let rays = rays.map_or(f64::NAN, |total| total.reflected.value);
        // Nothing comes back from below the plane: by reciprocity what is seen in uniform light is what is
        // reflected.
        let plane = of(view, "black", |values| Some(values.Y));
        table.row([
            deg.to_string(),
            fixed(100.0 * rays, 2),
            fixed(100.0 * plane, 2),
            fixed(100.0 * (plane - rays), 2),
        ]);
    }
    Ok(Section::new("figure-2-15", "Figure 2.15: the bumps as a plane with a BSDF")
        .say(
            "The thesis replaces the bumps by a plane with their BRDF. Here the kernel of all four ways is a layer of the display. \
             Above a black display in uniform light, it reflects what the rays reflect:",
        )
        .table(table))
}
