//! Designs through a kept kernel: the numbers of a run, in any order.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]

use std::sync::atomic::AtomicBool;

use papilio_colour::{Lab, UvPrime};
use papilio_display::scene::{FilmPixel, Method, Metric, Pixel, Scene, Stop, Thickness};
use papilio_display::{Control, Designs, DisplayError, Prepared, Quantity};
use papilio_sampling::{Numbers, Sampler};
use papilio_spectra::Spectrum;
use papilio_validation::scenario;

/// Displays of every kind that designs go through, on few wavelengths. The target is so wide that two levels are enough
/// for any design: a run then reports the level that designs are computed at.
fn scenes() -> Vec<(&'static str, Scene)> {
    let scene = |name: &str, overrides: &[&str]| {
        let overrides = [&["spectrum.step_nm=20", "metrics.gamut_volume=true"], overrides].concat();
        let mut scene = scenario(name, &overrides).unwrap().scene;
        scene.solver.method = Method::Adding;
        scene.solver.stop = Stop::RelativeError { target: 0.9, every_bin: false };
        scene
    };
    vec![
        ("diffuser and front", scene("indoor", &[])),
        ("a mirror for a front", scene("indoor", &["display.front.0.reflectance=0.3"])),
        (
            "straight light",
            scene("indoor", &["display.diffuser.straight_through=0.1", "lighting.directed.0.radius_deg=2"]),
        ),
        ("a narrow lobe", scene("indoor", &["display.diffuser.haze=0.3"])),
        ("dispersive glass", scene("indoor", &["display.glass.index=BK7"])),
        ("two views", scene("indoor", &["viewer.theta_deg=[8, 40]"])),
        ("bare", scene("reference-pixel", &[])),
        ("front light", scene("front-light", &[])),
        ("any layers", scene("slab", &[])),
    ]
}

fn film(scene: &Scene) -> &FilmPixel {
    match &scene.display.pixel {
        Pixel::Film(film) => film,
        other => panic!("no film: {other:?}"),
    }
}

/// Layers, gaps and shares moved at random: thicknesses by up to a third, one layer gone, gaps by up to 30 nm.
fn moved(film: &FilmPixel, number: u64) -> FilmPixel {
    let numbers = Numbers::new(Sampler::Random, 8, 0);
    let mut thrown = 0;
    let mut random = || {
        thrown += 1;
        2.0 * numbers.block(number, thrown)[0] - 1.0
    };
    let mut moved = film.clone();
    for (k, layer) in moved.layers.iter_mut().enumerate() {
        if let Thickness::Fixed(nm) = &mut layer.thickness {
            *nm *= if k as u64 == number { 0.0 } else { 1.0 + random() / 3.0 };
        }
    }
    moved.sub_pixels.iter_mut().for_each(|sub_pixel| sub_pixel.gap_nm += 30.0 * random());
    moved.dark_gap_nm = moved.dark_gap_nm.map(|nm| nm + 15.0 * random());
    moved.fill_factor *= 0.95 + 0.05 * random();
    moved
}

/// Every metric of every state in every view, and distances from made-up wants.
fn everything(scene: &Scene) -> Vec<Quantity> {
    let views = scene.viewer.theta_deg.len();
    let mut all = Vec::new();
    for view in 0..views {
        let together = Metric::ALL.iter().filter(|metric| metric.is_of_view());
        all.extend(together.map(|&metric| Quantity::Metric { view, state: None, metric }));
        for state in &film(scene).states {
            let state = state.name.clone();
            let own = Metric::ALL.iter().filter(|metric| !metric.is_of_view());
            all.extend(own.map(|&metric| Quantity::Metric { view, state: Some(state.clone()), metric }));
            let wanted = Spectrum::constant(&scene.grid, 0.3);
            all.push(Quantity::SpectrumDistance { view, state: state.clone(), wanted });
            let wanted = Lab { l: 50.0, a: 10.0, b: -20.0 };
            all.push(Quantity::ColourDistance { view, state: state.clone(), wanted });
            all.push(Quantity::ChromaticityDistance { view, state, wanted: UvPrime { u: 0.2, v: 0.47 } });
        }
    }
    all
}

fn control(stop: &AtomicBool) -> Control<'_> {
    Control { threads: Some(1), progress: &|_| {}, stop }
}

fn designs(scene: &Scene, quantities: &[Quantity]) -> Designs {
    Designs::new(scene, quantities, &control(&AtomicBool::new(false))).unwrap()
}

/// Peaks of spectra that are flat within their errors, which a run forgets, are the one thing that differs.
#[test]
fn a_design_is_what_a_run_reports() {
    for (name, scene) in scenes() {
        let quantities = everything(&scene);
        let mut designs = designs(&scene, &quantities);
        let mut prepared = Prepared::new(&scene).unwrap();
        for number in 0..6 {
            let mut other = scene.clone();
            let film = moved(film(&scene), number);
            other.display.pixel = Pixel::Film(film.clone());
            let result = prepared.run(&other, &control(&AtomicBool::new(false))).unwrap();
            let found = designs.evaluate(&film).unwrap();
            let mut defined = 0;
            for (quantity, found) in quantities.iter().zip(found) {
                let expected = quantity.of(&result);
                let is_peak = format!("{quantity:?}").contains("peak");
                if expected.is_some() || !is_peak {
                    assert_eq!(found, expected, "{name}, design {number}: {quantity:?}");
                }
                defined += usize::from(expected.is_some());
            }
            assert!(defined > quantities.len() / 3, "{name}: {defined} of {}", quantities.len());
        }
    }
}

#[test]
fn the_order_of_designs_changes_nothing() {
    for (name, scene) in scenes() {
        let quantities = everything(&scene);
        let films: Vec<FilmPixel> = (0..8).map(|number| moved(film(&scene), number)).collect();
        let mut first = designs(&scene, &quantities);
        let forwards: Vec<_> = films.iter().map(|film| first.evaluate(film).unwrap()).collect();
        let mut second = designs(&scene, &quantities);
        for number in [5, 0, 7, 2, 2, 6, 1, 4, 3] {
            assert_eq!(second.evaluate(&films[number]).unwrap(), forwards[number], "{name}, design {number}");
        }
        assert_eq!(second.clone().evaluate(&films[3]).unwrap(), forwards[3], "{name}: a clone");
    }
}

#[test]
fn what_is_no_design_is_refused() {
    let scene = &scenes()[0].1;
    let stop = AtomicBool::new(false);
    let refused = |scene: &Scene, quantity: Quantity| Designs::new(scene, &[quantity], &control(&stop)).err();
    let white =
        |view, state: &str| Quantity::Metric { view, state: Some(state.to_owned()), metric: Metric::Y };
    let missing = |what: &str| Some(DisplayError::NoSuchQuantity { what: what.to_owned(), quantity: "Y" });
    assert_eq!(refused(scene, white(1, "white")), missing("view 1"));
    assert_eq!(refused(scene, white(0, "pink")), missing("state `pink`"));
    let stateless = Quantity::Metric { view: 0, state: None, metric: Metric::Y };
    assert_eq!(refused(scene, stateless), missing("state given"));
    let mut walk = scene.clone();
    walk.solver.method = Method::Walk;
    assert_eq!(refused(&walk, white(0, "white")), Some(DisplayError::NotByAdding));
    let paint = scenario("slab", &["display.pixel.model=uniform"]);
    assert!(paint.is_err());
    let mut fewer = film(scene).clone();
    fewer.states.pop();
    assert_eq!(designs(scene, &[white(0, "white")]).evaluate(&fewer), Err(DisplayError::OtherStates));
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(refused(scene, white(0, "white")), Some(DisplayError::Interrupted));
}
