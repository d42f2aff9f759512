//! Scatterers of a stack, computed once for all wavelengths that share them.

use papilio_optics::lobe::{BalancedLobe, FaceLobe, Lobe};
use papilio_optics::rough::{Rough, Side};
use papilio_optics::scatter::Scatter;

use super::algebra::Operator;
use super::grid::Grid;
use super::known::Known;
use super::lobes::LobeOrders;
use super::matrix::Matrix;
use super::once::{Kernel, Pairs, ScatterMode};
use super::part::Part;
use super::rough::RoughOrders;
use super::scatter::ScatterOrders;
use super::slab::{Model, Slab};

/// A scatterer on one grid.
#[derive(Debug)]
enum Scatterer<'a> {
    Slab(Slab),
    Diffuser(LobeBetween),
    Balanced(Balanced<'a>),
    Rough { face: &'a Rough, orders: Option<Box<RoughOrders>>, missing: [Vec<f64>; 2] },
    Scatter { scatter: &'a Scatter, disc: f64, orders: Option<ScatterOrders>, missing: Vec<f64> },
}

/// A diffuser's lobe between media of these indices.
#[derive(Debug)]
struct LobeBetween {
    lobe: Lobe,
    /// Radius of the disc of a Lambertian lobe; 1 for other lobes.
    disc: f64,
    indices: [f64; 2],
    orders: LobeOrders,
    /// Light of each node that the quadrature misses, averaged over both directions.
    missing: Vec<f64>,
}

/// A balanced lobe.
#[derive(Debug)]
struct Balanced<'a> {
    lobe: &'a BalancedLobe,
    /// Its factor at each node.
    factors: Vec<f64>,
    /// Light of each node that the quadrature misses.
    missing: Vec<f64>,
}

/// Orders of the lobes of faces: transmitted and reflected light have lobes in common.
#[derive(Debug, Default)]
struct FaceLobes(Vec<(FaceLobe, LobeOrders)>);

impl FaceLobes {
    /// Returns the kernel of a lobe in this order.
    fn order(&mut self, lobe: FaceLobe, order: usize, grid: &Grid) -> Option<Matrix> {
        let place = self.0.iter().position(|(known, _)| *known == lobe).unwrap_or(self.0.len());
        if place == self.0.len() {
            self.0.push((lobe, LobeOrders::of_face(lobe)));
        }
        self.0[place].1.order(order, grid)
    }
}

/// Response of a scatterer in one azimuthal order.
#[derive(Debug)]
#[allow(clippy::large_enum_variant, reason = "there are as many as layers, and large parts are on the heap")]
pub(super) enum Scattered {
    /// Reflection and transmission.
    Whole(Part),
    /// Scattering of light from above in one mode.
    Kernel(Operator),
}

impl Scattered {
    /// Returns a slab that reflects and transmits the same from both sides.
    fn slab([reflected, transmitted]: [Operator; 2]) -> Self {
        Self::Whole(Part { above: reflected.clone(), below: reflected, down: transmitted, absorbed: None })
    }
}

/// All scatterers on a grid.
#[derive(Debug, Default)]
pub(super) struct Scatterers<'a> {
    all: Vec<Scatterer<'a>>,
    lobes: FaceLobes,
}

impl<'a> Scatterers<'a> {
    /// Returns the number of this layer; adds it if it is new.
    pub(super) fn slab(&mut self, model: Model, terms: usize, grid: &Grid) -> usize {
        let known = |s: &Scatterer<'_>| matches!(s, Scatterer::Slab(slab) if slab.model() == model);
        self.find(known, || Scatterer::Slab(Slab::new(model, terms, grid)))
    }

    /// Returns the number of a lobe between media of these indices; adds it if it is new. `disc` is the
    /// radius of the Lambertian lobe.
    pub(super) fn lobe(&mut self, lobe: Lobe, disc: f64, indices: [f64; 2], grid: &Grid) -> usize {
        let disc = if lobe == Lobe::Lambertian { disc } else { 1.0 };
        let known = |s: &Scatterer<'_>| matches!(s, Scatterer::Diffuser(d) if d.lobe == lobe && d.disc == disc && d.indices == indices);
        self.find(known, || Scatterer::Diffuser(LobeBetween::new(lobe, disc, indices, grid)))
    }

    /// Returns the number of a balanced lobe; adds it if it is new.
    pub(super) fn balanced_lobe(&mut self, lobe: &'a BalancedLobe, grid: &Grid) -> usize {
        let known = |s: &Scatterer<'_>| {
            let same = |other: &BalancedLobe| other.lobe() == lobe.lobe() && other.light() == lobe.light();
            matches!(s, Scatterer::Balanced(other) if same(other.lobe))
        };
        self.all.iter().position(known).unwrap_or_else(|| {
            self.all.push(Scatterer::Balanced(Balanced::new(lobe, grid, &mut self.lobes)));
            self.all.len() - 1
        })
    }

    /// Returns the number of this rough interface; adds it if it is new.
    pub(super) fn rough(&mut self, face: &'a Rough, orders: impl FnOnce() -> RoughOrders) -> usize {
        let like = |other: &Rough| {
            other.alpha() == face.alpha()
                && other.distribution() == face.distribution()
                && [Side::Above, Side::Below].into_iter().all(|side| other.index(side) == face.index(side))
        };
        let known = |s: &Scatterer<'_>| matches!(s, Scatterer::Rough { face, .. } if like(face));
        self.find(known, || Scatterer::Rough {
            face,
            orders: Some(Box::new(orders())),
            missing: Default::default(),
        })
    }

    /// Returns the number of this kernel in a disc of this radius; adds it if it is new.
    pub(super) fn scatter(
        &mut self,
        scatter: &'a Scatter,
        disc: f64,
        orders: impl FnOnce() -> ScatterOrders,
    ) -> usize {
        let known = |s: &Scatterer<'_>| matches!(s, Scatterer::Scatter { scatter: other, disc: of, .. } if *other == scatter && *of == disc);
        let new = || Scatterer::Scatter { scatter, disc, orders: Some(orders()), missing: Vec::new() };
        self.find(known, new)
    }

    fn find(&mut self, known: impl Fn(&Scatterer<'a>) -> bool, new: impl FnOnce() -> Scatterer<'a>) -> usize {
        self.all.iter().position(known).unwrap_or_else(|| {
            self.all.push(new());
            self.all.len() - 1
        })
    }

    /// Returns the number of azimuthal orders that are scattered among nodes with weight.
    pub(super) fn orders(&self) -> usize {
        let orders = |scatterer: &Scatterer<'_>| match scatterer {
            Scatterer::Slab(slab) => slab.orders(),
            Scatterer::Diffuser(LobeBetween { lobe: Lobe::Lambertian, .. }) => 1,
            Scatterer::Diffuser(_) | Scatterer::Balanced(_) => usize::MAX,
            Scatterer::Rough { orders, .. } => orders.as_ref().map_or(0, |orders| orders.orders()),
            Scatterer::Scatter { orders, .. } => orders.as_ref().map_or(0, ScatterOrders::orders),
        };
        self.all.iter().map(orders).max().unwrap_or(0)
    }

    /// Returns the same scatterers for the extra nodes of the grid alone; `known` keeps the kernels between
    /// others.
    pub(super) fn extras(self, grid: &Grid, known: &mut Known) -> Self {
        let mut extras = |scatterer| match scatterer {
            Scatterer::Slab(slab) => Scatterer::Slab(slab.extras(grid)),
            Scatterer::Diffuser(lobe) => Scatterer::Diffuser(LobeBetween {
                orders: LobeOrders::new(lobe.lobe, lobe.disc),
                missing: lobe.missing[grid.regular..].to_vec(),
                ..lobe
            }),
            Scatterer::Balanced(balanced) => Scatterer::Balanced(Balanced {
                factors: balanced.factors[grid.regular..].to_vec(),
                missing: balanced.missing[grid.regular..].to_vec(),
                ..balanced
            }),
            Scatterer::Rough { face, orders, missing } => {
                let kept = orders.map_or(missing, |orders| {
                    let extras = orders.missing_straight().each_ref().map(|all| all[grid.regular..].to_vec());
                    known.add_rough(face, *orders);
                    extras
                });
                Scatterer::Rough { face, orders: None, missing: kept }
            }
            Scatterer::Scatter { scatter, disc, orders, missing } => {
                let kept = orders.map_or(missing, |orders| {
                    let extras = orders.missing_straight()[grid.regular..].to_vec();
                    known.add_scatter(scatter, disc, orders);
                    extras
                });
                Scatterer::Scatter { scatter, disc, orders: None, missing: kept }
            }
        };
        Self { all: self.all.into_iter().map(&mut extras).collect(), lobes: FaceLobes::default() }
    }

    /// Returns the modes in which single scatterers without a closed series scatter light, by their numbers.
    pub(super) fn ways(&self) -> Vec<(usize, ScatterMode)> {
        const SIDES: [(Side, Side); 3] =
            [(Side::Above, Side::Above), (Side::Above, Side::Below), (Side::Below, Side::Below)];
        let mut ways = Vec::new();
        for (number, scatterer) in self.all.iter().enumerate() {
            let kernels: Vec<Kernel> = match scatterer {
                Scatterer::Rough { face, .. } => SIDES
                    .map(|(from, to)| Kernel::Rough { face: Box::new((*face).clone()), from, to })
                    .to_vec(),
                Scatterer::Scatter { scatter, disc, .. } => {
                    vec![Kernel::Scatter { scatter: (*scatter).clone(), disc: *disc }]
                }
                Scatterer::Slab(_) | Scatterer::Diffuser(_) | Scatterer::Balanced(_) => Vec::new(),
            };
            for kernel in kernels {
                let way = |pairs: &Pairs| (number, ScatterMode { kernel: kernel.clone(), pairs: *pairs });
                ways.extend(kernel.pairs().iter().map(way));
            }
        }
        ways
    }

    /// Returns the regular response of each scatterer, and a unit of light scattered in one mode of one of
    /// them; only for [`Self::extras`].
    pub(super) fn once(&mut self, (number, way): (usize, &ScatterMode), grid: &Grid) -> Vec<Scattered> {
        let len = grid.len();
        let unit = |straight: Vec<f64>| {
            let count = |out: usize, from: usize| if way.pairs.hold(from, out) { 1.0 } else { 0.0 };
            Operator { regular: 0, straight, kernel: Some(Matrix::from_fn(len, len, count).into()) }
        };
        let flat = |straight: Vec<f64>| Operator { regular: 0, straight, kernel: None };
        let one = |(k, scatterer): (usize, &mut Scatterer<'_>)| match scatterer {
            Scatterer::Slab(slab) => {
                let operators = slab.operators(0).map(|operator| slab.spread(&operator, grid));
                Scattered::slab(operators.map(|operator| flat(operator.straight)))
            }
            Scatterer::Diffuser(lobe) => Scattered::Kernel(flat(lobe.straight(grid))),
            Scatterer::Balanced(balanced) => Scattered::Kernel(flat(balanced.missing.clone())),
            Scatterer::Rough { missing, .. } => {
                let [mut above, mut below] = missing.clone().map(flat);
                let mut down = flat(vec![0.0; len]);
                if let (true, Kernel::Rough { from, to, .. }) = (k == number, &way.kernel) {
                    let sends = match (from, to) {
                        (Side::Above, Side::Above) => &mut above,
                        (Side::Below, Side::Below) => &mut below,
                        _ => &mut down,
                    };
                    *sends = unit(std::mem::take(&mut sends.straight));
                }
                Scattered::Whole(Part { above, below, down, absorbed: None })
            }
            Scatterer::Scatter { missing, .. } => {
                let straight = missing.clone();
                Scattered::Kernel(if k == number { unit(straight) } else { flat(straight) })
            }
        };
        self.all.iter_mut().enumerate().map(one).collect()
    }

    /// Returns the response of each scatterer in this order.
    pub(super) fn scattered(&mut self, order: usize, grid: &Grid) -> Vec<Scattered> {
        let lobes = &mut self.lobes;
        let one = |scatterer: &mut Scatterer<'_>| match scatterer {
            Scatterer::Slab(slab) => {
                Scattered::slab(slab.operators(order).map(|operator| slab.spread(&operator, grid)))
            }
            Scatterer::Diffuser(lobe) => Scattered::Kernel(lobe.operator(order, grid)),
            Scatterer::Balanced(balanced) => Scattered::Kernel(balanced.operator(order, grid, lobes)),
            Scatterer::Rough { face, orders, .. } => Scattered::Whole(match orders {
                Some(orders) => orders.part(face, order, grid),
                None => Part::dark(grid),
            }),
            Scatterer::Scatter { orders, .. } => Scattered::Kernel(match orders {
                Some(orders) => orders.operator(order, grid),
                None => Operator::diagonal(grid.regular, vec![0.0; grid.len()]),
            }),
        };
        self.all.iter_mut().map(one).collect()
    }
}

impl LobeBetween {
    fn new(lobe: Lobe, disc: f64, indices: [f64; 2], grid: &Grid) -> Self {
        let mut orders = LobeOrders::new(lobe, disc);
        let missing = orders.order(0, grid).map(|kernel| {
            let found = |j: usize, index: f64| -> f64 {
                let column = (0..grid.regular).filter(|&i| grid.beta[i] < index);
                column.map(|i| grid.scale[i] * kernel[(i, j)]).sum::<f64>() / grid.scale[j]
            };
            // Only the Lambertian lobe has a disc of its own: it is that of air, scaled.
            let whole = |beta: f64, index: f64| lobe.fraction_in_disc(beta / disc, index / disc);
            let misses = |j: usize, index| whole(grid.beta[j], index) - found(j, index);
            (0..grid.len()).map(|j| 0.5 * (misses(j, indices[0]) + misses(j, indices[1]))).collect()
        });
        Self { lobe, disc, indices, orders, missing: missing.unwrap_or_default() }
    }

    fn straight(&self, grid: &Grid) -> Vec<f64> {
        let [above, below] = self.indices;
        let both = |i: usize| grid.beta[i] < above.min(below);
        (0..grid.len()).map(|i| if both(i) { self.missing[i] } else { 0.0 }).collect()
    }

    fn operator(&mut self, order: usize, grid: &Grid) -> Operator {
        let [above, below] = self.indices;
        let straight = self.straight(grid);
        let mut kernel = self.orders.order(order, grid);
        for (from, column) in kernel.iter_mut().flat_map(Matrix::columns_mut) {
            let out = |(value, out): (&mut f64, &f64)| {
                let carried = grid.beta[from] < above && *out < below;
                if !carried {
                    *value = 0.0;
                }
            };
            column.iter_mut().zip(&grid.beta).for_each(out);
        }
        Operator { regular: grid.regular, straight, kernel: kernel.map(Into::into) }
    }
}

impl<'a> Balanced<'a> {
    fn new(lobe: &'a BalancedLobe, grid: &Grid, lobes: &mut FaceLobes) -> Self {
        let factors: Vec<f64> = grid.beta.iter().map(|beta| lobe.factor(*beta)).collect();
        let mut all = Self { lobe, factors, missing: Vec::new() };
        if let Some(kernel) = all.kernel(0, grid, lobes) {
            let found = |j: usize| -> f64 {
                let column = kernel.column(j)[..grid.regular].iter().zip(&grid.scale);
                column.map(|(value, scale)| value * scale).sum::<f64>() / grid.scale[j]
            };
            let of_face = |j: usize| lobe.light().at(grid.beta[j]);
            all.missing = (0..grid.len()).map(|j| of_face(j) - found(j)).collect();
        }
        all
    }

    fn kernel(&self, order: usize, grid: &Grid, lobes: &mut FaceLobes) -> Option<Matrix> {
        let mut kernel = lobes.order(self.lobe.lobe(), order, grid)?;
        for (j, column) in kernel.columns_mut() {
            let from = self.factors[j];
            column.iter_mut().zip(&self.factors).for_each(|(value, to)| *value *= from * to);
        }
        Some(kernel)
    }

    fn operator(&self, order: usize, grid: &Grid, lobes: &mut FaceLobes) -> Operator {
        let kernel = self.kernel(order, grid, lobes).map(Into::into);
        Operator { regular: grid.regular, straight: self.missing.clone(), kernel }
    }
}
