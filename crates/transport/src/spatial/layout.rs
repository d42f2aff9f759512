//! Arrangements of sub-pixels in a pixel, as windows with given areas.
//!
//! Areas are fractions of the active area; their sum is 1 (nearly: other sums are scaled). The active area is
//! first divided without gaps; each part is then shrunk about its middle, so that the sub-pixel covers its
//! area times the fill factor.

use super::{Rectangle, Window};

/// Stripes of full height from left to right. Shrinking makes them narrower.
///
/// ```
/// use papilio_transport::spatial::stripes;
///
/// // From 0 to 1/2 and from 1/2 to 1, of which 0.9 are active.
/// let windows = stripes(&[0.5, 0.5], 0.9);
/// let left = windows[0].rectangles[0];
/// assert!((left.x[0] - 0.025).abs() < 1e-15 && (left.x[1] - 0.475).abs() < 1e-15);
/// assert_eq!(left.y, [0.0, 1.0]);
/// ```
pub fn stripes(areas: &[f64], fill_factor: f64) -> Vec<Window> {
    let sum: f64 = areas.iter().sum();
    let scale = [(fill_factor * sum).min(1.0), 1.0];
    let mut left = 0.0;
    let stripe = |area: &f64| {
        let from = left;
        left += area / sum;
        window(Rectangle { x: [from, left], y: [0.0, 1.0] }, scale)
    };
    areas.iter().map(stripe).collect()
}

/// Rows of cells, the first row at the top: each cell is a part of a sub-pixel (its number, from 0) with an
/// area. The height of a row and the widths of its cells are such that every cell has its area. Shrinking
/// reduces the width and the height of cells by the same factor.
///
/// A quad is two rows of two; a PenTile pixel is red and half of green over the other half of green and blue;
/// a single sub-pixel is one row of one.
pub fn rows(rows: &[Vec<(usize, f64)>], sub_pixels: usize, fill_factor: f64) -> Vec<Window> {
    let of_row = |row: &[(usize, f64)]| row.iter().map(|(_, area)| area).sum::<f64>();
    let sum: f64 = rows.iter().map(|row| of_row(row)).sum();
    let scale = [(fill_factor * sum).min(1.0).sqrt(); 2];
    let mut windows = vec![Window::default(); sub_pixels];
    let mut top = 1.0;
    for row in rows {
        let total = of_row(row);
        let (bottom, mut left) = (top - total / sum, 0.0);
        for (sub_pixel, area) in row.iter().filter(|(_, area)| *area > 0.0) {
            let right = left + area / total;
            let cell = Rectangle { x: [left, right], y: [bottom, top] };
            windows[*sub_pixel].rectangles.push(cell.scaled(scale));
            left = right;
        }
        top = bottom;
    }
    windows
}

fn window(cell: Rectangle, scale: [f64; 2]) -> Window {
    if cell.area() > 0.0 { Window::from_rectangle(cell.scaled(scale)) } else { Window::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    /// No two rectangles overlap, and all lie within the period.
    fn assert_disjoint(windows: &[Window]) {
        let all: Vec<&Rectangle> = windows.iter().flat_map(|window| &window.rectangles).collect();
        for (i, one) in all.iter().enumerate() {
            assert!((one.overlap(&Rectangle::WHOLE) - one.area()).abs() < 1e-12, "{one:?}");
            for other in &all[..i] {
                assert!(one.overlap(other) < 1e-12, "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn stripes_have_their_areas_and_middles() {
        let areas = [0.493, 0.381, 0.126];
        let windows = stripes(&areas, 0.873);
        assert_disjoint(&windows);
        let mut left = 0.0;
        for (window, area) in windows.iter().zip(areas) {
            close(window.area(), area * 0.873);
            let [from, to] = window.rectangles[0].x;
            close(0.5 * (from + to), left + 0.5 * area);
            left += area;
        }
    }

    #[test]
    fn rows_have_their_areas() {
        let (red, green, blue) = (0.25, 0.4, 0.35);
        let pentile = [vec![(0, red), (1, 0.5 * green)], vec![(1, 0.5 * green), (2, blue)]];
        for fill_factor in [1.0, 0.6] {
            let windows = rows(&pentile, 3, fill_factor);
            assert_disjoint(&windows);
            for (window, area) in windows.iter().zip([red, green, blue]) {
                close(window.area(), area * fill_factor);
            }
            assert_eq!(windows[1].rectangles.len(), 2);
        }
        // Four equal areas are quadrants, the first at the upper left.
        let quad = rows(&[vec![(0, 0.25), (1, 0.25)], vec![(2, 0.25), (3, 0.25)]], 4, 1.0);
        assert_eq!(quad[0].rectangles, [Rectangle { x: [0.0, 0.5], y: [0.5, 1.0] }]);
        assert_eq!(quad[3].rectangles, [Rectangle { x: [0.5, 1.0], y: [0.0, 0.5] }]);
        let single = rows(&[vec![(0, 1.0)]], 1, 0.81);
        let [from, to] = single[0].rectangles[0].x;
        close(from, 0.05);
        close(to, 0.95);
    }

    /// Sums that differ from 1 by a rounding, and sub-pixels without area.
    #[test]
    fn sums_and_areas_at_their_limits_are_handled() {
        let windows = stripes(&[0.5005, 0.5, 0.0], 0.9);
        assert_disjoint(&windows);
        close(windows[0].area(), 0.5005 * 0.9);
        assert!(windows[2].rectangles.is_empty() && windows[2].area() == 0.0);
        assert_disjoint(&stripes(&[0.5005, 0.5], 1.0));
        let windows = rows(&[vec![(0, 0.0), (1, 0.0)], vec![(2, 1.0)]], 3, 1.0);
        assert_eq!(windows[2].rectangles, [Rectangle { x: [0.0, 1.0], y: [0.0, 1.0] }]);
        assert!(windows[0].rectangles.is_empty());
    }
}
