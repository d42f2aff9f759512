//! Tasks of each round of a search.
//!
//! **One objective.** Descents from `starts` points for every combination of choices; or a population; or a
//! population followed by descents.
//!
//! **Several objectives.** First each objective is optimised alone. Many designs may be as good in it; of these, the one that is
//! best in the next objectives is an end of the front (lexicographic order). Then the first objective is optimised at
//! points along the front, with limits on the others (the epsilon-constraint method: Haimes, Lasdon and
//! Wismer 1971). These tasks start from the ends and from new points. Finally each
//! point of the front is optimised again, starting from its neighbours.

use papilio_scenario::SearchMethod;

use super::front::EQUAL;
use super::starts::random_point;
use super::{Search, SearchResult, Task, TaskMethod, front};

impl Search {
    /// Tasks of a round, given the results of the rounds before it; empty if the search is finished.
    pub(super) fn round(&self, round: usize, results: &[SearchResult]) -> Vec<Task> {
        let objectives = self.aims.objectives();
        // Rounds until each objective is optimised alone, and until all ends of the front are known.
        let alone = 1 + usize::from(self.spec.method == SearchMethod::Both);
        let ends = alone + objectives - 1;
        let mut tasks = match round {
            0 => self.single_objectives(self.spec.method != SearchMethod::Gradient),
            _ if round < alone => self.refinements(results),
            _ if round < ends => self.tasks_of_ends(1 + round - alone, results),
            _ if objectives == 1 => Vec::new(),
            _ if round == ends => self.front_points(results),
            _ if round == ends + 1 && objectives == 2 && self.spec.method != SearchMethod::Global => {
                self.tasks_from_neighbours(results)
            }
            _ => Vec::new(),
        };
        tasks.iter_mut().enumerate().for_each(|(index, task)| task.number = results.len() + index);
        tasks
    }

    /// Number of rounds of a search in which every round finds designs.
    pub(super) fn expected_rounds(&self) -> usize {
        let of_front = match self.aims.objectives() {
            1 => 0,
            2 if self.spec.method != SearchMethod::Global => 2,
            _ => 1,
        };
        usize::from(self.spec.method == SearchMethod::Both) + self.aims.objectives() + of_front
    }

    fn task(
        &self,
        objective: usize,
        limits: Vec<Option<f64>>,
        method: TaskMethod,
        evaluations: usize,
    ) -> Task {
        Task { number: 0, objective, limits, method, evaluations }
    }

    fn no_limits(&self) -> Vec<Option<f64>> {
        vec![None; self.aims.objectives()]
    }

    /// Tasks that optimise each objective alone.
    fn single_objectives(&self, by_population: bool) -> Vec<Task> {
        let objectives = 0..self.aims.objectives();
        if by_population {
            return objectives
                .map(|objective| {
                    self.task(objective, self.no_limits(), TaskMethod::Population, self.spec.evaluations)
                })
                .collect();
        }
        objectives.flat_map(|objective| self.starts(objective, &self.no_limits(), self.spec.starts)).collect()
    }

    /// Descents of an objective from `starts` points for every combination of choices.
    fn starts(&self, objective: usize, limits: &[Option<f64>], starts: usize) -> Vec<Task> {
        let each = (self.spec.evaluations / (starts * self.combinations.len()).max(1)).max(1);
        let methods = self.combinations.iter().flat_map(|choices| {
            (0..starts).map(|start| TaskMethod::Start { start, choices: choices.clone() })
        });
        methods.map(|method| self.task(objective, limits.to_vec(), method, each)).collect()
    }

    /// Descents from the results of populations.
    fn refinements(&self, results: &[SearchResult]) -> Vec<Task> {
        let each = (self.spec.evaluations / self.spec.starts).max(1);
        let valid = results.iter().enumerate().filter(|(_, one)| !one.design.is_empty());
        valid
            .map(|(objective, one)| {
                self.task(objective, self.no_limits(), TaskMethod::From(one.design.clone()), each)
            })
            .collect()
    }

    /// Tasks that optimise, for each end of the front, the objective that is `step` after its own, without loss in its own and those
    /// between them. They start from all ends.
    fn tasks_of_ends(&self, step: usize, results: &[SearchResult]) -> Vec<Task> {
        let ends = self.ends(results);
        let objectives = self.aims.objectives();
        let each = (self.spec.evaluations / (self.spec.starts + ends.len()).max(1)).max(1);
        let mut tasks = Vec::new();
        for (own, end) in ends.iter().enumerate() {
            let mut limits = self.no_limits();
            for objective in (own..own + step).map(|objective| objective % objectives) {
                limits[objective] = self.aims.merit(objective, &end.values);
            }
            let next = (own + step) % objectives;
            if self.spec.method == SearchMethod::Global {
                tasks.push(self.task(next, limits, TaskMethod::Population, self.spec.evaluations));
                continue;
            }
            tasks.extend(
                ends.iter()
                    .map(|one| self.task(next, limits.clone(), TaskMethod::From(one.design.clone()), each)),
            );
        }
        tasks
    }

    /// Tasks that optimise the first objective along the front, with limits on the others.
    fn front_points(&self, results: &[SearchResult]) -> Vec<Task> {
        let ends = self.ends(results);
        let Some(ranges) = self.ranges(&ends) else { return Vec::new() };
        let others = ranges.len() - 1;
        let inner = self.spec.points.saturating_sub(if others == 1 { 2 } else { 0 });
        let mut tasks = Vec::new();
        for point in 0..inner {
            let fractions = match others {
                1 => vec![(point + 1) as f64 / (inner + 1) as f64],
                _ => random_point(self.spec.seed, u64::MAX - 1, point as u64, others),
            };
            let of_others = ranges[1..]
                .iter()
                .zip(fractions)
                .map(|((best, worst), fraction)| best + fraction * (worst - best));
            let limits: Vec<Option<f64>> = std::iter::once(None).chain(of_others.map(Some)).collect();
            if self.spec.method == SearchMethod::Global {
                tasks.push(self.task(0, limits, TaskMethod::Population, self.spec.evaluations));
                continue;
            }
            let each = (self.spec.evaluations / (self.spec.starts + ends.len())).max(1);
            let from_ends = ends
                .iter()
                .map(|end| self.task(0, limits.clone(), TaskMethod::From(end.design.clone()), each));
            tasks.extend(from_ends);
            tasks.extend(self.starts(0, &limits, self.spec.starts));
        }
        tasks
    }

    /// Best design of each objective: the ends of the front. Of equal ones, the best in the next objective, and so on.
    fn ends<'a>(&self, results: &'a [SearchResult]) -> Vec<&'a SearchResult> {
        let objectives = self.aims.objectives();
        let all = front(&self.aims, results);
        let best = |own: usize| {
            let mut equal: Vec<&SearchResult> = all.iter().map(|at| &results[*at]).collect();
            for objective in (own..own + objectives).map(|objective| objective % objectives) {
                let merit =
                    |one: &SearchResult| self.aims.merit(objective, &one.values).unwrap_or(f64::INFINITY);
                let least = equal.iter().map(|one| merit(one)).fold(f64::INFINITY, f64::min);
                equal.retain(|one| merit(one) <= least + EQUAL);
            }
            equal.first().copied()
        };
        (0..objectives).filter_map(best).collect()
    }

    /// Best and worst merit of each objective among the ends of the front.
    fn ranges(&self, ends: &[&SearchResult]) -> Option<Vec<(f64, f64)>> {
        let range = |objective: usize| {
            let merits: Option<Vec<f64>> =
                ends.iter().map(|end| self.aims.merit(objective, &end.values)).collect();
            let merits = merits.filter(|merits| !merits.is_empty())?;
            let (least, most) = (f64::INFINITY, f64::NEG_INFINITY);
            Some(
                merits
                    .iter()
                    .fold((least, most), |(least, most), merit| (least.min(*merit), most.max(*merit))),
            )
        };
        (0..self.aims.objectives()).map(range).collect()
    }

    /// Tasks that optimise each point of the front again, starting from the neighbouring points.
    fn tasks_from_neighbours(&self, results: &[SearchResult]) -> Vec<Task> {
        let front = front(&self.aims, results);
        let each = (self.spec.evaluations / self.spec.starts).max(1);
        let mut tasks = Vec::new();
        for (position, index) in front.iter().enumerate() {
            let Some(merit) = self.aims.merit(1, &results[*index].values) else { continue };
            let limits = vec![None, Some(merit)];
            let neighbours = [position.checked_sub(1), Some(position + 1)];
            let neighbours = neighbours.into_iter().flatten().filter_map(|position| front.get(position));
            tasks.extend(neighbours.map(|other| {
                self.task(0, limits.clone(), TaskMethod::From(results[*other].design.clone()), each)
            }));
        }
        tasks
    }
}
