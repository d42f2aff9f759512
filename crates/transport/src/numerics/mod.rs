//! Numerics without light: quadrature, products of matrices, Bessel functions.

pub(crate) mod bessel;
pub(crate) mod product;
pub(crate) mod quadrature;
