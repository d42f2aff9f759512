//! Rows of measured values of tables: sorted by part and pair of directions, and put together as a grid where they
//! are all combinations of values of four axes.

use std::collections::HashMap;
use std::ops::Range;

use papilio_goniometry::{Channel, Direction, Geometry, MeasuredPart, ScatterMode, SphericalGrid};

use super::angles::Angles;
use super::table_read::{ANGLES, Column, Layout, cells, channel_of, is_not_measured, way_of};
use super::text::Text;
use super::{BsdfProblem, MOST_CELLS};
use crate::error::{FormatError, Problem};
use crate::table::{QUARTER_TURN, TURN, Unit, may_be_radians, rounding};

/// Largest number of values; sorting them into pairs of directions takes some hundred bytes each.
const MOST_ROWS: usize = 10_000_000;

/// All rows, sorted by part.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) count: usize,
    channels: Vec<Channel>,
    numbers: HashMap<u64, usize>,
    ways: [Pairs; 4],
    /// Whether inclinations state the sides: they are from the normal of the front, up to 180 deg.
    is_unfolded: bool,
    pub(super) angles: Angles,
}

/// The rows of one part.
#[derive(Default)]
struct Pairs {
    pairs: Vec<[f64; 4]>,
    numbers: HashMap<[u64; 4], u32>,
    /// Pair, channel, value and start of the row, bytes.
    entries: Vec<(u32, u32, f64, usize)>,
}

pub(super) const WAYS: [ScatterMode; 4] = [
    ScatterMode::FrontReflection,
    ScatterMode::FrontTransmission,
    ScatterMode::BackTransmission,
    ScatterMode::BackReflection,
];

impl Rows {
    pub(super) fn take(
        &mut self,
        text: Text<'_>,
        layout: &Layout,
        line: Range<usize>,
    ) -> Result<(), FormatError> {
        let count = layout.columns.len();
        let found = cells(text, line.clone(), layout.separator).take(count + 1).count();
        if found != count {
            let expected =
                "the columns theta_i,phi_i,theta_o,phi_o[,wavelength],value, or those of the header";
            return Err(text.error(line, Problem::Columns { count, expected, found }));
        }
        let mut angles = [0.0; 4];
        let (mut way, mut channel, mut value) = (None, Channel::Monochrome, f64::NAN);
        let most = if layout.columns.contains(&Column::ScatterMode) { 90.0 } else { 180.0 };
        for (cell, column) in cells(text, line.clone(), layout.separator).zip(&layout.columns) {
            match *column {
                Column::Angle(k, unit) => angles[k] = self.angle(text, cell, (k, unit), most)?,
                Column::ScatterMode => way = Some(way_of(text, cell)?),
                Column::Channel(unit) => channel = channel_of(text, cell, unit)?,
                // An empty cell was not measured.
                Column::Value if is_not_measured(text, &cell) => {}
                Column::Other => {}
                Column::Value => value = text.value(cell)?,
            }
        }
        match way {
            Some(way) => self.add(text, line, way, angles, (channel, value)),
            None => self.add_unfolded(text, line, angles, (channel, value)),
        }
    }

    /// Reads angle `k` of a row, in degrees.
    fn angle(
        &mut self,
        text: Text<'_>,
        cell: Range<usize>,
        (k, unit): (usize, Option<Unit>),
        most: f64,
    ) -> Result<f64, FormatError> {
        let unit = unit.unwrap_or(Unit::Angle(1.0));
        let value = self.angles.degrees(text, cell.clone(), unit)?;
        let (least, most) = if k.is_multiple_of(2) { (0.0, most) } else { (-360.0, 720.0) };
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let expected = match (k % 2, most) {
            (0, 90.0) => "an inclination from 0 to 90 deg, from the normal of its side",
            (0, _) => "an inclination from 0 to 180 deg, from the normal of the front",
            _ => "an azimuth from -360 to 720 deg",
        };
        Err(text.error(cell, Problem::OutOfRange { what: ANGLES[k], value, expected }))
    }

    /// Replaces angles that are multiples of a step but for their rounding by these.
    fn without_rounding(&mut self) {
        // Inclinations, then azimuths, of the light and of the viewer together.
        let steps = [0, 1].map(|first| {
            let pairs = self.ways.iter().flat_map(|way| &way.pairs);
            self.angles.step(pairs.flat_map(|pair| [pair[first], pair[first + 2]]))
        });
        let snapped = |pair: [f64; 4]| {
            let snap = |k: usize| steps[k % 2].map_or(pair[k], |step| rounding::nearest(pair[k], step));
            [snap(0), snap(1), snap(2), snap(3)]
        };
        for way in &mut self.ways {
            if way.pairs.iter().any(|pair| snapped(*pair) != *pair) {
                *way = way.with_angles(snapped);
            }
        }
    }

    /// Adds the value of a row whose inclinations are from the normal of the front.
    pub(super) fn add_unfolded(
        &mut self,
        text: Text<'_>,
        line: Range<usize>,
        mut angles: [f64; 4],
        value: (Channel, f64),
    ) -> Result<(), FormatError> {
        self.is_unfolded = true;
        let way = unfold(&mut angles);
        self.add(text, line, way, angles, value)
    }

    /// Moves rows at exactly 90 deg, where the sides of the sample meet and which [`unfold`] gives to the front,
    /// to the side that has other rows; they stay at the front if both sides or none have some.
    fn settle_horizon(&mut self) {
        let at_horizon = |pair: &[f64; 4]| [0, 2].map(|k| pair[k] == 90.0);
        let has_others = |pairs: &Pairs| pairs.pairs.iter().any(|pair| at_horizon(pair) == [false; 2]);
        let known = self.ways.each_ref().map(has_others);
        for way in 0..self.ways.len() {
            if known[way] || self.ways[way].pairs.is_empty() {
                continue;
            }
            let rows = std::mem::take(&mut self.ways[way]);
            for (pair, channel, value, at) in rows.rows() {
                let [light, viewer] = at_horizon(&pair);
                // The part with the other side of the viewer, of the light, or of both.
                let turned = [(viewer, TURNED_VIEWER), (light, TURNED_LIGHT), (light && viewer, TURNED_BOTH)];
                let mut others = turned.into_iter().filter(|(may, _)| *may).map(|(_, turned)| turned[way]);
                let to = others.find(|to| known[*to]).unwrap_or(way);
                self.ways[to].take(pair, channel, value, at);
            }
        }
    }

    /// Refuses a ring of directions at one inclination beside a part with more of them: a display would have its
    /// values at all inclinations.
    fn refuse_ring(&self, text: Text<'_>) -> Result<(), FormatError> {
        let has_others = self.ways.iter().filter(|way| !way.pairs.is_empty()).count() > 1;
        for (pairs, way) in self.ways.iter().zip(WAYS).filter(|_| self.is_unfolded && has_others) {
            let Some([_, _, theta_o, phi_o]) = pairs.pairs.first().copied() else { continue };
            let is_ring = theta_o > 0.0
                && pairs.pairs.iter().all(|pair| pair[2] == theta_o)
                && pairs.pairs.iter().any(|pair| pair[3] != phi_o);
            if is_ring {
                let is_behind = matches!(way, ScatterMode::FrontTransmission | ScatterMode::BackReflection);
                let theta_o = if is_behind { 180.0 - theta_o } else { theta_o };
                let what =
                    format!("a {} with a single inclination of the viewer, {theta_o} deg,", way.name());
                let expected = "several inclinations of the viewer on each side of the sample that has rows; \
                                remove the others, or state the parts in a column `way`";
                return Err(text.whole(BsdfProblem::Unsupported { what, expected }));
            }
        }
        Ok(())
    }

    /// Adds the value of a row.
    pub(super) fn add(
        &mut self,
        text: Text<'_>,
        line: Range<usize>,
        way: usize,
        angles: [f64; 4],
        (channel, value): (Channel, f64),
    ) -> Result<(), FormatError> {
        if self.count >= MOST_ROWS {
            return Err(text.error(line, BsdfProblem::TooManyCells { limit: MOST_ROWS }));
        }
        let channel = self.channel(text, &line, channel)?;
        self.count += 1;
        self.ways[way].take(angles, channel, value, line.start);
        Ok(())
    }

    /// Returns whether all angles are probably in radians.
    pub(super) fn may_be_radians(&self) -> bool {
        let pairs = || self.ways.iter().flat_map(|way| &way.pairs);
        let of = |k: usize| pairs().map(|angles| angles[k]).collect::<Vec<f64>>();
        let all = [(QUARTER_TURN, of(0)), (TURN, of(1)), (QUARTER_TURN, of(2)), (TURN, of(3))];
        may_be_radians(all.iter().map(|(most, angles)| (*most, &angles[..])))
    }

    fn channel(&mut self, text: Text<'_>, line: &Range<usize>, channel: Channel) -> Result<u32, FormatError> {
        let key = match channel {
            Channel::Wavelength(nm) => nm.to_bits(),
            named => NAMED.iter().position(|known| *known == named).unwrap_or(0) as u64,
        };
        let next = self.channels.len();
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.channels.push(channel);
        }
        u32::try_from(number)
            .map_err(|_| text.error(line.clone(), BsdfProblem::TooManyCells { limit: MOST_CELLS }))
    }

    pub(super) fn parts(mut self, text: Text<'_>) -> Result<Vec<MeasuredPart>, FormatError> {
        self.without_rounding();
        if self.is_unfolded {
            self.settle_horizon();
        }
        self.refuse_ring(text)?;
        let mut order: Vec<usize> = (0..self.channels.len()).collect();
        if self.channels.iter().all(|channel| matches!(channel, Channel::Wavelength(_))) {
            let nm = |k: usize| match self.channels[k] {
                Channel::Wavelength(nm) => nm,
                _ => 0.0,
            };
            order.sort_by(|&a, &b| nm(a).total_cmp(&nm(b)));
        }
        let mut parts = Vec::new();
        for (pairs, way) in self.ways.into_iter().zip(WAYS) {
            if !pairs.pairs.is_empty() {
                parts.push(pairs.part(text, way, &self.channels, &order)?);
            }
        }
        Ok(parts)
    }
}

/// The channels with a name.
pub(super) const NAMED: [Channel; 8] = [
    Channel::Monochrome,
    Channel::X,
    Channel::Y,
    Channel::Z,
    Channel::Red,
    Channel::Green,
    Channel::Blue,
    Channel::Solar,
];

/// Indices in [`WAYS`] of the parts with the other side of the viewer, of the light, and of both.
const TURNED_VIEWER: [usize; 4] = [1, 0, 3, 2];
const TURNED_LIGHT: [usize; 4] = [2, 3, 0, 1];
const TURNED_BOTH: [usize; 4] = [3, 2, 1, 0];

/// Converts inclinations from the normal of the front to inclinations from the normals of their own sides,
/// and returns the index of the part in [`WAYS`].
fn unfold(angles: &mut [f64; 4]) -> usize {
    let from_back = angles[0] > 90.0;
    let to_back = angles[2] > 90.0;
    for (k, back) in [(0, from_back), (2, to_back)] {
        if back {
            angles[k] = 180.0 - angles[k];
        }
    }
    match (from_back, to_back) {
        (false, false) => 0,
        (false, true) => 1,
        (true, false) => 2,
        (true, true) => 3,
    }
}

impl Pairs {
    fn take(&mut self, angles: [f64; 4], channel: u32, value: f64, at: usize) {
        let next = self.pairs.len() as u32;
        let number = *self.numbers.entry(angles.map(f64::to_bits)).or_insert(next);
        if number == next {
            self.pairs.push(angles);
        }
        self.entries.push((number, channel, value, at));
    }

    /// The rows: angles, channel, value and start.
    fn rows(&self) -> impl Iterator<Item = ([f64; 4], u32, f64, usize)> {
        let row =
            |&(pair, channel, value, at): &(u32, _, _, _)| (self.pairs[pair as usize], channel, value, at);
        self.entries.iter().map(row)
    }

    /// Returns the same rows with other angles, of which several may be the same.
    fn with_angles(&self, angles: impl Fn([f64; 4]) -> [f64; 4]) -> Self {
        let mut others = Self::default();
        self.rows().for_each(|(pair, channel, value, at)| others.take(angles(pair), channel, value, at));
        others
    }

    fn part(
        self,
        text: Text<'_>,
        way: ScatterMode,
        channels: &[Channel],
        order: &[usize],
    ) -> Result<MeasuredPart, FormatError> {
        let present: Vec<usize> = {
            let mut used = vec![false; channels.len()];
            self.entries.iter().for_each(|entry| used[entry.1 as usize] = true);
            order.iter().copied().filter(|&k| used[k]).collect()
        };
        let cells = self.pairs.len();
        let all = cells.checked_mul(present.len()).filter(|all| *all <= MOST_CELLS);
        let all = all.ok_or_else(|| text.whole(BsdfProblem::TooManyCells { limit: MOST_CELLS }))?;
        if all > 4 * self.entries.len() + 1000 {
            return Err(text.whole(BsdfProblem::Missing {
                what: "value for most combinations of directions and wavelengths",
            }));
        }
        let (geometry, place) = self.geometry();
        let mut place_of_channel = vec![0; channels.len()];
        present.iter().enumerate().for_each(|(place, &k)| place_of_channel[k] = place);
        let mut values = vec![f64::NAN; all];
        let mut taken = vec![false; all];
        for &(pair, channel, value, at) in &self.entries {
            let cell = place_of_channel[channel as usize] * cells + place[pair as usize];
            if std::mem::replace(&mut taken[cell], true) {
                return Err(text.error(
                    at..text.bytes.len(),
                    BsdfProblem::Twice { what: "this pair of directions".to_owned() },
                ));
            }
            values[cell] = value;
        }
        let channels = present.iter().map(|&k| channels[k]).collect();
        Ok(MeasuredPart { way, channels, geometry, values, tis: Vec::new() })
    }

    /// Returns a grid if the pairs form one, otherwise the pairs, and the cell of each pair.
    fn geometry(&self) -> (Geometry, Vec<usize>) {
        let axes: [Vec<f64>; 4] = std::array::from_fn(|k| {
            let mut axis: Vec<f64> = self.pairs.iter().map(|pair| pair[k]).collect();
            axis.sort_by(f64::total_cmp);
            axis.dedup();
            axis
        });
        let product = axes.iter().try_fold(1_usize, |cells, axis| cells.checked_mul(axis.len()));
        if product != Some(self.pairs.len()) {
            let pairs =
                self.pairs.iter().map(|&[ti, pi, to, po]| [Direction::new(ti, pi), Direction::new(to, po)]);
            return (Geometry::Pairs(pairs.collect()), (0..self.pairs.len()).collect());
        }
        let cell = |pair: &[f64; 4]| {
            axes.iter().zip(pair).fold(0, |cell, (axis, angle)| {
                cell * axis.len() + axis.partition_point(|other| other < angle)
            })
        };
        let place = self.pairs.iter().map(cell).collect();
        let [theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg] = axes;
        (Geometry::Spherical(SphericalGrid { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg }), place)
    }
}
