//! Values of forms: for each term, a sum over the products of which it is the first factor, times that term.
//! A few columns are computed at a time, so that only the values themselves leave the registers.

use pulp::{Arch, Simd, WithSimd};

/// Forms of one degree and the terms at which they are evaluated.
pub(super) struct Values<'a> {
    /// `[form][product]`, and the number of products.
    pub(super) forms: &'a [f64],
    pub(super) products: usize,
    /// `[term][column]`.
    pub(super) terms: &'a [f64],
    /// Products of one degree less, `[product][column]`.
    pub(super) less: &'a [f64],
    /// For each term the first of these of which it is the first factor.
    pub(super) from: &'a [usize],
    pub(super) columns: usize,
    /// `[form][column]`.
    pub(super) out: &'a mut [f64],
}

/// Number of registers of columns that are computed together.
const WIDE: usize = 4;

impl Values<'_> {
    /// Adds the values to `out`.
    pub(super) fn add(self) {
        if self.columns > 0 && self.products > 0 {
            Arch::new().dispatch(self);
        }
    }

    /// Computes `FORMS` forms from this one on.
    #[inline(always)]
    fn rows<S: Simd, const FORMS: usize>(&mut self, simd: S, form: usize) {
        let columns_at_once = WIDE * S::F64_LANES;
        let whole = self.columns - self.columns % columns_at_once;
        for at in (0..whole).step_by(columns_at_once) {
            self.block::<S, FORMS, WIDE>(simd, form, at);
        }
        for at in (whole..self.columns).step_by(S::F64_LANES) {
            self.block::<S, FORMS, 1>(simd, form, at);
        }
    }

    #[inline(always)]
    fn block<S: Simd, const FORMS: usize, const WIDTH: usize>(&mut self, simd: S, form: usize, at: usize) {
        let (columns, kept) = (self.columns, self.less.len() / self.columns);
        let zero = [[simd.splat_f64s(0.0); WIDTH]; FORMS];
        let coefficients: [&[f64]; FORMS] =
            std::array::from_fn(|f| &self.forms[(form + f) * self.products..][..self.products]);
        let (mut sum, mut place) = (zero, 0);
        for (term, from) in self.terms.chunks_exact(columns).zip(self.from) {
            let mut inner = zero;
            for product in self.less[from * columns..kept * columns].chunks_exact(columns) {
                let product = load::<S, WIDTH>(simd, product, at);
                for f in 0..FORMS {
                    let coefficient = simd.splat_f64s(coefficients[f][place]);
                    for v in 0..WIDTH {
                        inner[f][v] = simd.mul_add_e_f64s(coefficient, product[v], inner[f][v]);
                    }
                }
                place += 1;
            }
            let term = load::<S, WIDTH>(simd, term, at);
            for f in 0..FORMS {
                for v in 0..WIDTH {
                    sum[f][v] = simd.mul_add_e_f64s(inner[f][v], term[v], sum[f][v]);
                }
            }
        }
        for (f, sum) in sum.iter().enumerate() {
            let row = &mut self.out[(form + f) * columns..][..columns];
            let before = load::<S, WIDTH>(simd, row, at);
            for v in 0..WIDTH {
                let from = at + v * S::F64_LANES;
                let here = &mut row[from..columns.min(from + S::F64_LANES)];
                simd.partial_store_f64s(here, simd.add_f64s(before[v], sum[v]));
            }
        }
    }
}

impl WithSimd for Values<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let count = self.forms.len() / self.products;
        let mut form = 0;
        while form < count {
            match count - form {
                1 => self.rows::<S, 1>(simd, form),
                2 => self.rows::<S, 2>(simd, form),
                _ => self.rows::<S, 3>(simd, form),
            }
            form += 3;
        }
    }
}

/// Loads registers of a row from `at` on; a single one may reach beyond its end.
#[inline(always)]
fn load<S: Simd, const WIDTH: usize>(simd: S, row: &[f64], at: usize) -> [S::f64s; WIDTH] {
    let (whole, rest) = S::as_simd_f64s(&row[at..row.len().min(at + WIDTH * S::F64_LANES)]);
    match <&[S::f64s; WIDTH]>::try_from(whole) {
        Ok(all) => *all,
        Err(_) => [simd.partial_load_f64s(rest); WIDTH],
    }
}
