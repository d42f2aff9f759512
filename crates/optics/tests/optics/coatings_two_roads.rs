//! Tabulated coatings compared with the reference implementation, closed forms and laws.

use num_complex::Complex64;
use papilio_optics::OpticsError;
use papilio_optics::film::{Coating, Film, Layer, Polarisation, SpectralLayer, Thickness, coherent};
use papilio_optics::interface::fresnel_reflectance;
use papilio_sampling::{SampleStream, Sampler};

const NM: f64 = 550.0;

fn spectral(layers: &[Layer]) -> Vec<SpectralLayer> {
    let one = |layer: &Layer| SpectralLayer {
        index: vec![layer.index],
        thickness: Thickness::Fixed(layer.thickness_nm),
    };
    layers.iter().map(one).collect()
}

fn layer(n: f64, k: f64, thickness_nm: f64) -> Layer {
    Layer { index: Complex64::new(n, k), thickness_nm }
}

/// The mean of s and p, and each of them.
const LIGHTS: [Option<Polarisation>; 3] = [None, Some(Polarisation::S), Some(Polarisation::P)];

fn coating(above: f64, layers: &[Layer], below: f64) -> Coating {
    Coating::new(&[NM], &[above], &spectral(layers), &[below]).unwrap()
}

/// Transmittance and reflectance by the reference implementation.
fn plain(
    light: Option<Polarisation>,
    (incidence, layers, substrate): (f64, Vec<Layer>, f64),
    beta: f64,
) -> [f64; 2] {
    let film = Film { incidence, layers, substrate: substrate.into() };
    let [s, p] = [Polarisation::S, Polarisation::P]
        .map(|polarisation| coherent(&film, NM, beta, polarisation).unwrap());
    match light {
        None => [0.5 * (s.transmittance + p.transmittance), 0.5 * (s.reflectance + p.reflectance)],
        Some(Polarisation::S) => [s.transmittance, s.reflectance],
        Some(Polarisation::P) => [p.transmittance, p.reflectance],
    }
}

/// Returns the largest difference from the reference implementation at random beta in either medium; asserts
/// R + T <= 1.
fn worst_difference(above: f64, layers: &[Layer], below: f64, stream: u64) -> f64 {
    let of = |light| worst_difference_of(light, above, layers, below, stream);
    LIGHTS.map(of).into_iter().fold(0.0, f64::max)
}

fn worst_difference_of(
    light: Option<Polarisation>,
    above: f64,
    layers: &[Layer],
    below: f64,
    stream: u64,
) -> f64 {
    let table = match light {
        None => coating(above, layers, below),
        Some(one) => Coating::of(one, &[NM], &[above], &spectral(layers), &[below]).unwrap(),
    };
    let upside_down: Vec<Layer> = layers.iter().rev().copied().collect();
    let numbers = SampleStream::new(Sampler::Random, 5, stream);
    let mut worst = 0.0_f64;
    for path in 0..2000 {
        // Half of them are close to grazing, where square roots begin.
        let u = numbers.block(path, 0);
        let beta = above.max(below) * if path % 2 == 0 { u[0] } else { 1.0 - 1e-3 * u[0] * u[0] };
        let part = table.part(beta * beta, 0);
        let smaller = above.min(below);
        let beta_low = smaller * beta / above.max(below);
        for beta in [beta, beta_low] {
            let part = if beta == beta_low { table.part(beta * beta, 0) } else { part };
            let mut expected = [0.0; 3];
            if beta < above {
                [expected[0], expected[1]] = plain(light, (above, layers.to_vec(), below), beta);
            }
            if beta < below {
                let [t, r] = plain(light, (below, upside_down.clone(), above), beta);
                assert!(beta >= above || (t - expected[0]).abs() < 1e-9, "reciprocity at {beta}");
                (expected[0], expected[2]) = (t, r);
            }
            let found = [part.transmittance, part.above, part.below];
            assert!(found[0] + found[1].max(found[2]) <= 1.0 + 1e-15, "{beta}: {part:?}");
            worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
        }
    }
    worst
}

/// Twice the tolerance midway between the nodes.
const TOLERANCE: f64 = 2e-9;

#[test]
fn tables_equal_reference() {
    let quarter = NM / (4.0 * 1.38);
    let stacks: [(f64, Vec<Layer>, f64); 9] = [
        (1.0, vec![layer(1.38, 0.0, quarter)], 1.52),
        (1.5, vec![layer(1.38, 0.0, quarter)], 1.0),
        (1.5, vec![layer(1.0, 0.0, 300.0)], 1.5),
        (1.5, vec![layer(1.0, 0.0, 5000.0)], 1.6),
        (
            1.0,
            vec![
                layer(2.35, 0.0, 13.0),
                layer(1.46, 0.0, 34.0),
                layer(2.35, 0.0, 115.0),
                layer(1.46, 0.0, 87.0),
            ],
            1.52,
        ),
        (1.5, vec![layer(0.06, 3.6, 40.0)], 1.0),
        (1.7, vec![layer(2.0, 0.01, 800.0), layer(1.0, 0.0, 500.0), layer(0.97, 6.4, 8.0)], 1.6),
        (1.5, vec![layer(1.45, 0.0, 20_000.0)], 1.500_001),
        (1.0, vec![layer(1.5, 0.0, 40_000.0)], 1.33),
    ];
    for (stream, (above, layers, below)) in (0..).zip(stacks) {
        let worst = worst_difference(above, &layers, below, stream);
        assert!(worst < TOLERANCE, "{above} {layers:?} {below}: {worst:e}");
    }
}

#[test]
fn random_coatings_equal_reference() {
    for stream in 0..40 {
        let numbers = SampleStream::new(Sampler::Random, 77, stream);
        let media = numbers.block(0, 0);
        let layers: Vec<Layer> = (1..=(1 + stream % 5))
            .map(|path| {
                let u = numbers.block(path, 0);
                let k = if u[3] < 0.5 { 0.0 } else { 3.0 * u[2] };
                layer(1.0 + 1.5 * u[0], k, 400.0 * u[1])
            })
            .collect();
        let worst = worst_difference(1.0 + media[0], &layers, 1.0 + media[1], 1000 + stream);
        assert!(worst < TOLERANCE, "{stream}: {worst:e}");
    }
}

/// H. A. Macleod, "Thin-Film Optical Filters", 4th ed., section 4.1: MgF2 on glass of 1.52.
#[test]
fn quarter_wave_on_glass_reflects_1_26_percent() {
    let part = coating(1.0, &[layer(1.38, 0.0, NM / (4.0 * 1.38))], 1.52).part(0.0, 0);
    let closed = ((1.52 - 1.38 * 1.38) / (1.52 + 1.38 * 1.38_f64)).powi(2);
    assert!((closed - 0.0126).abs() < 5e-5);
    assert!((part.above - closed).abs() < 1e-9 && (part.below - closed).abs() < 1e-9);
    assert!((part.transmittance - (1.0 - closed)).abs() < 1e-9);
}

#[test]
fn coating_without_layers_equals_fresnel() {
    for (above, below) in [(1.0, 1.5), (1.5, 1.0), (1.5, 1.51), (2.4, 1.0)] {
        let table = coating(above, &[], below);
        for step in 0..1000 {
            let beta = 1.1 * above.max(below) * f64::from(step) / 1000.0;
            let part = table.part(beta * beta, 0);
            let r = fresnel_reflectance(above, below, beta);
            let exists = |n: f64| if beta < n { r } else { 0.0 };
            assert!((part.above - exists(above)).abs() < 1e-8, "{above} {below} {beta}: {part:?} {r}");
            assert!((part.below - exists(below)).abs() < 1e-8, "{above} {below} {beta}: {part:?} {r}");
            assert!((part.transmittance - (1.0 - r)).abs() < 1e-8, "{above} {below} {beta}: {part:?}");
        }
    }
}

/// Frustrated total reflection, s and p, in closed form: S. Zhu et al., Am. J. Phys. 54, 601
/// (1986): 1/T = 1 + a sinh^2(k0 kappa d), with a of the like of (q^2 + kappa^2)^2/(2 q kappa)^2.
#[test]
fn light_tunnels_through_thin_air_gap() {
    let (n, gap_nm) = (1.5_f64, 120.0);
    let table = coating(n, &[layer(1.0, 0.0, gap_nm)], n);
    for beta in [1.05_f64, 1.2, 1.35, 1.45] {
        let (q, kappa) = ((n * n - beta * beta).sqrt(), (beta * beta - 1.0).sqrt());
        let sinh = (2.0 * std::f64::consts::PI / NM * kappa * gap_nm).sinh();
        let through = |q: f64| 1.0 / (1.0 + ((q * q + kappa * kappa) / (2.0 * q * kappa) * sinh).powi(2));
        let expected = 0.5 * (through(q) + through(q / (n * n)));
        let part = table.part(beta * beta, 0);
        assert!(part.transmittance > 0.02);
        assert!((part.transmittance - expected).abs() < 1e-8, "{beta}: {part:?} {expected}");
        assert!((part.above + part.transmittance - 1.0).abs() < 1e-12);
    }
}

#[test]
fn coating_uses_indices_of_each_wavelength() {
    let index = vec![1.38.into(), 1.39.into()];
    let layers = [SpectralLayer { index, thickness: Thickness::Fixed(100.0) }];
    let both = Coating::new(&[500.0, 600.0], &[1.0, 1.0], &layers, &[1.53, 1.51]).unwrap();
    let second = [SpectralLayer { index: vec![1.39.into()], thickness: Thickness::Fixed(100.0) }];
    let alone = Coating::new(&[600.0], &[1.0], &second, &[1.51]).unwrap();
    for beta_squared in [0.0, 0.5, 0.99, 1.2, 2.27, 3.0] {
        assert_eq!(both.part(beta_squared, 1), alone.part(beta_squared, 0));
    }
    assert!(both.part(1.515 * 1.515, 0).below > 0.99 && both.part(1.515 * 1.515, 1).below == 0.0);
}

#[test]
fn invalid_coatings_are_refused() {
    let new = |above: f64, layer: Layer| Coating::new(&[NM], &[above], &spectral(&[layer]), &[1.5]);
    assert!(matches!(new(0.0, layer(1.4, 0.0, 1.0)), Err(OpticsError::Incidence { .. })));
    assert!(matches!(new(1.0, layer(1.4, -1.0, 1.0)), Err(OpticsError::Index { .. })));
    assert!(matches!(new(1.0, layer(1.4, 0.0, -1.0)), Err(OpticsError::Thickness { .. })));
    assert!(matches!(new(1.0, layer(1.4, 0.0, 1e6)), Err(OpticsError::Fringes { .. })));
    let gap = SpectralLayer { index: vec![1.0.into()], thickness: Thickness::Gap };
    assert_eq!(Coating::new(&[NM], &[1.0], &[gap], &[1.5]), Err(OpticsError::CoatingGap));
    let short = Coating::new(&[NM, NM], &[1.0; 2], &spectral(&[layer(1.4, 0.0, 1.0)]), &[1.5; 2]);
    assert!(matches!(short, Err(OpticsError::Length { expected: 2, found: 1, .. })));
}

/// Metals and dielectrics (n, k near 550 nm) on substrates of every usual index: no ordinary film is refused,
/// and look-ups equal the reference, close to the horizons too.
#[test]
fn absorbing_film_on_any_substrate_is_tabulated() {
    let films = [
        Complex64::new(3.17, 3.33),
        Complex64::new(0.96, 6.7),
        Complex64::new(1.77, 3.25),
        Complex64::new(2.48, 3.35),
        Complex64::new(0.06, 3.6),
        Complex64::new(3.6, 3.6),
        Complex64::new(1.9, 0.02),
        Complex64::new(1.77, 0.0),
    ];
    let substrates =
        (26..=50).map(|index| 0.05 * f64::from(index)).chain([1.47, 1.519, 1.59, 1.72, 1.79, 1.97]);
    for below in substrates {
        for index in films {
            for thickness_nm in [2.0, 12.0, 45.0, 300.0] {
                let layer = SpectralLayer { index: vec![index], thickness: Thickness::Fixed(thickness_nm) };
                let coating = Coating::new(&[NM], &[1.0], &[layer], &[below]);
                let coating =
                    coating.unwrap_or_else(|error| panic!("{index} {thickness_nm} {below}: {error}"));
                let film = Film {
                    incidence: below,
                    layers: vec![Layer { index, thickness_nm }],
                    substrate: 1.0.into(),
                };
                for beta in
                    [0.0, 0.5, 0.9, 0.999, 0.999_999, 1.000_001, 1.001, 1.05, 0.5 + 0.5 * below, below - 1e-5]
                {
                    let of = |polarisation| coherent(&film, NM, beta, polarisation).unwrap().reflectance;
                    let exact = 0.5 * (of(Polarisation::S) + of(Polarisation::P));
                    let found = coating.part(beta * beta, 0).below;
                    assert!(
                        (found - exact).abs() < 1e-8,
                        "{index} {thickness_nm} {below} {beta}: {found} {exact}"
                    );
                }
            }
        }
    }
}

/// Single metal and ITO films on substrates from 1.3 to 2.4, from both sides and beyond the critical angle,
/// against the table that PyPI `tmm` makes (`validation/films/tmm_oracle.py`).
#[test]
fn absorbing_films_on_any_substrate_equal_tmm() {
    let table = include_str!("../../../../validation/films/coatings.csv");
    let mut rows = 0;
    for row in table.lines().skip(1) {
        let cells: Vec<f64> = row.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect();
        let [n, k, thickness_nm, below, beta, from_air, through, from_below] = cells[..] else {
            panic!("{row}")
        };
        let part = coating(1.0, &[layer(n, k, thickness_nm)], below).part(beta * beta, 0);
        let expected = [from_air, through, from_below];
        let found = [part.above, part.transmittance, part.below];
        let is_used = [beta < 1.0, beta < 1.0, true];
        for ((found, expected), is_used) in found.into_iter().zip(expected).zip(is_used) {
            assert!(!is_used || (found - expected).abs() < 1e-7, "{row}: {found} {expected}");
        }
        rows += 1;
    }
    assert_eq!(rows, 8 * 3 * 13 * 7);
}

/// Products of the amplitudes of p and s: those of the reference implementation at random directions below both indices, of which the sizes are the geometric
/// means of the powers; and the phase of total reflection at a bare face (Born and Wolf, 1.5.4) where the film is the medium above.
#[test]
fn products_of_amplitudes_equal_the_reference() {
    let films = [layer(2.1, 0.02, 140.0), layer(1.38, 0.0, 95.0)];
    for (above, below) in [(1.0, 1.52), (1.7, 1.45), (1.5, 1.5)] {
        let films = spectral(&films);
        let coating = Coating::new(&[NM], &[above], &films, &[below]).unwrap();
        let coating = coating.with_products(&[NM], &[above], &films, &[below]).unwrap();
        let random = SampleStream::new(Sampler::Random, 7, 0);
        for path in 0..200 {
            let beta = random.block(path, 0)[0] * above.min(below);
            let of = |[incidence, substrate]: [f64; 2], layers: Vec<Layer>| {
                let film = Film { incidence, layers, substrate: substrate.into() };
                [Polarisation::S, Polarisation::P].map(|one| coherent(&film, NM, beta, one).unwrap())
            };
            let down = [layer(2.1, 0.02, 140.0), layer(1.38, 0.0, 95.0)];
            let up = down.into_iter().rev().collect();
            let [s, p] = of([above, below], down.to_vec());
            let [s_up, p_up] = of([below, above], up);
            let found = coating.products(beta * beta, 0).unwrap();
            assert!((found.above - p.r * s.r.conj()).norm() < 1e-8, "{above} {beta}: {found:?}");
            assert!((found.below - p_up.r * s_up.r.conj()).norm() < 1e-8, "{above} {beta}: {found:?}");
            // The phase, and the power of both: the electric field alone is not that of the power.
            let phase = p.t * s.t.conj() / (p.t * s.t.conj()).norm();
            let expected = phase * (p.transmittance * s.transmittance).sqrt();
            assert!((found.transmitted - expected).norm() < 1e-8, "{above} {beta}: {found:?} {expected}");
        }
    }
    let films = spectral(&[layer(1.5, 0.0, 200.0)]);
    let coating = Coating::new(&[NM], &[1.5], &films, &[1.0]).unwrap();
    let coating = coating.with_products(&[NM], &[1.5], &films, &[1.0]).unwrap();
    let theta = 55.0_f64.to_radians();
    let found = coating.products((1.5 * theta.sin()).powi(2), 0).unwrap();
    let shift =
        2.0 * (theta.cos() * (theta.sin().powi(2) - 1.5_f64.powi(-2)).sqrt() / theta.sin().powi(2)).atan();
    assert!(
        (found.above.arg().abs() - shift).abs() < 1e-7 && (found.above.norm() - 1.0).abs() < 1e-7,
        "{found:?}"
    );
    assert_eq!(found.transmitted, Complex64::ZERO);
}
