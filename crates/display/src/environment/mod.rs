//! The room and the sky as fields of light over the display.
//!
//! - [`cap`]: an even part of the hemisphere around any direction;
//! - [`profile`]: alike at all azimuths, from a table over inclination;
//! - [`luminous_sheet`]: what a sheet of light sends into each direction;
//! - [`Panorama`]: a picture of the whole sphere;
//! - [`Sky`]: the CIE standard general skies;
//! - [`Pose`]: how the display stands below a sky or in a room.
//!
//! Everything here is relative: shares of illuminance and spectra are the scene's.

mod cap;
mod map;
mod pose;
mod profile;
mod sheet;
mod sky;

pub use cap::cap;
pub use map::{Cells, Panorama};
pub use pose::Pose;
pub use profile::profile;
pub use sheet::{Sheet, luminous_sheet};
pub use sky::Sky;
