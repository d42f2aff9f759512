//! Cells of a period: a grid along the edges of all windows.

use super::super::Window;

/// Cells of a period, each within one window or between windows.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodCells {
    axes: [Axis; 2],
    /// Number of windows. The areas between them, one for each pixel, have the numbers that follow.
    windows: usize,
    /// Window of each field between edges, rows from the bottom.
    fields: Vec<usize>,
}

/// How finely a period is divided into cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Division {
    /// Number of cells of equal length in a period, about.
    pub per_period: usize,
    /// Least number of cells of each window between `near`, graded towards its edges.
    pub per_window: usize,
    /// Fractions of the period along x between which windows have graded cells; below 0 and above 1 in the
    /// periods beside it.
    pub near: [f64; 2],
}

impl Division {
    /// Cells that are graded in all windows.
    pub fn everywhere(per_period: usize, per_window: usize) -> Self {
        Self { per_period, per_window, near: [0.0, 1.0] }
    }

    /// True for a window that is near, in the middle of which a place along x is.
    fn is_near(&self, place: f64) -> bool {
        [-1.0, 0.0, 1.0].iter().any(|period| (self.near[0]..self.near[1]).contains(&(place + period)))
    }
}

/// Division of the period along an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// Edges of cells, from 0 to 1.
    cells: Vec<f64>,
    /// Edges of windows, from 0 to 1.
    fields: Vec<f64>,
    /// Field of each cell.
    field_of: Vec<usize>,
}

/// Part of the period in which a cell and its shifted images are each within one cell or field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) length: f64,
    /// Cell at this place.
    pub(super) to: usize,
    /// Cell from which light comes back to this place.
    pub(super) from: usize,
    /// Fields in which the light passes the filter.
    pub(super) at: [usize; 2],
}

/// Edges closer than this are one.
const SAME: f64 = 1e-12;

impl PeriodCells {
    /// Divides a period of so many pixels along x, with these windows, into cells along each axis that the
    /// windows depend on. Near the edges of windows, light changes over lengths of `reach`, a fraction of the
    /// period along each axis.
    pub(super) fn new((windows, columns): (&[Window], usize), division: &Division, reach: [f64; 2]) -> Self {
        let pixels = columns;
        let axes = [(0, columns), (1, 1)]
            .map(|(axis, pixels)| Axis::new((windows, pixels), axis, division, reach[axis]));
        let [columns, rows] = axes.each_ref().map(|axis| axis.fields.len() - 1);
        let middle =
            |axis: usize, field: usize| 0.5 * (axes[axis].fields[field] + axes[axis].fields[field + 1]);
        let holds = |window: &Window, x: f64, y: f64| {
            window
                .rectangles
                .iter()
                .any(|one| (one.x[0]..one.x[1]).contains(&x) && (one.y[0]..one.y[1]).contains(&y))
        };
        let fields = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let fields = fields.map(|(column, row)| {
            let (x, y) = (middle(0, column), middle(1, row));
            let between = || windows.len() + ((x * pixels as f64) as usize).min(pixels - 1);
            windows.iter().position(|window| holds(window, x, y)).unwrap_or_else(between)
        });
        Self { fields: fields.collect(), windows: windows.len(), axes }
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.axes.iter().map(Axis::count).product()
    }

    /// Area of a cell, as a fraction of the period.
    pub fn area(&self, cell: usize) -> f64 {
        let columns = self.axes[0].count();
        self.axes[0].length(cell % columns) * self.axes[1].length(cell / columns)
    }

    /// Window of a cell; `None` between windows.
    pub fn window_of(&self, cell: usize) -> Option<usize> {
        let columns = self.axes[0].count();
        let [x, y] = [self.axes[0].field_of[cell % columns], self.axes[1].field_of[cell / columns]];
        Some(self.window([x, y])).filter(|window| *window < self.windows)
    }

    /// True if the windows depend on the place along an axis.
    pub(super) fn varies(&self, axis: usize) -> bool {
        self.axes[axis].count() > 1
    }

    pub(super) fn axis(&self, axis: usize) -> &Axis {
        &self.axes[axis]
    }

    pub(super) fn cell(&self, [column, row]: [usize; 2]) -> usize {
        row * self.axes[0].count() + column
    }

    /// Window of a field; those after the last one lie between windows.
    pub(super) fn window(&self, [column, row]: [usize; 2]) -> usize {
        self.fields[row * (self.axes[0].fields.len() - 1) + column]
    }
}

impl Axis {
    fn new((windows, pixels): (&[Window], usize), axis: usize, division: &Division, reach: f64) -> Self {
        let rectangles = windows.iter().flat_map(|window| &window.rectangles);
        let of_pixels = (0..=pixels).map(|pixel| pixel as f64 / pixels as f64);
        let mut fields: Vec<f64> =
            rectangles.flat_map(|one| if axis == 0 { one.x } else { one.y }).chain(of_pixels).collect();
        fields.sort_by(f64::total_cmp);
        fields.dedup_by(|a, b| (*a - *b).abs() < SAME);
        let (mut cells, mut field_of) = (vec![0.0], Vec::new());
        let is_one = fields.len() == 2;
        for (field, ends) in fields.windows(2).enumerate() {
            let length = ends[1] - ends[0];
            let is_near = axis == 1 || division.is_near(0.5 * (ends[0] + ends[1]));
            let uniform = (length * division.per_period as f64).ceil().max(1.0) as usize;
            let parts = match (is_one, is_near) {
                (true, _) => 1,
                (false, true) => uniform.max(division.per_window),
                (false, false) => uniform,
            };
            let grade = if is_near { grade(parts, FIRST * reach / length) } else { 0.0 };
            for part in 1..=parts {
                cells.push(ends[0] + length * graded(part as f64 / parts as f64, grade));
                field_of.push(field);
            }
        }
        Self { cells, fields, field_of }
    }

    fn count(&self) -> usize {
        self.field_of.len()
    }

    /// Edges of cells, from 0 to 1.
    pub(super) fn edges(&self) -> &[f64] {
        &self.cells
    }

    fn length(&self, cell: usize) -> f64 {
        self.cells[cell + 1] - self.cells[cell]
    }

    /// Divides the period at the edges of cells, and of fields shifted by this many periods: those of light
    /// that passes the filter the shift before it is at a place.
    pub(super) fn pieces(&self, [shift]: &[f64; 1], out: &mut Vec<Piece>) {
        self.divide(&[(&self.cells, 0.0), (&self.fields, *shift)], out, |at, length| Piece {
            length,
            to: at[0],
            from: 0,
            at: [at[1], 0],
        });
    }

    /// The same for light that comes from a place `whole` before, and passes the filter at two places before.
    pub(super) fn return_pieces(&self, passes: [f64; 2], whole: f64, out: &mut Vec<Piece>) {
        let lists: [(&[f64], f64); 4] =
            [(&self.cells, 0.0), (&self.cells, whole), (&self.fields, passes[0]), (&self.fields, passes[1])];
        self.divide(&lists, out, |at, length| Piece { length, to: at[0], from: at[1], at: [at[2], at[3]] });
    }

    /// Divides the period at the edges of fields shifted by each of these numbers of periods: lengths, each
    /// with the fields that are so many periods before it.
    pub(super) fn divided(&self, shifts: &[f64]) -> Vec<(f64, Vec<usize>)> {
        let lists: Vec<(&[f64], f64)> = shifts.iter().map(|shift| (&self.fields[..], *shift)).collect();
        let mut all = Vec::new();
        self.divide(&lists, &mut all, |at, length| (length, at.to_vec()));
        all
    }

    /// Calls `piece` for each piece between the edges of these lists, shifted by so many periods, with the interval
    /// of each list in which it lies, and its length.
    fn divide<P>(&self, lists: &[(&[f64], f64)], out: &mut Vec<P>, piece: impl Fn(&[usize], f64) -> P) {
        out.clear();
        let mut shifted: Vec<Shifted<'_>> =
            lists.iter().map(|(list, shift)| Shifted::new(list, *shift)).collect();
        let mut at = vec![0; lists.len()];
        let mut located = |middle: f64, at: &mut [usize]| {
            at.iter_mut().zip(&mut shifted).for_each(|(at, list)| *at = list.locate(middle));
        };
        if self.count() == 1 {
            located(0.5, &mut at);
            out.push(piece(&at, 1.0));
            return;
        }
        let mut edges: Vec<f64> =
            Vec::with_capacity(2 + lists.iter().map(|(list, _)| list.len()).sum::<usize>());
        edges.extend([0.0, 1.0]);
        for (list, shift) in lists {
            let shift = within_period(*shift);
            // The last edge is the first one of the next period.
            edges.extend(
                list[1..].iter().map(|edge| edge + shift).map(|at| if at < 1.0 { at } else { at - 1.0 }),
            );
        }
        // Stable: it finds the lists, which ascend but for one place each.
        edges.sort_by(f64::total_cmp);
        for ends in edges.windows(2) {
            let length = ends[1] - ends[0];
            if length > SAME {
                located(ends[0] + 0.5 * length, &mut at);
                out.push(piece(&at, length));
            }
        }
    }
}

/// The place in the period from 0 to 1.
fn within_period(place: f64) -> f64 {
    place - place.floor()
}

/// Intervals of a period between edges from 0 to 1, shifted; places are looked up in ascending order.
struct Shifted<'a> {
    edges: &'a [f64],
    shift: f64,
    /// The last interval found.
    interval: usize,
}

impl<'a> Shifted<'a> {
    fn new(edges: &'a [f64], shift: f64) -> Self {
        Self { edges, shift: within_period(shift), interval: 0 }
    }

    /// Number of the interval in which a place of the period is.
    fn locate(&mut self, place: f64) -> usize {
        let place = place - self.shift;
        let place = if place < 0.0 { place + 1.0 } else { place };
        if place < self.edges[self.interval] {
            self.interval = 0;
        }
        while self.interval + 2 < self.edges.len() && self.edges[self.interval + 1] <= place {
            self.interval += 1;
        }
        self.interval
    }
}

/// Length of the cell beside an edge, in lengths over which light changes.
const FIRST: f64 = 0.25;
/// Strongest grading: the cell in the middle is at most some tens of times as long as those beside the edges.
const MOST_GRADED: f64 = 3.0;

/// Where in a window a cell ends: `part` is the fraction of the cells before.
fn graded(part: f64, grade: f64) -> f64 {
    if part >= 1.0 || grade == 0.0 {
        part
    } else {
        0.5 + 0.5 * (grade * (2.0 * part - 1.0)).tanh() / grade.tanh()
    }
}

/// Grading with which the first of some cells has this length, a fraction of the window; 0 if equal cells are
/// as short.
fn grade(parts: usize, first: f64) -> f64 {
    let length = |grade: f64| graded(1.0 / parts as f64, grade);
    if parts < 3 || length(0.0) <= first {
        return 0.0;
    }
    let mut between = [0.0, MOST_GRADED];
    for _ in 0..30 {
        let middle = 0.5 * (between[0] + between[1]);
        between[usize::from(length(middle) < first)] = middle;
    }
    between[0]
}
