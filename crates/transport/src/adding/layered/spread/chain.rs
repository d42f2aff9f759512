//! Flat elements at one `|beta|`, with the phases of the places that light crosses.
//!
//! A medium multiplies light by `exp(-2 pi i f.D(beta))`, whether it goes up or down. All inter-reflections
//! between flat elements are summed in closed form, above a black base; scatterers have their regular part. Where all
//! elements are flat, light is the mean of the sums of s and of p.

use num_complex::Complex64;

use super::super::elements::{indices, regular};
use crate::Stack;
use crate::front::Flat;
use crate::skeleton::{Propagation, Ray};

/// Smallest 1 - R of a cavity: light does not enter one of perfect mirrors.
const CLOSED: f64 = 1e-12;

/// The elements of a stack at one `|beta|` and wavelength.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// For each light: unpolarised, or s and p.
    lights: Vec<Vec<Flat>>,
    /// By how much each element moves light, mm.
    moves_mm: Vec<f64>,
    reflects: bool,
}

/// Memory for [`Chain::links`].
#[derive(Debug, Clone, Default)]
pub(super) struct Cavities {
    passed: Vec<Complex64>,
    above: Vec<Complex64>,
    below: Vec<Complex64>,
    /// Light that has passed each element, downwards and upwards, and all that is returned to it behind.
    entered: [Vec<Complex64>; 2],
    currents: [Vec<Complex64>; 2],
}

impl Chain {
    pub(super) fn new(stack: &Stack, bin: usize, beta: f64) -> Self {
        let of_each = stack.layers_of_each();
        let mut lights =
            vec![Vec::with_capacity(2 * stack.layers.len()); if of_each.is_some() { 2 } else { 1 }];
        let mut moves_mm = Vec::with_capacity(2 * stack.layers.len());
        for (number, (kind, media)) in stack.elements().enumerate() {
            let indices @ [index, _] = indices(media, bin);
            for (light, flats) in lights.iter_mut().enumerate() {
                let kind = match of_each {
                    Some(both) if number % 2 == 0 => both[light][number / 2].interface.kind(),
                    _ => kind,
                };
                flats.push(regular(kind, bin, indices, beta));
            }
            let is_medium = number % 2 == 1;
            moves_mm.push(if is_medium {
                moved_mm(index, stack.layers[number / 2].thickness_mm, beta)
            } else {
                0.0
            });
        }
        let reflects = lights.iter().flatten().any(|flat| flat.above != 0.0 || flat.below != 0.0);
        Self { lights, moves_mm, reflects }
    }

    /// Returns by how much all elements together move light, mm.
    pub(super) fn moves_mm(&self) -> f64 {
        self.moves_mm.iter().sum()
    }

    pub(super) fn reflects(&self) -> bool {
        self.reflects
    }

    /// Returns the light of a ray that arrives as another if nothing reflects: its fraction, and by how much
    /// it is moved.
    pub(super) fn link(&self, from: Ray, to: Ray) -> (f64, f64) {
        let passed = match (from.going, to.going) {
            (Propagation::Up, Propagation::Up) if to.plane <= from.plane => to.plane..from.plane,
            (Propagation::Down, Propagation::Down) if from.plane <= to.plane => from.plane..to.plane,
            _ => return (0.0, 0.0),
        };
        let of_light = |flats: &Vec<Flat>| flats[passed.clone()].iter().map(|flat| flat.t).product::<f64>();
        let t = self.lights.iter().map(of_light).sum::<f64>() / self.lights.len() as f64;
        (t, self.moves_mm[passed].iter().sum())
    }

    /// Computes the light of each ray that arrives as each other, `[from][to]`, at a wave of so many radians
    /// per mm along it.
    pub(super) fn links(
        &self,
        [from, to]: [&[Ray]; 2],
        per_mm: f64,
        cavities: &mut Cavities,
        out: &mut [Complex64],
    ) {
        if !self.reflects {
            let pairs = from.iter().flat_map(|from| to.iter().map(|to| self.link(*from, *to)));
            out.iter_mut()
                .zip(pairs)
                .for_each(|(out, (t, way))| *out = Complex64::from_polar(t, -way * per_mm));
            return;
        }
        let [first, others @ ..] = &self.lights[..] else { return };
        self.links_of(first, [from, to], per_mm, cavities, out);
        for flats in others {
            let before = out.to_vec();
            self.links_of(flats, [from, to], per_mm, cavities, out);
            out.iter_mut().zip(before).for_each(|(out, before)| *out = 0.5 * (*out + before));
        }
    }

    /// The same of one light, whose elements reflect.
    fn links_of(
        &self,
        flats: &[Flat],
        [from, to]: [&[Ray]; 2],
        per_mm: f64,
        cavities: &mut Cavities,
        out: &mut [Complex64],
    ) {
        let planes = flats.len() + 1;
        let Cavities { passed, above, below, entered: [falls, rises], currents } = cavities;
        passed.clear();
        let passes = |(flat, way): (&Flat, &f64)| match way * per_mm {
            0.0 => Complex64::from(flat.t),
            phase => Complex64::from_polar(flat.t, -phase),
        };
        passed.extend(flats.iter().zip(&self.moves_mm).map(passes));
        for all in [&mut *above, &mut *below, &mut *falls, &mut *rises].into_iter().chain(&mut *currents) {
            all.clear();
            all.resize(planes, Complex64::ZERO);
        }
        for (k, flat) in flats.iter().enumerate() {
            rises[k] = entered(passed[k], flat.above * above[k]);
            above[k + 1] = flat.below + passed[k] * above[k] * rises[k];
        }
        for (k, flat) in flats.iter().enumerate().rev() {
            falls[k] = entered(passed[k], flat.below * below[k + 1]);
            below[k] = flat.above + passed[k] * below[k + 1] * falls[k];
        }
        let [down, up] = currents;
        for (from, out) in from.iter().zip(out.chunks_exact_mut(to.len().max(1))) {
            let p = from.plane;
            let sent = entered(Complex64::ONE, above[p] * below[p]);
            (down[p], up[p]) = match from.going {
                Propagation::Down => (sent, sent * below[p]),
                Propagation::Up => (sent * above[p], sent),
            };
            // What has been emitted downwards, or reflected down, and the same upwards.
            for k in p..planes - 1 {
                down[k + 1] = down[k] * falls[k];
                up[k + 1] = down[k + 1] * below[k + 1];
            }
            for k in (0..p).rev() {
                up[k] = up[k + 1] * rises[k];
                down[k] = up[k] * above[k];
            }
            for (out, to) in out.iter_mut().zip(to) {
                *out = if to.going == Propagation::Up { up[to.plane] } else { down[to.plane] };
            }
        }
    }
}

/// Returns by how much a medium moves light; 0 if it does not carry it.
pub(super) fn moved_mm(index: f64, length_mm: f64, beta: f64) -> f64 {
    let squared = (index - beta) * (index + beta);
    if squared > 0.0 { length_mm * beta / squared.sqrt() } else { 0.0 }
}

/// Light that passes an element and is then reflected to and fro behind it, a fraction `returned` each time.
fn entered(t: Complex64, returned: Complex64) -> Complex64 {
    if returned == Complex64::ZERO {
        return t;
    }
    let left = 1.0 - returned;
    let squared = left.norm_sqr();
    if squared < CLOSED * CLOSED { Complex64::ZERO } else { t * left.conj() * (1.0 / squared) }
}
