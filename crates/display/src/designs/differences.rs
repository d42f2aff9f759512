//! Derivatives by finite differences, for kernels without reverse differentiation.
//!
//! The reflectance factors are analytic functions of the table. Tables that are moved along the tangent of a
//! parameter, by one and two steps in both directions, are evaluated as additional states of the same pixel:
//! one estimate for each parameter. A step changes each reflectance by at most 1e-3. The truncation error of
//! fourth-order differences is then below 1e-10 of the slope, and the rounding error below 1e-12 of the
//! reflectance factor.

use papilio_optics::film::Polarisation;
use papilio_transport::adding::Kernel;
use papilio_transport::{AngularTable, Base, ReflectanceFactor, Reflector, Stack};

use super::derivatives::Tangents;
use super::parameter::Change;
use crate::DisplayError;

/// Largest change of a reflectance or an area fraction in one step.
const STEP: f64 = 1e-3;

/// Displacements in steps, and their coefficients in the difference.
const MOVES: [(f64, f64); 4] =
    [(1.0, 8.0 / 12.0), (-1.0, -8.0 / 12.0), (2.0, -1.0 / 12.0), (-2.0, 1.0 / 12.0)];

impl Tangents<'_> {
    /// Computes, for each parameter, the derivatives of the reflectance factors,
    /// `[source][state][wavelength]`; empty if they are zero.
    pub(super) fn by_differences(
        &self,
        kernel: &Kernel,
        stack: &Stack,
        table: &AngularTable,
        view: usize,
    ) -> Result<Vec<Vec<f64>>, DisplayError> {
        let Some([(of_s, s), (of_p, p)]) = kernel.polarised(stack) else {
            return match stack.polarised_bases() {
                Some(mirrors) => self.of_mirrors((kernel, stack, table), mirrors, view),
                None => self.of_light((kernel, stack, table), None, view),
            };
        };
        let of = |kernel, stack: &Stack, polarisation| match &stack.base().reflector {
            Reflector::Specular(table) => self.of_light((kernel, stack, table), Some(polarisation), view),
            _ => Ok(Vec::new()),
        };
        let (s, p) = (of(of_s, s, Polarisation::S)?, of(of_p, p, Polarisation::P)?);
        let weights = kernel.weights_by_source(stack, view);
        let columns = table.state_count() * table.common.len();
        Ok(s.iter().zip(&p).map(|(s, p)| weighted(s, p, &weights, columns)).collect())
    }

    /// Computes the same below a scatterer and layers that keep s and p apart together with the mirror: the sum of the
    /// slopes by the mirror of each.
    fn of_mirrors(
        &self,
        (kernel, stack, mean): (&Kernel, &Stack, &AngularTable),
        mirrors: [&Base; 2],
        view: usize,
    ) -> Result<Vec<Vec<f64>>, DisplayError> {
        let as_often = |table: &AngularTable| {
            Reflector::Specular(AngularTable { mixture: table.mixture.repeat(MOVES.len()), ..table.clone() })
        };
        let columns = mean.state_count() * mean.common.len();
        let mut sums: Vec<Vec<f64>> = vec![Vec::new(); self.changes.len()];
        for (number, polarisation) in [Polarisation::S, Polarisation::P].into_iter().enumerate() {
            let (Reflector::Specular(own), Reflector::Specular(other)) =
                (&mirrors[number].reflector, &mirrors[1 - number].reflector)
            else {
                continue;
            };
            let of_film = self.of_film(Some(polarisation))?;
            let mut stack = stack.clone();
            stack.set_reflector(as_often(mean));
            for (sum, change) in sums.iter_mut().zip(&self.changes) {
                let Some((moved, step)) = self.moved(own, &of_film, change) else { continue };
                let both = stack.polarised_bases_mut().into_iter().flatten();
                let mut reflectors = [Reflector::Specular(moved), as_often(other)];
                reflectors.rotate_left(number);
                both.zip(reflectors).for_each(|(base, reflector)| base.reflector = reflector);
                let slopes = slopes(&kernel.seen(&stack, view), columns, step);
                *sum = weighted(sum, &slopes, &vec![[1.0; 2]; slopes.len() / columns], columns);
            }
        }
        Ok(sums)
    }

    /// Computes the same for light of one polarisation, or for unpolarised light.
    fn of_light(
        &self,
        (kernel, stack, table): (&Kernel, &Stack, &AngularTable),
        polarisation: Option<Polarisation>,
        view: usize,
    ) -> Result<Vec<Vec<f64>>, DisplayError> {
        let columns = table.state_count() * table.common.len();
        let of_film = self.of_film(polarisation)?;
        let mut stack = stack.clone();
        let slopes = self.changes.iter().map(|change| {
            let Some((moved, step)) = self.moved(table, &of_film, change) else { return Vec::new() };
            stack.set_reflector(Reflector::Specular(moved));
            slopes(&kernel.seen(&stack, view), columns, step)
        });
        Ok(slopes.collect())
    }

    /// Returns a table with the states displaced along a parameter, `[displacement][state]`, and the step;
    /// `None` if the table does not depend on the parameter.
    fn moved(&self, table: &AngularTable, of_film: &[f64], change: &Change) -> Option<(AngularTable, f64)> {
        let bins = table.common.len();
        let width = self.gaps * bins;
        // Additional basis reflectances, `[node][..]`, and the mixture coefficients that apply to them.
        let (more, first, shares, step): (Vec<f64>, usize, Option<&[f64]>, f64) = match change {
            Change::Nothing => return None,
            Change::Film { variable, gap } => {
                let of_film = &of_film[self.place(*variable) * table.basis.len()..][..table.basis.len()];
                let (first, count) = gap.map_or((0, self.gaps), |gap| (gap, 1));
                let rows = of_film.chunks_exact(width).flat_map(|row| &row[first * bins..][..count * bins]);
                let more: Vec<f64> = rows.copied().collect();
                let largest = more.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                if largest == 0.0 {
                    return None;
                }
                let step = STEP / largest;
                (more.into_iter().map(|value| value * step).collect(), first, None, step)
            }
            Change::Shares { mixture, inactive } => {
                let row = self.inactive_reflectance.iter().map(|r| r * inactive * STEP);
                let row: Vec<f64> = row.collect();
                (row.repeat(table.nodes.count()), 0, Some(mixture), STEP)
            }
        };
        let added = more.len() / (table.nodes.count() * bins).max(1);
        let both = table.basis.chunks_exact(width).zip(more.chunks_exact(added * bins));
        let basis: Vec<f64> = both.flat_map(|(old, new)| old.iter().chain(new)).copied().collect();
        let mixture = MOVES.iter().flat_map(|(steps, _)| {
            table.mixture.chunks_exact(self.gaps).enumerate().flat_map(move |(state, row)| {
                let moved = |k: usize| {
                    let share = shares.map_or(0.0, |shares| shares[state * self.gaps + k] * steps * step);
                    row[k] + share
                };
                let of_new = |k: usize| steps * if shares.is_some() { 1.0 } else { row[first + k] };
                (0..self.gaps).map(moved).chain((0..added).map(of_new)).collect::<Vec<f64>>()
            })
        });
        let mixture = mixture.collect();
        Some((
            AngularTable {
                nodes: table.nodes.clone(),
                basis: basis.into(),
                mixture,
                common: table.common.clone(),
            },
            step,
        ))
    }
}

/// Returns the slopes, `[source][state][wavelength]`, of light seen with the displacements as states.
fn slopes(seen: &[ReflectanceFactor], columns: usize, step: f64) -> Vec<f64> {
    let slope = |rho: &ReflectanceFactor| {
        let mut slope = vec![0.0; columns];
        for ((_, count), row) in MOVES.iter().zip(rho.via_pixel.chunks_exact(columns)) {
            slope.iter_mut().zip(row).for_each(|(slope, seen)| *slope += count / step * seen);
        }
        slope
    };
    seen.iter().flat_map(slope).collect()
}

/// Returns the sum of two slopes, `[source][column]`, with weights of each source; an empty list is that of zeros.
fn weighted(s: &[f64], p: &[f64], weights: &[[f64; 2]], columns: usize) -> Vec<f64> {
    let at = |slopes: &[f64], k: usize| slopes.get(k).copied().unwrap_or_default();
    let weights = weights.iter().flat_map(|pair| std::iter::repeat_n(pair, columns));
    (0..s.len().max(p.len()))
        .zip(weights)
        .map(|(k, [of_s, of_p])| of_s * at(s, k) + of_p * at(p, k))
        .collect()
}
