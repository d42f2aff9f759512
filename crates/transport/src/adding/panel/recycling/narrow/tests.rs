//! Light under a narrow lobe, compared with the series summed on a grid that resolves the lobe.

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::{Direction, Plan, Recycling};
use super::Lit;
use crate::adding::panel::first_pass::Pass;
use crate::adding::panel::ledger::Sums;
use crate::adding::quadrature::Point;
use crate::{AngularTable, Base, Diffuser, Medium, Nodes, Reflector, Source};

const INDEX: f64 = 1.5;

/// A smooth reflectance, as of a film.
fn table() -> AngularTable {
    let value = |node: u32| 0.275 + 0.225 * (8.0 * (0.1 + 0.9 * f64::from(node) / 32.0)).cos();
    AngularTable {
        nodes: Nodes::Cosines(33),
        basis: (0..33).map(value).collect(),
        mixture: vec![1.0],
        common: vec![0.0],
    }
}

/// Returns recycled light between two directions by a plan, for a fraction g that is sent back.
fn light(pass: &Pass<'_>, plan: Plan, [view, source]: [Beta; 2], g: f64) -> f64 {
    let table = table();
    let base = Base { reflector: Reflector::Specular(table.clone()), inactive_absorptance: vec![0.0].into() };
    let medium = Medium::new(vec![INDEX].into());
    let recycling = Recycling::new(pass, plan);
    let r = recycling.reflectances(&base, &table, &medium);
    let direction = |beta: Beta| {
        let mut reflectance = vec![0.0];
        base.reflectance(beta.squared(), &medium, &mut reflectance);
        let round_trips = vec![1.0 / (1.0 - g * pass.straight().powi(2) * reflectance[0])];
        Direction { reflectance, round_trips }
    };
    let [of_view, of_source] = [view, source].map(direction);
    let [view, source] = [view, source].map(|beta| Point { beta, weight: 1.0 });
    let mut sums = Sums::zeros(1, &[Source::Beam(source.beta)]);
    if let Some(seen) = recycling.seen(&[view]) {
        let form = recycling.two_passes(&[&[view]], &[&[source]]).map(|forms| forms[0][0].clone());
        let towards = recycling.towards(&[view], Lit::Points(&[source], form)).expect("the lobe is narrow");
        recycling.add_narrow(&seen, &[vec![(Some(&towards), &of_source)]], &r, &[g], &mut sums);
    } else {
        let group = |point: Point, is_view| recycling.group(&[point], point, INDEX, is_view);
        let (one, other) = (group(view, true), group(source, false));
        recycling.add_by_columns((&one, &of_view), &[vec![(&other, &of_source)]], &r, &[g], &mut sums);
    }
    sums.directed[0][0]
}

/// Errors are stated relative to the recycled light, which is at most g R of all light: the more of it, the
/// more its third and later orders contribute.
#[test]
fn light_equals_series_on_grid() {
    let width = 0.03;
    for (regular_fraction, g) in [(0.0, 0.02), (0.0, 0.3), (0.3, 0.3)] {
        let lobe = Lobe::KCorrelation { width };
        let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
        let nodes = Nodes::Cosines(33);
        // Under a strong front, only the first level extrapolates.
        let (digits, most) = if g < 0.1 { (15.0, 8e-3) } else { (11.5, 3e-2) };
        let pass = Pass { diffuser: &diffuser, table: &nodes, index: INDEX, digits };
        for (view_deg, light_deg) in
            [(0.0, -20.0), (20.0, -20.0), (28.0, -20.0), (-60.0, -20.0), (75.0, -40.0)]
        {
            let ends = [Beta::towards(view_deg, 0.0, 1.0), Beta::from_source(light_deg, 25.0, 1.0)];
            let reach = (ends[0].length() * ends[1].length()).sqrt();
            let narrow = Plan::new(&pass, 0.5 * g, (Some(reach), true, false)).expect("light is sent back");
            assert!(narrow.narrow.is_some());
            let mut grid =
                Plan { narrow: None, terms: Vec::new(), recycled_digits: 13.0, width, ..narrow.clone() };
            grid.orders = grid.orders_for(&pass, Some(reach));
            let [found, truth] = [narrow, grid].map(|plan| light(&pass, plan, ends, g));
            let error = found / truth - 1.0;
            let what = format!("s {regular_fraction}, g {g}, {view_deg} and {light_deg} deg: {error:.1e}");
            assert!(error.abs() < most, "{what}");
        }
    }
}
