//! Mirror-like pixels below a filter.
//!
//! **What.** A mirror conserves the direction: light along beta that meets the pixel at x has passed the filter
//! at `x - D_h(beta)`, and passes it again at `x + D_h(beta)`. A flat face returns a part F of it to `x + 2D`, a
//! front of screen a part `F_m` to `x + 2D + 2m D_air`, after m return trips through the air below it. With
//! `s = 1/cos(theta)`,
//! `L(x) = t(x + D_h)^s rho(beta, x) t(x - D_h)^s (1 + F L(x - 2D) + sum over m of F_m L(x - 2D - 2m D_air))`.
//! A view sees the mean of L over a period, in each of its directions.
//!
//! **How.** Light is followed back along its direction, from place to place. The period is divided at the edges
//! of all windows that light passes or meets at one of the places: in each piece all factors are constants, and
//! areas are exact. Places whose light is faint have the mean over the period. Directions, with their light,
//! are those of a [`PanelSpread`].
//!
//! **Limits.** The pixel below a window is uniform; between windows it is black.

use super::super::{PanelSpread, SpreadError, air_below_front_mm, displacement};
use super::{Asked, Shown, TwoPlanes};
use crate::specular::FlatTop;
use crate::{Panel, Top};

/// Fraction of the light below which a place has the mean over the period, at level 0 and each further one.
const FAINTEST: f64 = 1e-4;
const FAINTER: f64 = 0.01;
/// Most return trips that have places of their own at level 0, for windows that depend on one axis, or both.
const MOST_RETURNS: [usize; 2] = [24, 6];

/// Places at which light along one direction meets the pixel, followed back from the viewer.
struct Line {
    /// Periods from the first place along x and y.
    shifts: Vec<[f64; 2]>,
    /// Place before each place by order of the return; `None` for one that is not followed.
    before: Vec<Vec<Option<usize>>>,
    /// Fractions that return, `[order][wavelength]`.
    returns: Vec<Vec<f64>>,
}

impl Line {
    /// Light that meets the pixel once.
    fn once() -> Self {
        Self { shifts: vec![[0.0; 2]], before: vec![Vec::new()], returns: Vec::new() }
    }

    /// Follows light until less than `faintest` of it is left, or so many times; `most`: largest fraction that
    /// a meeting with the pixel leaves; `ways`: periods of a return trip through glass and air.
    fn new(returns: Vec<Vec<f64>>, ways: [[f64; 2]; 2], most: f64, (faintest, times): (f64, usize)) -> Self {
        let largest = |row: &Vec<f64>| row.iter().copied().fold(0.0, f64::max);
        let fractions: Vec<f64> = returns.iter().map(|row| most * largest(row)).collect();
        let nothing = vec![None; returns.len()];
        let mut line = Self { shifts: vec![[0.0; 2]], before: vec![nothing.clone()], returns };
        // Places after the same number of returns: numbers of trips through the air, of the place, and light.
        let mut last = vec![(0, 0, 1.0)];
        for time in 1..=times {
            let mut light = vec![0.0; last.last().map_or(0, |(air, ..)| air + fractions.len())];
            for (air, _, left) in &last {
                fractions.iter().enumerate().for_each(|(order, part)| light[air + order] += left * part);
            }
            let mut next = Vec::new();
            for (air, left) in light.into_iter().enumerate().filter(|(_, left)| *left > faintest) {
                next.push((air, line.shifts.len(), left));
                line.shifts.push([0, 1].map(|k| time as f64 * ways[0][k] + air as f64 * ways[1][k]));
                line.before.push(nothing.clone());
            }
            for (air, place, _) in &last {
                for (order, before) in line.before[*place].iter_mut().enumerate() {
                    *before = next.iter().find(|one| one.0 == air + order).map(|one| one.1);
                }
            }
            last = next;
        }
        line
    }
}

/// Fractions of the light of a mirror that come back by the face, by the front after one return trip through the
/// air below it, and so on, `[order][wavelength]`, for some wavelengths. The last order stands for all that
/// follow; none is below `faintest`.
fn returns(panel: &Panel, face: &FlatTop, bins: &[usize], faintest: f64) -> Vec<Vec<f64>> {
    let by_front = |order: i32, rest: bool| -> Vec<f64> {
        let of = |bin: &usize| {
            let front = panel.front.reflectance_below[*bin];
            let between = face.above[*bin] * front;
            let all = if rest { 1.0 / (1.0 - between) } else { 1.0 };
            face.t[*bin].powi(2) * front * between.powi(order) * all
        };
        bins.iter().map(of).collect()
    };
    let mut all: Vec<Vec<f64>> = vec![bins.iter().map(|bin| face.below[*bin]).collect()];
    for order in 0.. {
        let own = by_front(order, false);
        if own.iter().all(|part| *part <= faintest) {
            let last = all.last_mut().into_iter().flatten();
            last.zip(by_front(order, true)).for_each(|(last, rest)| *last += rest);
            break;
        }
        all.push(own);
    }
    all
}

/// Transmittances and reflectances in one direction, at some of the wavelengths.
struct Factors {
    bins: usize,
    /// `[window][wavelength]`.
    passes: Vec<f64>,
    /// `[state][wavelength]`.
    rho: Vec<f64>,
}

impl TwoPlanes {
    /// What is seen of mirror-like pixels, as reflectance factors: `spread` is that of the view and the light
    /// by direction. A higher `level` is finer.
    ///
    /// # Errors
    /// If several components of the front reflect at different heights.
    pub fn mirrored(
        &self,
        panel: &Panel,
        spread: &PanelSpread,
        asked: &Asked<'_>,
        level: u32,
    ) -> Result<Shown, SpreadError> {
        let (bins, mut shown) = (self.bins, self.nothing(asked));
        let (mut rho, mut known) = (vec![0.0; panel.base.states() * bins], f64::NAN);
        let is_azimuthal = panel.base.is_azimuthal();
        let is_plane = self.cells.varies(0) && self.cells.varies(1);
        let faintest = FAINTEST * FAINTER.powi(level as i32);
        let times = MOST_RETURNS[usize::from(is_plane)] << level;
        let (mut face, is_flat) = (FlatTop::new(bins), !matches!(panel.top, Top::Diffuser(_)));
        let lengths_mm = [panel.gaps_mm.last().copied().unwrap_or_default(), air_below_front_mm(panel)?];
        for part in spread.parts() {
            let lit: Vec<usize> = (0..bins).filter(|bin| part.through[*bin] != 0.0).collect();
            if lit.is_empty() {
                continue;
            }
            part.each_sample(|sample| {
                let squared = sample.beta.squared();
                if squared != known {
                    face.set_surface(panel, squared);
                }
                if squared != known || is_azimuthal {
                    panel.base.reflectance_towards(sample.beta, &panel.medium, &mut rho);
                }
                known = squared;
                let of = |row: &[f64]| lit.iter().map(|bin| row[*bin]).collect::<Vec<_>>();
                let passes = self.oblique(squared.sqrt(), part.index());
                let factors = Factors {
                    bins: lit.len(),
                    passes: passes.iter().flat_map(|row| of(row)).collect(),
                    rho: rho.chunks_exact(bins).flat_map(of).collect(),
                };
                let height = self.periods(displacement(sample.beta, self.height_mm, part.index()));
                let returns = if is_flat { returns(panel, &face, &lit, faintest) } else { Vec::new() };
                let line = if returns.iter().flatten().any(|part| *part > 0.0) {
                    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
                    let most = most(&factors.passes).powi(2) * most(&factors.rho);
                    let [glass_mm, air_mm] = lengths_mm.map(|length| 2.0 * length);
                    let ways = [(glass_mm, part.index()), (air_mm, 1.0)];
                    let ways = ways.map(|(mm, index)| self.periods(displacement(sample.beta, mm, index)));
                    Line::new(returns, ways, most, (faintest, times))
                } else {
                    Line::once()
                };
                let far = self.far(&line, height, &factors, asked);
                self.follow((&line, height), &factors, (asked, &far), |period, window, own, area, light| {
                    let slot = shown.slot(period, window, own);
                    for (bin, light) in lit.iter().zip(light) {
                        slot[*bin] += area * sample.weight * part.through[*bin] * light;
                    }
                });
            });
        }
        Ok(shown)
    }

    /// Light of a place that is not followed: that of the mean over the period, through all orders,
    /// `[period][wavelength]`; empty where nothing returns.
    fn far(&self, line: &Line, height: [f64; 2], factors: &Factors, asked: &Asked<'_>) -> Vec<Vec<f64>> {
        if line.returns.is_empty() {
            return Vec::new();
        }
        let mut mean = vec![vec![0.0; factors.bins]; asked.states.len()];
        let all = Asked { windows: (0..self.transmittance.len()).collect(), ..asked.clone() };
        self.follow((&Line::once(), height), factors, (&all, &[]), |period, _, _, area, light| {
            mean[period].iter_mut().zip(light).for_each(|(sum, light)| *sum += area * light);
        });
        for row in &mut mean {
            for (bin, mean) in row.iter_mut().enumerate() {
                let returned: f64 = line.returns.iter().map(|order| order[bin]).sum();
                *mean /= 1.0 - returned * *mean;
            }
        }
        mean
    }

    /// Calls `each` with the light of each piece of the period in each list of states: its list, window,
    /// sub-pixel and area, and the light by wavelength.
    fn follow(
        &self,
        (line, height): (&Line, [f64; 2]),
        factors: &Factors,
        (asked, far): (&Asked<'_>, &[Vec<f64>]),
        mut each: impl FnMut(usize, usize, usize, f64, &[f64]),
    ) {
        let (places, bins, between) = (line.shifts.len(), factors.bins, self.sub_pixels);
        // Of each place: where light leaves through the filter, meets the pixel, and entered.
        let pieces = [0, 1].map(|axis| {
            let at = |shift: &[f64; 2]| [-1.0, 0.0, 1.0].map(|sign| shift[axis] + sign * height[axis]);
            self.cells.axis(axis).divided(&line.shifts.iter().flat_map(at).collect::<Vec<_>>())
        });
        let mut windows = vec![0; 3 * places];
        let mut light = vec![0.0; places * bins];
        for ((along_y, y), (along_x, x)) in
            pieces[1].iter().flat_map(|y| pieces[0].iter().map(move |x| (y, x)))
        {
            let [left, own] = [0, 1].map(|k| self.cells.window([x[k], y[k]]));
            if own >= between || !asked.windows.contains(&left) {
                continue;
            }
            for (window, fields) in windows.iter_mut().zip(x.iter().zip(y)) {
                *window = self.cells.window([*fields.0, *fields.1]);
            }
            for (period, states) in asked.states.iter().enumerate() {
                for place in (0..places).rev() {
                    let [up, here, down] = [0, 1, 2].map(|k| windows[3 * place + k]);
                    let (own, before) = light.split_at_mut((place + 1) * bins);
                    let own = &mut own[place * bins..];
                    if here >= between {
                        own.fill(0.0);
                        continue;
                    }
                    own.fill(1.0);
                    for (order, returned) in line.returns.iter().enumerate() {
                        let from = match line.before[place][order] {
                            Some(other) => &before[(other - place - 1) * bins..][..bins],
                            None => &far[period],
                        };
                        own.iter_mut()
                            .zip(returned)
                            .zip(from)
                            .for_each(|((own, part), from)| *own += part * from);
                    }
                    let [up, down] = [up, down].map(|window| &factors.passes[window * bins..][..bins]);
                    let rho = &factors.rho[states[here] * bins..][..bins];
                    for (own, ((up, down), rho)) in own.iter_mut().zip(up.iter().zip(down).zip(rho)) {
                        *own *= up * down * rho;
                    }
                }
                each(period, left, own, along_x * along_y, &light[..bins]);
            }
        }
    }
}
