//! Light under a narrow lobe, compared with the series summed on a grid that resolves the lobe.

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_testing::everyday;

use super::super::{Direction, Plan, Recycling};
use super::Lit;
use crate::adding::panel::first_pass::Pass;
use crate::adding::panel::ledger::Sums;
use crate::adding::panel::projected::Circle;
use crate::light::cone_points::Point;
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

/// Form in which the light of a source is given.
#[derive(Clone, Copy)]
enum Given {
    /// Points, with exact passes or in the closed form alone.
    Points { exact: bool },
    /// Circles about the normal.
    Circles,
}

/// Returns recycled light between a view and directions of a source, each with its weight, by a plan, for a
/// fraction g that is sent back.
fn light(pass: &Pass<'_>, recycling: &Recycling, view: Beta, of_source: (&[Point], Given), g: f64) -> f64 {
    light_towards(pass, recycling, Point { beta: view, weight: 1.0 }, of_source, g)
}

/// Returns the same of a view with a weight.
fn light_towards(
    pass: &Pass<'_>,
    recycling: &Recycling,
    view: Point,
    (source, given): (&[Point], Given),
    g: f64,
) -> f64 {
    let table = table();
    let base = Base { reflector: Reflector::Specular(table.clone()), inactive_absorptance: vec![0.0].into() };
    let medium = Medium::new(vec![INDEX].into());
    let r = recycling.reflectances(&base, &table, &medium, &[g]);
    let direction = |beta: Beta| {
        let mut reflectance = vec![0.0];
        base.reflectance(beta.squared(), &medium, &mut reflectance);
        let round_trips = vec![1.0 / (1.0 - g * pass.straight().powi(2) * reflectance[0])];
        Direction { reflectance, round_trips }
    };
    let of_view = direction(view.beta);
    let mut sums = Sums::zeros(1, &[Source::Beam(source[0].beta)]);
    let Some(seen) = recycling.seen(&[view]) else {
        let group = |point: Point, is_view| recycling.group(&[point], point, INDEX, is_view);
        let groups: Vec<_> = source.iter().map(|l| (group(*l, false), direction(l.beta))).collect();
        let of_source = groups.iter().map(|(group, direction)| (group, direction)).collect();
        recycling.add_by_columns((&group(view, true), &of_view), &[of_source], &r, &[g], &mut sums);
        return sums.directed[0][0];
    };
    let towards: Vec<_> = match given {
        Given::Points { exact } => {
            let one = |l: &Point| {
                let all = recycling.between_points(&[&[view]], &[&[*l]]).expect("the lobe is narrow");
                let exact = if exact { all[0][0].clone() } else { Vec::new() };
                (recycling.towards((&[view], &seen), Lit::Points(&[*l], exact)), direction(l.beta))
            };
            source.iter().map(one).collect()
        }
        Given::Circles => {
            let parts = |l: &Point| [false, true].map(|odd| (circle(l, odd), odd, direction(l.beta)));
            let one = |(circle, odd, direction): (Circle, bool, Direction)| {
                (recycling.towards((&[view], &seen), Lit::Circles(&[circle], odd)), direction)
            };
            source.iter().flat_map(parts).map(one).collect()
        }
    };
    let towards = towards.iter().map(|(towards, direction)| (towards.as_ref(), direction)).collect();
    recycling.add_narrow(&seen, &[towards], &r, &[g], &mut sums);
    sums.directed[0][0]
}

/// Returns the even or odd part of light from one direction.
fn circle(light: &Point, odd: bool) -> Circle {
    let order = |m: u32| {
        let (sin, cos) = (f64::from(m) * light.beta.y.atan2(light.beta.x)).sin_cos();
        light.weight * if odd { sin } else { cos }
    };
    Circle { radius: light.beta.length(), orders: (0..400).map(order).collect() }
}

/// Returns some directions of light, the same on neither side of azimuth 0.
fn several() -> Vec<Point> {
    let one = |k: i32| {
        let (k, turn) = (f64::from(k), 0.8 - 0.9 * f64::from(k));
        let radius = 0.25 + 0.15 * k;
        Point { beta: Beta { x: radius * turn.cos(), y: radius * turn.sin() }, weight: 0.1 + 0.05 * k }
    };
    (0..5).map(one).collect()
}

/// The closed form between a view and a field, by the orders of its circles, equals that between the view and
/// all its directions.
#[test]
fn closed_form_of_circles_equals_sum_over_points() {
    for regular_fraction in [0.0, 0.3] {
        let lobe = Lobe::KCorrelation { width: 0.03 };
        let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
        let nodes = Nodes::AnglesInAir(vec![0.0, 1.0]);
        let pass = Pass { diffuser: &diffuser, table: &nodes, index: INDEX, digits: 11.5 };
        let plan = Plan::new(&pass, 0.1, (Some(1.0), true, true)).expect("light is sent back");
        let recycling = Recycling::new(&pass, plan);
        for view in [Beta { x: 0.5, y: -0.2 }, Beta { x: -0.9, y: 0.3 }, Beta::default()] {
            let view = [Point { beta: view, weight: 1.0 }];
            let seen = recycling.seen(&view).expect("the lobe is narrow");
            let weights =
                |lit: Lit<'_>| recycling.towards((&view, &seen), lit).expect("the lobe is narrow").lobe.rows;
            for light in several() {
                let points = weights(Lit::Points(&[light], Vec::new()));
                let [even, odd] = [false, true].map(|odd| weights(Lit::Circles(&[circle(&light, odd)], odd)));
                for (points, (even, odd)) in points.iter().zip(even.iter().zip(&odd)) {
                    let most = points.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    for (point, (even, odd)) in points.iter().zip(even.iter().zip(odd)) {
                        assert!(
                            (even + odd - point).abs() < 1e-6 * most,
                            "{regular_fraction} {view:?} {light:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Exact passes between a view and a field, interpolated between a few directions, equal those between the
/// view and all its directions, which are integrals.
///
/// An integral has the digits of its plan. Of the difference from the closed form, which alone is
/// interpolated, 0.6 of these are represented. Orders after the exact ones are extrapolated from the last of
/// them, which has the fewest.
#[test]
fn passes_of_fields_equal_sum_over_points() {
    for (width, regular_fraction, g, digits) in
        [(0.009, 0.0, 0.02, 11.5), (0.009, 0.0, 0.3, 15.0), (0.03, 0.3, 0.3, 15.0)]
    {
        let lobe = Lobe::KCorrelation { width };
        let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
        let pass = Pass { diffuser: &diffuser, table: &Nodes::Cosines(33), index: INDEX, digits };
        let plan = Plan::new(&pass, 0.5 * g, (Some(1.0), true, true)).expect("light is sent back");
        let exact = plan.narrow.expect("the lobe is narrow").exact;
        let fewest = exact.iter().flatten().map(|plan| plan.digits).fold(f64::INFINITY, f64::min);
        assert!(fewest < digits);
        let recycling = Recycling::new(&pass, plan);
        for view in everyday(1, [Beta { x: 0.5, y: -0.2 }, Beta { x: -0.9, y: 0.3 }, Beta::default()]) {
            let [points, closed, field] =
                [Given::Points { exact: true }, Given::Points { exact: false }, Given::Circles]
                    .map(|given| light(&pass, &recycling, view, (&several(), given), g));
            let most = (-fewest).exp() + (-0.6 * fewest).exp() * (closed / points - 1.0).abs();
            let error = field / points - 1.0;
            let what = format!("b {width}, s {regular_fraction}, g {g}, {view:?}: {error:.1e}, {most:.1e}");
            assert!(error.abs() < most, "{what}");
        }
    }
}

/// Light is proportional to the weight of a view's direction: those of a field of view are groups of their own, if the
/// diffuser has regular transmittance.
#[test]
fn light_is_proportional_to_the_weight_of_a_view() {
    let lobe = Lobe::KCorrelation { width: 0.02 };
    let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction: 0.3 };
    for digits in [11.5, 15.0] {
        let pass = Pass { diffuser: &diffuser, table: &Nodes::Cosines(33), index: INDEX, digits };
        let plan = Plan::new(&pass, 0.05, (Some(1.0), true, false)).expect("light is sent back");
        let recycling = Recycling::new(&pass, plan);
        let source = [Point { beta: Beta { x: 0.42, y: 0.1 }, weight: 1.0 }];
        for exact in [true, false] {
            let of = |weight: f64| {
                let view = Point { beta: Beta { x: 0.3, y: 0.0 }, weight };
                light_towards(&pass, &recycling, view, (&source, Given::Points { exact }), 0.1)
            };
            assert!((of(0.25) / of(1.0) - 0.25).abs() < 1e-9, "{digits} {exact}: {} {}", of(0.25), of(1.0));
        }
    }
}

/// Powers of the reflectance on one ring equal interpolated powers, for a field of view of 0.05 deg and a
/// beam, up to the square of the relative change of the reflectance over the field of view.
#[test]
fn powers_on_one_ring_equal_interpolated_powers() {
    for regular_fraction in [0.0, 0.3] {
        let lobe = Lobe::KCorrelation { width: 0.009 };
        let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
        let pass = Pass { diffuser: &diffuser, table: &Nodes::Cosines(33), index: INDEX, digits: 18.5 };
        let plan = Plan::new(&pass, 0.15, (Some(1.0), true, false)).expect("light is sent back");
        let recycling = Recycling::new(&pass, plan);
        let view =
            [-9e-4, 0.0, 9e-4].map(|away| Point { beta: Beta { x: 0.5 + away, y: 0.0 }, weight: 1.0 / 3.0 });
        let light = Point { beta: Beta { x: 0.42, y: 0.1 }, weight: 1.0 };
        let base = Base { reflector: Reflector::Specular(table()), inactive_absorptance: vec![0.0].into() };
        let (g, medium) = (0.3, Medium::new(vec![INDEX].into()));
        let r = recycling.reflectances(&base, &table(), &medium, &[g]);
        let direction = Direction { reflectance: vec![], round_trips: vec![] };
        let seen = recycling.seen(&view).expect("the lobe is narrow");
        let towards =
            recycling.towards((&view, &seen), Lit::Points(&[light], Vec::new())).expect("the lobe is narrow");
        assert!(seen.is_one_ring && towards.lobe.is_one_ring);
        let (mut any_seen, mut any_towards) = (seen.clone(), towards.clone());
        any_seen.is_one_ring = false;
        any_towards.lobe.is_one_ring = false;
        let [on_ring, truth] = [(&seen, &towards), (&any_seen, &any_towards)].map(|(seen, towards)| {
            let mut sums = Sums::zeros(1, &[Source::Beam(light.beta)]);
            recycling.add_narrow(seen, &[vec![(Some(towards), &direction)]], &r, &[g], &mut sums);
            sums.directed[0][0]
        });
        assert!((on_ring / truth - 1.0).abs() < 3e-4, "{regular_fraction}: {on_ring} {truth}");
    }
}

/// Errors are stated relative to the recycled light, which is at most g R of all light: the more of it, the
/// more its third and later orders contribute.
#[test]
fn light_equals_series_on_grid() {
    let width = 0.03;
    // Under a strong front, the first level has the closed form of the third pass, the second the pass
    // itself.
    for (regular_fraction, g, digits, most) in [
        (0.0, 0.02, 15.0, 8e-3),
        (0.0, 0.3, 11.5, 5e-2),
        (0.0, 0.3, 15.0, 4e-3),
        (0.3, 0.3, 11.5, 5e-2),
        (0.3, 0.3, 15.0, 4e-3),
    ] {
        let lobe = Lobe::KCorrelation { width };
        let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
        let nodes = Nodes::Cosines(33);
        let pass = Pass { diffuser: &diffuser, table: &nodes, index: INDEX, digits };
        // First the mirror direction, and light far from it.
        let ways = [(20.0, -20.0), (75.0, -40.0), (0.0, -20.0), (28.0, -20.0), (-60.0, -20.0)];
        for (view_deg, light_deg) in everyday(2, ways) {
            let ends = [Beta::towards(view_deg, 0.0, 1.0), Beta::from_source(light_deg, 25.0, 1.0)];
            let reach = (ends[0].length() * ends[1].length()).sqrt();
            let narrow = Plan::new(&pass, 0.5 * g, (Some(reach), true, false)).expect("light is sent back");
            assert!(narrow.narrow.is_some());
            let mut grid =
                Plan { narrow: None, terms: Vec::new(), recycled_digits: 13.0, width, ..narrow.clone() };
            grid.orders = grid.orders_for(&pass, Some(reach));
            let source = [Point { beta: ends[1], weight: 1.0 }];
            let given = Given::Points { exact: true };
            let of_plan = |plan| light(&pass, &Recycling::new(&pass, plan), ends[0], (&source, given), g);
            let [found, truth] = [narrow, grid].map(of_plan);
            let error = found / truth - 1.0;
            let what =
                format!("s {regular_fraction}, g {g}, {digits}, {view_deg} and {light_deg} deg: {error:.1e}");
            assert!(error.abs() < most, "{what}");
        }
    }
}
