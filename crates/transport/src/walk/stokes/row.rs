//! What a meter makes of the Stokes parameters I, Q, U, V of light: a row of four numbers, which events multiply by
//! their Mueller matrices.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use papilio_optics::phase::Elements;

use crate::light::polarised::{Frame, Quartet};
use crate::mueller::Factors;

/// Weights of I, Q, U and V.
pub(super) type Row = [f64; 4];

/// Returns the row of a meter that is given for the coherency matrix.
pub(super) fn of_meter([p, s, re, im]: Quartet) -> Row {
    [0.5 * (p + s), 0.5 * (p - s), FRAC_1_SQRT_2 * re, FRAC_1_SQRT_2 * im]
}

/// Returns what is seen of light that is given by its coherency matrix.
pub(super) fn seen([i, q, u, v]: Row, [p, s, re, im]: Quartet) -> f64 {
    i * (p + s) + q * (p - s) + SQRT_2 * (u * re + v * im)
}

/// Returns the row of a meter behind something that multiplies `|p|^2`, `|s|^2` and `p s*` by these factors.
pub(super) fn behind(factors: Factors, [i, q, u, v]: Row) -> Row {
    let (p, s, crossed) = (factors.p * (i + q), factors.s * (i - q), factors.crossed);
    [0.5 * (p + s), 0.5 * (p - s), u * crossed.re + v * crossed.im, v * crossed.re - u * crossed.im]
}

/// Returns the row of a meter that sees no polarisation.
pub(super) fn unpolarised(weight: f64) -> Row {
    [weight, 0.0, 0.0, 0.0]
}

/// What scattering from one direction to another does to rows: a rotation into the scattering plane, the phase matrix,
/// and a rotation out of it.
pub(super) struct Turned {
    /// The cosine and sine of twice the angles of rotation.
    before: [f64; 2],
    after: [f64; 2],
}

impl Turned {
    /// Light arrives in one frame and leaves in the other.
    pub(super) fn new([arriving, leaving]: [Frame; 2]) -> Self {
        let [of_arriving, of_leaving] = Frame::of_scattering(arriving, leaving);
        Self { before: leaving.turn(of_leaving), after: of_arriving.turn(arriving) }
    }

    /// Returns the row of a meter of the light that leaves as one of the light that arrives.
    pub(super) fn times(&self, elements: Elements, row: Row) -> Row {
        let Elements { a1, a2, a3, a4, b1, b2 } = elements;
        let [i, q, u, v] = turned(row, self.before);
        turned([i * a1 + q * b1, i * b1 + q * a2, u * a3 - v * b2, u * b2 + v * a4], self.after)
    }
}

fn turned([i, q, u, v]: Row, [cos, sin]: [f64; 2]) -> Row {
    [i, q * cos + u * sin, u * cos - q * sin, v]
}
