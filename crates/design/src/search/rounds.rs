//! Which tasks a search is made of, round by round.
//!
//! **One objective.** Descents from `starts` places of every combination of choices; or a population; or the one after the other.
//!
//! **Several.** First each one alone. Then, along the front, the first one again with the others kept at least
//! as good as a limit (the epsilon-constraint method: Haimes, Lasdon and Wismer 1971), from the designs that the first
//! round found and from places of their own. At last each of these from what its neighbours found.

use papilio_scenario::SearchMethod;

use super::starts::drawn;
use super::{Found, Search, Task, Way, front};

/// No search has more rounds.
const ROUNDS: usize = 5;

impl Search {
    /// The tasks of a round, given all that was found before it; none: the search is over.
    pub(super) fn round(&self, round: usize, found: &[Found]) -> Vec<Task> {
        let population_first = self.said.method == SearchMethod::Both;
        let mut tasks = match (round, population_first) {
            (0, _) => self.alone(self.said.method != SearchMethod::Gradient),
            (1, true) => self.polished(found),
            _ if self.aims.objectives() == 1 || round >= ROUNDS => Vec::new(),
            (1, false) | (2, true) => self.along(found),
            (2, false) | (3, true)
                if self.aims.objectives() == 2 && self.said.method != SearchMethod::Global =>
            {
                self.neighbours(found)
            }
            _ => Vec::new(),
        };
        tasks.iter_mut().enumerate().for_each(|(at, task)| task.number = found.len() + at);
        tasks
    }

    fn task(&self, objective: usize, limits: Vec<Option<f64>>, way: Way, evaluations: usize) -> Task {
        Task { number: 0, objective, limits, way, evaluations }
    }

    fn free(&self) -> Vec<Option<f64>> {
        vec![None; self.aims.objectives()]
    }

    /// Each objective for itself.
    fn alone(&self, by_population: bool) -> Vec<Task> {
        let objectives = 0..self.aims.objectives();
        if by_population {
            return objectives
                .map(|objective| self.task(objective, self.free(), Way::Population, self.said.evaluations))
                .collect();
        }
        objectives.flat_map(|objective| self.starts(objective, &self.free(), self.said.starts)).collect()
    }

    /// Descents of an objective from so many places of every combination of choices.
    fn starts(&self, objective: usize, limits: &[Option<f64>], starts: usize) -> Vec<Task> {
        let each = (self.said.evaluations / (starts * self.combinations.len()).max(1)).max(1);
        let ways = self
            .combinations
            .iter()
            .flat_map(|choices| (0..starts).map(|start| Way::Start { start, choices: choices.clone() }));
        ways.map(|way| self.task(objective, limits.to_vec(), way, each)).collect()
    }

    /// Descents from what populations found.
    fn polished(&self, found: &[Found]) -> Vec<Task> {
        let each = (self.said.evaluations / self.said.starts).max(1);
        let sound = found.iter().enumerate().filter(|(_, one)| !one.design.is_empty());
        sound.map(|(at, one)| self.task(at, self.free(), Way::From(one.design.clone()), each)).collect()
    }

    /// The first objective along the front, limits on the others.
    fn along(&self, found: &[Found]) -> Vec<Task> {
        let ends = self.ends(found);
        let Some(ranges) = self.ranges(&ends) else { return Vec::new() };
        let others = ranges.len() - 1;
        let inner = self.said.points.saturating_sub(if others == 1 { 2 } else { 0 });
        let mut tasks = Vec::new();
        for point in 0..inner {
            let shares = match others {
                1 => vec![(point + 1) as f64 / (inner + 1) as f64],
                _ => drawn(self.said.seed, u64::MAX - 1, point as u64, others),
            };
            let of_others =
                ranges[1..].iter().zip(shares).map(|((best, worst), share)| best + share * (worst - best));
            let limits: Vec<Option<f64>> = std::iter::once(None).chain(of_others.map(Some)).collect();
            if self.said.method == SearchMethod::Global {
                tasks.push(self.task(0, limits, Way::Population, self.said.evaluations));
                continue;
            }
            let each = (self.said.evaluations / (self.said.starts + ends.len())).max(1);
            let from_ends =
                ends.iter().map(|end| self.task(0, limits.clone(), Way::From(end.design.clone()), each));
            tasks.extend(from_ends);
            tasks.extend(self.starts(0, &limits, self.said.starts));
        }
        tasks
    }

    /// The best design of each objective alone.
    fn ends<'a>(&self, found: &'a [Found]) -> Vec<&'a Found> {
        let best = |objective: usize| {
            let front = front(&self.aims, found).into_iter().map(|at| &found[at]);
            let merit = |one: &Found| self.aims.merit(objective, &one.values).unwrap_or(f64::INFINITY);
            front.min_by(|a, b| merit(a).total_cmp(&merit(b)))
        };
        (0..self.aims.objectives()).filter_map(best).collect()
    }

    /// The best and the worst merit of each objective among the ends.
    fn ranges(&self, ends: &[&Found]) -> Option<Vec<(f64, f64)>> {
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

    /// Each point of the front again, from what the points beside it found.
    fn neighbours(&self, found: &[Found]) -> Vec<Task> {
        let front = front(&self.aims, found);
        let each = (self.said.evaluations / self.said.starts).max(1);
        let mut tasks = Vec::new();
        for (at, one) in front.iter().enumerate() {
            let Some(merit) = self.aims.merit(1, &found[*one].values) else { continue };
            let limits = vec![None, Some(merit)];
            let beside =
                [at.checked_sub(1), Some(at + 1)].into_iter().flatten().filter_map(|at| front.get(at));
            tasks
                .extend(beside.map(|other| {
                    self.task(0, limits.clone(), Way::From(found[*other].design.clone()), each)
                }));
        }
        tasks
    }
}
