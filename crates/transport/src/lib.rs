//! Light through the layered display: the stack and the Monte Carlo walk.
