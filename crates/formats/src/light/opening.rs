//! Luminous openings of luminaires: their shape, and how large they appear.
//!
//! LM-63 writes the shape as the signs of width, length and height, which mean different things in its
//! editions. The length is along the plane C = 0, the width across it.

use std::f64::consts::FRAC_PI_4;

/// Shape of the luminous part of a luminaire, in the box of its sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpeningShape {
    /// No extent.
    Point,
    /// A rectangle, or a box whose sides are luminous.
    Box,
    /// A disc or an ellipse, or a cylinder with that base, whose axis is vertical.
    VerticalCylinder,
    /// The same with its axis along the plane C = 0: a vertical disc that faces C = 0, or a horizontal
    /// cylinder.
    CylinderAlong,
    /// The same with its axis across the plane C = 0.
    CylinderAcross,
    /// A sphere or an ellipsoid.
    Ellipsoid,
}

/// Luminous opening of a luminaire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Its shape.
    pub shape: OpeningShape,
    /// Its side along the plane C = 0, m.
    pub along_m: f64,
    /// Its side across the plane C = 0, m.
    pub across_m: f64,
    /// Its height on the sides that face C = 0, 90, 180 and 270 deg, m.
    pub height_m: [f64; 4],
}

impl Opening {
    /// An opening without extent.
    pub const POINT: Self =
        Self { shape: OpeningShape::Point, along_m: 0.0, across_m: 0.0, height_m: [0.0; 4] };

    /// Returns the area, m2, of the opening as it appears from a direction: angles from the nadir and around
    /// it, degrees.
    pub fn seen_m2(&self, vertical_deg: f64, horizontal_deg: f64) -> f64 {
        let (sin, down) = (vertical_deg.to_radians().sin(), vertical_deg.to_radians().cos());
        let (across, along) = horizontal_deg.to_radians().sin_cos();
        let height = |towards: f64, sides: [usize; 2]| self.height_m[sides[usize::from(towards < 0.0)]];
        // The areas of the sides of its box that face the three axes, as they appear.
        let along = (sin * along).abs() * self.across_m * height(along, [0, 2]);
        let across = (sin * across).abs() * self.along_m * height(across, [1, 3]);
        let down = down.abs() * self.along_m * self.across_m;
        match self.shape {
            OpeningShape::Point => 0.0,
            OpeningShape::Box => along + across + down,
            OpeningShape::VerticalCylinder => FRAC_PI_4 * down + along.hypot(across),
            OpeningShape::CylinderAlong => FRAC_PI_4 * along + across.hypot(down),
            OpeningShape::CylinderAcross => FRAC_PI_4 * across + along.hypot(down),
            OpeningShape::Ellipsoid => FRAC_PI_4 * along.hypot(across).hypot(down),
        }
    }

    /// Returns its longest side, m.
    pub fn longest_m(&self) -> f64 {
        self.height_m.iter().copied().fold(self.along_m.max(self.across_m), f64::max)
    }

    /// Returns its shape in words.
    pub fn in_words(&self) -> String {
        let Self { along_m, across_m, .. } = self;
        let high = self.height_m.iter().copied().fold(0.0, f64::max);
        let sides = format!("{along_m} m along C = 0 by {across_m} m, {high} m high");
        match self.shape {
            OpeningShape::Point => "a point".to_owned(),
            OpeningShape::Box if high == 0.0 => {
                format!("a rectangle of {along_m} m along C = 0 by {across_m} m")
            }
            OpeningShape::Box => format!("a box of {sides}"),
            OpeningShape::VerticalCylinder if high == 0.0 && along_m == across_m => {
                format!("a disc of {along_m} m")
            }
            OpeningShape::VerticalCylinder if high == 0.0 => {
                format!("an ellipse of {along_m} m along C = 0 by {across_m} m")
            }
            OpeningShape::VerticalCylinder => format!("a vertical cylinder of {sides}"),
            OpeningShape::CylinderAlong if *along_m == 0.0 => {
                format!("a vertical ellipse that faces C = 0, of {across_m} m by {high} m")
            }
            OpeningShape::CylinderAlong => format!("a horizontal cylinder of {sides}"),
            OpeningShape::CylinderAcross => format!("a horizontal cylinder of {sides}"),
            OpeningShape::Ellipsoid => format!("an ellipsoid of {sides}"),
        }
    }
}

/// Edition of LM-63, in the order of their years.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Edition {
    Of1986,
    Of1991,
    Of1995,
    Of2002,
    Of2019,
}

/// Returns the opening of these sides, m, by the rules of an edition; `None` if no rule has these signs.
pub(super) fn by_signs(edition: Edition, [width, length, height]: [f64; 3]) -> Option<Opening> {
    use OpeningShape as Shape;
    let sign = |side: f64| {
        if side == 0.0 {
            '0'
        } else if side < 0.0 {
            '-'
        } else {
            '+'
        }
    };
    let signs: String = [width, length, height].into_iter().map(sign).collect();
    let [w, l, h] = [width, length, height].map(f64::abs);
    let (shape, [along, across, high]) = match (&*signs, edition) {
        ("000", _) => (Shape::Point, [0.0; 3]),
        ("++0" | "+++" | "+0+" | "0++" | "+00" | "0+0" | "00+", _) => (Shape::Box, [l, w, h]),
        // Up to 1995 a circle has its diameter as a negative width alone.
        ("-00", _) => (Shape::VerticalCylinder, [w, w, 0.0]),
        ("-0+", _) => (Shape::VerticalCylinder, [w, w, h]),
        ("-+0" | "+-0" | "--0", _) => (Shape::VerticalCylinder, [l, w, 0.0]),
        ("-++", Edition::Of1986 | Edition::Of1991) => (Shape::Ellipsoid, [l, w, h]),
        ("-0-", Edition::Of1995) => (Shape::Ellipsoid, [w, w, h]),
        ("0+-", Edition::Of1995) => (Shape::CylinderAlong, [l, h, h]),
        ("+0-", Edition::Of1995) => (Shape::CylinderAcross, [h, w, h]),
        ("-++" | "+-+", _) => (Shape::VerticalCylinder, [l, w, h]),
        ("+--" | "-+-", Edition::Of1995) => (Shape::Ellipsoid, [l, w, h]),
        ("--+", _) => (Shape::VerticalCylinder, [l, w, h]),
        ("---", _) => (Shape::Ellipsoid, [l, w, h]),
        ("-+-", _) => (Shape::CylinderAlong, [l, w, h]),
        ("+--", _) => (Shape::CylinderAcross, [l, w, h]),
        ("-0-", _) => (Shape::CylinderAlong, [0.0, w, h]),
        _ => return None,
    };
    Some(Opening { shape, along_m: along, across_m: across, height_m: [high; 4] })
}
