//! Where light comes from: profiles over inclination.

mod profile;

pub use profile::read_profile;
