//! What a view sees under a diffuser as a function of few sums over the base's table, and its derivatives.
//!
//! These sums are those of the first pass, one for each source, in which the result is linear, and the terms
//! of recycled light, in which it is a polynomial. A sum is a set of weights on the nodes of the table. The
//! same sums on other nodes, fewer or better placed, give the same result where these integrate the
//! reflectance as well.
//!
//! The gradient is propagated backwards in the same way: from the result to the sums of each state
//! ([`Recycling::slopes`]), from these to the sums of each basis, and from there to all nodes at once, by one
//! matrix product.

use std::sync::Arc;

use super::super::super::{TableGradient, TableSums, TableValues};
use super::super::recycling::{Forms, Recycling, is_fitted};
use super::{AtIndex, Kernel, View, sent_back};
use crate::{Diffuser, Panel, Reflector, Source};

/// What a view sees of each source as a function of sums over the base's table; for a dispersive medium, at
/// one of the indices between which results are interpolated.
#[derive(Debug, Clone)]
pub struct ViewSums {
    /// `[sum][node]`: light of each source after one reflection, then the terms of recycled light.
    rows: Vec<Vec<f64>>,
    /// Number of sources.
    sources: usize,
    /// Factor of the result, `[wavelength]`: `(t T)^2`, the transmittance of front and diffuser on both ways,
    /// and the weight of the index.
    through: Vec<f64>,
    /// Fraction of light that the front sends back, `[wavelength]`.
    sent_back: Vec<f64>,
    recycled: Option<Recycled>,
}

/// Light that the front sends back to the base.
#[derive(Debug, Clone)]
struct Recycled {
    /// For each index, and the number of this one.
    recycling: Arc<[Recycling]>,
    index: usize,
    /// For each source.
    forms: Vec<Forms>,
}

impl ViewSums {
    /// Returns the weights of each sum on the nodes of the table for which the kernel was prepared. The first
    /// ones are those of each source.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// Returns the number of sources.
    pub fn sources(&self) -> usize {
        self.sources
    }

    /// Returns the factor of the sums of the first pass, `[wavelength]`.
    pub fn through(&self) -> &[f64] {
        &self.through
    }

    /// Returns the fraction of light that the front of screen sends back to the base, `[wavelength]`.
    pub fn sent_back(&self) -> &[f64] {
        &self.sent_back
    }

    /// Adds what the view sees of each source, `[source][state][wavelength]`, given the sums of the states,
    /// `[sum][state][wavelength]`.
    pub fn add_seen(&self, of_states: &[f64], out: &mut [f64]) {
        let columns = of_states.len() / self.rows.len().max(1);
        let first = &of_states[..self.sources * columns];
        let again = self.recycled.as_ref().map(|recycled| {
            let terms = &of_states[first.len()..];
            let g = self.sent_back.repeat(columns / self.sent_back.len().max(1));
            let forms: Vec<&Forms> = recycled.forms.iter().collect();
            let recycling = recycled.recycling();
            recycling.values(&forms, false, &recycling.products(terms, columns), &g)
        });
        let bins = self.through.len();
        for (row, (out, first)) in out.chunks_exact_mut(bins).zip(first.chunks_exact(bins)).enumerate() {
            match &again {
                Some(again) => {
                    let again = &again[row * bins..][..bins];
                    for (((out, first), again), through) in
                        out.iter_mut().zip(first).zip(again).zip(&self.through)
                    {
                        *out += through * (first + again);
                    }
                }
                None => out
                    .iter_mut()
                    .zip(first)
                    .zip(&self.through)
                    .for_each(|((out, first), t)| *out += t * first),
            }
        }
    }

    /// Adds the gradients of numbers with these derivatives by what the view sees,
    /// `[number][source][state][wavelength]`.
    pub fn pull_back(&self, sums: &TableSums<'_>, seen: &[f64], gradients: &mut [TableGradient]) {
        let columns = sums.columns();
        let size = self.sources * columns;
        let slopes = self.recycled.as_ref().map_or(Vec::new(), |recycled| {
            let g = self.sent_back.repeat(columns / self.sent_back.len().max(1));
            let r = recycled.recycling().products(&sums.of_states()[size..], columns);
            let forms: Vec<Vec<&Forms>> = recycled.forms.iter().map(|one| vec![one]).collect();
            recycled.recycling().slopes(&forms, &r, &g)
        });
        for (gradient, seen) in gradients.iter_mut().zip(seen.chunks_exact(size.max(1))) {
            let seen: Vec<f64> = seen.iter().zip(self.through.iter().cycle()).map(|(s, w)| s * w).collect();
            sums.pull_back(&by_sums(&seen, &slopes, columns), gradient);
        }
    }
}

impl Recycled {
    fn recycling(&self) -> &Recycling {
        &self.recycling[self.index]
    }
}

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
        let values = TableValues { basis: &table.basis, mixture: &table.mixture, common: &table.common };
        let size = self.sources.len() * stack.base.states() * stack.base.bins();
        let mut gradients = vec![TableGradient::zero(&values); seen.len() / size.max(1)];
        for view in self.sums_of(stack, diffuser, self.view_of_sums(stack, view)?) {
            let weights = view.rows.concat();
            let sums = TableSums::new(view.rows.len(), &weights, values);
            view.pull_back(&sums, seen, &mut gradients);
        }
        Some(gradients)
    }

    /// See [`view_sums`](super::super::super::Kernel::view_sums).
    pub(in super::super) fn view_sums(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        view: usize,
    ) -> Option<Vec<ViewSums>> {
        let view = self.view_of_sums(stack, view)?;
        self.pass(0).filter(is_fitted)?;
        Some(self.sums_of(stack, diffuser, view).collect())
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

    /// Returns the sums of a view at each index.
    fn sums_of<'a>(
        &'a self,
        stack: &'a Panel,
        diffuser: &'a Diffuser,
        view: &'a View,
    ) -> impl Iterator<Item = ViewSums> + 'a {
        let sent_back = sent_back(stack, &diffuser.transmittance);
        view.at.iter().enumerate().map(move |(index, at)| {
            let recycled = self.recycling.as_ref().map(|recycling| Recycled {
                recycling: Arc::clone(recycling),
                index,
                forms: self.forms(at, &recycling[index]),
            });
            let terms = self.recycling.iter().flat_map(|all| all[index].terms()).map(<[f64]>::to_vec);
            ViewSums {
                rows: self.first_rows(at).into_iter().chain(terms).collect(),
                sources: self.sources.len(),
                through: self.weights(stack, diffuser, index),
                sent_back: sent_back.clone(),
                recycled,
            }
        })
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

    /// Returns the forms of the recycled light of each source.
    fn forms(&self, at: &AtIndex, recycling: &Recycling) -> Vec<Forms> {
        let of = |(light, number): (&Arc<super::Light>, usize)| {
            let each = at.recycled.iter();
            if light.source == Source::Diffuse {
                recycling.total(each.filter_map(|recycled| Some(&recycled.alone.as_ref()?.leaving)))
            } else {
                recycling.total(each.flat_map(|recycled| &recycled.between[number]).map(|(forms, _)| forms))
            }
        };
        self.sources.iter().zip(0..).map(of).collect()
    }

    /// Returns the factor of the sums at an index, `[wavelength]`.
    fn weights(&self, stack: &Panel, diffuser: &Diffuser, index: usize) -> Vec<f64> {
        let through = stack.front.transmittance.iter().zip(diffuser.transmittance.iter());
        through.enumerate().map(|(bin, (t, d))| (t * d).powi(2) * self.indices.blend_at(index, bin)).collect()
    }
}

fn has_forms(at: &AtIndex) -> bool {
    at.recycled.iter().all(|recycled| recycled.alone.is_some())
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
