//! Designs whose quantities are all colours: films on as many nodes over angle as X, Y and Z need.

use std::borrow::Cow;
use std::sync::Arc;

use papilio_spectra::{Grid, Spectrum, StateSpectra};
use papilio_transport::adding::{TableGradient, TableSums, TableValues, ViewSums};
use papilio_transport::{Cone, Nodes, ReflectanceFactor, Reflector};

use super::{Quantity, ViewGroup};
use crate::DisplayError;
use crate::meter::Meter;
use crate::pixel::film::{Mixture, common, fit_nodes, tabulated_for};
use crate::pixel::{SeenLight, WeightedNodes, WeightedTable};
use crate::scene::{FilmPixel, Pixel, Stop};
use crate::setup::Setup;

/// Largest estimate of the error of X, Y and Z that is caused by the nodes over angle, relative to Y of the
/// state (or to 0.01, if Y is less). If a tenth of the scene's `relative_error` is smaller, it is that. The
/// error is to be at most 1e-5: that of rare films, with structure at the critical angle of their gap, is up
/// to four times the estimate.
const NODES_ERROR: f64 = 2e-6;

/// Views of a display as functions of sums over a film's reflectance, and the nodes over angle for these
/// sums.
#[derive(Debug, Clone)]
pub(super) struct ColourViews {
    nodes: WeightedNodes,
    /// By number of the view; `None` if no quantity needs it.
    views: Arc<[Option<SeenView>]>,
}

#[derive(Debug, Clone)]
struct SeenView {
    /// For each index of a dispersive glass, with the numbers of the rows of its sums.
    sums: Vec<(ViewSums, Vec<usize>)>,
    /// Light of each source that the front reflects, `[wavelength]`.
    fronts: Vec<Vec<f64>>,
}

/// Film on the nodes that the light needs.
#[derive(Debug, Clone)]
pub(super) struct ColourTable {
    table: WeightedTable,
    /// Area fractions, `[state][gap]`, and the reflectance of the inactive area.
    mixture: Vec<f64>,
    common: Vec<f64>,
    /// All sums, `[row][state][wavelength]`.
    of_states: Vec<f64>,
}

impl ColourViews {
    /// Prepares the sums of all views of these quantities; `None` if they need more than colours, or if what
    /// is seen is not a function of few integrals over the table (see
    /// [`Kernel::view_sums`](papilio_transport::adding::Kernel::view_sums)).
    pub(super) fn new(
        setup: &Setup,
        groups: &[ViewGroup],
        quantities: &[Quantity],
    ) -> Result<Option<Self>, DisplayError> {
        let scene = &setup.scene;
        let (Pixel::Film(film), Stop::RelativeError { target, .. }) =
            (&scene.display.pixel, &scene.solver.stop)
        else {
            return Ok(None);
        };
        let Some(colours) = Meter::new(setup).colour_weights() else { return Ok(None) };
        let is_unsuitable = |group: &ViewGroup| group.kernels[0].view_sums(&setup.stack, 0).is_none();
        if !quantities.iter().all(Quantity::is_of_colours) || groups.iter().any(is_unsuitable) {
            return Ok(None);
        }
        // Over a perfect mirror the kernels have as many terms of recycled light as any film needs.
        let panels = Nodes::CosinePanels(WeightedNodes::light_nodes());
        let mixture = Mixture::new(film)?;
        let ones = vec![1.0; panels.count() * mixture.gaps_nm.len() * scene.grid.len()];
        let mut stack = setup.stack.clone();
        stack.set_reflector(Reflector::Specular(mixture.table(panels, ones.into(), film)));
        let mut views: Vec<Option<SeenView>> = vec![None; setup.views.len()];
        let (mut rows, mut lights, mut recycled) = (Vec::new(), Vec::new(), 0.0_f64);
        for group in groups {
            let fields: Vec<Cone> = setup.views[group.views.clone()].iter().map(|view| view.field).collect();
            let mut kernel = group.kernels[0].unprepared();
            kernel.prepare(&stack, &fields, &setup.sources);
            for (number, view) in group.views.clone().enumerate() {
                if quantities.iter().all(|quantity| quantity.view() != view) {
                    continue;
                }
                let Some(sums) = kernel.view_sums(&stack, number) else { return Ok(None) };
                let seen: Vec<_> = sums.into_iter().map(|sums| numbered(sums, &mut rows)).collect();
                for (sums, own) in &seen {
                    recycled = sums.sent_back().iter().copied().fold(recycled, f64::max);
                    lights.extend(lights_of(view, (sums, own), &colours));
                }
                let fronts = kernel.seen(&stack, number).into_iter().map(|rho| rho.front).collect();
                views[view] = Some(SeenView { sums: seen, fronts });
            }
        }
        let mut nodes = WeightedNodes::new(rows, lights, recycled, NODES_ERROR.min(0.1 * target));
        fit_nodes(&mut nodes, film, (&scene.grid, scene.display.index_above_pixel()))?;
        Ok(Some(Self { nodes, views: views.into() }))
    }

    /// Tabulates a film; `None` if it needs the nodes of all light.
    pub(super) fn table(
        &mut self,
        film: &FilmPixel,
        grid: (&Grid, &Spectrum),
        mixture: &Mixture,
    ) -> Result<Option<ColourTable>, DisplayError> {
        let Some(table) = tabulated_for(&mut self.nodes, film, grid, mixture)? else { return Ok(None) };
        let (mixture, common) = (mixture.fractions.clone(), common(film));
        let values = TableValues { basis: &table.values, mixture: &mixture, common: &common };
        let count = table.weights.len() / table.cosines.len();
        let of_states = TableSums::new(count, &table.weights, values).into_states();
        Ok(Some(ColourTable { table, mixture, common, of_states }))
    }

    /// Returns what a view sees of each source.
    pub(super) fn seen(&self, view: usize, table: &ColourTable) -> Option<Vec<ReflectanceFactor>> {
        let view = self.views[view].as_ref()?;
        let bins = table.common.len();
        let columns = table.states() * bins;
        let mut seen = vec![0.0; view.fronts.len() * columns];
        for (sums, rows) in &view.sums {
            sums.add_seen(&rows_of(&table.of_states, rows, columns), &mut seen);
        }
        let by_source = seen.chunks_exact(columns).zip(&view.fronts);
        let factor = |(via_pixel, front): (&[f64], &Vec<f64>)| ReflectanceFactor {
            via_pixel: StateSpectra::new(via_pixel.to_vec(), bins),
            front: front.clone(),
        };
        Some(by_source.map(factor).collect())
    }

    /// Returns the gradients of numbers with these derivatives by what a view sees,
    /// `[number][source][state][wavelength]`.
    pub(super) fn pull_back(
        &self,
        view: usize,
        table: &ColourTable,
        (seen, numbers): (&[f64], usize),
    ) -> Option<Vec<TableGradient>> {
        let nodes = table.table.cosines.len();
        let mut gradients = vec![TableGradient::zero(&table.values()); numbers];
        for (sums, rows) in &self.views[view].as_ref()?.sums {
            let own: Vec<&[f64]> =
                rows.iter().map(|row| &table.table.weights[row * nodes..][..nodes]).collect();
            let weights = own.concat();
            sums.pull_back(&TableSums::new(rows.len(), &weights, table.values()), seen, &mut gradients);
        }
        Some(gradients)
    }
}

impl ColourTable {
    /// Returns the cosines of the nodes.
    pub(super) fn cosines(&self) -> &[f64] {
        &self.table.cosines
    }

    fn states(&self) -> usize {
        let gaps = self.table.values.len() / (self.table.cosines.len() * self.common.len());
        self.mixture.len() / gaps
    }

    fn values(&self) -> TableValues<'_> {
        TableValues { basis: &self.table.values, mixture: &self.mixture, common: &self.common }
    }
}

/// Adds the rows of these sums to `rows` unless they are there, and returns their numbers. Views share terms
/// of recycled light.
fn numbered(sums: ViewSums, rows: &mut Vec<Vec<f64>>) -> (ViewSums, Vec<usize>) {
    let number = |row: &Vec<f64>| {
        rows.iter().position(|known| known == row).unwrap_or_else(|| {
            rows.push(row.clone());
            rows.len() - 1
        })
    };
    let numbers = sums.rows().iter().map(number).collect();
    (sums, numbers)
}

/// Returns these rows of a matrix with this number of columns; without a copy, if they follow each other.
fn rows_of<'a>(matrix: &'a [f64], rows: &[usize], columns: usize) -> Cow<'a, [f64]> {
    match rows.first() {
        Some(&first) if rows.iter().copied().eq(first..first + rows.len()) => {
            Cow::Borrowed(&matrix[first * columns..][..rows.len() * columns])
        }
        _ => rows.iter().flat_map(|row| &matrix[row * columns..][..columns]).copied().collect(),
    }
}

/// Returns the light of each source that a view sees.
fn lights_of<'a>(
    view: usize,
    (sums, rows): (&'a ViewSums, &'a [usize]),
    colours: &'a [Vec<Vec<f64>>],
) -> impl Iterator<Item = SeenLight> + 'a {
    let through = |weights: &Vec<f64>| weights.iter().zip(sums.through()).map(|(w, t)| w * t).collect();
    rows[..sums.sources()].iter().zip(colours).map(move |(row, colour)| SeenLight {
        view,
        colour: colour.iter().map(through).collect(),
        row: *row,
    })
}
