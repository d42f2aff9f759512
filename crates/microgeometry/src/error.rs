//! What can be wrong with a surface or its measurement.

/// What can be wrong with a surface or its measurement.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MicrogeometryError {
    /// A map has the wrong number of heights.
    #[error("a height map of {columns} x {rows} has {heights} heights")]
    NumberOfHeights {
        /// Columns of the map.
        columns: usize,
        /// Rows of the map.
        rows: usize,
        /// Heights that were given.
        heights: usize,
    },
    /// A number is not finite, or not positive.
    #[error("the {what} of {of} is {value} (expected a {wanted} number)")]
    NotANumber {
        /// The thing.
        of: &'static str,
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// "finite" or "positive".
        wanted: &'static str,
    },
    /// Heights differ too much for rays.
    #[error(
        "the heights of the map are between {low_um} and {high_um} um, {:.0} times the distance of {pitch_um} um between them (expected at most \
         {most}): rays would cross the map many times before they meet it",
        (high_um - low_um) / pitch_um
    )]
    Relief {
        /// Lowest height, um.
        low_um: f64,
        /// Highest height, um.
        high_um: f64,
        /// Smaller distance between heights, um.
        pitch_um: f64,
        /// The limit.
        most: f64,
    },
    /// A cap would be more than a hemisphere.
    #[error(
        "the aperture radius of a cap, {aperture_um} um, is beyond the radius of its ball, {radius_um} um (expected at most a hemisphere)"
    )]
    ApertureBeyondRadius {
        /// Radius of the rim, um.
        aperture_um: f64,
        /// Radius of the ball, um.
        radius_um: f64,
    },
    /// A cap is so flat that rounding errors of its ball hide it.
    #[error(
        "caps with an aperture radius of {aperture_um} um are flat at a radius of {radius_um} um (`radius_um`; expected at most {most_um:.3e} um)"
    )]
    FlatCaps {
        /// Radius of the rim, um.
        aperture_um: f64,
        /// Radius of the ball, um.
        radius_um: f64,
        /// Largest radius of the ball, um.
        most_um: f64,
    },
    /// Neighbours in a lattice overlap.
    #[error(
        "caps with an aperture radius of {aperture_um} um overlap at a pitch of {pitch_um} um (expected a pitch of at least {}; only random places may overlap)",
        2.0 * aperture_um
    )]
    CapsOverlap {
        /// Radius of the rims, um.
        aperture_um: f64,
        /// Distance of neighbours, um.
        pitch_um: f64,
    },
    /// A random face is described by too few numbers, or by some that contradict each other.
    #[error("{wrong}")]
    RandomFace {
        /// What is wrong, what was expected, and a hint.
        wrong: String,
    },
    /// Films that cannot be computed.
    #[error("the films on the surface cannot be computed: {wrong}")]
    Coating {
        /// What is wrong.
        wrong: String,
    },
    /// Triangles that form no surface.
    #[error("{wrong}")]
    Mesh {
        /// What is wrong, where, and what was expected.
        wrong: String,
    },
    /// Particles that cannot be placed.
    #[error("{wrong}")]
    Volume {
        /// What is wrong, what was expected, and a hint.
        wrong: String,
    },
    /// A surface without heights is asked for them.
    #[error("{surface} has no heights, which waves need (expected `road = \"rays\"`)")]
    NoHeights {
        /// "a mesh" or "a volume".
        surface: &'static str,
    },
    /// Rays were lost.
    #[error(
        "{lost} of {rays} rays were lost in the surface (expected none): its facets may be narrower than numbers can resolve"
    )]
    LostRays {
        /// Lost ones.
        lost: u64,
        /// All.
        rays: u64,
    },
    /// The kernel contradicts a law beyond its errors.
    #[error(
        "the kernel of the surface contradicts {law}: root mean square of {z_rms:.2} standard errors over {count} tests (expected at most {most})"
    )]
    Law {
        /// "reciprocity" or "the conservation of energy".
        law: &'static str,
        /// Root mean square of the z-scores.
        z_rms: f64,
        /// Number of z-scores.
        count: usize,
        /// The limit.
        most: f64,
    },
    /// A kernel by azimuth cannot have these azimuths.
    #[error(
        "a kernel of {bands} bands cannot have {azimuths} azimuths in a turn (expected an even number, and at most {most} patches of directions): \
         the finest whole step is {finest} deg",
        most = crate::patches::MOST_PATCHES
    )]
    Azimuths {
        /// Azimuths that were asked for.
        azimuths: usize,
        /// Bands on both sides.
        bands: usize,
        /// The smallest step that is possible, whole degrees.
        finest: usize,
    },
    /// A kernel by azimuth cannot be balanced.
    #[error(
        "the kernel by azimuth cannot be balanced: {:.2} % of the light of a patch of directions is missing (expected none): more `rays`, or wider \
         steps of azimuth",
        100.0 * missing
    )]
    Unbalanced {
        /// The largest fraction of the light of a patch that is missing.
        missing: f64,
    },
    /// A surface has too many heights for a phase screen.
    #[error(
        "a phase screen of {columns} x {rows} heights is too large (expected at most {most} heights): a smaller part of the map, or \
         `road = \"rays\"`"
    )]
    NoScreen {
        /// Heights along x.
        columns: usize,
        /// Heights along y.
        rows: usize,
        /// The limit.
        most: usize,
    },
    /// A list of the kernel of a face has the wrong length.
    #[error(
        "`{name}` of the kernel of a face has {found} numbers (expected {expected}, as many as its bands have)"
    )]
    FaceLength {
        /// Name of the list.
        name: &'static str,
        /// Its length.
        found: usize,
        /// The length that the indices ask for.
        expected: usize,
    },
    /// A kernel loses or gains light.
    #[error(
        "light of band {band} of the kernel of a face adds up to {sum} (expected 1 within 1e-6: scattered and regular light, without losses)"
    )]
    FaceLoses {
        /// Number of the band, from 0.
        band: usize,
        /// Sum of what leaves.
        sum: f64,
    },
    /// A kernel treats the two ways of light between bands differently.
    #[error(
        "the kernel of a face is not reciprocal: between bands {from} and {to} goes {there} of the light one way, and {back} the other"
    )]
    FaceOneWay {
        /// Number of a band, from 0.
        from: usize,
        /// Number of the other.
        to: usize,
        /// Light from one to the other, per étendue of all.
        there: f64,
        /// Light back.
        back: f64,
    },
    /// The measurement was stopped.
    #[error("interrupted")]
    Interrupted,
}
