//! Random numbers, low-discrepancy points and warps, each with its density.
