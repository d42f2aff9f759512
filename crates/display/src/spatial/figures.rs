//! Lines, text and patterns of two states, seen in light that meets mirror-like pixels below a diffuser more than once.
//!
//! **What.** Light whose m meetings are at some places of a figure has the product of the reflectances there. The chains of
//! directions are those of `meetings.rs`; each has its light in all 2^m combinations of the two states, with the spectra of light,
//! layers and pixels. A figure says which state is at each place; the mean over its positions is exact for patterns.
//!
//! **Uniform pages** have a light that is known exactly: the sums over chains are scaled to that of the brighter state, and what a
//! figure has of each state adds what its own page differs by.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use papilio_transport::{Cone, Panel, Source, Top};

use super::PatternKind;
use super::meetings::{Air, Chain, Points, Way, each_number};
use super::patterns::Text;

/// Most combinations of states of all chains with the same number of meetings.
const MOST_COMBINATIONS: usize = 1 << 21;

/// Most chains times strokes of text: of large text some of the chains are enough.
const MOST_LOOKUPS: usize = 1 << 25;

/// Places closer than this, mm, are the same in any pattern.
const SAME_MM: f64 = 1e-9;

/// What light passes, and figures that are known.
pub(super) struct FigureLight {
    panel: Panel,
    view: Cone,
    source: Source,
    index: f64,
    glass_mm: f64,
    air: Air,
    points: Points,
    /// Weights of the light, `[wavelength]`.
    weights: Vec<f64>,
    known: Mutex<Vec<Arc<Figures>>>,
}

/// Chains with the same number of meetings.
struct Group {
    meetings: usize,
    /// Places of the meetings of each chain, mm.
    places: Vec<[f64; 2]>,
    /// Light of each chain by combination: bit i is set where meeting i is with the second state.
    lights: Vec<f64>,
    /// Number of chains of which the light is the mean, with those without light.
    count: usize,
}

/// Light of two states that meets them more than once.
pub(super) struct Figures {
    groups: Vec<Group>,
    states: [usize; 2],
}

/// Means over chains: of a figure, and of the pages of both states.
struct Means {
    figure: f64,
    pages: [f64; 2],
}

impl FigureLight {
    pub(super) fn new(way: &Way<'_>, points: Points, panel: &Panel, weights: &[f64]) -> Self {
        Self {
            panel: panel.clone(),
            view: *way.view,
            source: way.source.clone(),
            index: way.index,
            glass_mm: way.glass_mm,
            air: way.air.clone(),
            points,
            weights: weights.to_vec(),
            known: Mutex::default(),
        }
    }

    /// Light of two states.
    pub(super) fn of(&self, states: [usize; 2]) -> Arc<Figures> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(figures) = known.iter().find(|figures| figures.states == states) {
            return Arc::clone(figures);
        }
        let figures = Arc::new(self.followed(states));
        known.push(Arc::clone(&figures));
        figures
    }

    fn followed(&self, states: [usize; 2]) -> Figures {
        let Self { panel, weights, .. } = self;
        let Top::Diffuser(diffuser) = &panel.top else { return Figures { groups: Vec::new(), states } };
        let (view, source, index, glass_mm, air) =
            (&self.view, &self.source, self.index, self.glass_mm, &self.air);
        let way = Way { view, source, diffuser, index, glass_mm, air, kept: 1.0 };
        let bins = weights.len();
        let kept = |bin: usize| panel.front.reflectance_below[bin] * diffuser.transmittance[bin].powi(2);
        let once = |bin: usize| {
            weights[bin] * (panel.front.transmittance[bin] * diffuser.transmittance[bin]).powi(2)
        };
        let mut rho = vec![0.0; panel.base.states() * bins];
        let mut chain = Chain::default();
        let mut groups = Vec::new();
        let (mut rows, mut next) = (Vec::new(), Vec::new());
        for (meetings, count, numbers) in each_number(&self.points) {
            let count = count.min((MOST_COMBINATIONS >> meetings).max(1));
            let mut group = Group { meetings, places: Vec::new(), lights: Vec::new(), count };
            let light: Vec<f64> =
                (0..bins).map(|bin| once(bin) * kept(bin).powi(meetings as i32 - 1)).collect();
            for point in 0..count as u64 {
                let weight = chain.follow(&way, meetings, &numbers, point);
                if weight <= 0.0 {
                    continue;
                }
                rows.clear();
                rows.extend(light.iter().map(|light| weight * light));
                chain.colour(&way, &mut rows);
                for beta in chain.at_pixel() {
                    panel.base.reflectance(beta.squared(), &panel.medium, &mut rho);
                    next.clear();
                    for state in states {
                        let rho = &rho[state * bins..][..bins];
                        for row in rows.chunks_exact(bins) {
                            next.extend(row.iter().zip(rho).map(|(light, rho)| light * rho.max(0.0)));
                        }
                    }
                    std::mem::swap(&mut rows, &mut next);
                }
                group.lights.extend(rows.chunks_exact(bins).map(|row| row.iter().sum::<f64>()));
                chain.each_place(&way, |place_mm| group.places.push(place_mm));
            }
            groups.push(group);
        }
        Figures { groups, states }
    }
}

impl Figures {
    /// Light of a figure of the first state on a page of the second, at a place of which `is_second` tells whether it belongs to
    /// the page. `exact`: that of uniform pages.
    pub(super) fn at_place(&self, exact: [f64; 2], is_second: impl Fn([f64; 2]) -> bool) -> f64 {
        let means = self.means(|places, lights| lights[bits(places, &is_second)]);
        means.light(exact, 0.0)
    }

    /// Mean light of a pattern whose first half is of the first state.
    pub(super) fn of_pattern(&self, exact: [f64; 2], kind: PatternKind, period_mm: f64) -> f64 {
        let mut combinations = Vec::new();
        let means = self.means(|places, lights| {
            if period_mm == 0.0 {
                return mean_of_fine(places, lights);
            }
            let along = |axis: usize, found: &mut Vec<(usize, f64)>| pieces(places, axis, period_mm, found);
            along(0, &mut combinations);
            let across = match kind {
                PatternKind::Stripes => vec![(0, 1.0)],
                PatternKind::Checkerboard => {
                    let mut across = Vec::new();
                    along(1, &mut across);
                    across
                }
            };
            let of_row = |(row, height): &(usize, f64)| -> f64 {
                let light = combinations.iter().map(|(column, width)| width * lights[row ^ column]);
                height * light.sum::<f64>()
            };
            across.iter().map(of_row).sum()
        });
        means.light(exact, 0.5)
    }

    /// Light of the middle of each stroke of text of the first state on a page of the second.
    pub(super) fn of_text(&self, exact: [f64; 2], text: &Text<'_>) -> Vec<f64> {
        let chains: usize = self.groups.iter().map(Group::len).sum();
        let part = (MOST_LOOKUPS as f64 / (chains * text.middles.len()).max(1) as f64).min(1.0);
        let [columns, rows] = text.bitmap.count.map(|count| count as i64);
        let mut sums = vec![0.0; text.middles.len()];
        let mut pages = [0.0; 2];
        let mut steps: Vec<[i64; 2]> = Vec::new();
        for group in &self.groups {
            let (chains, scale) = group.first(part);
            for (places, lights) in group.chains(chains) {
                steps.clear();
                // Light goes from a place to the opposite one about the place where it is seen.
                let step =
                    |place: &[f64; 2]| [0, 1].map(|k| (0.5 - place[k] / text.pitch_mm[k]).floor() as i64);
                steps.extend(places.iter().map(step));
                for (sum, middle) in sums.iter_mut().zip(text.middles) {
                    let (column, row) = (*middle as i64 % columns, *middle as i64 / columns);
                    let is_white = |step: [i64; 2]| {
                        let (x, y) = (column + step[0], row + step[1]);
                        let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
                        !(inside && text.bitmap.black[(y * columns + x) as usize])
                    };
                    *sum += scale * lights[bits(&steps, is_white)];
                }
                pages[0] += scale * lights[0];
                pages[1] += scale * lights[lights.len() - 1];
            }
        }
        sums.into_iter().map(|figure| Means { figure, pages }.light(exact, 0.0)).collect()
    }

    fn means(&self, mut of: impl FnMut(&[[f64; 2]], &[f64]) -> f64) -> Means {
        let mut means = Means { figure: 0.0, pages: [0.0; 2] };
        for group in &self.groups {
            let (chains, scale) = group.first(1.0);
            for (places, lights) in group.chains(chains) {
                means.figure += scale * of(places, lights);
                means.pages[0] += scale * lights[0];
                means.pages[1] += scale * lights[lights.len() - 1];
            }
        }
        means
    }
}

impl Means {
    /// Scales to the exact light of pages; `part` is what the figure has of the first state, of which the page has none.
    fn light(&self, exact: [f64; 2], part: f64) -> f64 {
        let Self { figure, pages } = self;
        let brighter = usize::from(pages[1] > pages[0]);
        let scale = if pages[brighter] > 0.0 { exact[brighter] / pages[brighter] } else { 0.0 };
        let [first, second] = [0, 1].map(|k| exact[k] - scale * pages[k]);
        scale * figure + part * first + (1.0 - part) * second
    }
}

impl Group {
    fn len(&self) -> usize {
        self.places.len() / self.meetings
    }

    /// The first ones of the chains, about this part of them, and what each counts.
    fn first(&self, part: f64) -> (Range<usize>, f64) {
        let used = ((part * self.len() as f64).ceil() as usize).min(self.len());
        (0..used, if used > 0 { self.len() as f64 / (self.count * used) as f64 } else { 0.0 })
    }

    /// Places and lights of some chains.
    fn chains(&self, chains: Range<usize>) -> impl Iterator<Item = (&[[f64; 2]], &[f64])> {
        let (places, lights) =
            (self.places.chunks_exact(self.meetings), self.lights.chunks_exact(1 << self.meetings));
        places.zip(lights).take(chains.len())
    }
}

/// Combination in which these meetings are with the second state.
fn bits<T: Copy>(places: &[T], is_second: impl Fn(T) -> bool) -> usize {
    places.iter().rev().fold(0, |bits, place| (bits << 1) | usize::from(is_second(*place)))
}

/// Combinations of the meetings with stripes across an axis, each with its part of all positions of the stripes.
fn pieces(places: &[[f64; 2]], axis: usize, period_mm: f64, found: &mut Vec<(usize, f64)>) {
    // Where each meeting passes an edge, in periods.
    let mut edges: Vec<(f64, usize)> = Vec::with_capacity(2 * places.len());
    let mut now = 0;
    for (meeting, place) in places.iter().enumerate() {
        let at = (place[axis] / period_mm).rem_euclid(1.0);
        now |= usize::from((1.0 - at).rem_euclid(1.0) >= 0.5) << meeting;
        edges.extend([at, (at + 0.5).rem_euclid(1.0)].map(|edge| (edge, 1 << meeting)));
    }
    edges.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.clear();
    let mut last = 0.0;
    for (edge, meeting) in edges {
        if edge > last {
            found.push((now, edge - last));
            last = edge;
        }
        if edge > 0.0 {
            now ^= meeting;
        }
    }
    found.push((now, 1.0 - last));
}

/// Mean over the combinations of a fine pattern: either state at each place, whatever is at the others.
fn mean_of_fine(places: &[[f64; 2]], lights: &[f64]) -> f64 {
    let mut apart: Vec<([f64; 2], usize)> = Vec::with_capacity(places.len());
    for (meeting, place) in places.iter().enumerate() {
        let is_same =
            |(known, _): &&mut ([f64; 2], usize)| (known[0] - place[0]).hypot(known[1] - place[1]) < SAME_MM;
        match apart.iter_mut().find(is_same) {
            Some((_, meetings)) => *meetings |= 1 << meeting,
            None => apart.push((*place, 1 << meeting)),
        }
    }
    let of_choice = |choice: usize| {
        let chosen = apart.iter().enumerate().filter(|(k, _)| (choice >> k) & 1 == 1);
        lights[chosen.map(|(_, (_, meetings))| meetings).sum::<usize>()]
    };
    let choices = 1 << apart.len();
    (0..choices).map(of_choice).sum::<f64>() / choices as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two chains of two meetings, of which one meeting lies on the page: each has the light of its own combination.
    #[test]
    fn figure_has_the_light_of_each_meeting_at_its_place() {
        let places = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]];
        // First on the figure and second on the page is 3; the other way round 2.
        let lights = vec![0.0, 2.0, 3.0, 6.0];
        let group = Group { meetings: 2, places, lights: [lights.clone(), lights].concat(), count: 2 };
        let figures = Figures { groups: vec![group], states: [0, 1] };
        let is_second = |place: [f64; 2]| place[0] > 0.5;
        let found = |first: usize| {
            let group = &figures.groups[0];
            let (places, lights) = group.chains(0..2).nth(first).unwrap();
            lights[bits(places, is_second)]
        };
        assert_eq!([found(0), found(1)], [3.0, 2.0]);
        assert_eq!(figures.at_place([0.0, 6.0], is_second), 2.5);
        // Stripes of 1 mm: each chain has either combination over half of the positions.
        assert_eq!(figures.of_pattern([0.0, 6.0], PatternKind::Stripes, 2.0), 2.5);
    }
}
