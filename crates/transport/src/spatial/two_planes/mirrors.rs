//! Mirror-like pixels below a filter.
//!
//! **What.** A mirror conserves the direction: light along beta that meets the pixel at x has passed the filter
//! at `x - D_h(beta)`, and passes it again at `x + D_h(beta)`. A flat face returns a part F of it to `x + 2D`, a
//! front of screen a part `F_m` to `x + 2D + 2m D_air`, after m return trips through the air below it. With
//! `s = 1/cos(theta)`,
//! `L(x) = t(x + D_h)^s rho(beta, x) t(x - D_h)^s (1 + F L(x - 2D) + sum over m of F_m L(x - 2D - 2m D_air))`.
//! A view sees the mean of L over a period, in each of its directions. Below flat layers, light of a pixel that changes polarisation has four numbers
//! ([`Mueller`]): rho is a matrix, F and `F_m` have one factor each for p, s and what is crossed, and a filter scales all of them.
//!
//! **How.** Light is followed back along its direction, from place to place. The period is divided at the edges
//! of all windows that light passes or meets at one of the places: in each piece all factors are constants, and
//! areas are exact. Places whose light is faint have the mean over the period. Directions, with their light,
//! are those of a [`PanelSpread`].
//!
//! **Limits.** The pixel below a window is uniform; between windows it is black.

use std::ops::Range;

use super::super::{PanelSpread, Part, Sample, SpreadError, air_below_front_mm, displacement};
use super::{Asked, Shown, TwoPlanes};
use crate::light::polarised::Quartet;
use crate::mueller::{Above, Factors, LIGHT, METER, dot, solved};
use crate::specular::FlatTop;
use crate::{Mueller, Panel, Top};

/// Fraction of the light below which a place has the mean over the period, at level 0 and each further one.
const FAINTEST: f64 = 1e-4;
const FAINTER: f64 = 0.01;
/// Most return trips that have places of their own at level 0, for windows that depend on one axis, or both.
const MOST_RETURNS: [usize; 2] = [24, 6];

/// Light of one direction at one wavelength: of mean polarisation, or the four numbers of polarised light.
trait Light: Copy + 'static {
    /// What a flat part returns of it.
    type Returned: Copy;
    /// What a pixel reflects of it.
    type Reflected: Copy;
    /// Light of which all other light is a sum.
    const UNITS: &'static [Self];
    const DARK: Self;

    fn plus(self, other: Self) -> Self;
    /// Multiplies it by a factor for all of it.
    fn scaled(self, factor: f64) -> Self;
    fn returned(self, by: Self::Returned) -> Self;
    fn reflected(self, by: Self::Reflected, passes: f64) -> Self;
    /// What a meter sees of it, times a factor.
    fn seen(self, factor: f64, meter: Self) -> f64;
    /// The largest fraction of any light that is returned, or reflected.
    fn most_returned(by: Self::Returned) -> f64;
    fn most_reflected(by: Self::Reflected) -> f64;
    /// Light that a pixel has reflected and all orders of returns have returned to it, of this light that arrives: `reflects` is what it reflects of each
    /// unit.
    fn settled(self, reflects: &[Self], returns: &[Self::Returned]) -> Self;
}

impl Light for f64 {
    type Returned = f64;
    type Reflected = f64;
    const UNITS: &'static [f64] = &[1.0];
    const DARK: f64 = 0.0;

    fn plus(self, other: f64) -> f64 {
        self + other
    }

    fn scaled(self, factor: f64) -> f64 {
        factor * self
    }

    fn returned(self, by: f64) -> f64 {
        by * self
    }

    fn reflected(self, by: f64, passes: f64) -> f64 {
        self * (passes * by)
    }

    fn seen(self, factor: f64, meter: f64) -> f64 {
        factor * meter * self
    }

    fn most_returned(by: f64) -> f64 {
        by
    }

    fn most_reflected(by: f64) -> f64 {
        by
    }

    fn settled(self, reflects: &[f64], returns: &[f64]) -> f64 {
        let reflects: f64 = reflects.iter().sum();
        self * reflects / (1.0 - returns.iter().sum::<f64>() * reflects)
    }
}

impl Light for Quartet {
    type Returned = Factors;
    /// The rows of its matrix.
    type Reflected = [Quartet; 4];
    const UNITS: &'static [Quartet] =
        &[[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    const DARK: Quartet = [0.0; 4];

    fn plus(self, other: Quartet) -> Quartet {
        [0, 1, 2, 3].map(|k| self[k] + other[k])
    }

    fn scaled(self, factor: f64) -> Quartet {
        self.map(|value| factor * value)
    }

    fn returned(self, by: Factors) -> Quartet {
        by.of(self)
    }

    fn reflected(self, by: [Quartet; 4], passes: f64) -> Quartet {
        by.map(|row| passes * dot(row, self))
    }

    fn seen(self, factor: f64, meter: Quartet) -> f64 {
        factor * dot(meter, self)
    }

    fn most_returned(by: Factors) -> f64 {
        by.largest()
    }

    /// At most twice what is reflected of unpolarised light.
    fn most_reflected([p, s, ..]: [Quartet; 4]) -> f64 {
        (p[0] + p[1] + s[0] + s[1]).min(1.0)
    }

    fn settled(self, reflects: &[Quartet], returns: &[Factors]) -> Quartet {
        let all = returns.iter().fold(Factors::NONE, |sum, order| sum.plus(*order));
        let row = |row: usize| {
            let reflected: Quartet = [0, 1, 2, 3].map(|column| reflects[column][row]);
            let again = all.before(reflected);
            let open = |column: usize| f64::from(u8::from(row == column)) - again[column];
            [open(0), open(1), open(2), open(3), dot(reflected, self)]
        };
        solved([0, 1, 2, 3].map(row))
    }
}

/// Places at which light along one direction meets the pixel, followed back from the viewer.
struct Line<L: Light> {
    /// Periods from the first place along x and y.
    shifts: Vec<[f64; 2]>,
    /// Place before each place by order of the return; `None` for one that is not followed.
    before: Vec<Vec<Option<usize>>>,
    /// Fractions that return, `[order][wavelength]`.
    returns: Vec<Vec<L::Returned>>,
}

impl<L: Light> Line<L> {
    /// Light that meets the pixel once.
    fn once() -> Self {
        Self { shifts: vec![[0.0; 2]], before: vec![Vec::new()], returns: Vec::new() }
    }

    /// Follows light until less than `faintest` of it is left, or so many times; `most`: largest fraction that
    /// a meeting with the pixel leaves; `ways`: periods of a return trip through glass and air.
    fn new(
        returns: Vec<Vec<L::Returned>>,
        ways: [[f64; 2]; 2],
        most: f64,
        (faintest, times): (f64, usize),
    ) -> Self {
        let largest = |row: &Vec<L::Returned>| row.iter().map(|by| L::most_returned(*by)).fold(0.0, f64::max);
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
    let by_face = bins.iter().map(|bin| face.below[*bin]).collect();
    in_orders::<f64>((by_face, faintest), by_front, |last, rest| *last += rest)
}

/// The same for polarised light.
fn returns_of_each(panel: &Panel, beta_squared: f64, bins: &[usize], faintest: f64) -> Vec<Vec<Factors>> {
    let (by_face, fronts): (Vec<Factors>, Vec<_>) =
        bins.iter().map(|bin| Above::returned_by(panel, beta_squared, *bin)).unzip();
    let by_front = |order: i32, rest: bool| fronts.iter().map(|front| front.after(order, rest)).collect();
    in_orders::<Quartet>((by_face, faintest), by_front, |last, rest| *last = last.plus(rest))
}

/// Orders by the front are followed as long as they return more than `faintest`.
fn in_orders<L: Light>(
    (by_face, faintest): (Vec<L::Returned>, f64),
    by_front: impl Fn(i32, bool) -> Vec<L::Returned>,
    add: impl Fn(&mut L::Returned, L::Returned),
) -> Vec<Vec<L::Returned>> {
    let mut all = vec![by_face];
    for order in 0.. {
        let own = by_front(order, false);
        if own.iter().all(|part| L::most_returned(*part) <= faintest) {
            let last = all.last_mut().into_iter().flatten();
            last.zip(by_front(order, true)).for_each(|(last, rest)| add(last, rest));
            break;
        }
        all.push(own);
    }
    all
}

/// What light of one direction meets, at some of the wavelengths.
struct Optics<L: Light> {
    /// These wavelengths.
    bins: Vec<usize>,
    /// `[window][wavelength]`.
    passes: Vec<f64>,
    /// `[state][wavelength]`.
    pixel: Vec<L::Reflected>,
    /// `[order][wavelength]`; empty where nothing returns.
    returns: Vec<Vec<L::Returned>>,
    /// Light that arrives at the filter from outside, and what a view makes of what leaves it.
    arrives: Vec<L>,
    meter: Vec<L>,
}

/// How far light is followed: faintest light, and most return trips.
type Limits = (f64, usize);

impl TwoPlanes {
    /// What is seen of mirror-like pixels, as reflectance factors: `spread` is that of the view and the light
    /// by direction, of all directions or those of a sum. A higher `level` is finer.
    ///
    /// # Errors
    /// If several components of the front reflect at different heights.
    pub fn mirrored(
        &self,
        panel: &Panel,
        (spread, sum): (&PanelSpread, Option<usize>),
        asked: &Asked<'_>,
        level: u32,
    ) -> Result<Shown, SpreadError> {
        let (bins, mut shown) = (self.bins, self.nothing(asked));
        let (mut rho, mut known) = (vec![0.0; panel.base.states() * bins], f64::NAN);
        let is_azimuthal = panel.base.is_azimuthal();
        let is_plane = self.cells.varies(0) && self.cells.varies(1);
        let faintest = FAINTEST * FAINTER.powi(level as i32);
        let limits = (faintest, MOST_RETURNS[usize::from(is_plane)] << level);
        let (mut face, is_flat) = (FlatTop::new(bins), !matches!(panel.top, Top::Diffuser(_)));
        let lengths_mm = [panel.gaps_mm.last().copied().unwrap_or_default(), air_below_front_mm(panel)?];
        for part in spread.parts() {
            let lit: Vec<usize> = (0..bins).filter(|bin| part.through[*bin] != 0.0).collect();
            if lit.is_empty() {
                continue;
            }
            part.each_sample_of(sum, |sample| {
                let squared = sample.beta.squared();
                let passes = self.oblique(squared.sqrt(), part.index());
                let passes: Vec<f64> =
                    passes.iter().flat_map(|row| lit.iter().map(|bin| row[*bin])).collect();
                let place = (part, sample, lengths_mm);
                if let Some(pixel) = &panel.mueller {
                    let optics = changed((panel, pixel), sample, &lit, passes, faintest);
                    return self.add(&optics, place, limits, asked, &mut shown);
                }
                if squared != known {
                    face.set_surface(panel, squared);
                }
                if squared != known || is_azimuthal {
                    panel.base.reflectance_towards(sample.beta, &panel.medium, &mut rho);
                }
                known = squared;
                let optics = Optics {
                    passes,
                    pixel: rho.chunks_exact(bins).flat_map(|row| lit.iter().map(|bin| row[*bin])).collect(),
                    returns: if is_flat { returns(panel, &face, &lit, faintest) } else { Vec::new() },
                    arrives: vec![1.0; lit.len()],
                    meter: lit.iter().map(|bin| part.through[*bin]).collect(),
                    bins: lit.clone(),
                };
                self.add(&optics, place, limits, asked, &mut shown);
            });
        }
        Ok(shown)
    }

    /// Adds what is seen along one direction; `lengths_mm` are those of the glass and of the air above it.
    fn add<L: Light>(
        &self,
        optics: &Optics<L>,
        (part, sample, lengths_mm): (&Part, Sample, [f64; 2]),
        limits: Limits,
        asked: &Asked<'_>,
        shown: &mut Shown,
    ) {
        let height = self.periods(displacement(sample.beta, self.height_mm, part.index()));
        let returns = optics.returns.iter().flatten().any(|by| L::most_returned(*by) > 0.0);
        let line = if returns {
            let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
            let of_pixel = most(&mut optics.pixel.iter().map(|by| L::most_reflected(*by)));
            let most = most(&mut optics.passes.iter().copied()).powi(2) * of_pixel;
            let [glass_mm, air_mm] = lengths_mm.map(|length| 2.0 * length);
            let ways = [(glass_mm, part.index()), (air_mm, 1.0)];
            let ways = ways.map(|(mm, index)| self.periods(displacement(sample.beta, mm, index)));
            Line::new(optics.returns.clone(), ways, most, limits)
        } else {
            Line::once()
        };
        let far = self.far(&line, height, optics, asked);
        let of = (optics, &optics.arrives[..]);
        self.follow((&line, height), of, (asked, &far), |period, window, own, area, light| {
            let slot = shown.slot(period, window, own);
            for ((bin, light), meter) in optics.bins.iter().zip(light).zip(&optics.meter) {
                slot[*bin] += light.seen(area * sample.weight, *meter);
            }
        });
    }

    /// Light of a place that is not followed: that of the mean over the period, through all orders,
    /// `[period][wavelength]`; empty where nothing returns.
    fn far<L: Light>(
        &self,
        line: &Line<L>,
        height: [f64; 2],
        optics: &Optics<L>,
        asked: &Asked<'_>,
    ) -> Vec<Vec<L>> {
        if line.returns.is_empty() {
            return Vec::new();
        }
        let (bins, units) = (optics.bins.len(), L::UNITS.len());
        // What the mean of the period reflects of each unit of light, `[period][wavelength][unit]`.
        let mut reflects = vec![L::DARK; asked.states.len() * bins * units];
        let all = Asked { windows: (0..self.transmittance.len()).collect(), ..asked.clone() };
        for (number, unit) in L::UNITS.iter().enumerate() {
            let (once, arrives) = (Line::once(), vec![*unit; bins]);
            self.follow((&once, height), (optics, &arrives), (&all, &[]), |period, _, _, area, light| {
                for (bin, light) in light.iter().enumerate() {
                    let sum = &mut reflects[(period * bins + bin) * units + number];
                    *sum = sum.plus(light.scaled(area));
                }
            });
        }
        let settled = |(bin, reflects): (usize, &[L])| {
            let returns: Vec<L::Returned> = line.returns.iter().map(|order| order[bin]).collect();
            optics.arrives[bin].settled(reflects, &returns)
        };
        let periods = reflects.chunks_exact(bins * units);
        periods.map(|row| row.chunks_exact(units).enumerate().map(settled).collect()).collect()
    }

    /// Calls `each` with the light of each piece of the period in each list of states: its list, window,
    /// sub-pixel and area, and the light by wavelength, of which `arrives` from outside.
    fn follow<L: Light>(
        &self,
        (line, height): (&Line<L>, [f64; 2]),
        (optics, arrives): (&Optics<L>, &[L]),
        (asked, far): (&Asked<'_>, &[Vec<L>]),
        mut each: impl FnMut(usize, usize, usize, f64, &[L]),
    ) {
        let (places, bins, between) = (line.shifts.len(), optics.bins.len(), self.sub_pixels);
        // Of each place: where light leaves through the filter, meets the pixel, and entered.
        let pieces = [0, 1].map(|axis| {
            let at = |shift: &[f64; 2]| [-1.0, 0.0, 1.0].map(|sign| shift[axis] + sign * height[axis]);
            self.cells.axis(axis).divided(&line.shifts.iter().flat_map(at).collect::<Vec<_>>())
        });
        let mut windows = vec![0; 3 * places];
        let mut light = vec![L::DARK; places * bins];
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
                        own.fill(L::DARK);
                        continue;
                    }
                    own.copy_from_slice(arrives);
                    for (order, returned) in line.returns.iter().enumerate() {
                        let from = match line.before[place][order] {
                            Some(other) => &before[(other - place - 1) * bins..][..bins],
                            None => &far[period],
                        };
                        for ((own, by), from) in own.iter_mut().zip(returned).zip(from) {
                            *own = own.plus(from.returned(*by));
                        }
                    }
                    let [up, down] = [up, down].map(|window| &optics.passes[of_row(window, bins)]);
                    let pixel = &optics.pixel[of_row(states[here], bins)];
                    for (own, ((up, down), by)) in own.iter_mut().zip(up.iter().zip(down).zip(pixel)) {
                        *own = own.reflected(*by, up * down);
                    }
                }
                each(period, left, own, along_x * along_y, &light[..bins]);
            }
        }
    }
}

/// The numbers of a row.
fn of_row(row: usize, length: usize) -> Range<usize> {
    row * length..(row + 1) * length
}

/// Returns what light of a direction meets above a pixel that changes polarisation, at some wavelengths.
fn changed(
    (panel, pixel): (&Panel, &Mueller),
    sample: Sample,
    bins: &[usize],
    passes: Vec<f64>,
    faintest: f64,
) -> Optics<Quartet> {
    let (all, squared) = (panel.base.bins(), sample.beta.squared());
    let matrices = pixel.at(sample.beta, &panel.medium);
    let rows = |(state, bin): (usize, usize)| {
        let of = |element: usize| matrices[(state * Mueller::ELEMENTS + element) * all + bin];
        [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| of(4 * row + column)))
    };
    let above = bins.iter().map(|bin| Above::new(panel, squared, *bin).transmits());
    let above: Vec<Factors> = above.collect();
    Optics {
        pixel: (0..pixel.states)
            .flat_map(|state| bins.iter().map(move |bin| (state, *bin)))
            .map(rows)
            .collect(),
        returns: returns_of_each(panel, squared, bins, faintest),
        arrives: above.iter().map(|above| above.of(LIGHT)).collect(),
        meter: above.iter().map(|above| above.before(METER)).collect(),
        bins: bins.to_vec(),
        passes,
    }
}
