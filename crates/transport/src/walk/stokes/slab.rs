//! Flights in a scattering medium.

use papilio_optics::Beta;
use papilio_optics::phase::{Elements, HenyeyGreenstein};
use papilio_sampling::warp;

use super::row::{Row, Turned};
use super::sums::{Path, Run};
use super::{Stokes, frame};
use crate::Scattering;
use crate::estimate::Account;
use crate::layers::Departure;
use crate::skeleton::Propagation::{Down, Up};

/// Least probability with which light that enters a slab is scattered.
const LEAST_SCATTERED: f64 = 0.3;

impl Stokes<'_> {
    /// A scattering medium: exponential flights and deflections until light leaves. Absorption besides the scattering
    /// weakens the light on its way.
    pub(super) fn cross_slab(&self, element: usize, slab: &Scattering, path: &mut Path, run: &mut Run<'_>) {
        let medium = &self.stack.layers[element / 2].medium;
        let (n, thickness) = (medium.largest_index(), slab.optical_thickness);
        let clear = |row: usize, flight: f64| {
            medium.transmittance().map_or(1.0, |t| t[self.bin(row)].powf(flight / thickness))
        };
        let elements = |cos: f64| match &slab.matrix {
            Some(matrix) => matrix.at_cosine(cos),
            None => Elements::depolarised(HenyeyGreenstein { anisotropy: slab.anisotropy }.at_cosine(cos)),
        };
        let mut depth = if path.going == Down { 0.0 } else { thickness };
        let mut least = LEAST_SCATTERED;
        while path.survives(run) {
            let (now, [u, v, w, _]) = (Departure { beta: path.beta, going: path.going }, run.random());
            let leaving = frame(now, n);
            let direction = leaving.travel();
            let cosine = direction[2].abs().max(f64::MIN_POSITIVE);
            let to_the_end = if now.going == Down { thickness - depth } else { depth } / cosine;
            // Thin slabs scatter more often, and less at a time.
            let scattered = -(-to_the_end).exp_m1();
            let chance = scattered.max(std::mem::take(&mut least));
            let is_scattered = u < chance;
            let (flight, weight) = match is_scattered {
                true => (-(-scattered * u / chance).ln_1p(), scattered / chance),
                false => (to_the_end, (1.0 - scattered) / (1.0 - chance)),
            };
            let lost = path.weaken(|_| weight);
            run.unaccounted(path, &lost);
            let lost = path.weaken(|row| clear(row, flight));
            run.absorb(Account::Glass, path, &lost);
            if !is_scattered {
                return path.depart(element, now);
            }
            // The light propagates against the path: upwards where that goes down.
            depth += flight * direction[2];
            let lost = path.weaken(|row| slab.albedo[self.bin(row)]);
            run.absorb(Account::Diffuser, path, &lost);
            let rows = path.rows.clone();
            let scattered = |to: Departure, cos: f64, scale: f64| -> Vec<Row> {
                let (turned, elements) = (Turned::new([frame(to, n), leaving]), elements(cos).times(scale));
                rows.iter().map(|row| turned.times(elements, *row)).collect()
            };
            let density = |to: Departure| {
                let after = frame(to, n).travel();
                let rest = if to.going == Down { thickness - depth } else { depth };
                let (over_beta, rest) = (1.0 / (n * n * after[2].abs()), rest / after[2].abs());
                let cos: f64 = direction.iter().zip(after).map(|(a, b)| a * b).sum();
                let mut rows = scattered(to, cos, over_beta * (-rest).exp());
                for (k, row) in rows.iter_mut().enumerate() {
                    *row = row.map(|value| value * clear(k, rest));
                }
                (rows, over_beta * elements(cos).a1)
            };
            let cos = match &slab.matrix {
                Some(matrix) => matrix.sample_cosine(v),
                None => HenyeyGreenstein { anisotropy: slab.anisotropy }.sample_cosine(v),
            };
            let [x, y, z] = warp::deflected(direction, 1.0 - cos, w);
            let to = Departure { beta: Beta { x: n * x, y: n * y }, going: if z > 0.0 { Down } else { Up } };
            let phase = elements(cos).a1;
            let after = scattered(to, cos, 1.0 / phase);
            // A polarised meter sees more or less of this direction than of the mean.
            let less: Vec<f64> =
                rows.iter().zip(&after).map(|(before, after)| before[0] - after[0]).collect();
            run.unaccounted(path, &less);
            let sent = (to, after, phase / (n * n * z.abs().max(f64::MIN_POSITIVE)));
            self.scatter((element, &[Up, Down]), path, run, density, Some(sent));
        }
    }
}
