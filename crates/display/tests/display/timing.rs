//! Temporary.
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use crate::common::scenario;
use papilio_display::scene::{Metric, Pixel, Thickness};
use papilio_display::{Control, Designs, Quantity};
#[test]
fn timing() {
    if std::env::var_os("TIMING").is_none() { return; }
    let scene = scenario("indoor", &[]).unwrap().scene;
    let Pixel::Film(film) = scene.display.pixel.clone() else { unreachable!() };
    let mut all = vec![Quantity::Metric { view: 0, state: None, metric: Metric::gamut_percent_srgb }, Quantity::Metric { view: 0, state: None, metric: Metric::contrast_ratio }];
    for state in &film.states {
        let of = |metric| Quantity::Metric { view: 0, state: Some(state.name.clone()), metric };
        all.extend([Metric::X, Metric::Y, Metric::Z, Metric::L_star, Metric::a_star, Metric::b_star].map(of));
    }
    let stop = AtomicBool::new(false);
    let t0 = Instant::now();
    let mut designs = Designs::new(&scene, &all, &Control { threads: Some(1), progress: &|_| {}, stop: &stop }).unwrap();
    eprintln!("new {:.1} ms", t0.elapsed().as_secs_f64() * 1e3);
    let count: usize = std::env::var("TIMING").unwrap().parse().unwrap();
    for _ in 0..3 {
        let mut each: Vec<f64> = Vec::new();
        for times in 0..count {
            let mut film = film.clone();
            for layer in &mut film.layers {
                if let Thickness::Fixed(nm) = &mut layer.thickness { *nm *= 1.0 + 1e-6 * times as f64; }
            }
            film.sub_pixels.iter_mut().for_each(|s| s.gap_nm += 1e-4 * times as f64);
            film.dark_gap_nm = film.dark_gap_nm.map(|nm| nm + 1e-4 * times as f64);
            let t = Instant::now();
            designs.evaluate(&film).unwrap();
            each.push(t.elapsed().as_secs_f64() * 1e3);
        }
        each.sort_by(f64::total_cmp);
        eprintln!("min {:.3} median {:.3} ms", each[0], each[count / 2]);
    }
}
