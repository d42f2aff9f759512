//! FLIP row by row: the same numbers as of [`FlipPicture`](super::FlipPicture), with the rows that its kernels reach
//! at hand, at samples of the rows. Filters act down the columns first, where only rows with samples are needed.

use super::filter::Kernel;
use super::flip::{blurs, difference, feature_kernels, largest_colour_difference, opponent_of, seen_colour};
use super::rows::{LANES, Padded, Ring, Taps, across, along, lanes, stride};

/// The filters of FLIP.
pub(super) struct FlipEye {
    blurs: [Vec<(f32, Kernel)>; 3],
    smooth: Kernel,
    /// Of edges and of points.
    derivatives: [Kernel; 2],
    /// Rows about a pixel on which its values depend.
    pub(super) reach: usize,
    most: f32,
}

/// Rows in opponent colours.
pub(super) struct FlipLines {
    opponents: [Ring<f32>; 3],
    padded: Padded,
    places: Vec<usize>,
    sums: [Vec<f32>; 2],
    /// The row that comes next.
    pub(super) next: usize,
}

/// A row as it is seen: lightness and two chromatic coordinates, and the strengths of edges and of points.
#[derive(Clone, Copy)]
pub(super) struct FlipRow<'a> {
    pub(super) colours: [&'a [f32]; 3],
    pub(super) features: [&'a [f32]; 2],
}

impl FlipEye {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let blurs = blurs(pixels_per_degree);
        let [smooth, edge, point] = feature_kernels(pixels_per_degree);
        let of_blurs = blurs.iter().flatten().map(|(_, kernel)| kernel.reach());
        let reach = of_blurs.chain([&smooth, &edge, &point].map(|one| one.reach())).max().unwrap_or(0);
        Self { blurs, smooth, derivatives: [edge, point], reach, most: largest_colour_difference() }
    }

    /// For rows of `columns`, with a sample every `step`.
    pub(super) fn lines(&self, columns: usize, step: usize) -> FlipLines {
        let ring = || Ring::new(stride(columns), 2 * self.reach + 1);
        FlipLines {
            opponents: [ring(), ring(), ring()],
            padded: Padded::new(columns, self.reach, step),
            places: Vec::new(),
            sums: [0; 2].map(|_| vec![0.0; stride(columns / step)]),
            next: 0,
        }
    }

    /// The differences of the pixels of two rows.
    #[inline(always)]
    pub(super) fn differences(&self, one: FlipRow<'_>, other: FlipRow<'_>, into: &mut [f32]) {
        for (block, into) in into.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let at = block * LANES;
            let FlipRow { colours: [l, a, b], features: [edges, points] } = one;
            let [l, a, b, edges, points] =
                [lanes(l, at), lanes(a, at), lanes(b, at), lanes(edges, at), lanes(points, at)];
            let FlipRow { colours: [l2, a2, b2], features: [edges2, points2] } = other;
            let [l2, a2, b2, edges2, points2] =
                [lanes(l2, at), lanes(a2, at), lanes(b2, at), lanes(edges2, at), lanes(points2, at)];
            for k in 0..LANES {
                let colours = (&[l[k], a[k], b[k]], &[l2[k], a2[k], b2[k]]);
                let features = (&[edges[k], points[k]], &[edges2[k], points2[k]]);
                into[k] = difference(colours, features, self.most);
            }
        }
    }
}

impl FlipLines {
    /// Takes the next row, in linear sRGB.
    #[inline(always)]
    pub(super) fn push(&mut self, pixel: impl Fn(usize) -> [f32; 3], columns: usize) {
        let row = self.next;
        let [one, two, three] = self.opponents.each_mut().map(|ring| &mut ring.row_mut(row)[..columns]);
        for (at, ((one, two), three)) in one.iter_mut().zip(two).zip(three).enumerate() {
            [*one, *two, *three] = opponent_of(pixel(at));
        }
        self.next += 1;
    }

    /// Writes what is seen of the samples of a row from column `first` on, of a picture of `rows` rows of which those in reach were
    /// pushed.
    #[inline(always)]
    pub(super) fn see(
        &mut self,
        eye: &FlipEye,
        at @ (_, _, first): (usize, usize, usize),
        colours: [&mut [f32]; 3],
        features: [&mut [f32]; 2],
    ) {
        let Self { opponents, padded, places, sums: [x, y], .. } = self;
        let [one, two, three] = colours;
        for ((terms, ring), into) in
            eye.blurs.iter().zip(&*opponents).zip([&mut *one, &mut *two, &mut *three])
        {
            into.fill(0.0);
            for (scale, kernel) in terms {
                down(kernel, ring, at, places, padded);
                x.fill(0.0);
                along(kernel, padded, first, x);
                into.iter_mut().zip(&*x).for_each(|(sum, value)| *sum += scale * value);
            }
        }
        for ((one, two), three) in one.iter_mut().zip(two).zip(three) {
            [*one, *two, *three] = seen_colour([*one, *two, *three]);
        }
        let [lightness, ..] = &*opponents;
        let [edges, points] = features;
        down(&eye.smooth, lightness, at, places, padded);
        for (kernel, into) in eye.derivatives.iter().zip([&mut *edges, &mut *points]) {
            into.fill(0.0);
            along(kernel, padded, first, into);
        }
        for (kernel, into) in eye.derivatives.iter().zip([edges, points]) {
            down(kernel, lightness, at, places, padded);
            y.fill(0.0);
            along(&eye.smooth, padded, first, y);
            into.iter_mut().zip(&*y).for_each(|(x, y)| *x = (*x * *x + y * y).sqrt());
        }
    }
}

/// Filters the rows about one of them; beyond the borders, the picture continues with what is there.
#[inline(always)]
fn down(
    kernel: &Kernel,
    ring: &Ring<f32>,
    (row, rows, _): (usize, usize, usize),
    places: &mut Vec<usize>,
    padded: &mut Padded,
) {
    let reach = kernel.reach();
    places.clear();
    places.extend((0..=2 * reach).map(|k| ring.place((row + k).saturating_sub(reach).min(rows - 1))));
    padded.inner().fill(0.0);
    across(kernel, ring.values(), places, padded.inner());
    padded.hold();
}

#[cfg(test)]
mod tests {
    use super::super::{FlipPicture, Picture};
    use super::*;

    /// Row by row, from the first row or from a later one, FLIP is that of the whole picture at each sample.
    #[test]
    fn rows_are_those_of_whole_pictures() {
        let (columns, rows, per_degree) = (43, 31, 30.0);
        let value = |k: usize, step: f64| (step * k as f64).fract();
        let picture = |steps: [f64; 3]| {
            Picture::new(columns, steps.map(|step| (0..columns * rows).map(|k| value(k, step)).collect()))
                .unwrap()
        };
        let pictures =
            [picture([0.618_034, 0.414_214, 0.732_051]), picture([0.236_068, 0.645_751, 0.316_625])];
        let [one, other] = pictures.each_ref().map(|picture| FlipPicture::new(picture, per_degree));
        let expected = one.differences(&other).unwrap();
        let eye = FlipEye::new(per_degree);
        for (start, step, first) in [(0, 1, 0), (17, 1, 0), (0, 2, 1), (5, 3, 2)] {
            let across = columns / step;
            let mut lines = [eye.lines(columns, step), eye.lines(columns, step)];
            let mut planes = [0; 2].map(|_| [0; 5].map(|_| vec![0.0; stride(across)]));
            lines.iter_mut().for_each(|lines| lines.next = start.max(eye.reach) - eye.reach);
            for row in start..rows {
                for ((lines, picture), planes) in lines.iter_mut().zip(&pictures).zip(&mut planes) {
                    while lines.next < (row + eye.reach + 1).min(rows) {
                        let from = lines.next * columns;
                        let pixel =
                            |x: usize| picture.planes().each_ref().map(|plane| plane[from + x] as f32);
                        lines.push(pixel, columns);
                    }
                    let [l, a, b, edges, points] = planes.each_mut().map(Vec::as_mut_slice);
                    lines.see(&eye, (row, rows, first), [l, a, b], [edges, points]);
                }
                let [one, other] = planes.each_ref().map(|[l, a, b, edges, points]| FlipRow {
                    colours: [l, a, b],
                    features: [edges, points],
                });
                let mut found = vec![0.0; stride(across)];
                eye.differences(one, other, &mut found);
                for (at, found) in found[..across].iter().enumerate() {
                    let expected = expected[row * columns + first + at * step];
                    // Filters in another order.
                    assert!((found - expected).abs() < 2e-5, "{row} {at}: {found} {expected}");
                }
            }
        }
    }
}
