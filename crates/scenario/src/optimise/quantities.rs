//! Objectives and constraints, in all their conditions and views.

use papilio_colour::{Lab, UvPrime};
use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::Quantity;
use papilio_formats::{LARGEST_FILE, read_fractions_with_notes};
use papilio_spectra::{Grid, SpectraError, Spectrum, Tabulated};

use super::read::{ConditionScene, Reader};
use super::{NamedQuantity, SearchAim, SearchConstraint, SearchObjective};
use crate::describe::limits::MetricName;
use crate::describe::numbers::Count;
use crate::describe::optimize::{self as describe, DesiredSpectrum};
use crate::describe::sweep::Any;
use crate::library::Missing;
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// The keys that objectives and constraints have in common.
struct QuantitySpec<'a> {
    at: Origin,
    metric: &'a Spanned<Option<MetricName>>,
    state: &'a Spanned<Option<String>>,
    spectrum: &'a Spanned<Option<DesiredSpectrum>>,
    lab: &'a Spanned<Option<Vec<Spanned<Any>>>>,
    uv: &'a Spanned<Option<Vec<Spanned<Any>>>>,
    condition: &'a Spanned<Option<String>>,
    view: &'a Spanned<Option<Count<0, 4999>>>,
}

/// Error: there is no such condition.
fn no_such_condition(name: &str, names: &[&str]) -> Diagnostic {
    let mut known = names.iter().copied().filter(|name| !name.is_empty()).peekable();
    let hint = match known.peek() {
        None => "[[optimize.conditions]] gives conditions their names".to_owned(),
        Some(_) => suggestion(name, known, "conditions"),
    };
    Diagnostic::new(format!("there is no condition `{name}`")).hint(hint)
}

impl Reader {
    pub(super) fn objective(
        &mut self,
        spec: &Spanned<describe::Objective>,
        names: &[&str],
        weights: &[f64],
        scenes: &[ConditionScene],
    ) -> Option<SearchObjective> {
        let asked = QuantitySpec {
            at: spec.origin,
            metric: &spec.metric,
            state: &spec.state,
            spectrum: &spec.spectrum,
            lab: &spec.lab,
            uv: &spec.uv,
            condition: &spec.condition,
            view: &spec.view,
        };
        let parts = self.quantities(&asked, names, scenes)?;
        let aim = match (spec.metric.is_some(), &spec.aim.value) {
            (true, Some(describe::Aim::Sense(describe::Sense::Maximise))) => SearchAim::Maximise,
            (true, Some(describe::Aim::Sense(describe::Sense::Minimise))) => SearchAim::Minimise,
            (true, Some(describe::Aim::Target(target))) => SearchAim::Target(target.target.0),
            (true, None) => {
                self.errors.push(spec.origin, mistake::missing_key("aim", describe::Aim::in_words()));
                return None;
            }
            (false, None) => SearchAim::Minimise,
            (false, Some(_)) => {
                self.errors
                    .push(spec.aim.origin, mistake::not_with("aim", "a difference, which is minimised"));
                return None;
            }
        };
        let sum: f64 = parts.iter().map(|part| weights[part.condition]).sum();
        let name = match parts.as_slice() {
            [one] => one.name.clone(),
            _ => format!("mean {}", parts[0].name.split(" (").next().unwrap_or_default()),
        };
        let parts = parts.into_iter().map(|part| (weights[part.condition] / sum, part)).collect();
        Some(SearchObjective { name, parts, aim })
    }

    pub(super) fn constraint(
        &mut self,
        spec: &Spanned<describe::Constraint>,
        names: &[&str],
        scenes: &[ConditionScene],
    ) -> Option<Vec<SearchConstraint>> {
        let asked = QuantitySpec {
            at: spec.origin,
            metric: &spec.metric,
            state: &spec.state,
            spectrum: &spec.spectrum,
            lab: &spec.lab,
            uv: &spec.uv,
            condition: &spec.condition,
            view: &spec.view,
        };
        let (at_least, at_most) =
            (spec.at_least.as_ref().map(|limit| limit.0), spec.at_most.as_ref().map(|limit| limit.0));
        if at_least.is_none() && at_most.is_none() {
            let expected = "a number under `at_least`, `at_most`, or both";
            self.errors.push(spec.origin, mistake::missing_key("at_least", expected));
            return None;
        }
        if let Some((from, to)) = at_least.zip(at_most).filter(|(least, most)| least > most) {
            self.errors.push(spec.at_most.origin, mistake::empty_range(from, to));
            return None;
        }
        let parts = self.quantities(&asked, names, scenes)?;
        Some(parts.into_iter().map(|quantity| SearchConstraint { quantity, at_least, at_most }).collect())
    }

    /// Returns the quantity in each of its conditions and views.
    fn quantities(
        &mut self,
        asked: &QuantitySpec<'_>,
        names: &[&str],
        scenes: &[ConditionScene],
    ) -> Option<Vec<NamedQuantity>> {
        let conditions = match &asked.condition.value {
            None => (0..names.len()).collect(),
            Some(name) => match names.iter().position(|known| known == name) {
                Some(at) => vec![at],
                None => {
                    self.errors.push(asked.condition.origin, no_such_condition(name, names));
                    return None;
                }
            },
        };
        let mut found = Vec::new();
        for condition in conditions {
            let ConditionScene { scene, states, .. } = &scenes[condition];
            let views = scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len();
            let asked_views = match &asked.view.value {
                None => (0..views).collect(),
                Some(view) if (view.0 as usize) < views => vec![view.0 as usize],
                Some(view) => {
                    let wrong = Diagnostic::new(format!("there is no view {}", view.0))
                        .expected(format!("a number from 0 to {}", views.saturating_sub(1)));
                    self.errors.push(asked.view.origin, wrong);
                    return None;
                }
            };
            for view in asked_views {
                let (name, quantity) = self.quantity(asked, view, &scene.grid, states)?;
                let of_condition = (names.len() > 1).then(|| names[condition].to_owned());
                let of_view = (views > 1).then(|| format!("view {view}"));
                let places: Vec<String> = of_condition.into_iter().chain(of_view).collect();
                let name = if places.is_empty() { name } else { format!("{name} ({})", places.join(", ")) };
                found.push(NamedQuantity { name, condition, quantity });
            }
        }
        Some(found)
    }

    fn quantity(
        &mut self,
        asked: &QuantitySpec<'_>,
        view: usize,
        grid: &Grid,
        states: &[String],
    ) -> Option<(String, Quantity)> {
        let given =
            [asked.metric.is_some(), asked.spectrum.is_some(), asked.lab.is_some(), asked.uv.is_some()];
        let given = given.into_iter().filter(|given| *given).count();
        if given != 1 {
            let keys = "`metric`, `spectrum`, `lab` and `uv`";
            self.errors.push(asked.at, mistake::exactly_one(keys, given));
            return None;
        }
        if let Some(metric) = &asked.metric.value {
            if asked.state.is_some() {
                let wrong = mistake::not_with("state", "`metric`, which names the state: \"white.Y\"");
                self.errors.push(asked.state.origin, wrong);
                return None;
            }
            if let Some(state) = &metric.state {
                self.known_state(state, asked.metric.origin, states)?;
            }
            if let Some(wrong) = mistake::lacks_states(&metric.text(), metric.metric, states) {
                self.errors.push(asked.metric.origin, wrong);
                return None;
            }
            let quantity = Quantity::Metric { view, state: metric.state.clone(), metric: metric.metric };
            return Some((metric.text(), quantity));
        }
        let Some(state) = asked.state.value.clone() else {
            self.errors.push(asked.at, mistake::missing_key("state", "the name of a state"));
            return None;
        };
        self.known_state(&state, asked.state.origin, states)?;
        if let Some(wanted) = &asked.spectrum.value {
            let (name, wanted) = self.desired(wanted, asked.spectrum.origin, grid)?;
            return Some((
                format!("{state} from {name}"),
                Quantity::SpectrumDistance { view, state, wanted },
            ));
        }
        if let Some(lab) = &asked.lab.value {
            let [l, a, b] = self.numbers(lab, asked.lab.origin, "[L, a, b]")?;
            let name = format!("{state} from Lab {l}, {a}, {b}");
            return Some((name, Quantity::ColourDistance { view, state, wanted: Lab { l, a, b } }));
        }
        let [u, v] =
            self.numbers(asked.uv.value.as_deref().unwrap_or_default(), asked.uv.origin, "[u', v']")?;
        let name = format!("{state} from u'v' {u}, {v}");
        Some((name, Quantity::ChromaticityDistance { view, state, wanted: UvPrime { u, v } }))
    }

    fn known_state(&mut self, state: &str, origin: Origin, states: &[String]) -> Option<()> {
        if states.iter().any(|known| known == state) {
            return Some(());
        }
        self.errors.push(origin, mistake::no_such_state(state, states));
        None
    }

    fn numbers<const N: usize>(
        &mut self,
        list: &[Spanned<Any>],
        origin: Origin,
        words: &str,
    ) -> Option<[f64; N]> {
        let numbers: Vec<f64> = list.iter().map(|number| number.0).collect();
        let found = numbers.try_into().ok();
        if found.is_none() {
            self.errors.push(origin, mistake::another_length(words));
        }
        found
    }

    fn desired(
        &mut self,
        wanted: &DesiredSpectrum,
        origin: Origin,
        grid: &Grid,
    ) -> Option<(String, Spectrum)> {
        let (name, table) = match wanted {
            DesiredSpectrum::Constant(share) => {
                return Some((share.0.to_string(), Spectrum::constant(grid, share.0)));
            }
            DesiredSpectrum::File(name) => {
                let kept = match self.base.library().open(name, LARGEST_FILE) {
                    Ok(kept) => kept,
                    Err(Missing::Unread(error)) => {
                        let tried = self.base.library().tried(name, origin.source > 0);
                        self.errors.push_unread(origin, error, tried);
                        return None;
                    }
                    Err(Missing::Unknown(wrong)) => {
                        self.errors.push(origin, wrong);
                        return None;
                    }
                };
                match read_fractions_with_notes(kept.file()) {
                    Ok(read) => {
                        self.file_notes.extend(read.warnings.iter().map(|note| format!("{name}: {note}")));
                        (name.clone(), read.value)
                    }
                    Err(error) => {
                        self.errors.push_data(origin, error);
                        return None;
                    }
                }
            }
            DesiredSpectrum::List(pairs) => {
                let pairs: Option<Vec<[f64; 2]>> =
                    pairs.iter().map(|pair| self.numbers(&pair.value, pair.origin, "[nm, value]")).collect();
                let (nm, values) = pairs?.into_iter().map(|[nm, value]| (nm, value)).unzip();
                match Tabulated::new(nm, values) {
                    Ok(table) => ("a list".to_owned(), table),
                    Err(error) => {
                        self.errors.push(origin, error);
                        return None;
                    }
                }
            }
        };
        match table.on(grid) {
            Ok(spectrum) => Some((name, spectrum)),
            Err(SpectraError::OutsideTable { first, last, .. }) => {
                let needed = (grid.start_nm(), grid.stop_nm());
                self.errors.push(origin, mistake::not_covered(&name, (first, last), needed, grid.step_nm()));
                None
            }
            Err(error) => {
                self.errors.push(origin, error);
                None
            }
        }
    }
}
