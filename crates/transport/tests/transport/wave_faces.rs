//! Faces by waves, at several wavelengths: energy, flat faces, both solvers.

use std::cell::RefCell;
use std::collections::HashMap;

use papilio_optics::lobe::{BalancedLobe, FaceLight, FaceLobe, Gaussian, KCorrelation};
use papilio_sampling::Sampler;
use papilio_spectra::Spectrum;
use papilio_transport::{
    Base, Estimate, Interface, Layer, Medium, Reflector, Source, Stack, WaveFace, WaveLight,
};

use crate::common::{assert_unbiased, everyday, mean_and_error, mirror, replicates_of, sized, view};
use crate::layers::{beam, estimate, views};

const BINS: usize = 3;
const GLASS: f64 = 1.5;

/// The lobe of a width.
type Shape = fn(f64) -> FaceLobe;

const SHAPES: [Shape; 2] =
    [|width| FaceLobe::KCorrelation(KCorrelation { width }), |width| FaceLobe::Gaussian(Gaussian { width })];

/// A face between air and glass whose lobes scatter more and wider light at each wavelength:
/// `fractions[lobe][wavelength]`.
fn face(shape: Shape, widths: [f64; 2], fractions: [[f64; BINS]; 2]) -> Interface {
    let kinds = [
        (FaceLight::Transmitted([1.0, GLASS]), 1.0),
        (FaceLight::Reflected([1.0, GLASS]), 4.0),
        (FaceLight::Reflected([GLASS, 1.0]), 6.0),
    ];
    let lights = kinds.map(|(light, wider)| {
        let lobes = widths.iter().zip(fractions).filter(|(_, of)| of.iter().any(|one| *one > 0.0));
        let lobes =
            lobes.map(|(width, of)| (BalancedLobe::new(shape(wider * width), light), of.to_vec().into()));
        WaveLight::new(lobes.collect(), BINS)
    });
    Interface::Wave(Box::new(WaveFace::new(lights)))
}

fn display(interface: Interface, base: Base) -> Stack {
    let medium = Medium::new(vec![GLASS; BINS].into());
    Stack::general(vec![Layer::new(interface, medium)], base)
}

fn paper(reflectance: f64) -> Base {
    Base {
        reflector: Reflector::lambertian(vec![reflectance; BINS], BINS),
        inactive_absorptance: Spectrum::from_values(vec![0.0; BINS]),
    }
}

fn seen(estimate: &Estimate, source: usize, bin: usize) -> f64 {
    estimate.rho[source].via_pixel[bin] + estimate.rho[source].front[bin]
}

const COLOURED: [[f64; BINS]; 2] = [[0.2, 0.5, 0.3], [0.7, 0.1, 0.0]];

/// White paper below a face returns all diffuse light, in every direction; a face that scatters nothing is a
/// flat one.
#[test]
fn nothing_is_lost() {
    let eyes = [view(0.0), view(35.0), view(70.0)];
    for shape in SHAPES {
        let stack = display(face(shape, [0.05, 0.2], COLOURED), paper(1.0));
        for estimate in views(1, &stack, &eyes, &[Source::Diffuse]) {
            for bin in 0..BINS {
                let white = seen(&estimate, 0, bin);
                assert!((white - 1.0).abs() < 1e-4, "{white} at wavelength {bin}, {:?}", shape(1.0));
            }
        }
    }
    let sources = [Source::Diffuse, beam(-30.0, 0.0)];
    let faces = [face(SHAPES[0], [0.05, 0.2], [[1e-9; BINS], [0.0; BINS]]), Interface::Fresnel];
    let [smooth, flat] = faces.map(|face| estimate(1, &display(face, paper(0.6)), view(20.0), &sources));
    for source in 0..2 {
        let (a, b) = (seen(&smooth, source, 0), seen(&flat, source, 0));
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
}

/// Both solvers find the same light at each wavelength, above paper and above a mirror, where the lamp is
/// seen through the lobes alone.
#[test]
fn both_solvers_agree_at_each_wavelength() {
    let Base { reflector: Reflector::Specular(mut table), .. } = mirror(0.7) else { panic!("no mirror") };
    table.basis = vec![0.7; BINS].into();
    table.common = vec![0.0; BINS];
    let above_mirror = Base {
        reflector: Reflector::Specular(table),
        inactive_absorptance: Spectrum::from_values(vec![0.0; BINS]),
    };
    let sources = [Source::Diffuse, beam(-25.0, 0.0)];
    let cases = [
        ("paper", paper(0.6), SHAPES[0]),
        ("mirror below Gaussian lobes", above_mirror.clone(), SHAPES[1]),
        ("mirror", above_mirror, SHAPES[0]),
    ];
    for (name, base, shape) in everyday(2, cases) {
        let stack = display(face(shape, [0.08, 0.25], COLOURED), base);
        let truth = estimate(2, &stack, view(12.0), &sources);
        let runs = RefCell::new(HashMap::<u64, Vec<Estimate>>::new());
        for source in 0..2 {
            for bin in 0..BINS {
                let what = format!("{name}, source {source}, wavelength {bin}");
                assert_unbiased(&what, seen(&truth, source, bin), 0.1, |seed| {
                    let mut runs = runs.borrow_mut();
                    let estimates = runs.entry(seed).or_insert_with(|| {
                        replicates_of(&stack, view(12.0), &sources, seed, sized(64, 250), Sampler::Sobol)
                    });
                    mean_and_error(estimates.iter().map(|estimate| seen(estimate, source, bin)))
                });
            }
        }
    }
}
