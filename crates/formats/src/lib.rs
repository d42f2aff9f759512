//! Readers and writers: spectra, n-k tables, pixel tables, results.
