//! FLIP row by row: the same numbers as of [`FlipPicture`](super::FlipPicture), with the rows that its kernels reach
//! at hand.

use super::filter::Kernel;
use super::flip::{blurs, difference, feature_kernels, largest_colour_difference, opponent_of, seen_colour};
use super::rows::{LANES, Ring, Taps, across, along, held, lanes, stride};

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

/// Rows that were filtered along themselves.
pub(super) struct FlipLines {
    blurs: [Vec<Ring<f32>>; 3],
    smooth: Ring<f32>,
    derivatives: [Ring<f32>; 2],
    padded: [Vec<f32>; 3],
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

    pub(super) fn lines(&self, columns: usize) -> FlipLines {
        let stride = stride(columns);
        let ring = || Ring::new(stride, 2 * self.reach + 1);
        FlipLines {
            blurs: self.blurs.each_ref().map(|terms| terms.iter().map(|_| ring()).collect()),
            smooth: ring(),
            derivatives: [ring(), ring()],
            padded: [0; 3].map(|_| vec![0.0; stride + 2 * self.reach]),
            places: Vec::new(),
            sums: [0; 2].map(|_| vec![0.0; stride]),
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
    pub(super) fn push(&mut self, eye: &FlipEye, columns: usize, pixel: impl Fn(usize) -> [f32; 3]) {
        let [one, two, three] = &mut self.padded;
        let inner = eye.reach..eye.reach + columns;
        let planes = one[inner.clone()].iter_mut().zip(&mut two[inner.clone()]).zip(&mut three[inner]);
        for (at, ((one, two), three)) in planes.enumerate() {
            [*one, *two, *three] = opponent_of(pixel(at));
        }
        self.padded.iter_mut().for_each(|plane| held(plane, eye.reach, columns));
        let row = self.next;
        for ((terms, rings), padded) in eye.blurs.iter().zip(&mut self.blurs).zip(&self.padded) {
            for ((_, kernel), ring) in terms.iter().zip(rings) {
                along(kernel, padded, eye.reach, ring.row_mut(row));
            }
        }
        let [lightness, ..] = &self.padded;
        along(&eye.smooth, lightness, eye.reach, self.smooth.row_mut(row));
        for (kernel, ring) in eye.derivatives.iter().zip(&mut self.derivatives) {
            along(kernel, lightness, eye.reach, ring.row_mut(row));
        }
        self.next += 1;
    }

    /// Writes what is seen of a row, of a picture of `rows` rows of which those in reach were pushed.
    #[inline(always)]
    pub(super) fn see(
        &mut self,
        eye: &FlipEye,
        (row, rows): (usize, usize),
        colours: [&mut [f32]; 3],
        features: [&mut [f32]; 2],
    ) {
        let Self { blurs, smooth, derivatives, places, sums: [x, y], .. } = self;
        let at = (row, rows);
        let [one, two, three] = colours;
        for ((terms, rings), into) in eye.blurs.iter().zip(&*blurs).zip([&mut *one, &mut *two, &mut *three]) {
            into.fill(0.0);
            for ((scale, kernel), ring) in terms.iter().zip(rings) {
                down(kernel, ring, at, places, x);
                into.iter_mut().zip(&*x).for_each(|(sum, value)| *sum += scale * value);
            }
        }
        for ((one, two), three) in one.iter_mut().zip(two).zip(three) {
            [*one, *two, *three] = seen_colour([*one, *two, *three]);
        }
        for ((kernel, ring), into) in eye.derivatives.iter().zip(&*derivatives).zip(features) {
            down(&eye.smooth, ring, at, places, x);
            down(kernel, smooth, at, places, y);
            let both = x.iter().zip(&*y);
            into.iter_mut().zip(both).for_each(|(to, (x, y))| *to = (x * x + y * y).sqrt());
        }
    }
}

/// Filters the rows about one of them; beyond the borders, the picture continues with the rows there.
#[inline(always)]
fn down(
    kernel: &Kernel,
    ring: &Ring<f32>,
    (row, rows): (usize, usize),
    places: &mut Vec<usize>,
    into: &mut [f32],
) {
    let reach = kernel.reach();
    places.clear();
    places.extend((0..=2 * reach).map(|k| ring.place((row + k).saturating_sub(reach).min(rows - 1))));
    into.fill(0.0);
    across(kernel, ring.values(), places, into);
}
