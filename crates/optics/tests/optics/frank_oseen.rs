//! The director at a voltage: thresholds, the exact solution of splay and bend, and the equations of equilibrium.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::frank_oseen::{DrivenCell, INTERVALS, Nematic, Profile, director};

const EPSILON_0: f64 = 8.854_187_812_8;
const NEMATIC: Nematic = Nematic { elastic_pn: [11.0, 6.5, 17.0], permittivity: [19.0, 5.2] };
const NEGATIVE: Nematic = Nematic { elastic_pn: [16.7, 7.0, 18.1], permittivity: [3.6, 7.8] };

fn cell(nematic: Nematic, tilt_deg: f64, twist_deg: f64, volts: f64) -> Profile {
    doped(nematic, tilt_deg, [twist_deg, 0.0], volts)
}

/// With this twist, and natural one.
fn doped(nematic: Nematic, tilt_deg: f64, twists_deg: [f64; 2], volts: f64) -> Profile {
    let [twist_deg, natural_twist_deg] = twists_deg;
    director(&DrivenCell { nematic, tilt_deg: [tilt_deg; 2], twist_deg, natural_twist_deg, volts }).unwrap()
}

fn middle(profile: &Profile) -> f64 {
    profile.tilt_deg[INTERVALS / 2]
}

/// Integral over the depth, by trapezoids.
fn integral(depth: &[f64], values: &[f64]) -> f64 {
    depth.windows(2).zip(values.windows(2)).map(|(z, v)| 0.5 * (z[1] - z[0]) * (v[0] + v[1])).sum()
}

/// Freedericksz thresholds of splay, of bend and of twisted cells, without and with a chiral dopant (F. M. Leslie, Mol. Cryst. Liq. Cryst. 12,
/// 57 (1970); E. P. Raynes, Mol. Cryst. Liq. Cryst. Lett. 4, 1 (1986)).
#[test]
fn directors_move_above_the_threshold_only() {
    let [splay, twist, bend] = NEMATIC.elastic_pn;
    let difference = NEMATIC.permittivity[0] - NEMATIC.permittivity[1];
    let threshold = |elastic: f64, difference: f64| PI * (elastic / (EPSILON_0 * difference)).sqrt();
    for twists in [[0.0_f64, 0.0], [45.0, 0.0], [90.0, 0.0], [90.0, 60.0], [-240.0, -250.0], [60.0, -20.0]] {
        let [turn, natural] = twists.map(|turn_deg: f64| turn_deg / 180.0);
        let elastic = splay + (bend - 2.0 * twist) * turn * turn + 2.0 * twist * turn * natural;
        let volts = threshold(elastic, difference);
        assert!(middle(&doped(NEMATIC, 0.0, twists, 0.998 * volts)).abs() < 1e-3, "{twists:?}");
        assert!(middle(&doped(NEMATIC, 0.0, twists, 1.002 * volts)) > 2.0, "{twists:?}");
    }
    let volts = threshold(NEGATIVE.elastic_pn[2], 7.8 - 3.6);
    assert!((middle(&cell(NEGATIVE, 90.0, 0.0, 0.998 * volts)) - 90.0).abs() < 1e-3);
    assert!(middle(&cell(NEGATIVE, 90.0, 0.0, 1.002 * volts)) < 88.0);
}

/// Voltage over the threshold at which the middle of a splay cell without pretilt has this tilt: H. J. Deuling, Mol. Cryst. Liq. Cryst. 19,
/// 123 (1972). `sin theta = sin theta_m sin psi` removes the singular end of the integral.
fn voltage_over_threshold(nematic: Nematic, tilt: f64) -> f64 {
    let kappa = nematic.elastic_pn[2] / nematic.elastic_pn[0] - 1.0;
    let gamma = nematic.permittivity[0] / nematic.permittivity[1] - 1.0;
    let most = tilt.sin().powi(2);
    let count = 2000;
    let sum: f64 = (0..count)
        .map(|k| {
            let square = most * (FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(count)).sin().powi(2);
            ((1.0 + kappa * square) / ((1.0 + gamma * square) * (1.0 - square))).sqrt()
        })
        .sum();
    2.0 / PI * (1.0 + gamma * most).sqrt() * sum * FRAC_PI_2 / f64::from(count)
}

#[test]
fn splay_and_bend_are_those_of_the_exact_solution() {
    let threshold = PI * (11.0 / (EPSILON_0 * 13.8)).sqrt();
    for tilt_deg in [10.0_f64, 30.0, 60.0, 80.0, 89.0] {
        let volts = threshold * voltage_over_threshold(NEMATIC, tilt_deg.to_radians());
        let found = middle(&cell(NEMATIC, 0.0, 0.0, volts));
        assert!((found - tilt_deg).abs() < 0.01, "{tilt_deg}: {found}");
    }
    // The bend cell is the splay cell with the axes exchanged.
    let exchanged = Nematic { elastic_pn: [18.1, 7.0, 16.7], permittivity: [7.8, 3.6] };
    let threshold = PI * (18.1 / (EPSILON_0 * 4.2)).sqrt();
    for tilt_deg in [10.0_f64, 45.0, 85.0] {
        let volts = threshold * voltage_over_threshold(exchanged, tilt_deg.to_radians());
        let found = 90.0 - middle(&cell(NEGATIVE, 90.0, 0.0, volts));
        assert!((found - tilt_deg).abs() < 0.01, "{tilt_deg}: {found}");
    }
}

/// At high voltages the middle stands, and the first integral gives the depth of each tilt by quadrature:
/// `(K11 cos^2 + K33 sin^2) tilt'^2 = D^2/epsilon_0 (1/epsilon - 1/epsilon_parallel)`, with `D` from the voltage.
#[test]
fn directors_at_high_voltages_are_those_of_the_first_integral() {
    let nematic = Nematic { elastic_pn: [10.0, 7.0, 15.0], permittivity: [15.0, 5.0] };
    let pretilt = 2.0_f64.to_radians();
    let birefringence = |tilt: f64| {
        let (sin, cos) = tilt.sin_cos();
        1.0 / (sin * sin / (1.5 * 1.5) + cos * cos / (1.7 * 1.7)).sqrt() - 1.5
    };
    // Integral from the pretilt to a tilt of a value over the slope of the tilt, times D/sqrt(epsilon_0).
    let over_slope = |tilt: f64, value: &dyn Fn(f64) -> f64| {
        let count = 20_000;
        let step = (tilt - pretilt) / f64::from(count);
        let at = |k: i32| {
            let tilt = pretilt + step * (f64::from(k) + 0.5);
            let (sin2, cos2) = (tilt.sin().powi(2), tilt.cos().powi(2));
            let rate = (10.0 * cos2 / ((10.0 * cos2 + 15.0 * sin2) * 15.0 * (5.0 + 10.0 * sin2))).sqrt();
            value(tilt) / rate
        };
        (0..count).map(at).sum::<f64>() * step
    };
    let more = over_slope(FRAC_PI_2, &|tilt| 1.0 / (5.0 + 10.0 * tilt.sin().powi(2)) - 1.0 / 15.0);
    let retardance = 2.0 * over_slope(FRAC_PI_2, &birefringence);
    for volts in [20.0, 50.0, 100.0] {
        let unit = 1.0 / (15.0 * (volts * EPSILON_0.sqrt() - 2.0 * more));
        let found = cell(nematic, 2.0, 0.0, volts);
        for (depth, tilt_deg) in found.depth.iter().zip(&found.tilt_deg).skip(1) {
            if *tilt_deg < 80.0 && *depth < 0.5 {
                let expected = unit * over_slope(tilt_deg.to_radians(), &|_| 1.0);
                assert!(
                    (depth / expected - 1.0).abs() < 1e-3,
                    "{volts} V, {tilt_deg} deg: {depth} {expected}"
                );
            }
        }
        let thin: Vec<f64> = found.tilt_deg.iter().map(|tilt| birefringence(tilt.to_radians())).collect();
        let (found, expected) = (integral(&found.depth, &thin), unit * retardance);
        // The retardance of 6 um, to 0.004 nm: after a double passage, a reflectance changes by at most 2 pi/550 of that, 5e-5.
        assert!((found / expected - 1.0).abs() < 1e-3, "{volts} V: {found} {expected}");
        assert!(6e3 * (found - expected).abs() < 4e-3, "{volts} V: {found} {expected}");
    }
}

/// Of a driven twisted cell: the torque about the normal and the torque about the horizontal axis vanish at every depth, by differences of the
/// profile (another discretisation than that of the energy).
#[test]
fn twisted_cells_are_in_equilibrium() {
    let volts = 2.5;
    let found = cell(NEMATIC, 3.0, 90.0, volts);
    let [splay, twist, bend] = NEMATIC.elastic_pn;
    let tilt: Vec<f64> = found.tilt_deg.iter().map(|tilt| tilt.to_radians()).collect();
    let azimuth: Vec<f64> = found.twist_deg.iter().map(|twist| twist.to_radians()).collect();
    let inverse: Vec<f64> =
        tilt.iter().map(|tilt| 1.0 / (NEMATIC.permittivity[1] + 13.8 * tilt.sin().powi(2))).collect();
    let total = integral(&found.depth, &inverse);
    // Slopes of the parabola through three depths.
    let slope = |values: &[f64], k: usize| {
        let [before, after] = [found.depth[k] - found.depth[k - 1], found.depth[k + 1] - found.depth[k]];
        let [first, second] = [(values[k] - values[k - 1]) / before, (values[k + 1] - values[k]) / after];
        (first * after + second * before) / (before + after)
    };
    // The first integral of the Euler-Lagrange equations: k tilt'^2 + a azimuth'^2 - D^2/(epsilon_0 epsilon), the same at all depths.
    let displacement = EPSILON_0 * volts / total;
    let first_integral: Vec<f64> = (1..INTERVALS)
        .map(|k| {
            let (sin2, cos2) = (tilt[k].sin().powi(2), tilt[k].cos().powi(2));
            let (change, turn) = (slope(&tilt, k), slope(&azimuth, k));
            (splay * cos2 + bend * sin2) * change * change + (twist * cos2 + bend * sin2) * cos2 * turn * turn
                - displacement * displacement * inverse[k] / EPSILON_0
        })
        .collect();
    let torque: Vec<f64> = (1..INTERVALS)
        .map(|k| {
            let (sin2, cos2) = (tilt[k].sin().powi(2), tilt[k].cos().powi(2));
            (twist * cos2 + bend * sin2) * cos2 * slope(&azimuth, k)
        })
        .collect();
    // Relative to the largest electric term, and to the torque.
    let electric = displacement * displacement * inverse[0] / EPSILON_0;
    for (what, values, scale) in
        [("first integral", first_integral, electric), ("torque", torque.clone(), torque[0])]
    {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let worst = values.iter().map(|value| (value - mean).abs() / scale).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{what}: {worst}");
    }
    assert!((found.twist_deg[INTERVALS] - 90.0).abs() < 1e-9);
    assert!((found.twist_deg[INTERVALS / 2] - 45.0).abs() < 1e-6);
}

/// A uniform cell has the energy of a capacitor; a driven cell has less.
#[test]
fn the_energy_is_that_of_a_capacitor_below_the_threshold_and_less_above() {
    let capacitor = |volts: f64| -0.5 * EPSILON_0 * 5.2 * volts * volts;
    assert!((cell(NEMATIC, 0.0, 0.0, 0.5).energy_pn / capacitor(0.5) - 1.0).abs() < 1e-9);
    assert!(cell(NEMATIC, 0.0, 0.0, 2.0).energy_pn < capacitor(2.0));
    // The twist of an undriven cell: (twist - natural twist)^2 K22/2, up to chords in place of arcs, whose sum over equal turns is known, too.
    let [twist, bend] = [6.5, 17.0];
    for natural in [0.0, 0.5 * FRAC_PI_2] {
        let found = doped(NEMATIC, 0.0, [90.0, natural.to_degrees()], 0.0).energy_pn;
        let (count, turn) = (INTERVALS as f64, FRAC_PI_2 / INTERVALS as f64);
        let chords = twist * turn.sin().powi(2) + bend * (1.0 - turn.cos()).powi(2);
        let chords = 0.5 * count * count * chords + twist * natural * (0.5 * natural - count * turn.sin());
        assert!((found / chords - 1.0).abs() < 1e-9, "{found} {chords}");
        let arcs = 0.5 * twist * (FRAC_PI_2 - natural).powi(2);
        assert!((found / arcs - 1.0).abs() < 4e-5, "{found} {arcs}");
    }
}

/// A hybrid cell with equal constants turns evenly; a cell whose tilt at the bottom is above 90 deg turns through the normal.
#[test]
fn hybrid_and_bend_cells_turn_between_their_surfaces() {
    let equal = Nematic { elastic_pn: [10.0; 3], permittivity: [10.0, 5.0] };
    for (top, bottom) in [(0.0, 90.0), (5.0, 175.0), (-20.0, 20.0)] {
        let cell = DrivenCell {
            nematic: equal,
            tilt_deg: [top, bottom],
            twist_deg: 0.0,
            natural_twist_deg: 0.0,
            volts: 0.0,
        };
        let found = director(&cell).unwrap().tilt_deg;
        for (k, tilt) in found.iter().enumerate() {
            let expected = top + (bottom - top) * k as f64 / INTERVALS as f64;
            assert!((tilt - expected).abs() < 1e-6, "{k}: {tilt} {expected}");
        }
    }
}

#[test]
fn impossible_cells_are_refused() {
    let good = DrivenCell {
        nematic: NEMATIC,
        tilt_deg: [0.0; 2],
        twist_deg: 0.0,
        natural_twist_deg: 0.0,
        volts: 1.0,
    };
    let wrong = [
        DrivenCell { nematic: Nematic { elastic_pn: [0.0, 1.0, 1.0], ..NEMATIC }, ..good },
        DrivenCell { nematic: Nematic { permittivity: [1.0, -1.0], ..NEMATIC }, ..good },
        DrivenCell { volts: -1.0, ..good },
        DrivenCell { volts: f64::NAN, ..good },
        DrivenCell { tilt_deg: [0.0, 200.0], ..good },
    ];
    for cell in wrong {
        assert!(director(&cell).is_err(), "{cell:?}");
    }
}

const HALF_TURN: Nematic = Nematic { elastic_pn: [11.0, 6.0, 17.0], permittivity: [13.0, 4.0] };

/// Half a turn with pretilt joins the same directors as a bend from 2 to 178 deg: the field turns one into the other.
#[test]
fn half_a_turn_becomes_a_bend() {
    let nematic = HALF_TURN;
    let bend = |volts: f64| {
        director(&DrivenCell {
            nematic,
            tilt_deg: [2.0, 178.0],
            twist_deg: 0.0,
            natural_twist_deg: 0.0,
            volts,
        })
        .unwrap()
    };
    let half_turn = |volts: f64| cell(nematic, 2.0, 180.0, volts);
    for volts in [0.0, 1.0, 1.5] {
        let found = half_turn(volts);
        assert!(found.energy_pn < bend(volts).energy_pn - 0.1, "{volts}");
        assert!((found.twist_deg[INTERVALS] - 180.0).abs() < 1e-9, "{volts}");
    }
    for volts in [2.0, 3.0, 5.5, 10.0] {
        let (found, bend) = (half_turn(volts), bend(volts));
        assert!((found.energy_pn / bend.energy_pn - 1.0).abs() < 1e-9, "{volts}");
        for (k, (found, bend)) in found.tilt_deg.iter().zip(&bend.tilt_deg).enumerate() {
            assert!((found - bend).abs() < 1e-4, "{volts} V, {k}: {found} {bend}");
        }
    }
}

/// Two thirds of a turn without a chiral dopant turn into a third of a turn the other way, where the twisted state loses its stability: energies
/// and tilts of a separate program (numpy: explicit flow downhill, 120 steps of depth).
#[test]
fn turns_of_more_than_half_escape_through_the_normal() {
    let found = cell(HALF_TURN, 5.0, 240.0, 1.35);
    assert!((found.energy_pn - 19.869).abs() < 0.03 && (middle(&found) - 16.3).abs() < 0.1, "{found:?}");
    assert!((found.twist_deg[INTERVALS] - 240.0).abs() < 1e-9);
    let found = cell(HALF_TURN, 5.0, 240.0, 1.4);
    assert!((found.energy_pn + 25.981).abs() < 0.01 && (middle(&found) - 38.41).abs() < 0.02, "{found:?}");
    assert!((found.twist_deg[INTERVALS] + 120.0).abs() < 1e-9);
    // With a dopant, the turn stays: the display of a supertwisted cell.
    let stays = doped(HALF_TURN, 5.0, [240.0, 250.0], 2.5);
    assert!((stays.twist_deg[INTERVALS] - 240.0).abs() < 1e-9 && middle(&stays) > 45.0, "{stays:?}");
    // The energy falls by the charge: its slope in the squared voltage is half of the capacity.
    for volts in [1.2, 1.5, 2.0, 4.0] {
        let at = |volts: f64| cell(HALF_TURN, 5.0, 240.0, volts);
        let [below, found, above] = [0.99, 1.0, 1.01].map(|factor| at(factor * volts));
        let inverse = found.tilt_deg.iter().map(|tilt| 1.0 / (4.0 + 9.0 * tilt.to_radians().sin().powi(2)));
        let inverse: Vec<f64> = inverse.collect();
        let integral = integral(&found.depth, &inverse);
        let slope = (above.energy_pn - below.energy_pn) / (volts * volts * (1.01 * 1.01 - 0.99 * 0.99));
        assert!((slope / (-0.5 * EPSILON_0 / integral) - 1.0).abs() < 2e-3, "{volts}: {slope}");
    }
}
