//! Chapter 4: Monte Carlo.

use papilio_display::scene::{Lobe, Sampler, Strategy};
use papilio_display::{StudyCurve, study};
use papilio_figures::{
    Chart, ChartCurve, ErrorCurve, ErrorPanel, Hue, ScatterCurve, Scattering, accuracy, chart, point_sets,
    scattering,
};
use papilio_goniometry::{Data, Fit, FitOptions, Kind, Normalisation};
use papilio_optics::Beta;
use papilio_sampling::SampleStream;
use papilio_sampling::table_4_1::Estimator;

use crate::chapter_3::{in_plane, measurement, shape};
use crate::displays::{Bench, ReproductionError};
use crate::report::{Section, Table, number};

/// Table 4.1: variance times N (or N cubed) and samples for a standard error of 0.08, as printed.
const TABLE_4_1: [(&str, u64); 5] =
    [("56.8/N", 8875), ("21.3/N", 3328), ("0", 1), ("0.1645/N", 26), ("21.3/N^3", 15)];

/// Index of the glass.
const GLASS: f64 = 1.5;

pub(crate) fn sections(bench: &Bench<'_>) -> Result<Vec<Section>, ReproductionError> {
    Ok(vec![table_4_1(), paths(bench)?, sets(), densities(), standard_errors(bench)?, ward(bench)?])
}

fn table_4_1() -> Section {
    const SAMPLES: u64 = 16;
    const EXPERIMENTS: u64 = 20_000;
    let mut table = Table::new(&[
        "density",
        "variance, thesis",
        "variance, here",
        "variance at N = 16, exact",
        "by experiment",
        "N for a standard error of 0.08, thesis",
        "here",
    ]);
    for (way, (printed, samples)) in Estimator::ALL.into_iter().zip(TABLE_4_1) {
        let (factor, power) = way.variance();
        let formula = if power == 1 { format!("{factor:.4}/N") } else { format!("{factor:.4}/N^{power}") };
        let (found, error) = way.experiment(SAMPLES, EXPERIMENTS, 0);
        table.row([
            way.density_in_words().to_owned(),
            printed.to_owned(),
            formula,
            format!("{:.5}", factor / (SAMPLES as f64).powi(power)),
            format!("{found:.5} \u{b1} {error:.5}"),
            samples.to_string(),
            way.samples_for(0.08).to_string(),
        ]);
    }
    Section::new("table-4-1", "Table 4.1: comparison between different sampling functions")
        .table(table)
        .say(
            "Estimates of the integral of x from 0 to 4, which is 8. Variances are exact (eq. 4-9), and from 20 000 \
             experiments of 16 samples. In the first two rows, the thesis computed the numbers of samples from its rounded \
             variances.",
        )
}

/// Figure 4.1: paths with the directions of the Monte Carlo solver, drawn in the plane of incidence.
fn paths(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let scene = bench.resolve("indoor", &[])?.scene;
    let lobe = scene.display.panel().and_then(|panel| panel.diffuser()).map(|diffuser| diffuser.lobe);
    let lobe = lobe.unwrap_or(Lobe::Lambertian);
    // Thickness of the glass below the diffuser, and height of the eye above it.
    let (glass, eye) = (1.0, 1.3);
    let down = |beta: Beta, index: f64| beta.x / (index * index - beta.squared()).max(1e-9).sqrt();
    let view_direction = Beta::from_source(8.0, 0.0, 1.0);
    let numbers = SampleStream::new(Sampler::Stratified, 0, 0);
    let path = |k: u64| {
        let [u, v, s, t] = numbers.block(16 + k, 0);
        let start = -eye * down(view_direction, 1.0);
        let mut points = vec![(start, eye), (0.0, 0.0)];
        let Some(inside) =
            lobe.sample_direction(view_direction, [u, v]).filter(|beta| beta.squared() < GLASS * GLASS)
        else {
            return points;
        };
        let slope = down(inside, GLASS);
        points.extend([(glass * slope, -glass), (2.0 * glass * slope, 0.0)]);
        let Some(out) = lobe.sample_direction(inside, [s, t]).filter(|beta| beta.squared() < 1.0) else {
            return points;
        };
        points.push((2.0 * glass * slope + eye * down(out, 1.0), eye));
        points
    };
    let count = 14;
    // Extent of the figure to either side.
    let reach = 1.4;
    let curve = |k: u64| ChartCurve {
        name: String::new(),
        hue: Hue::Scale(k as f64 / count as f64),
        dashed: false,
        marks: false,
        points: path(k),
    };
    let interface = |height: f64, name: &str| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(3),
        dashed: false,
        marks: false,
        points: vec![(-reach, height), (reach, height)],
    };
    let mut curves: Vec<ChartCurve> = (0..count).map(curve).collect();
    for curve in &mut curves {
        let inside = curve.points.iter().take_while(|(x, _)| x.abs() <= reach).count();
        curve.points.truncate(inside);
    }
    curves.extend([interface(0.0, "diffuser"), interface(-glass, "pixel")]);
    let figure = Chart {
        x: "Position (in units of the glass thickness)".to_owned(),
        y: "Height (in units of the glass thickness)".to_owned(),
        logarithmic: false,
        at_least: vec![],
        curves,
    };
    Ok(Section::new("figure-4-1", "Figure 4.1: path tracing for display simulation").figure(
        chart(&figure, ""),
        "Paths of the indoor scenario, projected onto one plane: from the eye at 8 deg to the diffuser, scattered into the \
         glass, reflected by the pixel, and scattered out of the display.",
    ))
}

/// Figure 4.2.
fn sets() -> Section {
    const POINTS: u64 = 256;
    let named_set = |sampler: Sampler| (sampler.name(), sampler.first_pairs(POINTS..2 * POINTS));
    let sets: Vec<(&str, Vec<[f64; 2]>)> = Sampler::ALL.into_iter().map(named_set).collect();
    Section::new("figure-4-2", "Figure 4.2: random spatial samples from different sampling methods").figure(
        point_sets(&sets, "256 points"),
        "The first two coordinates of the random points of the paths.",
    )
}

/// Figure 4.3.
fn densities() -> Section {
    type Density = fn(f64) -> f64;
    let all: [(&str, Density); 4] = [
        ("(6 - x)/16", |x| (6.0 - x) / 16.0),
        ("x/8", |x| x / 8.0),
        ("(0.1 + 0.95 x)/8", |x| (0.1 + 0.95 * x) / 8.0),
        ("1/4", |_| 0.25),
    ];
    let curve = |(k, (name, density)): (usize, (&str, Density))| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(k),
        dashed: false,
        marks: false,
        points: (0..=40).map(|k| 0.1 * f64::from(k)).map(|x| (x, density(x))).collect(),
    };
    let figure = Chart {
        x: "x".to_owned(),
        y: "Density".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves: all.into_iter().enumerate().map(curve).collect(),
    };
    Section::new("figure-4-3", "Figure 4.3: different sampling functions for importance sampling")
        .figure(chart(&figure, ""), "Densities of Table 4.1; each integrates to 1 from 0 to 4.")
}

/// Figure 4.4.
fn standard_errors(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let scene = bench.resolve("sampling", &["display.front=[]"])?.scene;
    let paths: Vec<u64> = (0..6).map(|k| 512 << k).collect();
    let curves = study(&scene, &paths, &|| 0.0, bench.control())?;
    let random: Vec<&StudyCurve> = curves.iter().filter(|curve| curve.sampler == Sampler::Random).collect();
    let curve = |(k, curve): (usize, &&StudyCurve)| ErrorCurve {
        name: curve.strategy.name().to_owned(),
        group: k,
        dashed: matches!(curve.strategy, Strategy::Kernel | Strategy::Guided),
        points: curve.points.iter().map(|point| (point.paths as f64, point.relative_error)).collect(),
    };
    let panel = ErrorPanel {
        x: "Paths".to_owned(),
        powers: true,
        curves: random.iter().enumerate().map(curve).collect(),
    };
    let heads: Vec<String> = paths.iter().map(|paths| format!("{paths} paths")).collect();
    let head: Vec<&str> = std::iter::once("scattering").chain(heads.iter().map(String::as_str)).collect();
    let mut table = Table::new(&head);
    for curve in &random {
        let cells = curve.points.iter().map(|point| format!("{} %", number(100.0 * point.relative_error, 2)));
        table.row(std::iter::once(curve.strategy.name().to_owned()).chain(cells));
    }
    let errors = |strategy: Strategy| -> Vec<f64> {
        let of = random.iter().find(|curve| curve.strategy == strategy);
        of.map(|curve| curve.points.iter().map(|point| point.relative_error).collect()).unwrap_or_default()
    };
    let (uniform, cosine, ward) =
        (errors(Strategy::Uniform), errors(Strategy::Cosine), errors(Strategy::Ward));
    let smaller = |a: &[f64], b: &[f64]| {
        let count = a.iter().zip(b).filter(|(a, b)| a < b).count();
        format!("for {count} of {} numbers of paths", a.len().min(b.len()))
    };
    let mut claims = Table::new(&["the thesis finds", "here"]);
    claims.row(["cosine sampling reduces the error more than uniform sampling", &smaller(&cosine, &uniform)]);
    claims.row(["the error of Ward sampling is below that of cosine sampling", &smaller(&ward, &cosine)]);
    Ok(Section::new("figure-4-4", "Figure 4.4: standard error of different sampling methods")
        .figure(
            accuracy(&[panel], "Indoor, haze 78, random numbers"),
            "Largest relative standard error of Y over the states. Dashed: methods that the thesis does not have, sampling \
             of the lobe itself (kernel) and of the product of lobe, light and pixel (guided).",
        )
        .table(table)
        .table(claims)
        .say(
            "The thesis draws all directions from the fitted Ward lobe. Ours are drawn by the cosine with a probability of \
             0.1; otherwise the variance would be unbounded (the lobe decreases by a power, and the tail of a Gaussian is \
             below it).",
        ))
}

/// Figure 4.5.
fn ward(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let measurement = measurement(bench, "data/H78.bsdf")?;
    let shape = shape(&measurement)?;
    let part = &measurement.parts[0];
    let data = Data::of_part(part, part.luminous());
    let fit = Fit::new(&data, Kind::Ward(Normalisation::Ward), &FitOptions::default())
        .map_err(|error| ReproductionError::Sample(error.to_string()))?;
    let mut curves = Vec::new();
    let mut table =
        Table::new(&["incidence (deg)", "peak of the data (1/sr)", "peak of the fit", "fit / data"]);
    for (k, from) in shape.incidences_deg().enumerate().filter(|(_, deg)| [5.0, 20.0].contains(deg)) {
        let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
        let values = in_plane(&shape, k, from);
        let fitted: Vec<(f64, f64)> =
            values.iter().map(|(to, _)| (*to, fit.value(ray(from), ray(*to)))).collect();
        let peak = |values: &[(f64, f64)]| values.iter().map(|(_, value)| *value).fold(0.0, f64::max);
        let [measured, fit_peak] = [peak(&values), peak(&fitted)];
        table.row([
            from.to_string(),
            number(measured, 3),
            number(fit_peak, 3),
            number(fit_peak / measured, 3),
        ]);
        for (name, points, values) in [("data", true, values), ("Ward", false, fitted)] {
            let name = Some(name.to_owned());
            curves.push(ScatterCurve { name, incidence_deg: from, points, values });
        }
    }
    let figure = Scattering { quantity: "BTDF (1/sr)".to_owned(), curves, maps: Vec::new() };
    let parameters: Vec<String> =
        fit.parameters.iter().map(|p| format!("{} = {}", p.name, number(p.value, 4))).collect();
    Ok(Section::new("figure-4-5", "Figure 4.5: fitted Ward BRDF against measured data")
        .figure(
            scattering(&figure, "H78, simulated measurement with an imaging sphere"),
            format!("Least-squares fit to all cells (eq. 4-16 to 4-18): {}.", parameters.join(", ")),
        )
        .table(table)
        .say("The thesis: \u{201c}The peak of the fitted curve is lower than the measured data.\u{201d} This also holds here."))
}
