//! Tests of the generator: the pages of `docs/`, and small repositories with one mistake each.

mod docs;
mod mistakes;
