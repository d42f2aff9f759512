//! Colour gamut as a solid in CIELAB: its volume and its gamut rings.
//!
//! **What.** A display that mixes its colours by area or in time shows all colours between its eight corners
//! (black, red, green, blue, cyan, magenta, yellow, white), which are linear interpolations of X, Y, Z
//! (Neugebauer). The surface of that solid is sampled in ten steps of each drive (uniform at a gamma of 2.2),
//! which are 602 colours. They are converted to CIELAB, and triangles between them enclose the volume (IDMS
//! 1.1, CIELAB gamut volume): that of all mixtures within about 0.3 % (0.21 % less for sRGB).
//!
//! **Gamut rings** (Masaoka, Jiang, Fairchild, Heckaman, J. SID 28, 273 (2020); IDMS 1.1) show the solid in
//! the plane: for each hue, the area within the ring of lightness L* equals the volume below that lightness.
//! The area within the last ring is the whole volume.
//!
//! **Range.** Any eight colours. If the surface intersects itself, the folds contribute with their sign.
//! **Limits.** Lightness and chroma are those of CIELAB relative to one white: surface colours.

use std::f64::consts::TAU;

use crate::{Lab, Xyz};

/// Steps along each edge, and exponent from step to drive. Uniform steps of light would leave too few
/// triangles for dark colours, where CIELAB is most sensitive.
const STEPS: usize = 10;
const GAMMA: f64 = 2.2;

/// Number of lightness slices in each ring.
const LEVELS_IN_A_RING: usize = 10;

/// Number of gamut rings; each spans 100 / `RINGS` in L\*.
pub const RINGS: usize = 10;

/// Number of hue sectors of a gamut ring.
pub const HUES: usize = 360;

/// Tristimulus values of the eight corners of a display's gamut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// Indexed by the sum of the primaries that are on, red (1), green (2) and blue (4): black, red, green,
    /// yellow, blue, magenta, cyan, white.
    pub xyz: [Xyz; 8],
}

/// Names of the corners, in order.
pub const CORNERS: [&str; 8] = ["black", "red", "green", "yellow", "blue", "magenta", "cyan", "white"];

/// Surface of a colour gamut in CIELAB: triangles that are anticlockwise seen from outside the cube of
/// drives.
#[derive(Debug, Clone, PartialEq)]
pub struct GamutSolid {
    triangles: Vec<[[f64; 3]; 3]>,
}

impl Corners {
    /// Mixes the corners at drives of red, green and blue from 0 to 1.
    pub fn mix(&self, drive: [f64; 3]) -> Xyz {
        let corners = self.xyz.iter().enumerate().map(|(corner, xyz)| {
            let weight = |axis: usize| if corner >> axis & 1 == 1 { drive[axis] } else { 1.0 - drive[axis] };
            *xyz * (weight(0) * weight(1) * weight(2))
        });
        corners.fold(Xyz { x: 0.0, y: 0.0, z: 0.0 }, |sum, part| sum + part)
    }

    /// Computes the solid in CIELAB relative to `white`; `None` if CIELAB is not defined for this white.
    pub fn solid(&self, white: Xyz) -> Option<GamutSolid> {
        let mut triangles = Vec::with_capacity(6 * 2 * STEPS * STEPS);
        for axis in 0..3 {
            for side in [0.0, 1.0] {
                let face = self.face(axis, side, white)?;
                for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
                    let at = |i: usize, j: usize| face[i * (STEPS + 1) + j];
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    let outwards = |[a, b, c]: [[f64; 3]; 3]| if side > 0.0 { [a, b, c] } else { [a, c, b] };
                    triangles.extend([outwards([a, b, c]), outwards([a, c, d])]);
                }
            }
        }
        Some(GamutSolid { triangles })
    }

    /// Colours a*, b*, L* of one face of the cube of drives, `[step along one edge][step along the other]`.
    fn face(&self, axis: usize, side: f64, white: Xyz) -> Option<Vec<[f64; 3]>> {
        let drive_at = |step: usize| (step as f64 / STEPS as f64).powf(GAMMA);
        let point = |k: usize| {
            let mut drive = [side; 3];
            drive[(axis + 1) % 3] = drive_at(k / (STEPS + 1));
            drive[(axis + 2) % 3] = drive_at(k % (STEPS + 1));
            self.mix(drive).lab(white).map(|Lab { l, a, b }| [a, b, l])
        };
        (0..(STEPS + 1) * (STEPS + 1)).map(point).collect()
    }
}

impl GamutSolid {
    /// Volume of the solid, in cubic units of L\*, a\*, b\*.
    pub fn volume(&self) -> f64 {
        let six: f64 = self
            .triangles
            .iter()
            .map(|[[ax, ay, az], [bx, by, bz], [cx, cy, cz]]| {
                ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
            })
            .sum();
        // The sign depends on the handedness of the primaries.
        six.abs() / 6.0
    }

    /// Radius of each gamut ring in each hue sector, which start at 0 degrees; shape `[ring][hue]`. The area
    /// within a ring is the volume of all lightness below it. The radius is 0 where that volume is negative
    /// (folds).
    pub fn rings(&self) -> Vec<Vec<f64>> {
        let step = 100.0 / (RINGS * LEVELS_IN_A_RING) as f64;
        let mut below = vec![0.0; HUES];
        let mut rings = Vec::with_capacity(RINGS);
        for ring in 0..RINGS {
            for level in 0..LEVELS_IN_A_RING {
                let lightness = step * ((ring * LEVELS_IN_A_RING + level) as f64 + 0.5);
                self.slice(lightness, step, &mut below);
            }
            let radius = |volume: &f64| (2.0 * volume * HUES as f64 / TAU).max(0.0).sqrt();
            rings.push(below.iter().map(radius).collect());
        }
        rings
    }

    /// Adds the volume of a slice to each hue sector.
    fn slice(&self, lightness: f64, thickness: f64, sectors: &mut [f64]) {
        for triangle in &self.triangles {
            if let Some((from, to)) = cut(triangle, lightness) {
                sweep(from, to, |hue, area| sectors[hue] += thickness * area);
            }
        }
    }
}

/// Segment in which a triangle intersects a plane of constant lightness; the solid is on its left.
fn cut(triangle: &[[f64; 3]; 3], lightness: f64) -> Option<([f64; 2], [f64; 2])> {
    let above = triangle.map(|[_, _, l]| l > lightness);
    let crossing = |from: usize, to: usize| {
        let ([a0, b0, l0], [a1, b1, l1]) = (triangle[from], triangle[to]);
        let t = (lightness - l0) / (l1 - l0);
        [a0 + t * (a1 - a0), b0 + t * (b1 - b0)]
    };
    let edges = [(0, 1), (1, 2), (2, 0)];
    let down = edges.iter().find(|(from, to)| above[*from] && !above[*to])?;
    let up = edges.iter().find(|(from, to)| !above[*from] && above[*to])?;
    Some((crossing(down.0, down.1), crossing(up.0, up.1)))
}

/// Areas between a segment and the origin for each hue sector; positive where the segment is anticlockwise.
fn sweep(from: [f64; 2], to: [f64; 2], mut add: impl FnMut(usize, f64)) {
    let sector = TAU / HUES as f64;
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let turn = cross(from, to).atan2(from[0] * to[0] + from[1] * to[1]);
    let start = from[1].atan2(from[0]).rem_euclid(TAU);
    let (first, last) = (start / sector, (start + turn) / sector);
    let borders: Vec<i64> = if turn > 0.0 {
        ((first.floor() as i64 + 1)..=(last.ceil() as i64 - 1)).collect()
    } else {
        ((last.floor() as i64 + 1)..=(first.ceil() as i64 - 1)).rev().collect()
    };
    let mut here = from;
    let mut middle = first;
    for border in borders {
        let (sin, cos) = (border as f64 * sector).sin_cos();
        // Intersection of the segment with the ray between two sectors.
        let along = |p: [f64; 2]| p[1] * cos - p[0] * sin;
        let t = along(from) / (along(from) - along(to));
        let there = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
        add(hue(0.5 * (middle + border as f64)), 0.5 * cross(here, there));
        (here, middle) = (there, border as f64);
    }
    add(hue(0.5 * (middle + last)), 0.5 * cross(here, to));
}

fn hue(sectors: f64) -> usize {
    sectors.floor().rem_euclid(HUES as f64) as usize % HUES
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{D65_WHITE, GamutReference};

    /// Additive display with these primaries and D65 as its white.
    fn additive(reference: GamutReference) -> Corners {
        // Luminances of the primaries such that they sum to D65, by Cramer's rule.
        let primaries = reference.primaries().map(|xy| xy.with_luminance(1.0).unwrap());
        let det = |m: [Xyz; 3]| {
            let [p, q, r] = m;
            p.x * (q.y * r.z - q.z * r.y) - p.y * (q.x * r.z - q.z * r.x) + p.z * (q.x * r.y - q.y * r.x)
        };
        let lit = [0, 1, 2].map(|k| {
            let mut replaced = primaries;
            replaced[k] = D65_WHITE;
            primaries[k] * (det(replaced) / det(primaries))
        });
        let corner =
            |on: usize| (0..3).filter(|k| on >> k & 1 == 1).fold(D65_WHITE * 0.0, |sum, k| sum + lit[k]);
        Corners { xyz: [0, 1, 2, 3, 4, 5, 6, 7].map(corner) }
    }

    /// CIELAB volume of sRGB relative to D65: 8.2e5 to 8.3e5 in the literature (colour-science's Monte Carlo
    /// manual page: 821 958).
    #[test]
    fn volume_of_srgb_equals_the_published_value() {
        let volume = additive(GamutReference::Srgb).solid(D65_WHITE).unwrap().volume();
        assert!((815_000.0..835_000.0).contains(&volume), "{volume}");
    }

    /// The area within the last ring equals the volume, up to the slice width.
    #[test]
    fn area_within_the_last_ring_equals_the_volume() {
        let solid = additive(GamutReference::Srgb).solid(D65_WHITE).unwrap();
        let rings = solid.rings();
        let area = |ring: &[f64]| ring.iter().map(|r| 0.5 * r * r * TAU / HUES as f64).sum::<f64>();
        let areas: Vec<f64> = rings.iter().map(|ring| area(ring)).collect();
        assert!((areas[RINGS - 1] / solid.volume() - 1.0).abs() < 2e-3, "{areas:?} {}", solid.volume());
        assert!(areas.windows(2).all(|pair| pair[0] <= pair[1]));
        // Blue is dark and yellow is bright: most of blue's volume is below L* = 60, and less than half of
        // yellow's.
        let below_60 = |hue: usize| (rings[5][hue] / rings[9][hue]).powi(2);
        assert!(below_60(300) > 0.8 && below_60(100) < 0.5, "{} {}", below_60(300), below_60(100));
    }

    #[test]
    fn gamut_of_greys_has_no_volume() {
        let grey = Corners { xyz: [0.0, 0.2, 0.3, 0.5, 0.1, 0.3, 0.4, 0.6].map(|y| D65_WHITE * y) };
        let solid = grey.solid(D65_WHITE).unwrap();
        assert!(solid.volume() < 1e-6, "{}", solid.volume());
        assert!(solid.rings().iter().flatten().all(|r| *r < 1e-2));
        assert_eq!(grey.solid(D65_WHITE * 0.0), None);
    }

    #[test]
    fn segment_is_divided_among_the_hue_sectors() {
        let mut sectors = vec![0.0; HUES];
        sweep([1.0, -1.0], [1.0, 1.0], |hue, area| sectors[hue] += area);
        assert!((sectors.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((sectors[0] - 0.5 * 1.0_f64.to_radians().tan()).abs() < 1e-12);
        assert!((sectors[359] - sectors[0]).abs() < 1e-12 && sectors[50] == 0.0);
        let mut back = vec![0.0; HUES];
        sweep([1.0, 1.0], [1.0, -1.0], |hue, area| back[hue] += area);
        assert!(sectors.iter().zip(&back).all(|(a, b)| (a + b).abs() < 1e-12));
    }
}
