//! The code that docs/adding.md and docs/designs.md show: the pages have these lines.

use std::sync::atomic::AtomicBool;

use papilio_display::scene::{Metric, Pixel};
use papilio_display::{Control, Designs, DisplayError, Parameter, Prepared, Quantity};

use crate::common::{run, scenario};

/// `papilio_display::Prepared`.
#[test]
fn prepared_display_of_the_page_equals_runs() -> Result<(), DisplayError> {
    let mut scene = scenario("indoor", &["spectrum.step_nm=20"]).unwrap().scene;
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let alone = run(&scene)?;
    let mut prepared = Prepared::new(&scene, &control)?;
    let first = prepared.run(&scene, &control)?;
    scene.viewer.theta_deg = vec![20.0];
    let second = prepared.run(&scene, &control)?; // computes only what depends on the view
    assert_eq!(format!("{first:?}"), format!("{alone:?}"));
    assert_eq!(format!("{second:?}"), format!("{:?}", run(&scene)?));
    Ok(())
}

/// `papilio_display::Designs`.
#[test]
fn design_of_the_page_has_a_value_and_its_gradient() -> Result<(), DisplayError> {
    let scene = scenario("indoor", &["spectrum.step_nm=20"]).unwrap().scene;
    let Pixel::Film(film) = scene.display.pixel.clone() else { panic!("a film") };
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let quantities = [Quantity::Metric { view: 0, state: None, metric: Metric::gamut_percent_srgb }];
    let mut designs = Designs::new(&scene, &quantities, &control)?;
    let gamut = designs.evaluate(&film)?[0];
    let gradient = designs.derivatives(&film, &[Parameter::Thickness { layer: 1 }, Parameter::DarkGap])?;
    assert!(gamut.is_some_and(|gamut| (gamut - 28.1).abs() < 1.0), "{gamut:?}");
    assert_eq!(gradient.values, [gamut]);
    assert!(gradient.gradients.len() == 2 && gradient.gradients.iter().all(|slope| slope.is_finite()));
    Ok(())
}
