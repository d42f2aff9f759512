//! What can be wrong with a scenario; `advice` says what to do about it.

mod plan;

use papilio_spectra::SpectraError;

pub use plan::PlanProblem;

/// What can be wrong with a scenario.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Not TOML.
    #[error("{message}")]
    Syntax {
        /// The parser's words.
        message: String,
    },
    /// A word or something else where a value should be.
    #[error("this is not a value")]
    NotAValue,
    /// A number with its unit, or a percent sign.
    #[error("this number has `{0}` behind it")]
    NumberWithUnit(String),
    /// A number with a decimal comma.
    #[error("this number has a comma")]
    DecimalComma,
    /// No line of it looks like TOML.
    #[error("this does not look like a scenario (TOML)")]
    NotAScenario,
    /// A key that the table does not have.
    #[error("there is no key `{key}` here")]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys that the table has.
        known: Vec<&'static str>,
    },
    /// Something that Papilio means to have, and this version does not.
    #[error("`{what}` is not in this version")]
    NotInThisVersion {
        /// The key or value.
        what: String,
        /// What there is instead.
        choices: Vec<String>,
    },
    /// A key that must be there.
    #[error("the key `{key}` is missing")]
    MissingKey {
        /// The key.
        key: String,
        /// Its value in words.
        expected: String,
    },
    /// A value of the wrong kind.
    #[error("this is {found}")]
    WrongType {
        /// The right kind, in words.
        expected: String,
        /// What stands there, in words.
        found: &'static str,
    },
    /// A number outside its range.
    #[error("{} is out of range", written(*.value))]
    OutOfRange {
        /// The number.
        value: f64,
        /// The range, in words.
        expected: &'static str,
    },
    /// A number that does not count what it should.
    #[error("{value} is {}", if value.fract() == 0.0 { "out of range" } else { "no whole number" })]
    NoSuchCount {
        /// The number.
        value: f64,
        /// The range, in words.
        expected: String,
    },
    /// A word that is none of the choices.
    #[error("`{found}` is not a choice here")]
    UnknownChoice {
        /// The word.
        found: String,
        /// The choices.
        choices: Vec<String>,
    },
    /// A material or light that is neither a name nor a file.
    #[error("there is no {kind} named `{name}`, nor a file")]
    UnknownName {
        /// "material" or "light".
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        names: Vec<&'static str>,
    },
    /// A state asks for a sub-pixel that the pixel does not have, or the like.
    #[error("there is no sub-pixel `{name}` in `{of}`")]
    NoSubPixel {
        /// The sub-pixel.
        name: String,
        /// Where it was looked for.
        of: &'static str,
        /// The sub-pixels there.
        known: Vec<String>,
    },
    /// Something is said of a state that the pixel does not have.
    #[error("there is no state `{name}`")]
    NoSuchState {
        /// The state.
        name: String,
        /// The states that there are.
        known: Vec<String>,
    },
    /// `dark` is not a sub-pixel.
    #[error("`dark` is not a sub-pixel: it has no area and is not driven")]
    DarkIsNoSubPixel,
    /// A state leaves a sub-pixel dark, and no dark gap is given.
    #[error("state `{state}` leaves `{sub_pixel}` dark, but there is no dark gap")]
    NoDarkGap {
        /// The state.
        state: String,
        /// The sub-pixel.
        sub_pixel: String,
    },
    /// A gap beside the sub-pixels of a state, not under one.
    #[error("`gap_nm` is given for a whole state")]
    GapOfAState,
    /// The pixel has no sub-pixels.
    #[error("this pixel has no sub-pixels")]
    NoSubPixels,
    /// The pixel has no states.
    #[error("this pixel has no states")]
    NoStates {
        /// How to give it one.
        remedy: &'static str,
    },
    /// Control characters in a text that is shown.
    #[error("this text has control characters")]
    ControlCharacters,
    /// Of several keys exactly one must be there.
    #[error("{} of {keys} is given", if *.given == 0 { "none" } else { "more than one" })]
    ExactlyOne {
        /// The keys.
        keys: &'static str,
        /// How many are given.
        given: usize,
    },
    /// A key that has no place beside another.
    #[error("`{key}` means nothing with {beside}")]
    NotWith {
        /// The key.
        key: &'static str,
        /// The other.
        beside: &'static str,
    },
    /// A key that tables of another kind have.
    #[error("`{key}` means nothing with {kind}")]
    OfAnotherKind {
        /// The key.
        key: String,
        /// The kind of this table, as it is written.
        kind: &'static str,
        /// The kinds that have the key.
        of: Vec<&'static str>,
    },
    /// A key of the ordinary panel beside `layers`.
    #[error("`{key}` stands beside `layers`, which says all that is over the pixel")]
    BesideLayers {
        /// `front`, `diffuser` or `glass`.
        key: &'static str,
        /// The layer that would be the same.
        layer: &'static str,
    },
    /// Something that only the ordinary panel can have.
    #[error("{what} is for the ordinary panel alone")]
    NeedsPanel {
        /// The key and its value.
        what: &'static str,
        /// The value that every display can have.
        instead: &'static str,
    },
    /// A scenario for a later version of this program.
    #[error("this scenario is of format {found}, which this version does not know")]
    NewerFormat {
        /// Its number.
        found: i64,
    },
    /// Two names of one key.
    #[error("`{old}` and `{new}` are two names of one key")]
    BothNames {
        /// The name that was found first, or the old one.
        old: String,
        /// The other.
        new: String,
    },
    /// A sheet between media of different index: which of them it is in makes a difference.
    #[error("this sheet lies between media of different index")]
    SheetAtFace,
    /// A rough face without a step of the index.
    #[error("the media on both sides of this face have the same index")]
    NoFace,
    /// A rough face beside a medium of dispersive index.
    #[error("a medium beside this face has an index of {} to {}", tidy(*.least), tidy(*.largest))]
    DispersiveFace {
        /// Smallest index.
        least: f64,
        /// Largest index.
        largest: f64,
    },
    /// A pixel that scatters, under a medium of dispersive index.
    #[error("the medium over this pixel has an index of {} to {}", tidy(*.least), tidy(*.largest))]
    DispersivePixel {
        /// Smallest index.
        least: f64,
        /// Largest index.
        largest: f64,
    },
    /// A slab whose index depends on wavelength, or absorbs.
    #[error("this index is {} to {}, with k up to {k}", tidy(*.least), tidy(*.largest))]
    SlabIndex {
        /// Smallest n.
        least: f64,
        /// Largest n.
        largest: f64,
        /// Largest k.
        k: f64,
    },
    /// A slab in which a walk takes for ever.
    #[error("a walk through an optical thickness of {optical_thickness} takes hours")]
    TooThickToWalk {
        /// Its optical thickness.
        optical_thickness: f64,
        /// The largest that is walked.
        limit: f64,
    },
    /// A film whose interference fringes over angle are too many to tabulate.
    #[error(
        "this layer of {thickness_nm} nm makes {fringes} interference fringes over angle at {nm} nm, more than are tabulated"
    )]
    TooManyFringes {
        /// Thickness of the layer that makes the most.
        thickness_nm: f64,
        /// Their number, from the normal to the horizon in the layer.
        fringes: f64,
        /// The wavelength.
        nm: f64,
        /// How thick films may be.
        most_mm: f64,
    },
    /// Shares that should make a whole and do not.
    #[error("{what} sum to {}", tidy(*.sum))]
    Sum {
        /// The shares.
        what: &'static str,
        /// Their sum.
        sum: f64,
        /// What the sum should be, in words.
        expected: &'static str,
    },
    /// The shares of the light do not make a whole.
    #[error("the shares of the light sum to {}", tidy(*.sum))]
    LightShares {
        /// Their sum.
        sum: f64,
        /// The key that could make it 1.
        remedy: String,
        /// The value that it would need.
        value: f64,
    },
    /// Too many of something for one computation.
    #[error("these are {count} {what}")]
    TooMany {
        /// The things.
        what: &'static str,
        /// How many.
        count: f64,
        /// How many there may be.
        limit: usize,
    },
    /// An item that its list has already.
    #[error("{value} is in this list twice")]
    Twice {
        /// The item.
        value: f64,
    },
    /// A list without items.
    #[error("this list is empty")]
    EmptyList,
    /// A range that ends before it begins.
    #[error("a range from {from} to {to} in steps of {step} has no end")]
    Range {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Step.
        step: f64,
    },
    /// A range that its step does not follow.
    #[error("steps of {step} do not lead from {from} to {to}")]
    StepLeadsAway {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Step.
        step: f64,
    },
    /// A file that is not among those that there are.
    #[error("there is no file `{name}` here")]
    NoSuchFile {
        /// What was asked for.
        name: String,
        /// The files that there are.
        known: Vec<String>,
    },
    /// A metric that no result has.
    #[error("there is no metric `{name}`")]
    NoSuchMetric {
        /// What was asked for.
        name: String,
        /// The metrics that there are.
        known: Vec<String>,
    },
    /// No k-correlation lobe has this haze.
    #[error("no lobe has a haze of {haze} with a straight-through share of {straight_through}")]
    NoWidth {
        /// The haze.
        haze: f64,
        /// The unscattered share.
        straight_through: f64,
        /// The largest haze beside it.
        limit: f64,
    },
    /// The lobe would transmit more than it receives.
    #[error("this makes the transmittance of the whole lobe {lobe:.4}")]
    LobeAboveOne {
        /// T of the whole lobe.
        lobe: f64,
        /// The largest total transmittance of this lobe.
        limit: f64,
    },
    /// A face where a diffuser's own faces stand.
    #[error("{0}")]
    SurfaceUnderDiffuser(&'static str),
    /// An index that no transparent medium has.
    #[error("this index is {n} + {k}i at {nm} nm")]
    NoGlass {
        /// n.
        n: f64,
        /// k.
        k: f64,
        /// Wavelength.
        nm: f64,
        /// The largest k that such a medium may have.
        largest_k: f64,
    },
    /// An index that no film has.
    #[error("this index is {n} + {k}i at {nm} nm")]
    NoFilm {
        /// n.
        n: f64,
        /// k.
        k: f64,
        /// Wavelength.
        nm: f64,
    },
    /// Angles in glass of a panel that they make no sense for.
    #[error("angles in glass need {0}")]
    AnglesInGlass(&'static str),
    /// A direction in glass that never leaves the glass.
    #[error("light at {theta_deg} deg in this glass never leaves it")]
    Trapped {
        /// The angle.
        theta_deg: f64,
        /// The largest angle that leaves.
        limit_deg: f64,
    },
    /// A cone that dips below the horizon of the display.
    #[error("this {what} reaches {} deg from the normal", (.theta_deg * 100.0).round() / 100.0)]
    BelowHorizon {
        /// "cone" or "luminaire".
        what: &'static str,
        /// Its largest inclination.
        theta_deg: f64,
    },
    /// A ring or cap that is not a part of the hemisphere.
    #[error("this {what} reaches from {} to {} deg", tidy(*.from_deg), tidy(*.to_deg))]
    RingEdges {
        /// "ring" or "cap".
        what: &'static str,
        /// Where it begins.
        from_deg: f64,
        /// Where it ends.
        to_deg: f64,
    },
    /// A sun that the display cannot see.
    #[error("the sun stands {theta_deg:.2} deg from the display's normal")]
    SunBehindDisplay {
        /// Its inclination in the display's frame.
        theta_deg: f64,
    },
    /// A front light's distribution over something else than a lobe.
    #[error("a distribution of the front light needs a panel whose diffuser is a lobe")]
    NoLobeBelow,
    /// An illuminance by a map, of which there has to be one, with a share of the light.
    #[error("{}", if *.maps == 1 { "the map has no share of the light".to_owned() } else { format!("there are {maps} maps that could say how many lx") })]
    NotOneMap {
        /// How many there are.
        maps: usize,
    },
    /// An environment without light over the display.
    #[error("none of this light falls on the display")]
    DarkField,
    /// A film without, or with several, gap layers.
    #[error("{found} layers of this film are the gap")]
    GapLayers {
        /// How many.
        found: usize,
    },
    /// A data file or model that does not cover the wavelengths.
    #[error("`{what}` reaches from {first} to {last} nm")]
    NotCovered {
        /// The file or name.
        what: String,
        /// First wavelength.
        first: f64,
        /// Last wavelength.
        last: f64,
        /// The wavelengths that are needed.
        needed_nm: (f64, f64),
    },
    /// A pixel table that does not reach as far as the light does.
    #[error("the angles of this table end at {last_deg} deg in {medium}")]
    TableTooShort {
        /// Its last angle.
        last_deg: f64,
        /// "air" or "glass".
        medium: &'static str,
        /// How far the light in the stack goes.
        needed_deg: f64,
    },
    /// A table in air angles under a stack that holds trapped light.
    #[error("angles in air do not reach the light beyond total internal reflection")]
    TableInAir,
    /// A light without light.
    #[error("this light is dark between {} and {} nm", .range_nm.0, .range_nm.1)]
    NoLight {
        /// The wavelengths looked at.
        range_nm: (f64, f64),
    },
    /// Wavelengths that no eye sees.
    #[error("nothing between {} and {} nm is visible", .range_nm.0, .range_nm.1)]
    Invisible {
        /// The wavelengths.
        range_nm: (f64, f64),
    },
    /// A `--set` without `=`.
    #[error("this is not PATH=VALUE")]
    SetWithoutValue,
    /// A `--set` path that leads nowhere.
    #[error("{why}")]
    SetPath {
        /// Why.
        why: String,
    },
    /// A file of measured scattering without the light that is asked for.
    #[error("this file has no {wanted}")]
    NoSuchWay {
        /// The way of light.
        wanted: &'static str,
        /// Those that it has.
        found: String,
    },
    /// A measurement that gives back more than it takes.
    #[error("{way}: {total:.3} times as much light leaves as came")]
    MoreThanAll {
        /// The way of light.
        way: &'static str,
        /// The largest total.
        total: f64,
    },
    /// A diffuser that an instrument cannot be put before.
    #[error("a slab has no BTDF of its own that an instrument could see")]
    NoBtdf,
    /// A spectrum that colours a measurement and holds nothing.
    #[error("a transmission or reflectance of 0 throughout colours nothing")]
    DarkShare,
    /// A measurement that cannot be used.
    #[error("{0}")]
    Measurement(#[from] papilio_goniometry::GoniometryError),
    /// What is asked of a scenario besides: a sweep, a search, a tolerance analysis.
    #[error(transparent)]
    Plan(#[from] PlanProblem),
    /// Something about spectral data.
    #[error(transparent)]
    Spectra(#[from] SpectraError),
    /// A data file that cannot be used, the scenario file itself included.
    #[error(transparent)]
    Data(#[from] papilio_formats::Problem),
}

impl Problem {
    /// Whether the path of a key is wrong, not what stands there.
    pub fn is_of_a_path(&self) -> bool {
        matches!(
            self,
            Self::UnknownKey { .. }
                | Self::NotInThisVersion { .. }
                | Self::OfAnotherKind { .. }
                | Self::SetPath { .. }
                | Self::NoSubPixel { .. }
        )
    }
}

/// The k of a clear medium: at most this.
pub(crate) const CLEAR_K: f64 = 1e-6;
/// And of one that absorbs along a path that is given; beyond it Fresnel's real index is not enough.
pub(crate) const ABSORBING_K: f64 = 1e-3;

/// A number as a reader writes it: without the digits that are rounding, and with an exponent where it is very large or small.
fn written(value: f64) -> String {
    let short: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    if short == 0.0 || (1e-6..1e16).contains(&short.abs()) || !short.is_finite() {
        short.to_string()
    } else {
        format!("{short:e}")
    }
}

/// A sum of decimal fractions as a reader writes it: to a millionth.
pub(crate) fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
