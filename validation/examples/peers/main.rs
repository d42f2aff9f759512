//! Papilio's part of `cargo xtask peers`: the tasks and their times on one core.
//!
//! `peers inputs` prints the input of all programs as JSON. `peers TASK SECONDS` repeats a task for this time
//! and prints the CPU seconds of one repetition on one line and the numbers of the result on the next.

#![allow(clippy::print_stdout, reason = "a program for the terminal")]

mod designs;

use std::error::Error;
use std::sync::LazyLock;
use std::time::Instant;

use num_complex::Complex64;
use papilio_colour::{Observer, Xyz};
use papilio_display::scene::Scene;
use papilio_optics::film::{GapFilm, SpectralLayer, Thickness};
use papilio_scenario::Scenario;
use papilio_spectra::{Grid, illuminant, material};
use papilio_validation::run_on;

type SampleStream = Result<Vec<f64>, Box<dyn Error>>;

const INDEX: f64 = 1.5;
/// The layers of the reference pixel from the glass down; there is glass behind its metal.
const LAYERS: [(&str, f64); 6] =
    [("Si3N4", 55.9), ("Cr:Johnson", 12.15), ("SiO2", 38.6), ("AlOx", 9.0), ("air", f64::NAN), ("Al", 200.0)];
const GAPS_NM: [f64; 4] = [275.9, 192.3, 137.8, 20.0];
/// Number of angles in glass, from 0 to 36 degrees.
const ANGLES: usize = 19;
const SPECTRA: usize = 1000;
/// Reflectance of the matte layer under a pane.
const SHADE: f64 = 0.6;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["inputs"] => inputs(),
        ["films", seconds] => timed(seconds, film()?),
        ["colours", seconds] => timed(seconds, colours()?),
        ["designs", seconds] => timed(seconds, designs::bare()?),
        ["displays", seconds] => timed(seconds, designs::through_diffuser()?),
        ["matrices", seconds] => timed(seconds, displayed(&pane()?)),
        ["scenes", kind, light, solver, seconds] => timed(seconds, displayed(&paper(kind, light, solver)?)),
        _ => Err("usage: peers inputs | films | colours | designs | displays | matrices | scenes KIND LIGHT SOLVER, then SECONDS"
            .into()),
    }
}

/// Repeats a task, at least once, and prints its time and numbers.
fn timed(seconds: &str, mut task: impl FnMut() -> SampleStream) -> Result<(), Box<dyn Error>> {
    let seconds: f64 = seconds.parse()?;
    let numbers = task()?;
    let (start, mut count) = (cpu_time()?, 0.0);
    let each = loop {
        task()?;
        count += 1.0;
        let taken = cpu_time()? - start;
        if taken >= seconds {
            break taken / count;
        }
    };
    println!("{each}");
    println!("{}", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    Ok(())
}

/// Returns the CPU time of all threads in seconds, as the kernel reports it in hundredths, or the clock time
/// on systems that do not report it.
fn cpu_time() -> Result<f64, Box<dyn Error>> {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let start = START.elapsed().as_secs_f64();
    let Ok(text) = std::fs::read_to_string("/proc/self/stat") else { return Ok(start) };
    // Field 2 is the name in brackets, which may contain blanks; fields 14 and 15 are user and system time.
    let fields = text.rsplit(')').next().unwrap_or_default().split_whitespace();
    let hundredths = fields.skip(11).take(2).map(str::parse::<f64>).sum::<Result<f64, _>>()?;
    Ok(0.01 * hundredths)
}

fn grid(step_nm: f64) -> Result<Grid, Box<dyn Error>> {
    Ok(Grid::new(380.0, 780.0, step_nm)?)
}

fn wavelengths() -> Result<Vec<f64>, Box<dyn Error>> {
    Ok(grid(5.0)?.wavelengths_nm())
}

/// Returns n + ik of each layer.
fn indices() -> Result<Vec<Vec<Complex64>>, Box<dyn Error>> {
    let grid = grid(5.0)?;
    LAYERS.iter().map(|(name, _)| Ok(material(name)?.on(&grid)?)).collect()
}

fn film() -> Result<impl FnMut() -> SampleStream, Box<dyn Error>> {
    let (wavelengths, indices) = (wavelengths()?, indices()?);
    let beta: Vec<f64> = angles_deg().map(|angle| INDEX * angle.to_radians().sin()).collect();
    Ok(move || {
        let layer = |(index, (_, nm)): (&Vec<Complex64>, &(&str, f64))| SpectralLayer {
            index: index.clone(),
            thickness: if nm.is_nan() { Thickness::Gap } else { Thickness::Fixed(*nm) },
        };
        let layers: Vec<SpectralLayer> = indices.iter().zip(&LAYERS).map(layer).collect();
        let (front, back) = (vec![INDEX; wavelengths.len()], vec![INDEX.into(); wavelengths.len()]);
        let mut out = vec![0.0; ANGLES * GAPS_NM.len() * wavelengths.len()];
        GapFilm::new(&wavelengths, &front, &layers, &back)?.reflectance(&beta, &GAPS_NM, &mut out)?;
        Ok(out)
    })
}

fn angles_deg() -> impl Iterator<Item = f64> {
    (0..ANGLES).map(|k| 2.0 * k as f64)
}

/// Returns smooth reflectances of different hues.
fn spectra() -> Vec<f64> {
    let one = |k: usize| {
        let (centre, width) = (400.0 + 360.0 * (k as f64 / SPECTRA as f64), 20.0 + (k % 7) as f64 * 15.0);
        (0..401).map(move |nm| {
            let x = (380.0 + f64::from(nm) - centre) / width;
            0.05 + 0.85 * (-x * x).exp()
        })
    };
    (0..SPECTRA).flat_map(one).collect()
}

fn colours() -> Result<impl FnMut() -> SampleStream, Box<dyn Error>> {
    let grid = grid(1.0)?;
    let (observer, light) = (Observer::new(&grid)?, illuminant("D65", &grid)?);
    let spectra = spectra();
    let mut seen = vec![0.0; grid.len()];
    Ok(move || {
        let mut xyz = |reflectance: Option<&[f64]>| -> Xyz {
            for (bin, value) in seen.iter_mut().enumerate() {
                *value = light[bin] * reflectance.map_or(1.0, |r| r[bin]);
            }
            observer.xyz(&seen)
        };
        let white = xyz(None);
        let scale = 1.0 / white.y;
        let scaled = |c: Xyz| Xyz { x: c.x * scale, y: c.y * scale, z: c.z * scale };
        let white = scaled(white);
        let all: Vec<Xyz> = spectra.chunks(grid.len()).map(|r| scaled(xyz(Some(r)))).collect();
        let labs: Option<Vec<_>> = all.iter().map(|c| c.lab(white)).collect();
        let labs = labs.ok_or("the white point has no light")?;
        let mut out = Vec::with_capacity(9 * all.len());
        for (k, (c, lab)) in all.iter().zip(&labs).enumerate() {
            let uv = c.uv_prime().ok_or("black")?;
            let before = labs[(k + labs.len() - 1) % labs.len()];
            out.extend([c.x, c.y, c.z, lab.l, lab.a, lab.b, uv.u, uv.v, lab.delta_e_2000(before)]);
        }
        Ok(out)
    })
}

/// Returns the task that computes a display from its scene, on one thread: reflectance factors of the state
/// by wavelength, and Y.
fn displayed(scene: &Scene) -> impl FnMut() -> SampleStream {
    || {
        let result = run_on(scene, Some(1))?;
        let state = &result.views[0].states.iter().next().ok_or("no state")?.1;
        let values = &state.value;
        Ok(values.reflectance_factor.iter().flatten().copied().chain([values.Y]).collect())
    }
}

/// Returns a pane in air over a matte layer, viewed along the normal in diffuse light. By reciprocity, its
/// reflectance factor is the reflected fraction of a beam at normal incidence.
fn pane() -> Result<Scene, Box<dyn Error>> {
    let text = format!(
        "[[display.layers]]\nkind = \"fresnel\"\n[[display.layers]]\nkind = \"medium\"\nindex = {INDEX}\n\
         [[display.layers]]\nkind = \"fresnel\"\n[[display.layers]]\nkind = \"medium\"\nindex = 1.0\n\
         [display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = {SHADE} }}\n\
         [lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = 1.0\n[viewer]\ntheta_deg = 0\n\
         [solver]\nrelative_error = 0.001\n"
    );
    Ok(Scenario::from_text(&text, "pane.toml", &std::env::temp_dir(), &[])?.resolve()?.scene)
}

/// Returns paper under an anti-glare interface: `kind` is `bands` (0.1 % in every wavelength bin) or
/// `luminous`.
fn paper(kind: &str, light: &str, solver: &str) -> Result<Scene, Box<dyn Error>> {
    let (diffuse, lamp) = match light {
        "lamp" => ("0.0", "[[lighting.directed]]\ntheta_deg = -45\nradius_deg = 5\nshare = 1.0\n"),
        _ => ("1.0", ""),
    };
    let folder = tempfile::tempdir()?;
    let rows = wavelengths()?.into_iter().zip(paper_white()).map(|(nm, r)| format!("{nm},{r}\n"));
    std::fs::write(
        folder.path().join("paper.csv"),
        format!("wavelength_nm,reflectance\n{}", rows.collect::<String>()),
    )?;
    let text = format!(
        "[[display.layers]]\nkind = \"rough\"\nalpha = 0.1\n[[display.layers]]\nkind = \"medium\"\nindex = {INDEX}\n\
         [display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = \"paper.csv\" }}\n\
         [lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = {diffuse}\n{lamp}\
         [viewer]\ntheta_deg = 8\n[solver]\nmethod = \"{solver}\"\nrelative_error = 0.001\n{}",
        if solver == "monte-carlo" && kind == "bands" { "per_wavelength = true\n" } else { "" }
    );
    Ok(Scenario::from_text(&text, "paper.toml", folder.path(), &[])?.resolve()?.scene)
}

/// Returns the reflectance of a slightly yellow paper.
fn paper_white() -> impl Iterator<Item = f64> {
    (0..81).map(|bin| 0.3 + 0.4 * f64::from(bin) / 80.0)
}

fn inputs() -> Result<(), Box<dyn Error>> {
    let list = |values: &mut dyn Iterator<Item = f64>| -> String {
        let words = values.map(|v| if v.is_nan() { "NaN".to_owned() } else { v.to_string() });
        format!("[{}]", words.collect::<Vec<_>>().join(","))
    };
    let indices = indices()?;
    let outer = std::iter::repeat_n(Complex64::from(INDEX), 81);
    let all: Vec<Complex64> = outer.clone().chain(indices.into_iter().flatten()).chain(outer).collect();
    let (fine, d65) = (grid(5.0)?, illuminant("D65", &grid(1.0)?)?);
    let observer = Observer::new(&fine)?;
    let coarse = illuminant("D65", &fine)?;
    let luminous = observer.weights()[1].iter().zip(coarse.iter()).map(|(y, s)| y * s);
    let fields = [
        ("wavelengths_nm", list(&mut wavelengths()?.into_iter())),
        ("index_n", list(&mut all.iter().map(|index| index.re))),
        ("index_k", list(&mut all.iter().map(|index| index.im))),
        ("thicknesses_nm", list(&mut LAYERS.iter().map(|(_, nm)| *nm))),
        ("gaps_nm", list(&mut GAPS_NM.into_iter())),
        ("designs_nm", list(&mut designs::given())),
        ("areas", list(&mut designs::AREAS.into_iter())),
        ("angles_deg", list(&mut angles_deg())),
        ("spectra", list(&mut spectra().into_iter())),
        ("light", list(&mut d65.iter().copied())),
        ("luminous", list(&mut luminous.into_iter())),
        ("paper", list(&mut paper_white())),
        ("index", INDEX.to_string()),
        ("reflectance", SHADE.to_string()),
        ("view_deg", "8".to_owned()),
        ("alpha", "0.1".to_owned()),
        ("lamp_deg", "-45".to_owned()),
        ("lamp_radius_deg", "5".to_owned()),
    ];
    let fields = fields.map(|(name, value)| format!("\"{name}\":{value}"));
    println!("{{{}}}", fields.join(","));
    Ok(())
}
