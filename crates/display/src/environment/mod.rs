//! Environments: angular distributions of the light from a room or a sky.
//!
//! - [`cap`]: uniform radiance in a spherical cap or ring around any direction;
//! - [`profile`]: a rotationally symmetric distribution, from a table over inclination;
//! - [`luminous_sheet`]: a luminous plane with a given intensity distribution;
//! - [`Panorama`]: an image of the whole sphere;
//! - [`Sky`]: the CIE standard general skies;
//! - [`MeterWindow`]: what the receptor of a glossmeter accepts;
//! - [`Pose`]: the orientation of the display below a sky or in a room.
//!
//! All distributions are relative: the scene defines their fractions of the illuminance and their spectra.

mod cap;
mod map;
mod pose;
mod profile;
mod sheet;
mod sky;
mod window;

pub use cap::cap;
pub use map::{MapField, Panorama};
pub use pose::Pose;
pub use profile::profile;
pub use sheet::{Sheet, luminous_sheet};
pub use sky::Sky;
pub use window::MeterWindow;
