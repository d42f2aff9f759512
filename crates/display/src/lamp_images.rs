//! Mirror images of round lamps in the faces of a display and in its pixels, in X, Y and Z.
//!
//! A lamp with `radius_deg` has an image with sharp borders. Pictures draw it at its place, and compute all
//! other light, which changes slowly with the direction, in few directions.

use papilio_spectra::sum_of_products;
use papilio_transport::{Cone, ReflectanceFactor, Source, disc_image, specular_image_of};

use crate::meter::Meter;
use crate::setup::Setup;

/// The image of one lamp: X, Y and Z relative to a perfect white in all light.
pub(crate) struct LampXyz {
    /// Number among the directed lights.
    pub(crate) light: usize,
    /// Reflected above the pixel.
    pub(crate) front: [f64; 3],
    /// Reflected by the pixel, for each state.
    pub(crate) pixel: Vec<[f64; 3]>,
}

/// Images of the lamps in the first view: those of which the view sees something.
pub(crate) fn in_view(setup: &Setup) -> Vec<LampXyz> {
    let Some(view) = setup.views.first() else { return Vec::new() };
    let images =
        discs(setup).map(|(light, disc)| (light, disc_image(&setup.stack, &view.field, (1 + light, disc))));
    let seen =
        |image: &ReflectanceFactor| image.front.iter().chain(&image.via_pixel).any(|part| *part != 0.0);
    images.filter(|(_, image)| seen(image)).map(|(light, image)| xyz(setup, light, &image)).collect()
}

/// Images of the lamps for a view that sees nothing else than the image of one; where nothing mirrors, all
/// are 0.
pub(crate) fn whole(setup: &Setup) -> Vec<LampXyz> {
    let of_disc = |(light, disc): (usize, &Cone)| {
        let mut image = specular_image_of(&setup.stack, 1 + light, &setup.sources[1 + light]);
        // Reflectance factor of a perfect mirror: its luminance over that of a perfect white.
        let factor = std::f64::consts::PI / disc.projected_solid_angle();
        image.front.iter_mut().chain(&mut image.via_pixel).for_each(|part| *part *= factor);
        xyz(setup, light, &image)
    };
    discs(setup).map(of_disc).collect()
}

fn discs(setup: &Setup) -> impl Iterator<Item = (usize, &Cone)> {
    let directed = setup.sources[1..].iter().take(setup.scene.lighting.directed.len());
    directed.enumerate().filter_map(|(light, source)| match source {
        Source::Disc(disc) => Some((light, disc)),
        _ => None,
    })
}

fn xyz(setup: &Setup, light: usize, image: &ReflectanceFactor) -> LampXyz {
    let meter = Meter::new(setup);
    let [x, y, z] = meter.weights(1 + light);
    let of = |reflected: &[f64]| [x, y, z].map(|weights| sum_of_products(reflected, weights));
    let pixel = match setup.scene.display.filter() {
        // Lambertian pixels have no image; a display with a filter has other states than its pixel.
        Some(_) => vec![[0.0; 3]; setup.states.len()],
        None => image.via_pixel.rows().map(of).collect(),
    };
    LampXyz { light, front: of(&image.front), pixel }
}
