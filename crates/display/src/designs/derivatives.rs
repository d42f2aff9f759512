//! Derivatives of the quantities of a design with respect to its film, gaps and areas.
//!
//! The derivatives of a quantity with respect to all parameters are computed together, by the chain rule in
//! reverse order: with respect to the reflectance factors (`meter::slopes`), with respect to the table of the
//! pixel's reflectances (the kernel's `pull_back`, or [`differences`](super::differences) if the kernel does
//! not support it), and finally, with the derivatives of the film at the table's nodes, with respect to each
//! parameter. A table on fixed nodes is linear in its values. These derivatives are therefore those of the
//! reported values, not of the exact values that they approximate.

use std::sync::Arc;

use papilio_colour::CORNERS;
use papilio_optics::film::{Polarisation, Variable};
use papilio_spectra::sum_of_products;
use papilio_transport::adding::TableGradient;
use papilio_transport::{AngularTable, Nodes, Reflector};

use super::parameter::Change;
use super::{DesignObservation, Designs, Parameter, Quantity};
use crate::DisplayError;
use crate::meter::{Meter, Number, PRIMARIES, Slopes, ViewScalars};
use crate::pixel::film::{Beta, Film, Mixture};
use crate::result::StateValues;
use crate::scene::{FilmPixel, Metric};

/// Quantities of a design and their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// Values of the quantities; `None` if one is not defined.
    pub values: Vec<Option<f64>>,
    /// Derivatives per unit of each parameter, `[quantity][parameter]`. NaN if a derivative is not defined:
    /// if the quantity is not defined here or at a small distance, and for `peak_shift_nm`, for which
    /// derivatives are not implemented.
    pub gradients: Vec<f64>,
}

impl Designs {
    /// Computes the quantities of another pixel with the same states and their exact derivatives for fixed
    /// table nodes.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate), and if the film does not have a parameter.
    pub fn derivatives(
        &mut self,
        film: &FilmPixel,
        parameters: &[Parameter],
    ) -> Result<Derivatives, DisplayError> {
        if parameters.is_empty() {
            return Ok(Derivatives { values: self.evaluate(film)?, gradients: Vec::new() });
        }
        let mixture = self.replace_pixel(film, Mixture::by_owner)?;
        let changes: Result<Vec<Change>, _> =
            parameters.iter().map(|parameter| parameter.change(film, &mixture)).collect();
        let tangents = Tangents::new(self, film, &mixture, changes?)?;
        let setup = Arc::clone(&self.setup);
        let meter = Meter::new(&setup);
        let mut values = vec![None; self.quantities.len()];
        let mut gradients = vec![f64::NAN; self.quantities.len() * parameters.len()];
        for view in 0..setup.views.len() {
            let in_view: Vec<usize> =
                (0..values.len()).filter(|k| self.quantities[*k].view() == view).collect();
            if in_view.is_empty() {
                continue;
            }
            let observed = self.observe(&meter, view)?;
            let mut numbers = Vec::with_capacity(in_view.len());
            let mut by_seen = Vec::new();
            for k in in_view {
                values[k] = observed.value(&meter, &self.quantities[k]);
                if let Some(one) = observed.slopes(&meter, &self.quantities[k]) {
                    numbers.push(k);
                    by_seen.extend(one);
                }
            }
            if numbers.is_empty() {
                continue;
            }
            let found = self.pull_back(view, (&by_seen, numbers.len()), &tangents)?;
            for (k, found) in numbers.into_iter().zip(found.chunks_exact(parameters.len())) {
                gradients[k * parameters.len()..][..parameters.len()].copy_from_slice(found);
            }
        }
        Ok(Derivatives { values, gradients })
    }

    /// Derivatives `[number][parameter]` of several numbers, from their derivatives with respect to the
    /// reflectance factors.
    fn pull_back(
        &mut self,
        view: usize,
        (by_seen, numbers): (&[f64], usize),
        tangents: &Tangents<'_>,
    ) -> Result<Vec<f64>, DisplayError> {
        let colours = self.colours.as_ref().zip(self.table.as_ref());
        let on_nodes =
            colours.and_then(|(colours, table)| colours.pull_back(view, table, (by_seen, numbers)));
        if let Some(gradients) = on_nodes {
            return tangents.along(&gradients);
        }
        let (setup, stack) = (&self.setup, &self.stack);
        let Reflector::Specular(table) = &stack.base().reflector else { return Ok(Vec::new()) };
        let Some(group) = self.groups.iter_mut().find(|group| group.views.contains(&view)) else {
            return Ok(Vec::new());
        };
        let number = view - group.views.start;
        let kernel = group.kernel_for(setup, stack);
        match kernel.pull_back(stack, number, by_seen) {
            Some(gradients) => tangents.along(&gradients),
            None => {
                let slopes = tangents.by_differences(kernel, stack, table, number)?;
                let along = |one: &[f64]| slopes.iter().map(|slope| dot(one, slope)).collect::<Vec<f64>>();
                Ok(by_seen.chunks_exact(by_seen.len() / numbers).flat_map(along).collect())
            }
        }
    }
}

/// Sum of products; an empty slice counts as zeros.
fn dot(one: &[f64], slopes: &[f64]) -> f64 {
    one.iter().zip(slopes).map(|(a, b)| a * b).sum()
}

/// Derivatives of the table with respect to the parameters.
pub(super) struct Tangents<'a> {
    pub(super) changes: Vec<Change>,
    film: Film<'a>,
    /// Cosines of the table's nodes.
    cosines: Vec<f64>,
    variables: Vec<Variable>,
    pub(super) gaps: usize,
    pub(super) inactive_reflectance: &'a [f64],
}

/// Number of nodes whose derivatives are computed at a time, so that they stay in the processor's cache until
/// used.
const NODES_TOGETHER: usize = 16;

impl<'a> Tangents<'a> {
    fn new(
        designs: &Designs,
        film: &'a FilmPixel,
        mixture: &'a Mixture,
        changes: Vec<Change>,
    ) -> Result<Self, DisplayError> {
        let mut variables: Vec<Variable> = Vec::new();
        for change in &changes {
            match change {
                Change::Film { variable, .. } if !variables.contains(variable) => variables.push(*variable),
                _ => {}
            }
        }
        let cosines: Vec<f64> = match (&designs.table, &designs.stack.base().reflector) {
            (Some(table), _) => table.cosines().to_vec(),
            (None, Reflector::Specular(AngularTable { nodes: Nodes::CosinePanels(panels), .. })) => {
                panels.nodes().collect()
            }
            _ => Vec::new(),
        };
        let scene = &designs.setup.scene;
        let index = scene.display.index_above_pixel();
        Ok(Self {
            changes,
            film: Film::new(film, &scene.grid, index, &mixture.gaps_nm, Beta::InGlass)?,
            cosines,
            variables,
            gaps: mixture.gaps_nm.len(),
            inactive_reflectance: &film.inactive_reflectance,
        })
    }

    /// Derivatives of the film's reflectances, `[variable][node][gap][wavelength]`.
    pub(super) fn of_film(&self, polarisation: Option<Polarisation>) -> Result<Vec<f64>, DisplayError> {
        self.film.derivatives_at_cosines(polarisation, &self.cosines, &self.variables)
    }

    /// Index of a variable.
    pub(super) fn place(&self, variable: Variable) -> usize {
        self.variables.iter().position(|one| *one == variable).unwrap_or_default()
    }

    /// Derivatives `[number][parameter]` of several numbers, from their derivatives with respect to the
    /// table.
    fn along(&self, gradients: &[TableGradient]) -> Result<Vec<f64>, DisplayError> {
        let by_gap = self.by_variable_and_gap(gradients)?;
        let one = |number: usize, change: &Change| match change {
            Change::Film { variable, gap } => {
                let first = (number * self.variables.len() + self.place(*variable)) * self.gaps;
                let of_gaps = &by_gap[first..][..self.gaps];
                gap.map_or_else(|| of_gaps.iter().sum(), |gap| of_gaps[gap])
            }
            Change::Shares { mixture, inactive } => {
                let gradient = &gradients[number];
                dot(&gradient.mixture, mixture) + inactive * dot(&gradient.common, self.inactive_reflectance)
            }
            Change::Nothing => 0.0,
        };
        let each = |number| self.changes.iter().map(move |change| one(number, change));
        Ok((0..gradients.len()).flat_map(each).collect())
    }

    /// Derivative of each number with respect to each variable through each gap: `[number][variable][gap]`.
    fn by_variable_and_gap(&self, gradients: &[TableGradient]) -> Result<Vec<f64>, DisplayError> {
        let variables = self.variables.len();
        let mut sums = vec![0.0; gradients.len() * variables * self.gaps];
        if sums.is_empty() {
            return Ok(sums);
        }
        let size = gradients[0].basis.len() / self.cosines.len().max(1);
        let bins = size / self.gaps;
        for (number, cosines) in self.cosines.chunks(NODES_TOGETHER).enumerate() {
            let first = number * NODES_TOGETHER * size;
            let slopes = self.film.derivatives_at_cosines(None, cosines, &self.variables)?;
            let per_variable = slopes.chunks_exact(cosines.len() * size);
            for (gradient, sums) in gradients.iter().zip(sums.chunks_exact_mut(variables * self.gaps)) {
                let basis = &gradient.basis[first..][..cosines.len() * size];
                for (slopes, sums) in per_variable.clone().zip(sums.chunks_exact_mut(self.gaps)) {
                    let rows = basis.chunks_exact(bins).zip(slopes.chunks_exact(bins));
                    for (k, (a, b)) in rows.enumerate() {
                        sums[k % self.gaps] += sum_of_products(a, b);
                    }
                }
            }
        }
        Ok(sums)
    }
}

impl DesignObservation {
    /// Derivatives of a quantity with respect to each source's `rho.base`, `[source][state][wavelength]`;
    /// `None` if it is not defined.
    fn slopes(&self, meter: &Meter<'_>, quantity: &Quantity) -> Option<Vec<f64>> {
        let (states, bins, sources) = meter.sizes();
        let mut slopes = Slopes::zeros(states, bins);
        match quantity {
            Quantity::Metric { metric: Metric::R_hemi, state: Some(name), .. } => {
                let state = meter.state_named(name)?;
                meter.under_diffuse(state, &self.sample)?;
                slopes.diffuse[state] = 1.0;
            }
            Quantity::ReflectanceFactor { state, bin, .. } => {
                let state = meter.state_named(state)?;
                self.value(meter, quantity)?;
                *slopes.factor.get_mut(state * bins + bin)? = 1.0;
            }
            Quantity::SpectrumDistance { state, wanted, .. } => {
                let state = meter.state_named(state)?;
                let factor = meter.reflectance_factor(state, &self.sample.0)?;
                let distance = self.value(meter, quantity)?;
                let of_bins =
                    factor.iter().zip(wanted.iter()).map(|(f, w)| (f - w) / (bins as f64 * distance));
                slopes.factor[state * bins..][..bins].iter_mut().zip(of_bins).for_each(|(s, d)| *s = d);
            }
            _ => {
                let (states, numbers) = depends_on(meter, quantity);
                let states: Vec<usize> = states.into_iter().flatten().collect();
                let value = |scalars: &ViewScalars| match quantity.state() {
                    Some(_) => quantity.of_state(&StateValues::of_scalars(&scalars.states[0])),
                    None => quantity.metric()?.of_view(&scalars.together),
                };
                if !meter.add_slopes(&self.sample, &states, numbers, value, &mut slopes) {
                    return None;
                }
            }
        }
        let mut out = vec![0.0; sources * states * bins];
        meter.pull_back(&self.sample, &mut slopes, &mut out).then_some(out)
    }
}

/// Returns the states on which a quantity depends, its own first, and which of their numbers.
fn depends_on(meter: &Meter<'_>, quantity: &Quantity) -> (Vec<Option<usize>>, &'static [Number]) {
    const XYZ: &[Number] = &[Number::Xyz(0), Number::Xyz(1), Number::Xyz(2)];
    let (others, numbers): (Vec<&str>, _) = match quantity.metric() {
        Some(Metric::luminance_cd_m2) => (vec![], &[Number::Luminance][..]),
        Some(Metric::peak_nm | Metric::peak_shift_nm) => (vec![], &[Number::Peak][..]),
        Some(Metric::contrast) => (vec!["black"], &[Number::Xyz(1)][..]),
        Some(Metric::contrast_ratio) => (vec!["white", "black"], &[Number::Xyz(1)][..]),
        Some(Metric::delta_E_2000_from_reference | Metric::distance_from_reference_uv) => {
            (vec![meter.reference_state()], XYZ)
        }
        Some(Metric::gamut_volume_cielab) => (CORNERS.to_vec(), XYZ),
        Some(Metric::average_peak_shift_nm) => (PRIMARIES.to_vec(), &[Number::Peak][..]),
        Some(
            Metric::text_luminance_cd_m2
            | Metric::text_contrast
            | Metric::reading_surrogate
            | Metric::reading_surrogate_age_20
            | Metric::reading_surrogate_age_50
            | Metric::reading_surrogate_age_75
            | Metric::visibility_level
            | Metric::contrast_margin,
        ) => (vec!["white", "black"], &[Number::Luminance][..]),
        Some(metric) if metric.is_of_view() => (PRIMARIES.to_vec(), XYZ),
        _ => (vec![], XYZ),
    };
    // Only metrics of all three numbers depend on the white of CIELAB.
    let own = (numbers.len() == XYZ.len() && meter.has_own_white()).then_some("white");
    let mut states: Vec<Option<usize>> = Vec::new();
    for name in quantity.state().into_iter().chain(others).chain(own) {
        let state = meter.state_named(name);
        if !states.contains(&state) {
            states.push(state);
        }
    }
    (states, numbers)
}
