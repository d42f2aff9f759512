//! The web app: a display laboratory in the browser, served from this machine.
//!
//! The server is a thin layer over `scenario`, `display`, `formats` and `figures`; it contains no physics.
//! The browser holds the text of the scenario, which is the only thing that is edited, and sends all of it
//! with each request. The server stores only data that may be lost at any time: prepared displays (so that
//! moving a slider takes milliseconds), states of pictures, files that were dropped onto the page (identified
//! by their SHA-256, and sent again when they are no longer stored), and running computations.
//!
//! - [`Site::bind`] binds a port of this machine, [`Site::serve`] serves requests on it.
//! - `api` has a row for each endpoint; the OpenAPI description is generated from the same rows and types
//!   ([`openapi`]).
//! - `work` runs computations on separate threads, limits their number and time, and stops them when the
//!   client disconnects.
//! - `guard` refuses requests that do not come from this page: foreign hosts and origins, missing tokens.
//! - `listen` and `places` accept a limited number of connections, and close those whose clients do not read.
//! - `prepared` stores prepared displays, `held` the states of pictures, `store` uploaded files.
//! - `jobs` runs commands of the program as processes that go on without the page.
//! - `page` serves the bundle of `web/page`, if one was built into the program.
//!
//! **Limits.** Requests of at most 1 MiB, scenarios of 256 KiB, files of 64 MiB, responses of about half a
//! million numbers. **Out of scope.** Reading the disk on behalf of the browser, or writing outside of
//! the folders of jobs; users and passwords.

mod api;
mod fault;
mod guard;
mod held;
mod jobs;
mod listen;
mod page;
mod panics;
mod places;
mod prepared;
mod reading;
mod shipped;
mod site;
mod store;
mod work;

pub use api::openapi;
pub use jobs::{JobOptions, LOCK_VARIABLE};
pub use listen::ServeError;
pub use site::{Options, Site, Start};
