//! Values of variables that the data do not determine: the scenario's own, where they fit as well.

use papilio_scenario::FitTarget;

use super::levenberg_marquardt::{Minimum, descend};
use super::problem::CommonDeviations;
use super::run::{Fitting, in_bounds};
use crate::DesignError;

/// Increase of chi-square at which values fit as well: small compared with 1, that by one standard error.
const AS_GOOD: f64 = 0.1;

impl Fitting<'_> {
    /// A minimum that is as good, at which as many as possible of the variables of each undetermined group have the value of the
    /// scenario: one after the other is held, those of the meter first, which `fitted.toml` does not have.
    pub(super) fn kept(
        &self,
        best: Minimum,
        common: CommonDeviations,
        groups: &[Vec<usize>],
    ) -> Result<Minimum, DesignError> {
        let mut problem = self.problem(common);
        let variables = &self.spec.variables;
        let most = best.chi_square + AS_GOOD;
        let mut held = vec![false; best.point.len()];
        let mut kept = best;
        let (of_meter, of_display): (Vec<usize>, Vec<usize>) =
            groups.iter().flatten().partition(|k| !matches!(variables[**k].target, FitTarget::Keys(_)));
        for k in of_meter.into_iter().chain(of_display) {
            let [from, to] = variables[k].bounds;
            let Some(own) = variables[k].own.filter(|own| (from..=to).contains(own)) else { continue };
            let mut point = kept.point.clone();
            point[k] = in_bounds(&variables[k], own);
            held[k] = true;
            match descend(&mut problem, &point, &held, None)?.filter(|one| one.chi_square <= most) {
                Some(found) => kept = found,
                None => held[k] = false,
            }
        }
        Ok(kept)
    }
}
