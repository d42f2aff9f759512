//! Nodes over angle of designs whose quantities are all colours.

use papilio_transport::adding::FirstPass;
use papilio_transport::{AngularTable, Cone, Nodes, Reflector};

use super::{Quantity, ViewGroup};
use crate::DisplayError;
use crate::meter::Meter;
use crate::pixel::film::{Mixture, on_nodes};
use crate::pixel::{SeenLight, WeightedNodes};
use crate::scene::{Pixel, Stop};
use crate::setup::{Setup, base_of};

/// Largest error of X, Y and Z that is caused by the nodes over angle, relative to Y of the state (or to 0.01, if Y is less).
/// If a tenth of the scene's `relative_error` is smaller, it is that.
const NODES_ERROR: f64 = 1e-5;

/// Returns the nodes for the light that these quantities need; `None` if they need more than colours, or if what is seen is
/// not a function of few sums over the table's nodes (see [`Kernel::first_pass`](papilio_transport::adding::Kernel::first_pass)).
pub(super) fn weighted_nodes(
    setup: &Setup,
    groups: &[ViewGroup],
    quantities: &[Quantity],
) -> Result<Option<WeightedNodes>, DisplayError> {
    let scene = &setup.scene;
    let (Pixel::Film(film), Stop::RelativeError { target, .. }) = (&scene.display.pixel, &scene.solver.stop)
    else {
        return Ok(None);
    };
    let Some(colours) = Meter::new(setup).colour_weights() else { return Ok(None) };
    let is_unsuitable = |group: &ViewGroup| group.kernels[0].first_pass(&setup.stack, 0).is_none();
    if !quantities.iter().all(Quantity::is_of_colours) || groups.iter().any(is_unsuitable) {
        return Ok(None);
    }
    let mixture = Mixture::new(film)?;
    let panels = WeightedNodes::light_nodes();
    let index = scene.display.index_above_pixel();
    let values = on_nodes(&panels, film, &scene.grid, index, &mixture.gaps_nm)?;
    let mut stack = setup.stack.clone();
    let table: AngularTable = mixture.table(Nodes::CosinePanels(panels), values, film);
    base_of(&mut stack).reflector = Reflector::Specular(table);
    let (mut lights, mut recycled) = (Vec::new(), 0.0_f64);
    for group in groups {
        let fields: Vec<Cone> = setup.views[group.views.clone()].iter().map(|view| view.field).collect();
        let mut kernel = group.kernels[0].unprepared();
        kernel.prepare(&stack, &fields, &setup.sources);
        for (number, view) in group.views.clone().enumerate() {
            if quantities.iter().all(|quantity| quantity.view() != view) {
                continue;
            }
            let Some((passes, sent_back)) = kernel.first_pass(&stack, number) else { return Ok(None) };
            recycled = recycled.max(sent_back);
            lights.extend(passes.iter().flat_map(|pass| lights_of(view, pass, &colours)));
        }
    }
    Ok(Some(WeightedNodes::new(lights, recycled, NODES_ERROR.min(0.1 * target))))
}

/// Returns the light of each source that a view sees.
fn lights_of<'a>(
    view: usize,
    pass: &'a FirstPass,
    colours: &'a [Vec<Vec<f64>>],
) -> impl Iterator<Item = SeenLight> + 'a {
    let through = |weights: &Vec<f64>| weights.iter().zip(&pass.through).map(|(w, t)| w * t).collect();
    pass.rows.iter().zip(colours).map(move |(row, colour)| SeenLight {
        view,
        colour: colour.iter().map(through).collect(),
        weights: row.clone(),
    })
}
