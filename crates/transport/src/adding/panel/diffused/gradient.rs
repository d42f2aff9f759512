//! Derivatives of the reflectance factor under a diffuser with respect to the base's table.
//!
//! The result depends on the table only through a few sums over its nodes: those of the first pass, one for
//! each source, and the terms of recycled light. It is linear in the former and a polynomial in the latter
//! ([`Recycling::slopes`]). The gradient is propagated backwards in the same way: from the result to the
//! sums of each state, from these to the sums of each basis, and from there to all nodes at once, by one
//! matrix product.

use std::sync::Arc;

use super::super::super::{FirstPass, TableGradient};
use super::super::recycling::{Forms, Recycling, is_fitted};
use super::{AtIndex, Kernel, View, sent_back};
use crate::product::{add_product, add_transposed_product};
use crate::{AngularTable, Diffuser, Panel, Reflector, Source};

impl Kernel {
    /// See [`pull_back`](super::super::super::Kernel::pull_back). `None` if the diffuser has regular
    /// transmittance, if recycled light is summed column by column, and if it is computed with a wider lobe.
    pub(in super::super) fn pull_back(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        view: usize,
        seen: &[f64],
    ) -> Option<Vec<TableGradient>> {
        let Reflector::Specular(table) = &stack.base.reflector else { return None };
        let view = self.view_of_sums(stack, view)?;
        let size = self.sources.len() * stack.base.states() * stack.base.bins();
        let mut gradients = vec![zero(table); seen.len() / size.max(1)];
        for (index, at) in view.at.iter().enumerate() {
            let terms = self.recycling.iter().flat_map(|all| all[index].terms()).map(<[f64]>::to_vec);
            let rows: Vec<Vec<f64>> = self.first_rows(at).into_iter().chain(terms).collect();
            let weights = self.weights(stack, diffuser, index);
            let slopes = self.slopes(stack, diffuser, table, (at, index));
            let sums = Sums::new(table, &rows);
            for (gradient, seen) in gradients.iter_mut().zip(seen.chunks_exact(size)) {
                let seen: Vec<f64> = seen.iter().zip(weights.iter().cycle()).map(|(s, w)| s * w).collect();
                let by_sums = by_sums(&seen, &slopes, stack.base.states() * stack.base.bins());
                sums.pull_back(&by_sums, gradient);
            }
        }
        Some(gradients)
    }

    /// See [`first_pass`](super::super::super::Kernel::first_pass).
    pub(in super::super) fn first_pass(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        view: usize,
    ) -> Option<(Vec<FirstPass>, f64)> {
        let view =
            self.view_of_sums(stack, view).filter(|_| self.pass(0).is_some_and(|pass| is_fitted(&pass)))?;
        let at = |(index, at): (usize, &AtIndex)| FirstPass {
            rows: self.first_rows(at),
            through: self.weights(stack, diffuser, index),
        };
        let largest = sent_back(stack, &diffuser.transmittance).into_iter().fold(0.0, f64::max);
        Some((view.at.iter().enumerate().map(at).collect(), largest))
    }

    /// Returns a view if what it sees depends on the table only through a few sums over its nodes.
    fn view_of_sums(&self, stack: &Panel, view: usize) -> Option<&View> {
        let view = self.views.get(view)?;
        let forms = view.at.iter().all(has_forms);
        let summed = self.grids().any(Recycling::sums_columns);
        let is_mirror = matches!(stack.base.reflector, Reflector::Specular(_));
        let serves =
            self.diffuser.regular_fraction == 0.0 && !summed && forms && self.recycling_serves(stack);
        (is_mirror && serves).then_some(view)
    }

    /// Returns the weights on the nodes of the first pass of each source.
    fn first_rows(&self, at: &AtIndex) -> Vec<Vec<f64>> {
        let leaving = |sum: &mut Vec<f64>| add(sum, at.alone.iter().map(|alone| &alone.leaving.0[..]));
        let row = |(light, number): (&Arc<super::Light>, usize)| {
            let mut sum = Vec::new();
            if light.source == Source::Diffuse {
                leaving(&mut sum);
            } else {
                add(
                    &mut sum,
                    at.pairs.iter().flat_map(|all| &all[number]).map(|(weights, _)| &weights.0[..]),
                );
            }
            sum
        };
        self.sources.iter().zip(0..).map(row).collect()
    }

    /// Returns the weight of a sum in the result, `[wavelength]`: `(t T)^2`, and the blend of indices.
    fn weights(&self, stack: &Panel, diffuser: &Diffuser, index: usize) -> Vec<f64> {
        let through = stack.front.transmittance.iter().zip(diffuser.transmittance.iter());
        through.enumerate().map(|(bin, (t, d))| (t * d).powi(2) * self.indices.blend_at(index, bin)).collect()
    }

    /// Returns the derivative of each source's recycled light by each term, `[source][term][column]`.
    fn slopes(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        table: &AngularTable,
        (at, index): (&AtIndex, usize),
    ) -> Vec<f64> {
        let Some(recycling) = self.recycling.as_ref().and_then(|all| all.get(index)) else {
            return Vec::new();
        };
        let medium = self.medium_at(stack, index);
        let r = self.reflectances(stack, table, &medium, index);
        let g = sent_back(stack, &diffuser.transmittance).repeat(stack.base.states());
        let of = |(light, number): (&Arc<super::Light>, usize)| -> Vec<&Forms> {
            let each = at.recycled.iter();
            if light.source == Source::Diffuse {
                each.filter_map(|recycled| Some(&recycled.alone.as_ref()?.leaving)).collect()
            } else {
                each.flat_map(|recycled| &recycled.between[number]).map(|(forms, _)| forms).collect()
            }
        };
        let forms = self.sources.iter().zip(0..).map(of).collect::<Vec<_>>();
        recycling.slopes(&forms, &r, &g)
    }
}

fn has_forms(at: &AtIndex) -> bool {
    at.recycled.iter().all(|recycled| recycled.alone.is_some())
}

fn zero(table: &AngularTable) -> TableGradient {
    let zeros = |like: &[f64]| vec![0.0; like.len()];
    TableGradient { basis: zeros(&table.basis), mixture: zeros(&table.mixture), common: zeros(&table.common) }
}

/// Replaces `sum` by the sum of these rows.
fn add<'a>(sum: &mut Vec<f64>, rows: impl Iterator<Item = &'a [f64]>) {
    for row in rows {
        sum.resize(row.len(), 0.0);
        sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
}

/// Returns the derivative of a number by each sum, `[sum][column]`, from its derivative by the result of
/// each source.
fn by_sums(seen: &[f64], slopes: &[f64], columns: usize) -> Vec<f64> {
    let sources = seen.len() / columns.max(1);
    let terms = slopes.len() / seen.len().max(1);
    let mut out = seen.to_vec();
    out.resize((sources + terms) * columns, 0.0);
    let of_terms = &mut out[sources * columns..];
    for (seen, slopes) in seen.chunks_exact(columns).zip(slopes.chunks_exact((terms * columns).max(1))) {
        for (sum, slopes) in of_terms.chunks_exact_mut(columns).zip(slopes.chunks_exact(columns)) {
            sum.iter_mut().zip(seen).zip(slopes).for_each(|((sum, seen), slope)| *sum += seen * slope);
        }
    }
    out
}

/// Sums over the nodes of a table.
struct Sums<'a> {
    table: &'a AngularTable,
    /// `[sum][node]`.
    rows: Vec<f64>,
    count: usize,
    /// `[sum][basis][wavelength]`.
    of_basis: Vec<f64>,
    /// Sums of the common part.
    totals: Vec<f64>,
}

impl<'a> Sums<'a> {
    fn new(table: &'a AngularTable, rows: &[Vec<f64>]) -> Self {
        let width = table.basis_count() * table.common.len();
        let totals = rows.iter().map(|row| row.iter().sum()).collect();
        let mut of_basis = vec![0.0; rows.len() * width];
        let (count, rows) = (rows.len(), rows.concat());
        add_product(&rows, &table.basis, table.nodes.count(), &mut of_basis);
        Self { table, rows, count, of_basis, totals }
    }

    /// Adds to the gradient of a number with this derivative by each sum of each state,
    /// `[sum][state][wavelength]`.
    fn pull_back(&self, by_sums: &[f64], gradient: &mut TableGradient) {
        let (bins, basis) = (self.table.common.len(), self.table.basis_count());
        let mut by_basis = vec![0.0; self.count * basis * bins];
        let states = by_sums.len() / (self.count * bins).max(1);
        for (sum, of_states) in by_sums.chunks_exact((states * bins).max(1)).enumerate() {
            for (state, seen) in of_states.chunks_exact(bins).enumerate() {
                gradient.common.iter_mut().zip(seen).for_each(|(c, seen)| *c += self.totals[sum] * seen);
                for b in 0..basis {
                    let at = (sum * basis + b) * bins;
                    let share = self.table.mixture[state * basis + b];
                    let pairs = self.of_basis[at..][..bins].iter().zip(seen);
                    gradient.mixture[state * basis + b] +=
                        pairs.map(|(value, seen)| value * seen).sum::<f64>();
                    if share != 0.0 {
                        let row = by_basis[at..][..bins].iter_mut().zip(seen);
                        row.for_each(|(sum, seen)| *sum += share * seen);
                    }
                }
            }
        }
        add_transposed_product(&self.rows, &by_basis, self.count, &mut gradient.basis);
    }
}
