//! `[microgeometry]`: the geometry of a surface, for `papilio gonio`. Its files are not scenarios: they have
//! a title and this table.

use super::Title;
use super::display::MaterialSpec;
use super::layers::CoatingFilm;
use super::numbers::{
    AzimuthStep, Count, Inclination, InnerShare, RmsHeight, Seed, Share, SurfaceIndex, SurfaceLength,
    Wavelength,
};
use crate::grammar::{choice, forms, kinds, table};
use crate::read::Spanned;

table! {
    /// A surface, for `papilio gonio`.
    SurfaceFile {
        /// Title of tables and figures.
        title: Option<Title>,
        /// The geometry of the surface, its media, and how it is measured.
        microgeometry: Microgeometry,
    }
}

kinds! {
    /// The geometry of a surface.
    Microgeometry by "surface" {
        /// A flat face.
        Flat(Flat) = "flat",
        /// Spherical caps on a flat face.
        Caps(Caps) = "caps",
        /// Heights of a file.
        HeightMap(HeightMap) = "height-map",
        /// A random face with Gaussian correlation.
        Gaussian(Gaussian) = "gaussian",
        /// A random face with exponential correlation.
        Exponential(Exponential) = "exponential",
        /// A random face with a given power spectral density.
        Psd(Psd) = "psd",
        /// Triangles of a file, which may overhang.
        Mesh(Mesh) = "mesh",
        /// Spheres or fibres in a slab.
        Volume(Volume) = "volume",
    }
}

/// Declares the table of a kind of surface: its own keys, and those that all kinds have.
macro_rules! surface {
    ($(#[doc = $doc:literal])* $name:ident { $($own:tt)* }) => {
        table! {
            $(#[doc = $doc])*
            $name {
                $($own)*
                /// Refractive index of the medium above, towards which heights count.
                index_above as "Index above": SurfaceIndex = SurfaceIndex(1.0),
                /// Refractive index of the medium below.
                index_below as "Index below": SurfaceIndex = SurfaceIndex(1.5),
                /// What lies on every facet. Default: nothing.
                coating: Option<FaceCoating>,
                /// Inclinations of the light, in its own medium. Default: 0 to 85 deg in steps of 5 deg.
                incidence_deg as "Inclination of the light": Vec<Spanned<Inclination>> = Vec::new(),
                /// Steps of azimuth by which rays are also sorted, a divisor of 180 deg.
                /// Default: the surface is turned about its normal.
                azimuth_deg as "Steps of azimuth": Option<AzimuthStep>,
                /// Solver.
                road as "Road": Road = Road::Rays,
                /// Wavelengths of waves. Default: 400 to 700 nm in steps of 50 nm.
                wavelength_nm as "Wavelengths of waves": Vec<Spanned<Wavelength>> = Vec::new(),
                /// Rays from each side at each inclination.
                rays as "Rays": Count<64, { 1 << 36 }> = Count(200_000),
                /// Seed of rays and random surfaces.
                seed: Seed = Count(0),
            }
        }
    };
}

surface! {
    /// A flat face.
    Flat {}
}

surface! {
    /// Spherical caps on a flat face: bumps of the medium below.
    Caps {
        /// Distance of neighbours; for random places, the side of the square with one cap on average.
        pitch_um: SurfaceLength,
        /// Radius of the balls of which the caps are parts.
        radius_um: SurfaceLength,
        /// Radius of the rim of a cap, up to `radius_um`: a hemisphere.
        aperture_radius_um: SurfaceLength,
        /// Where the caps stand.
        lattice: CapLattice = CapLattice::Square,
    }
}

surface! {
    /// Heights of a file, which repeat in both directions.
    HeightMap {
        /// The heights: of a profilometer (SDF, X3P, .sur, .gsf, .opd, .plux, .vk4, .vk6), a text of rows or
        /// points, .npy, OpenEXR, a grey PNG or TIFF.
        file: String,
        /// Distance of heights, one number or along x and y. Default: that of the file.
        pixel_um: Option<HeightDistance>,
        /// Height of the number 1 of the file. Default: the unit of the file; 1 um for .npy and .csv.
        height_um_per_unit: Option<SurfaceLength>,
        /// Whether the mean plane is subtracted (`"repeat"`: the mean, and a tilt that makes a step where periods
        /// meet).
        level: bool = true,
        /// How the map repeats.
        period: MapPeriod = MapPeriod::Mirror,
        /// Cut-off of a Gaussian filter (ISO 16610) that removes shorter waves, as noise: half of a wave of
        /// this length remains.
        cutoff_um: Option<SurfaceLength>,
        /// Cut-off of a Gaussian filter that removes longer waves, as the form of the sample.
        longest_um: Option<SurfaceLength>,
    }
}

forms! {
    /// The distance of neighbouring heights: a number, or `[x, y]`.
    HeightDistance, format!("{}, or a list of two, along x and y", <SurfaceLength as crate::read::Read>::in_words()); {
        /// The same along x and y.
        Square(SurfaceLength) if Value::Integer(_) | Value::Float(_),
        /// Along x and y.
        Oblong(Vec<Spanned<SurfaceLength>>) if Value::Array(_),
    }
}

surface! {
    /// A random face whose heights have the correlation exp(-r^2/tau^2).
    Gaussian {
        /// Root mean square height.
        rms_nm: RmsHeight,
        /// Distance at which the correlation is 1/e.
        correlation_um: SurfaceLength,
    }
}

surface! {
    /// A random face whose heights have the correlation exp(-r/tau).
    Exponential {
        /// Root mean square height, before the cut-off.
        rms_nm: RmsHeight,
        /// Distance at which the correlation is 1/e.
        correlation_um: SurfaceLength,
        /// Shortest wavelength of the face, without which its slopes have no limit.
        cutoff_um: SurfaceLength,
    }
}

surface! {
    /// A random face with the two-dimensional power spectral density A (1 + (B f)^2)^(-C/2), f in cycles per
    /// um, or with that of a file.
    Psd {
        /// A (um^4), B (um) and C; or `file`.
        abc: Option<Vec<Spanned<SurfaceLength>>>,
        /// A table of two columns: frequency in cycles per um, and density in um^4, as `psd.csv` of `papilio
        /// gonio`.
        file: Option<String>,
        /// Shortest wavelength of the face, without which its slopes have no limit.
        cutoff_um: SurfaceLength,
    }
}

surface! {
    /// Triangles of a file, which repeat in both directions. They form one closed surface between the media,
    /// and may overhang.
    Mesh {
        /// Wavefront OBJ, or STL in text or binary.
        file: String,
        /// Length of the number 1 of the file.
        um_per_unit: SurfaceLength = SurfaceLength(1.0),
        /// Period along x and y. Default: the extent of the mesh.
        period_um: Option<Vec<Spanned<SurfaceLength>>>,
    }
}

table! {
    /// Spheres or fibres at random places in a slab of a clear matrix, which is also the medium above and
    /// below.
    Volume {
        /// Radius of the spheres or fibres.
        radius_um: SurfaceLength,
        /// Length of a fibre without its hemispherical ends. Default: spheres.
        length_um: Option<SurfaceLength>,
        /// Refractive index of the particles; 1 for voids.
        index as "Index of the particles": SurfaceIndex,
        /// Fraction of the slab that the particles fill.
        volume_fraction: InnerShare,
        /// Thickness of the slab.
        thickness_um: SurfaceLength,
        /// Refractive index of the matrix.
        matrix_index as "Index of the matrix": SurfaceIndex = SurfaceIndex(1.5),
        /// Inclinations of the light, in the matrix. Default: 0 to 85 deg in steps of 5 deg.
        incidence_deg as "Inclination of the light": Vec<Spanned<Inclination>> = Vec::new(),
        /// Steps of azimuth by which rays are also sorted, a divisor of 180 deg. Default: the
        /// slab is turned about its normal.
        azimuth_deg as "Steps of azimuth": Option<AzimuthStep>,
        /// Rays from each side at each inclination.
        rays as "Rays": Count<64, { 1 << 36 }> = Count(200_000),
        /// Seed of rays and places.
        seed: Seed = Count(0),
    }
}

kinds! {
    /// What lies on every facet: its keys depend on `kind`.
    FaceCoating by "kind" {
        /// A mirror with the same reflectance at all angles.
        Mirror(MirrorCoating) = "mirror",
        /// An opaque metal.
        Metal(MetalCoating) = "metal",
        /// Coherent thin films.
        Film(FilmCoating) = "film",
    }
}

table! {
    /// A mirror that has the same reflectance at all angles and from both sides, and absorbs all other light.
    MirrorCoating {
        /// Its reflectance.
        reflectance: Share = Share(1.0),
    }
}

table! {
    /// An opaque metal: from both sides, light is reflected or absorbed.
    MetalCoating {
        /// Refractive index of the metal; its k must be above 0.
        material: MaterialSpec,
        /// Wavelength in vacuum for which it is computed.
        wavelength_nm: Wavelength = Wavelength(550.0),
    }
}

table! {
    /// Coherent thin films on every facet, along its normal.
    FilmCoating {
        /// The films from top to bottom, 1 to 256.
        film: Vec<Spanned<CoatingFilm>>,
        /// Wavelength in vacuum for which it is computed.
        wavelength_nm: Wavelength = Wavelength(550.0),
    }
}

choice! {
    /// Where caps stand.
    CapLattice {
        /// On squares.
        Square = "square",
        /// On equilateral triangles.
        Hexagonal = "hexagonal",
        /// At random places; caps may overlap.
        Random = "random",
    }
}

choice! {
    /// How a map of heights repeats.
    MapPeriod {
        /// Its mirror image beside it: heights are continuous, slopes change their sign.
        Mirror = "mirror",
        /// The map again: for maps of whole periods.
        Repeat = "repeat",
    }
}

choice! {
    /// How a surface is measured.
    Road {
        /// By rays, facet by facet.
        Rays = "rays",
        /// By waves behind a thin phase screen, along the normal.
        Waves = "waves",
        /// By rays and by waves.
        Both = "both",
    }
}
