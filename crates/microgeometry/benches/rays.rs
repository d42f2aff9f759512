//! Rays through surfaces: a replicate of a measurement, at two inclinations from each side and in all bands
//! of the kernel.

#![allow(missing_docs, reason = "a benchmark")]

use papilio_microgeometry::{
    Caps, Coating, Goniometer, HeightMap, Lattice, RandomHeights, Spectrum, Surface,
};

fn main() {
    divan::main();
}

/// Rays of each inclination and band: so many that the preparation of the surface hardly counts.
const RAYS: u64 = 4096;

fn replicate(bencher: divan::Bencher<'_, '_>, surface: &Surface) {
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: 1.5,
        coating: Coating::None,
        incidence_deg: vec![0.0, 60.0],
        azimuths: None,
        rays: RAYS,
        seed: 1,
    };
    let one = goniometer.replicate(surface, 0, &|| false).map(|one| one.rays()).unwrap_or_default();
    bencher
        .counter(divan::counter::ItemsCount::new(one))
        .bench(|| goniometer.replicate(surface, 0, &|| false).is_ok());
}

#[divan::bench(sample_count = 10)]
fn hemispheres(bencher: divan::Bencher<'_, '_>) {
    let caps = Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice: Lattice::Square };
    replicate(bencher, &Surface::Caps(caps));
}

/// A map of 1024 x 1024 heights in memory.
#[divan::bench(sample_count = 10)]
fn height_map(bencher: divan::Bencher<'_, '_>) {
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 0.5, correlation_um: 10.0 }, 1);
    let map = face.and_then(|face| face.realisation(0)).map(|map| {
        let side: Vec<f64> =
            (0..1024 * 1024).map(|at| map.heights_um()[at / 1024 % 256 * 256 + at % 1024 % 256]).collect();
        HeightMap::new(1024, map.pitch_um(), side)
    });
    if let Ok(Ok(map)) = map {
        replicate(bencher, &Surface::Heights(map));
    }
}
