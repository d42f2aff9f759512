//! Two independent methods: transfer matrices by the exponential of Berreman's matrix in this file, and
//! the table of PyPI `pyElli` 0.23.1 (`validation/films/berreman_oracle.py`).

use num_complex::Complex64;
use papilio_optics::berreman::{
    AnisotropicLayer, Dielectric, Director, Jones, Stack, Wave, direction, jones, slices,
};
use papilio_testing::{Dice, laws, sized};

use super::{any_case, layer};

type Matrix = [[Complex64; 4]; 4];

const TABLE: &str = include_str!("../../../../../validation/films/berreman.csv");

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let element = |i: usize, k: usize| (0..4).map(|j| a[i][j] * b[j][k]).sum();
    std::array::from_fn(|i| std::array::from_fn(|k| element(i, k)))
}

fn unit() -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| f64::from(i == k).into()))
}

/// Exponential by scaling, Taylor's series and squaring.
fn exponential(matrix: &Matrix) -> Matrix {
    let scaled = matrix.map(|row| row.map(|value| value / 1024.0));
    let (mut sum, mut term) = (unit(), unit());
    for k in 1..20 {
        term = product(&term, &scaled).map(|row| row.map(|value| value / f64::from(k)));
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    (0..10).fold(sum, |power, _| product(&power, &power))
}

/// Maxwell's curl equations for (Ex, Ey, Hx, Hy), with Ez and Hz eliminated, for a wave with the tangential vector (bx, by) in the
/// frame x, y of the panel reflected in y, z down. Not turned into the plane of incidence, unlike the crate's.
fn generator(e: &[[Complex64; 3]; 3], [bx, by]: [f64; 2]) -> Matrix {
    // z down and y reflected: elements with one of y, z change sign... both: y -> -y, z -> -z.
    let sign = [1.0, -1.0, -1.0];
    let e = |i: usize, k: usize| e[i][k] * (sign[i] * sign[k]);
    let zz = e(2, 2);
    // Ez = -(e31 Ex + e32 Ey + bx Hy - by Hx)/e33 and Hz = bx Ey - by Ex.
    let ez = [-e(2, 0) / zz, -e(2, 1) / zz, by / zz, -bx / zz];
    let hz: [Complex64; 4] = [(-by).into(), bx.into(), 0.0.into(), 0.0.into()];
    let row =
        |own: [Complex64; 4], factor: f64, z: [Complex64; 4]| std::array::from_fn(|k| own[k] + factor * z[k]);
    let none = Complex64::ZERO;
    let one = Complex64::ONE;
    let with_ez = |i: usize, k: usize| if k < 2 { e(i, k) } else { none } + e(i, 2) * ez[k];
    // dz Ex = i k0 (Hy + bx Ez); dz Ey = i k0 (-Hx + by Ez); dz Hx = i k0 (bx Hz - Dy); dz Hy = i k0 (by Hz + Dx).
    [
        row([none, none, none, one], bx, ez),
        row([none, none, -one, none], by, ez),
        row(std::array::from_fn(|k| -with_ez(1, k)), bx, hz),
        row(std::array::from_fn(|k| with_ez(0, k)), by, hz),
    ]
}

/// Fields (Ex, Ey, Hx, Hy) of p and s that travel down (`sign` 1) or up (-1).
fn waves(index: Complex64, beta: f64, azimuth: f64, sign: f64) -> [[Complex64; 4]; 2] {
    let mut q = (index * index - beta * beta).sqrt();
    if q.im < 0.0 {
        q = -q;
    }
    let q = sign * q;
    // The travel along the panel in the reflected frame, and s across it.
    let (x, y) = (azimuth.cos(), -azimuth.sin());
    let p = [q / index * x, q / index * y, -index * y, index * x];
    let s = [(-y).into(), x.into(), -q * x, -q * y];
    [p, s]
}

/// Reflection and transmission from the transfer matrix.
fn by_transfer(stack: &Stack, rows: &[[[Complex64; 3]; 3]], wave: Wave) -> [Jones; 2] {
    let azimuth = wave.azimuth_deg.to_radians();
    let tangent = [wave.beta * azimuth.cos(), -wave.beta * azimuth.sin()];
    let k0 = 2.0 * std::f64::consts::PI / wave.wavelength_nm;
    let mut fields = waves(stack.back, wave.beta, azimuth, 1.0);
    for (layer, tensor) in stack.layers.iter().zip(rows).rev() {
        let factor = -Complex64::I * k0 * layer.thickness_nm;
        let up = exponential(&generator(tensor, tangent).map(|row| row.map(|value| value * factor)));
        fields = fields.map(|field| std::array::from_fn(|i| (0..4).map(|k| up[i][k] * field[k]).sum()));
    }
    let [down, up] = [1.0, -1.0].map(|sign| waves(stack.front.into(), wave.beta, azimuth, sign));
    // Amplitudes above: E along p and s, H along s and p, of waves of one index are independent.
    let dot = |field: &[Complex64; 4], to: [f64; 4]| -> Complex64 { (0..4).map(|k| field[k] * to[k]).sum() };
    let (x, y) = (azimuth.cos(), -azimuth.sin());
    let (along_p, along_s) = ([x, y, 0.0, 0.0], [-y, x, 0.0, 0.0]);
    let (h_p, h_s) = ([0.0, 0.0, -y, x], [0.0, 0.0, x, y]);
    let amplitudes = |field: &[Complex64; 4]| {
        let p = [dot(field, along_p) / dot(&down[0], along_p), dot(field, h_p) / dot(&down[0], h_p)];
        let s = [dot(field, along_s), dot(field, h_s) / dot(&down[1], h_s)];
        // p: E of the wave up is opposite, H equal; s: E equal, H opposite.
        [[(p[1] + p[0]) / 2.0, (s[0] + s[1]) / 2.0], [(p[1] - p[0]) / 2.0, (s[0] - s[1]) / 2.0]]
    };
    assert!((dot(&up[0], along_p) + dot(&down[0], along_p)).norm() < 1e-12);
    let [a, b] = fields.each_ref().map(amplitudes);
    // Columns of (incident) and (reflected) for each wave transmitted.
    let determinant = a[0][0] * b[0][1] - b[0][0] * a[0][1];
    let t =
        [[b[0][1] / determinant, -b[0][0] / determinant], [-a[0][1] / determinant, a[0][0] / determinant]];
    let r = std::array::from_fn(|i| std::array::from_fn(|k| a[1][i] * t[0][k] + b[1][i] * t[1][k]));
    [r, t]
}

fn worst(found: [Jones; 2], expected: [Jones; 2]) -> f64 {
    let pairs = found.iter().flatten().flatten().zip(expected.iter().flatten().flatten());
    pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Where no wave decays much, which is where transfer matrices keep their digits.
#[test]
fn scattering_matrices_equal_matrix_exponentials() {
    let case = |dice: &mut Dice| {
        let (mut stack, mut wave) = any_case(dice, 0.2);
        wave.beta *= 0.5;
        stack.layers.iter_mut().for_each(|layer| layer.thickness_nm *= 0.3);
        let tensors: Vec<[[Complex64; 3]; 3]> =
            stack.layers.iter().map(|layer| layer.dielectric.rows()).collect();
        (stack, tensors, wave)
    };
    laws(sized(60, 500), case, |(stack, tensors, wave)| {
        let found = jones(stack, *wave).unwrap();
        let difference = worst([found.r, found.t], by_transfer(stack, tensors, *wave));
        assert!(difference < 1e-9, "{difference:e}");
    });
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

/// Layers of one cell of the table: `tensor:thickness:re:im:...` or `helix:n_o:n_e:azimuth:tilt:twist:slices:thickness`.
fn layers(text: &str) -> Vec<AnisotropicLayer> {
    let (kind, rest) = text.split_once(':').unwrap();
    let n: Vec<f64> = rest.split(':').map(number).collect();
    if kind == "helix" {
        let director = |depth: f64| Director { azimuth_deg: n[2] + n[4] * depth, tilt_deg: n[3] };
        return slices([n[0].into(), n[1].into()], n[6], n[5] as usize, director).unwrap();
    }
    let element = |k: usize| Complex64::new(n[1 + 2 * k], n[2 + 2 * k]);
    let [xx, yy, zz, xy, xz, yz] = std::array::from_fn(element);
    vec![layer(Dielectric::of_rows([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), n[0])]
}

#[test]
fn amplitudes_equal_py_elli() {
    let mut count = 0;
    for (at, line) in TABLE.lines().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let n = |k: usize| number(cells[k]);
        let stack = Stack {
            front: n(4),
            layers: cells[7].split(' ').flat_map(layers).collect(),
            back: Complex64::new(n(5), n(6)),
        };
        let wave = Wave { wavelength_nm: n(1), beta: n(2), azimuth_deg: n(3) };
        let matrix = |first: usize| -> Jones {
            std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    let at = first + 4 * i + 2 * k;
                    Complex64::new(n(at), n(at + 1))
                })
            })
        };
        let found = jones(&stack, wave).unwrap();
        let difference = worst([found.r, found.t], [matrix(8), matrix(16)]);
        assert!(difference < 1e-9, "row {} ({}): {difference:e}", at + 2, cells[0]);
        count += 1;
    }
    assert_eq!(count, 300);
    assert_eq!(direction(0.0, 0.0), [1.0, 0.0, 0.0]);
}
