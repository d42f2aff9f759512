//! `model = "liquid-crystal"` of `[display.pixel]`: cells, polarisers, retarders and other layers over a reflector.

use super::codes::Codes;
use super::display::{MaterialSpec, ShareSpectrum};
use super::numbers::{
    AxisAngle, Biaxiality, BottomTilt, Count, CrystalThickness, ElasticConstant, HelixPitch, Index,
    Nanometres, NaturalPitch, Permittivity, PositiveShare, Retardance, RetardanceRatio, Share, Tilt, Twist,
    Volts,
};
use crate::grammar::{choice, forms, kinds, table};
use crate::read::{Named, Spanned};

table! {
    /// Liquid-crystal cells, polarisers and retarders over a reflector, as they are from the glass down. Azimuths are in degrees,
    /// counter-clockwise as seen by the viewer, 0 along x.
    CrystalPixel {
        /// Layers from the glass down.
        stack as "Layers": Vec<Spanned<CrystalLayer>>,
        /// Material of the opaque, semi-infinite reflector.
        substrate: MaterialSpec,
        /// Active fraction of the panel.
        fill_factor: PositiveShare = PositiveShare(1.0),
        /// Reflectance of the inactive area.
        inactive_reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}

kinds! {
    /// A layer of a liquid-crystal pixel; its keys depend on `kind`.
    CrystalLayer by "kind" {
        /// A polariser.
        Polariser(Polariser) = "polariser",
        /// A retarder.
        Retarder(Retarder) = "retarder",
        /// A cell with a liquid crystal, whose director depends on the state.
        Cell(Cell) = "cell",
        /// A cholesteric layer: a helix of many turns.
        Cholesteric(Cholesteric) = "cholesteric",
        /// A thin isotropic film.
        Film(IsotropicFilm) = "film",
        /// A thick pane, in which light does not interfere.
        Slab(Pane) = "slab",
    }
}

choice! {
    /// The wave that a polariser transmits.
    TransmittedWave {
        /// Ordinary: the axis of the molecules absorbs, as in stretched polymers with iodine or dyes.
        Ordinary = "O",
        /// Extraordinary: directions across the axis absorb, as in coated films of dyes.
        Extraordinary = "E",
    }
}

table! {
    /// A polariser, without the faces to air of a datasheet.
    Polariser {
        /// Azimuth of the light that it transmits.
        axis_deg as "Transmission axis": AxisAngle,
        /// Measured spectra instead of `transmittance` and `extinction`: a CSV file with the columns
        /// `wavelength_nm`, `transmittance` and `extinction`, or `wavelength_nm`, `k_transmitted` and
        /// `k_absorbed` (extinction coefficients of the two polarisations).
        file: Option<String>,
        /// Transmittance for unpolarised light within the film, at most (1 + extinction)/2: that of a datasheet over 0.92,
        /// which the faces to air transmit. Default: 0.44.
        transmittance: Option<ShareSpectrum>,
        /// Transmittance of the absorbed polarisation over that of the transmitted one. Default: 1e-4.
        extinction as "Extinction ratio": Option<ShareSpectrum>,
        /// The wave that it transmits.
        transmits as "Transmitted wave": TransmittedWave = TransmittedWave::Ordinary,
        /// Refractive index, without k.
        index as "Refractive index": MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Thickness.
        thickness_um: CrystalThickness = CrystalThickness(20.0),
    }
}

choice! {
    /// Orientation of the optic axis of a retarder.
    Plate {
        /// In the panel.
        A = "A",
        /// Along the normal.
        C = "C",
        /// Oblique, at `tilt_deg`.
        O = "O",
    }
}

table! {
    /// A retarder: a uniform birefringent film.
    Retarder {
        /// Azimuth of the optic axis: the slow axis where `retardance_nm` is positive. A C plate has none.
        axis_deg as "Optic axis": Option<AxisAngle>,
        /// (n_e - n_o) times the thickness at 550 nm.
        retardance_nm: Retardance,
        /// Retardance at 450 nm over that at 550 nm, with `a + b/wavelength^2` between: 1 flat, below 1
        /// reverse dispersion.
        dispersion as "Re(450)/Re(550)": RetardanceRatio = RetardanceRatio(1.0),
        /// Orientation of the optic axis.
        plate: Plate = Plate::A,
        /// Tilt of the axis of an O plate out of the panel.
        tilt_deg as "Tilt of the axis": Option<Tilt>,
        /// Biaxiality (n_x - n_z)/(n_x - n_y) of an A plate, x along the axis: 1 if uniaxial.
        nz as "Biaxiality Nz": Biaxiality = Biaxiality(1.0),
        /// Ordinary refractive index.
        index as "Ordinary index": MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Thickness.
        thickness_um: CrystalThickness = CrystalThickness(40.0),
    }
}

table! {
    /// A cell. Its director turns from `rub_deg` at the top by `twist_deg` down to the bottom.
    Cell {
        /// Thickness of the liquid crystal.
        gap_um as "Gap": CrystalThickness,
        /// A liquid crystal by name: `5CB`, `E7` or `MLC-6608`, at 25 degrees Celsius. Default: `n_o` and
        /// `n_e`.
        liquid_crystal: Option<String>,
        /// Ordinary refractive index.
        n_o as "Ordinary index": Option<MaterialSpec>,
        /// Extraordinary refractive index.
        n_e as "Extraordinary index": Option<MaterialSpec>,
        /// Azimuth of the director at the top.
        rub_deg as "Rubbing direction": AxisAngle = AxisAngle(0.0),
        /// Turn of the director from top to bottom; positive: counter-clockwise as seen by the viewer.
        twist_deg: Twist = Twist(0.0),
        /// Tilt of the director out of the panel, in states without a tilt of their own.
        pretilt_deg: Tilt = Tilt(0.0),
        /// Tilt at the bottom of states by voltage. Above 90, the director turns through the normal, as in a
        /// driven pi cell. Default: `pretilt_deg`.
        pretilt_bottom_deg as "Pretilt at the bottom": Option<BottomTilt>,
        /// Elastic constant of splay. States by voltage need all three and both permittivities.
        K11_pN as "K11": Option<ElasticConstant>,
        /// Elastic constant of twist.
        K22_pN as "K22": Option<ElasticConstant>,
        /// Elastic constant of bend.
        K33_pN as "K33": Option<ElasticConstant>,
        /// Relative permittivity along the director, at the frequency of the drive.
        epsilon_parallel as "Permittivity along the director": Option<Permittivity>,
        /// Relative permittivity across the director.
        epsilon_perpendicular as "Permittivity across the director": Option<Permittivity>,
        /// Natural pitch of a liquid crystal with a chiral dopant, for states by voltage; positive: it turns as a
        /// positive `twist_deg`. Default: no dopant.
        pitch_um as "Natural pitch": Option<NaturalPitch>,
        /// The director in each state: `{ volts }`, `{ tilt_deg, twist_deg }`, or a file (CSV: depth, tilt_deg, twist_deg). Default: one
        /// state, `cell` (`pixel` if the display has no cell).
        states: Named<CellState> = Named(Vec::new()),
        /// Number of slices in each state. Default: 40 or more, by the turn of the director and the retardance, as many
        /// as keep Y within 1e-4.
        slices: Option<Count<1, 2000>>,
    }
}

forms! {
    /// The director in a state: a file, a voltage, or a tilt.
    CellState, "a file of directors by depth, or a table with volts or tilt_deg"; {
        /// A CSV file with the columns depth (a fraction of the gap, 0 at the top), tilt_deg and twist_deg (from `rub_deg`).
        File(String) if Value::Text(_),
        /// That of a voltage, or the same tilt at all depths.
        Uniform(UniformDirector) if Value::Table(_),
    }
}

table! {
    /// The director at a voltage, or with the same tilt at all depths.
    UniformDirector {
        /// Voltage, rms, risen from 0.
        volts as "Voltage": Option<Volts>,
        /// Tilt out of the panel. Default: `pretilt_deg`.
        tilt_deg: Option<Tilt>,
        /// Turn from the top to the bottom. Default: `twist_deg` of the cell.
        twist_deg: Option<Twist>,
    }
}

choice! {
    /// Sense of a helix.
    Handedness {
        /// As a corkscrew: clockwise away from the viewer; reflects right circular light.
        Right = "right",
        /// Counter-clockwise away from the viewer.
        Left = "left",
    }
}

table! {
    /// A cholesteric layer.
    Cholesteric {
        /// Length of a full turn.
        pitch_nm: HelixPitch,
        /// Sense of the helix.
        handedness: Handedness,
        /// Ordinary refractive index.
        n_o as "Ordinary index": MaterialSpec,
        /// Extraordinary refractive index.
        n_e as "Extraordinary index": MaterialSpec,
        /// Thickness.
        thickness_um: CrystalThickness,
        /// Azimuth of the director at the top.
        azimuth_deg as "Director at the top": AxisAngle = AxisAngle(0.0),
        /// What the layer is in each state. Default: planar in all states.
        states: Named<HelixState> = Named(Vec::new()),
    }
}

choice! {
    /// Texture of a cholesteric layer.
    HelixState {
        /// The helix stands and reflects its band.
        Planar = "planar",
        /// Small domains of all directions, as an isotropic medium of the mean permittivity, without
        /// scattering.
        FocalConic = "focal-conic",
    }
}

table! {
    /// A thin isotropic film.
    IsotropicFilm {
        /// Refractive index.
        material: MaterialSpec,
        /// Thickness.
        thickness_nm: Nanometres,
    }
}

table! {
    /// A thick pane without fringes, such as a glass substrate.
    Pane {
        /// Refractive index; its k absorbs.
        material: MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Thickness.
        thickness_um: CrystalThickness = CrystalThickness(500.0),
    }
}
