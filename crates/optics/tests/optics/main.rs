//! Films, coatings, rough interfaces and kernels, each compared with an independent reference.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, say what they expect by unwrapping")]

mod berreman;
mod coatings_two_roads;
mod films_derivatives;
mod films_equal_tmm;
mod films_known_killers;
mod films_laws;
mod films_reference_imod;
mod films_two_roads;
mod frank_oseen;
mod rough_faces;
mod scatter;
