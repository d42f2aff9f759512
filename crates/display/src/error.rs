//! Why a scene cannot be computed.

use papilio_colour::ColourError;
use papilio_optics::OpticsError;

/// Why a scene cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DisplayError {
    /// A film that cannot be.
    #[error(transparent)]
    Film(#[from] OpticsError),
    /// A light that cannot be scaled or seen.
    #[error(transparent)]
    Colour(#[from] ColourError),
    /// A state needs a dark sub-pixel, but the pixel has no dark gap.
    #[error("state `{state}` needs a dark sub-pixel, but there is no `dark` gap")]
    NoDarkGap {
        /// The state.
        state: String,
    },
    /// A direction that no reader in air can see, or no light in air can come from.
    #[error(
        "a {what} at {theta_deg} deg in a medium of index {index} is not above the display's horizon in air"
    )]
    BelowHorizon {
        /// "view" or "light".
        what: &'static str,
        /// Its inclination.
        theta_deg: f64,
        /// The medium of the angle.
        index: f64,
    },
    /// A film's fringes over angle are too many to tabulate.
    #[error(
        "{key}: this layer of {thickness_nm} nm makes {fringes} interference fringes over angle at {nm} nm, more than \
         are tabulated (expected films of about {most_mm} mm in all at most; a thicker layer does not interfere in room \
         light: make it a layer of the display)"
    )]
    Fringes {
        /// The key of its thickness or gap.
        key: String,
        /// Its thickness.
        thickness_nm: f64,
        /// Their number, from the normal to the horizon in the layer.
        fringes: f64,
        /// The wavelength.
        nm: f64,
        /// How thick films may be.
        most_mm: f64,
    },
    /// Angles in glass need one index.
    #[error("angles in glass need a glass whose index does not depend on wavelength")]
    DispersiveGlassAngles,
    /// A pixel that scatters lies under layers, not under the ordinary panel.
    #[error("a pixel given by its BRDF lies under layers in general form, not under the ordinary panel")]
    ScatteringUnderPanel,
    /// A pixel that scatters has no reflectance by angle and wavelength alone.
    #[error(
        "a pixel given by its BRDF sends light into all directions: there is no table of its reflectance by angle; \
         `papilio diffuser inspect` shows its file, and `papilio brdf` what the whole display makes of light"
    )]
    ScanOfScattering,
    /// The worker threads could not be started.
    #[error("{threads} worker threads could not be started")]
    Threads {
        /// How many were asked for.
        threads: usize,
    },
    /// A number overflowed: something in the scene is far outside of what displays are made of.
    #[error("a result is not a finite number: something in the scenario is far too small or far too large")]
    NotFinite,
    /// Something scatters into an angle too narrow for adding to resolve between other layers.
    #[error(
        "{what} (number {number} from the top of what scatters) is too narrow for adding among these layers: \
         it would take {nodes} directions, more than {most} are a matter of hours; the walk takes it \
         (--solver monte-carlo, or method = \"monte-carlo\")"
    )]
    TooNarrow {
        /// The layer: its kind, and what makes it narrow.
        what: String,
        /// Which one it is, counted from the top among what scatters, from 1.
        number: usize,
        /// Radial nodes that two levels need.
        nodes: usize,
        /// The most that are tried.
        most: usize,
    },
    /// Rows of a table are worse than what it is to hold.
    #[error(
        "{count} of {of} rows of the {table} have a relative error of Y above {most:.1e}, the worst: {named}{more}\n  = help: \
         --allow-error {enough} (allow_error in Python) writes the table with each row's error beside it; the walk \
         (method = \"monte-carlo\") computes single views without this error"
    )]
    RowsTooUncertain {
        /// What the table is of.
        table: &'static str,
        /// How many rows.
        count: usize,
        /// Of how many.
        of: usize,
        /// The error that was to hold.
        most: f64,
        /// The worst rows, with their errors.
        named: String,
        /// What follows them, if there are more.
        more: &'static str,
        /// What would have to be allowed.
        enough: f64,
    },
    /// A number of paths says nothing to a solver without paths.
    #[error("adding traces no paths: it needs a relative error to stop at")]
    NoPaths,
    /// Designs are pixels of films.
    #[error("designs are film pixels: this display has another pixel")]
    NotAFilm,
    /// Designs are seen through adding's kernel.
    #[error("designs are computed by adding to a relative error: the scene asks for another method")]
    NotByAdding,
    /// A design of other states than the display that was prepared.
    #[error("a design has the states of the display that was prepared, in the same order")]
    OtherStates,
    /// A quantity of a view or state that is not there.
    #[error("there is no {what} for the quantity `{quantity}`")]
    NoSuchQuantity {
        /// What is missing: a view or a state.
        what: String,
        /// The quantity's name.
        quantity: &'static str,
    },
    /// A derivative by something that the film does not have.
    #[error("the film has no {what} number {number}")]
    NoSuchParameter {
        /// A layer of fixed thickness, a sub-pixel, ...
        what: &'static str,
        /// Its number, from 0.
        number: usize,
    },
    /// The run was stopped before there was anything to report.
    #[error("stopped before the first estimate")]
    Interrupted,
}

/// The thickest coating, mm.
const THICKEST_COATING_MM: f64 = 0.05;

impl DisplayError {
    /// What is wrong with a coating that errors call `key`.
    pub(crate) fn of_coating(error: OpticsError, key: &str) -> Self {
        match error {
            OpticsError::Fringes { layer, thickness_nm, fringes, nm } => {
                let key = format!("{key}.film.{layer}.thickness_nm");
                Self::Fringes { key, thickness_nm, fringes, nm, most_mm: THICKEST_COATING_MM }
            }
            error => error.into(),
        }
    }
}
