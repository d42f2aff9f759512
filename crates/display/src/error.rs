//! Errors of scenes and runs.

use papilio_colour::ColourError;
use papilio_microgeometry::MicrogeometryError;
use papilio_optics::OpticsError;
use papilio_sparkle::SparkleError;

/// Reason why a scene cannot be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DisplayError {
    /// A film with invalid parameters.
    #[error(transparent)]
    Film(#[from] OpticsError),
    /// A spectrum that cannot be scaled, or a grid outside the observer's range.
    #[error(transparent)]
    Colour(#[from] ColourError),
    /// A state needs a dark sub-pixel, but the pixel has no dark gap.
    #[error("state `{state}` needs a dark sub-pixel, but there is no `dark` gap")]
    NoDarkGap {
        /// The state.
        state: String,
    },
    /// A view or light direction that does not exist in air.
    #[error(
        "a {what} at {theta_deg} deg in a medium of index {index} is below the display's horizon in air (expected all of its cone above the horizon)"
    )]
    BelowHorizon {
        /// The object: "view" or "light".
        what: &'static str,
        /// Its inclination.
        theta_deg: f64,
        /// Index of the medium of the angle.
        index: f64,
    },
    /// A numerical aperture in light that is not diffuse: mirror images of lamps are averaged in solid angle.
    #[error("`viewer.numerical_aperture` needs diffuse light alone, but there are lamps or an environment")]
    ApertureInDirectedLight,
    /// A polariser or a polarised source where light is taken as unpolarised.
    #[error("`{key}` needs {needs}")]
    Polarised {
        /// The polariser or source.
        key: String,
        /// What the display or the computation would have to be.
        needs: &'static str,
    },
    /// Particles whose polarised light a computation does not follow.
    #[error("`particles` of a slab need {needs}")]
    Particles {
        /// What the display or the computation would have to be.
        needs: &'static str,
    },
    /// An eye so close to a picture that it sees a part of it along the panel.
    #[error(
        "from `viewer.distance_mm` = {distance_mm} the reader sees a part of the picture at {theta_deg:.4} deg, along the panel (expected a larger distance, \
         or image.perspective = false)"
    )]
    TooClose {
        /// Distance of the eye, mm.
        distance_mm: f64,
        /// Inclination of the view of that part.
        theta_deg: f64,
    },
    /// A film with too many interference fringes over angle to tabulate.
    #[error(
        "{key}: this layer of {thickness_nm} nm has {fringes} interference fringes over angle at {nm} nm, and the table of the film over direction \
         would need more than {most_panels} panels (expected fewer or wider fringes: a thinner layer, or mirrors around it that reflect less; a layer of \
         more than about 0.01 mm does not interfere in room light: describe it as a layer of the display)"
    )]
    Fringes {
        /// The key of the layer's thickness or gap.
        key: String,
        /// Thickness of the layer, nm.
        thickness_nm: f64,
        /// Number of fringes from the normal to the horizon in the layer.
        fringes: f64,
        /// Wavelength, nm.
        nm: f64,
        /// Largest number of panels of a table.
        most_panels: usize,
    },
    /// A surface that cannot be measured.
    #[error("{key}: the surface cannot be measured: {error}")]
    Surface {
        /// The key of the surface.
        key: String,
        /// What is wrong.
        error: MicrogeometryError,
    },
    /// Angles in glass for a glass with dispersion.
    #[error("angles in glass need a glass whose index does not depend on wavelength")]
    DispersiveGlassAngles,
    /// An approximation for ordinary panels, of other layers.
    #[error(
        "approximations are for an ordinary panel only: components in air, a face or a lobe, clear glass, a pixel that is not measured"
    )]
    ApproximatesNoPanel,
    /// Colours of a display with a colour filter at a height above its pixels.
    #[error(
        "the colours of a display with [display.matrix.filter] depend on where light enters and leaves, which this command does not compute yet \
         (remove the filter, or describe it as a layer without pattern)"
    )]
    FilterWithoutPlace,
    /// A pixel whose reflectance depends on azimuth, in a computation that does not know azimuths.
    #[error(
        "the reflectance of this pixel depends on azimuth, which {what} does not compute yet (see `{key}`; {hint})"
    )]
    Azimuth {
        /// What is not computed.
        what: &'static str,
        /// The key of its cause.
        key: &'static str,
        /// What to do.
        hint: &'static str,
    },
    /// A liquid-crystal pixel with too many interference fringes over angle to tabulate.
    #[error(
        "the layers of this pixel have so many interference fringes over inclination or azimuth that their table would need more than 1 GB \
         (expected birefringent coherent layers of at most about 0.02 mm, others of at most about 0.05 mm; describe a thick pane as kind = \"slab\")"
    )]
    CrystalFringes,
    /// A light or approximation that the Monte Carlo solver with places does not have.
    #[error("the Monte Carlo solver with places does not compute {what} (see `{key}`; remove it)")]
    NoPlaces {
        /// The light or approximation.
        what: &'static str,
        /// Its key.
        key: &'static str,
    },
    /// Light that is not refracted, which has no places in the layers.
    #[error(
        "light that is not refracted has no places in the layers (expected `solver.approximation` = \"none\", and `solver.angle_medium` = \"air\" \
         or \"glass\")"
    )]
    NoRefraction,
    /// A walk with places that cannot be prepared.
    #[error(transparent)]
    Places(papilio_transport::walk::places::PlaceError),
    /// Too many samples of a picture.
    #[error(
        "`image.samples_per_pixel` = {per_pixel} makes {samples} samples of this picture (expected at most {most}; fewer samples for each pixel, or \
         fewer pixels in `display.matrix.pixels`)"
    )]
    TooManySamples {
        /// Samples along each side of a pixel.
        per_pixel: usize,
        /// Samples of the picture.
        samples: usize,
        /// The limit.
        most: usize,
    },
    /// Too many different parts of pixels.
    #[error(
        "`image.samples_per_pixel` = {per_pixel} divides the pixels of all states into {cells} different cells (expected at most {most}; fewer samples \
         for each pixel, or fewer states of the display)"
    )]
    TooManyCells {
        /// Samples along each side of a pixel.
        per_pixel: usize,
        /// Different cells.
        cells: usize,
        /// The limit.
        most: usize,
    },
    /// A display or light whose places are not computed.
    #[error(
        "the places of light are not computed yet for {what} (see `{key}`; expected mirror-like pixels below a diffuser or a flat face, or \
         Lambertian pixels below a flat face)"
    )]
    PlacesNotComputed {
        /// The layer or light.
        what: String,
        /// Its key.
        key: String,
    },
    /// A length that is too small for places of light.
    #[error(
        "a length of {length_mm:e} mm above the pixels is too small for the places of light (expected 0 or at least {least_mm:e} mm; see \
         `display.glass.thickness_mm` and the other lengths of the layers)"
    )]
    TooThin {
        /// The length, mm.
        length_mm: f64,
        /// The smallest one, mm.
        least_mm: f64,
    },
    /// Layers that are so thick that light spreads over too many pixels.
    #[error(
        "the layers above the pixels are {thickness_mm} mm thick: crosstalk and pictures are computed up to {most} times the pitch of the \
         pixels, {pitch_mm} mm (expected at most {} mm, see `display.glass.thickness_mm` and `display.matrix`)",
        most * pitch_mm
    )]
    TooThick {
        /// Thickness of the layers, mm.
        thickness_mm: f64,
        /// The smaller pitch, mm.
        pitch_mm: f64,
        /// Largest thickness over pitch.
        most: f64,
    },
    /// A display whose places only paths compute.
    #[error(
        "the adding solver does not compute the places of light for {what} (see `{key}`; set `solver.method = \"monte-carlo\"`, with which \
         `papilio run`, `papilio mtf` and `papilio crosstalk` compute any layers)"
    )]
    PlacesByPaths {
        /// The layers.
        what: String,
        /// Their key.
        key: String,
    },
    /// A length that the places of light depend on.
    #[error(
        "the key `{key}` is missing{}: the places of light depend on the thickness of each layer that light crosses obliquely between the \
         pixel and the highest layer that scatters or reflects it (expected a length in mm)",
        others.iter().map(|other| format!(", and `{other}`")).collect::<String>()
    )]
    MissingLength {
        /// Path of the key: that of the lowest layer.
        key: String,
        /// Paths of the other missing keys.
        others: Vec<String>,
    },
    /// A command that needs the places of sub-pixels.
    #[error(
        "`papilio {command}` needs the places of the sub-pixels: [display.matrix] is missing (expected ppi or pitch_um, and a layout)"
    )]
    NoMatrix {
        /// The command.
        command: &'static str,
    },
    /// A halftone for a reader's eye without the size of the pixels.
    #[error(
        "`image.halftone = \"direct-binary-search\"` needs the angle at which the reader sees a pixel: [display.matrix] is missing (expected \
         ppi or pitch_um)"
    )]
    NoPixelPitch,
    /// Sparkle that cannot be estimated.
    #[error("sparkle cannot be estimated: {0}")]
    Sparkle(#[from] SparkleError),
    /// Sparkle in the light of a collimated source.
    #[error(
        "directed source {number} has no radius_deg: the sparkle of a lamp depends on its size (expected radius_deg of the lamp as seen from \
         the display, for example 0.27 of the sun, 2 of a ceiling lamp)"
    )]
    SparkleOfPoint {
        /// Number of the source, from 0.
        number: usize,
    },
    /// Sparkle of a face above another layer that scatters.
    #[error(
        "layer {number} from the top, below the antiglare face, scatters light: the rays of sparkle pass clear layers between face and pixels \
         (expected media, flat interfaces and coatings below the face)"
    )]
    SparkleAboveScatterer {
        /// Number of the layer, from 1.
        number: usize,
    },
    /// An angle scan of a scattering pixel, whose reflectance is not a function of angle and wavelength
    /// alone.
    #[error(
        "a pixel given by its BRDF scatters light into all directions: it has no table of reflectance by angle; \
         `papilio diffuser inspect` shows its file, and `papilio brdf` computes the BRDF of the whole display"
    )]
    ScanOfScattering,
    /// The absorption in the layers of a pixel that is not a film.
    #[error(
        "this pixel has no film whose layers absorb: its reflectance is given, not computed; the absorptance of each layer \
         needs a pixel with `model = \"film\"`"
    )]
    AbsorptionWithoutFilm,
    /// A reference direction beyond the measured ones.
    #[error(
        "the reference direction, {theta_deg} deg, is beyond the directions in which the diffuser was measured: the colour there \
         is not known"
    )]
    UnknownReference {
        /// Inclination, degrees.
        theta_deg: f64,
    },
    /// The worker threads could not be started.
    #[error("{threads} worker threads could not be started")]
    Threads {
        /// Requested number of threads.
        threads: usize,
    },
    /// A result that is not finite: a value of the scene is far outside the range of real displays.
    #[error("a result is not a finite number: a value in the scenario is far too small or far too large")]
    NotFinite,
    /// A scatterer whose lobe is too narrow for adding to resolve within general layers.
    #[error(
        "{what} (scatterer {number} from the top) is too narrow for adding within these layers: \
         it needs {nodes} directions, and adding computes at most {most} (its work grows faster than their cube); use the Monte Carlo solver \
         (solver.method = \"monte-carlo\")"
    )]
    TooNarrow {
        /// The layer: its kind and the parameter that makes it narrow.
        what: String,
        /// Number of the scatterer, counted from the top, from 1.
        number: usize,
        /// Number of radial nodes that two levels need.
        nodes: usize,
        /// Largest number of nodes that is attempted.
        most: usize,
    },
    /// A lobe of an ordinary panel that is too narrow for adding in some light.
    #[error(
        "the diffuser of width {width:.1e} (`width` or `haze` of display.diffuser) is too narrow for adding in light that {light} (expected a width of at \
         least {least}): it would take hours; use the Monte Carlo solver (solver.method = \"monte-carlo\")"
    )]
    TooNarrowInField {
        /// Width of the lobe.
        width: f64,
        /// The smallest width.
        least: f64,
        /// What the light does.
        light: &'static str,
    },
    /// Rows of a table with an error above the limit.
    #[error(
        "{count} of {of} rows of the {table} have a relative error of Y above {most:.1e}; the worst are: {named}{more}\n  \
         = help: with an allowed error of {enough} the table is written, with the error of each row; the Monte Carlo \
         solver (solver.method = \"monte-carlo\") computes single views without this error"
    )]
    RowsTooUncertain {
        /// Name of the table.
        table: &'static str,
        /// Number of rows above the limit.
        count: usize,
        /// Number of all rows.
        of: usize,
        /// The limit of the relative error.
        most: f64,
        /// The worst rows, with their errors.
        named: String,
        /// "; ..." if more rows are above the limit than are named, or empty.
        more: &'static str,
        /// Limit that all rows would meet.
        enough: f64,
    },
    /// A number of paths as the stopping criterion of adding.
    #[error("adding does not trace paths: its stopping criterion must be a relative error")]
    NoPaths,
    /// Designs of a display whose pixel is not a film pixel.
    #[error("designs require a film pixel, but this display has another kind of pixel")]
    NotAFilm,
    /// Designs of a scene that is not solved by adding to a relative error.
    #[error(
        "designs are computed by adding to a relative error, but the scene specifies another method or stopping criterion"
    )]
    NotByAdding,
    /// A design whose states differ from those of the prepared display.
    #[error("the states of a design must be those of the prepared display, in the same order")]
    OtherStates,
    /// A quantity of a view or state that does not exist.
    #[error("there is no {what} for the quantity `{quantity}`")]
    NoSuchQuantity {
        /// The missing view or state.
        what: String,
        /// Name of the quantity.
        quantity: &'static str,
    },
    /// A computation for one view of a scene that has several.
    #[error("{what} is computed for one view, and there are {views}")]
    OneView {
        /// What is computed.
        what: &'static str,
        /// Number of views.
        views: usize,
    },
    /// A picture whose size is not that of the display.
    #[error("the picture has {} x {} pixels, the display {} x {}", picture[0], picture[1], display[0], display[1])]
    PictureSize {
        /// Columns and rows of the picture.
        picture: [usize; 2],
        /// Columns and rows of the display.
        display: [usize; 2],
    },
    /// States of pixels that do not belong to the picture or the display.
    #[error(
        "{pixels} states up to number {highest} are given (expected one for each of {expected} pixels, below {states})"
    )]
    GivenStates {
        /// Number of given states.
        pixels: usize,
        /// Number of pixels.
        expected: usize,
        /// Largest number of a state.
        highest: usize,
        /// Number of states of the display.
        states: usize,
    },
    /// Regions of a picture that has another number of pixels.
    #[error("regions of {pixels} pixels are given (expected one for each of {expected})")]
    Regions {
        /// Number of given pixels.
        pixels: usize,
        /// Number of pixels of the picture.
        expected: usize,
    },
    /// A picture that is to be held by a panel without a halftone.
    #[error("a panel holds states, which a picture without a halftone does not have")]
    NoHalftone,
    /// A picture that cannot be halftoned.
    #[error(transparent)]
    Imaging(#[from] papilio_imaging::ImagingError),
    /// A light without luminance or chromaticity.
    #[error("the light has no white: {what} is not defined")]
    NoWhite {
        /// What is computed.
        what: &'static str,
    },
    /// A darkest or lightest state with a colour, where neutral colours shall have black and white only.
    #[error(
        "neutral colours cannot be shown by black and white only: the darkest or lightest state, `{state}`, is coloured; use a black and a white, or image.neutrals = \"all\""
    )]
    NoNeutral {
        /// Name of the state.
        state: String,
    },
    /// A derivative with respect to a parameter that the film does not have.
    #[error("the film has no {what} number {number}")]
    NoSuchParameter {
        /// Kind of parameter: a layer of fixed thickness, a sub-pixel, ...
        what: &'static str,
        /// Number of the parameter, from 0.
        number: usize,
    },
    /// The run was stopped before its first estimate.
    #[error("stopped before the first estimate")]
    Interrupted,
}

impl DisplayError {
    /// Converts the error of a coating whose key is `key`.
    pub(crate) fn of_coating(error: OpticsError, key: &str) -> Self {
        match error {
            OpticsError::Fringes { layer, thickness_nm, fringes, nm } => {
                let key = format!("{key}.film.{layer}.thickness_nm");
                Self::Fringes {
                    key,
                    thickness_nm,
                    fringes,
                    nm,
                    most_panels: papilio_optics::film::Coating::MOST_PANELS,
                }
            }
            error => error.into(),
        }
    }
}
