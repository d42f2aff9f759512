//! Tests of the absorptance of each layer of a film pixel.

use crate::common::scenario;
use papilio_display::pixel::{PixelAbsorption, absorption, primaries, scan};
use papilio_display::scene::{AngleMedium, Scene};
use papilio_display::{DisplayError, pixel};

const THETA_DEG: [f64; 4] = [0.0, 30.0, 60.0, 90.0];

fn scene(name: &str, overrides: &[&str]) -> Scene {
    scenario(name, &[&["spectrum.step_nm=20"], overrides].concat()).unwrap().scene
}

/// Returns the sum over layers and substrate for each angle and wavelength.
fn sums(all: &PixelAbsorption, absorptance: &[f64]) -> Vec<f64> {
    let points = all.theta_deg.len() * all.wavelength_nm.len();
    (0..points).map(|k| absorptance.iter().skip(k).step_by(points).sum()).collect()
}

/// Absorptances are Poynting fluxes of one implementation, reflectances are those of the other.
#[test]
fn layers_and_substrate_sum_to_one_minus_reflectance() {
    for medium in [AngleMedium::Air, AngleMedium::Glass] {
        // Half-driven, analogue, and the default states; glass with dispersion in air.
        let states = "display.pixel.states={ half = { red = 0.5 }, set = { green = { gap_nm = 300 } } }";
        let index =
            if medium == AngleMedium::Air { "display.glass.index=BK7" } else { "display.glass.index=1.6" };
        let mut scene = scene("indoor", &[states, index]);
        scene.solver.angle_medium = medium;
        let all = absorption(&scene, &THETA_DEG).unwrap();
        assert_eq!((all.layers.len(), all.sub_pixels.len()), (6, 30));
        for one in &all.sub_pixels {
            for (sum, reflectance) in sums(&all, &one.absorptance).iter().zip(&one.reflectance) {
                assert!((sum + reflectance - 1.0).abs() < 1e-12, "{}: {sum} {reflectance}", one.state);
            }
            assert!(one.absorptance.iter().all(|fraction| *fraction >= -1e-14));
        }
    }
}

/// The areas of the sub-pixels and the inactive rest give the states of `papilio pixel`.
#[test]
fn areas_of_the_sub_pixels_give_the_reflectance_of_the_states() {
    let scene = scene("indoor", &["display.pixel.inactive_reflectance=0.1"]);
    let all = absorption(&scene, &THETA_DEG).unwrap();
    let states = scan(&scene, &THETA_DEG).unwrap().states;
    for (name, reflectance) in &states {
        let parts = || all.sub_pixels.iter().filter(|one| one.state == *name);
        let inactive = 1.0 - parts().map(|one| one.area).sum::<f64>();
        for (k, whole) in reflectance.iter().enumerate() {
            let sum: f64 = parts().map(|one| one.area * one.reflectance[k]).sum();
            assert!((sum + 0.1 * inactive - whole).abs() < 1e-12, "{name}");
        }
    }
}

/// The absorber takes most of the light of a dark sub-pixel, and clear layers none.
#[test]
fn absorbing_layers_are_chromium_and_aluminium() {
    let all = absorption(&scene("indoor", &[]), &[0.0]).unwrap();
    let materials: Vec<&str> = all.layers.iter().map(|layer| layer.material.as_str()).collect();
    assert_eq!(materials, ["Si3N4", "Cr:Johnson", "SiO2", "AlOx", "air", "Al"]);
    assert_eq!((all.layers[1].number, all.layers[5].number), (Some(1), None));
    let bins = all.wavelength_nm.len();
    let black = all.sub_pixels.iter().find(|one| one.state == "black").unwrap();
    let at_560 = |layer: usize| black.absorptance[layer * bins + 9];
    assert_eq!(all.wavelength_nm[9], 560.0);
    assert!(at_560(1) > 0.95 && at_560(5) > 0.005, "{} {}", at_560(1), at_560(5));
    assert!([2, 4].into_iter().all(|layer| at_560(layer) == 0.0));
}

/// Materials without a name are named by their index.
#[test]
fn given_indices_name_the_layer() {
    let film = "display.pixel.film=[{ material = { n = 3, k = 3.3 }, thickness_nm = 10 }, { material = 1.46, thickness_nm = 40 }, \
                { material = \"air\", thickness_nm = \"gap\" }]";
    let all = absorption(&scene("indoor", &[film]), &[0.0]).unwrap();
    assert_eq!(all.layers[0].material, "n = 3 + 3.3i");
    assert_eq!(all.layers[1].material, "n = 1.46");
}

#[test]
fn pixel_without_film_has_no_absorbing_layers() {
    for name in ["epaper", "table-pixel"] {
        assert_eq!(absorption(&scene(name, &[]), &[0.0]), Err(DisplayError::AbsorptionWithoutFilm));
    }
}

/// Only states that drive one sub-pixel have a peak that describes the pixel.
#[test]
fn primaries_are_the_states_that_drive_one_sub_pixel() {
    let of = |name: &str, overrides: &[&str]| primaries(&scene(name, overrides).display.pixel);
    assert_eq!(of("indoor", &[]), ["red", "green", "blue"]);
    let states = "display.pixel.states={ half = { red = 0.5 }, both = { red = 1, blue = { gap_nm = 150 } }, \
                  set = { green = { gap_nm = 300 } }, off = { green = { gap_nm = 20 } } }";
    assert_eq!(of("indoor", &[states]), ["red", "green", "blue", "half", "set"]);
    assert_eq!(of("epaper", &[]), Vec::<String>::new());
    assert_eq!(of("table-pixel", &[]), ["red"]);
    assert!(pixel::is_mixture("cyan") && !pixel::is_mixture("red"));
}
