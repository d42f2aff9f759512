//! The quantities that columns of tables may hold, with the names that other programs give them.

use super::units::Dimension;

/// A quantity of a column.
#[derive(Debug, PartialEq)]
pub(crate) struct Quantity {
    /// What it is, in words.
    pub(crate) what: &'static str,
    /// Its names, without unit, in small letters unless `with_case`; the first is that of Papilio.
    pub(crate) names: &'static [&'static str],
    /// Whether the case of the letters has a meaning: X is a tristimulus value, x a chromaticity.
    pub(crate) with_case: bool,
    /// Whether a unit alone is a name: `nm`.
    pub(crate) by_unit: bool,
    pub(crate) dimension: Dimension,
}

const fn named(what: &'static str, names: &'static [&'static str], dimension: Dimension) -> Quantity {
    Quantity { what, names, with_case: false, by_unit: false, dimension }
}

pub(crate) static WAVELENGTH: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a wavelength",
        &[
            "wavelength",
            "wl",
            "lambda",
            "wave",
            "lam",
            "wavelengths",
            "wavenumber",
            "wave_number",
            "energy",
            "energie",
            "photon_energy",
            "e",
            "hnu",
            "frequency",
            "wellenlaenge",
            "wellenlange",
            "wellenzahl",
            "longueur_d_onde",
            "longueur_dponde",
            "longitud_de_onda",
            "lunghezza_d_onda",
            "lunghezza_dponda",
            "spectral_nm",
        ],
        Dimension::Wavelength,
    )
};
pub(crate) static N: Quantity = named(
    "a refractive index n",
    &[
        "n",
        "refractive_index",
        "index",
        "ior",
        "re_n",
        "n_re",
        "n_real",
        "real_n",
        "index_n",
        "brechungsindex",
        "n_value",
    ],
    Dimension::Number,
);
pub(crate) static K: Quantity = named(
    "an extinction coefficient k",
    &[
        "k",
        "extinction_coefficient",
        "kappa",
        "extinction_coeff",
        "ext_coeff",
        "im_n",
        "n_im",
        "n_imag",
        "imag_n",
        "index_k",
        "extinktionskoeffizient",
        "k_value",
        "extinction",
    ],
    Dimension::Number,
);
pub(crate) static EPS_1: Quantity = named(
    "the real part of a permittivity",
    &[
        "eps1",
        "epsilon1",
        "e1",
        "eps_r",
        "eps_re",
        "eps_real",
        "re_eps",
        "real_eps",
        "epsilon_r",
        "epsilon_re",
        "epsilon_real",
        "re_epsilon",
        "er",
        "epsp",
        "epsilonp",
        "real_permittivity",
        "permittivity_real",
    ],
    Dimension::Number,
);
pub(crate) static EPS_2: Quantity = named(
    "the imaginary part of a permittivity",
    &[
        "eps2",
        "epsilon2",
        "e2",
        "eps_i",
        "eps_im",
        "eps_imag",
        "im_eps",
        "imag_eps",
        "epsilon_i",
        "epsilon_im",
        "epsilon_imag",
        "im_epsilon",
        "ei",
        "epspp",
        "epsilonpp",
        "imaginary_permittivity",
        "permittivity_imag",
        "permittivity_imaginary",
    ],
    Dimension::Number,
);
pub(crate) static FRACTION: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a fraction of the light",
        &[
            "value",
            "reflectance",
            "transmittance",
            "absorptance",
            "reflectance_factor",
            "r",
            "t",
            "transmission",
            "reflection",
            "internal_transmittance",
            "transmittance_factor",
            "reflectivity",
            "transmissivity",
            "spectral_reflectance",
            "spectral_transmittance",
            "refl",
            "trans",
            "rho",
            "tau",
            "fraction",
            "values",
            "sci",
            "sce",
            "spectral_dec",
            "spectral_pct",
            "remission",
            "reflexion",
            "reflexionsgrad",
            "transmissionsgrad",
            "absorptionsgrad",
            "efficiency",
        ],
        Dimension::Fraction,
    )
};
pub(crate) static REFLECTANCE: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a reflectance factor",
        &[
            "reflectance_factor",
            "reflectance",
            "r",
            "reflection",
            "reflectivity",
            "spectral_reflectance",
            "refl",
            "rho",
            "value",
            "sci",
            "sce",
            "remission",
            "reflexionsgrad",
            "spectral_dec",
            "spectral_pct",
        ],
        Dimension::Fraction,
    )
};
pub(crate) static LIGHT: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a spectrum of light",
        &[
            "relative_power",
            "spectral_power",
            "power",
            "spd",
            "value",
            "intensity",
            "irradiance",
            "radiance",
            "spectral_irradiance",
            "spectral_radiance",
            "spectral_power_distribution",
            "relative_spectral_power",
            "spectral_flux",
            "flux",
            "radiant_flux",
            "spectral_radiant_flux",
            "emission",
            "signal",
            "counts",
            "values",
            "s",
            "relative_intensity",
            "relative_irradiance",
            "relative_radiance",
            "radiant_intensity",
            "spectral_intensity",
            "power_density",
            "bestrahlungsstaerke",
            "intensitaet",
            "strahldichte",
            "relative",
            "energy_density",
            "absolute_irradiance",
        ],
        Dimension::Light,
    )
};
pub(crate) static STATE: Quantity = named(
    "the name of a state",
    &[
        "state",
        "sample",
        "name",
        "sample_name",
        "sample_id",
        "colour",
        "color",
        "patch",
        "label",
        "probe",
        "zustand",
        "etat",
        "estado",
        "stato",
        "farbe",
        "couleur",
        "specimen",
        "colour_name",
        "color_name",
        "patch_name",
        "ink",
    ],
    Dimension::Text,
);
pub(crate) static THETA: Quantity = Quantity {
    by_unit: true,
    ..named(
        "an inclination from the normal",
        &[
            "theta",
            "theta_o",
            "theta_s",
            "theta_r",
            "theta_t",
            "theta_out",
            "theta_v",
            "angle",
            "scattering_angle",
            "scatter_angle",
            "viewing_angle",
            "view_angle",
            "detector_angle",
            "detection_angle",
            "inclination",
            "theta_view",
            "polar_angle",
            "winkel",
            "streuwinkel",
            "betrachtungswinkel",
            "emission_angle",
            "receiver_angle",
        ],
        Dimension::Angle,
    )
};
pub(crate) static PHI: Quantity = named(
    "an azimuth",
    &["phi", "azimuth", "phi_o", "phi_s", "phi_r", "phi_out", "phi_v", "azimuth_angle", "phi_view", "azimut"],
    Dimension::Angle,
);
pub(crate) static RADIANCE: Quantity = named(
    "a relative radiance",
    &[
        "radiance",
        "luminance",
        "relative_radiance",
        "relative_luminance",
        "value",
        "l",
        "leuchtdichte",
        "strahldichte",
    ],
    Dimension::Light,
);
pub(crate) static X: Quantity = of_colour("the tristimulus value X", &["X", "XYZ_X", "CIE_X"]);
pub(crate) static Y: Quantity = of_colour("the tristimulus value Y", &["Y", "XYZ_Y", "CIE_Y"]);
pub(crate) static Z: Quantity = of_colour("the tristimulus value Z", &["Z", "XYZ_Z", "CIE_Z"]);
pub(crate) static L_STAR: Quantity = of_lab(
    "the lightness L*",
    &["l", "l_star", "lab_l", "cie_l", "lstar", "lightness", "cielab_l", "l_value"],
);
pub(crate) static A_STAR: Quantity =
    of_lab("a* of CIELAB", &["a", "a_star", "lab_a", "cie_a", "astar", "cielab_a", "a_value"]);
pub(crate) static B_STAR: Quantity =
    of_lab("b* of CIELAB", &["b", "b_star", "lab_b", "cie_b", "bstar", "cielab_b", "b_value"]);
pub(crate) static NAME: Quantity =
    named("the name of a sub-pixel", &["name", "subpixel", "sub_pixel", "window"], Dimension::Text);
pub(crate) static X_0: Quantity =
    named("the left edge", &["x0", "left", "x_min", "xmin"], Dimension::Fraction);
pub(crate) static Y_0: Quantity =
    named("the lower edge", &["y0", "bottom", "y_min", "ymin"], Dimension::Fraction);
pub(crate) static X_1: Quantity =
    named("the right edge", &["x1", "right", "x_max", "xmax"], Dimension::Fraction);
pub(crate) static Y_1: Quantity =
    named("the upper edge", &["y1", "top", "y_max", "ymax"], Dimension::Fraction);
pub(crate) static TRANSMITTANCE: Quantity = named(
    "a transmittance",
    &["transmittance", "t", "transmission", "single_transmittance"],
    Dimension::Fraction,
);
pub(crate) static EXTINCTION_RATIO: Quantity =
    named("an extinction ratio", &["extinction", "extinction_ratio"], Dimension::Fraction);
pub(crate) static K_TRANSMITTED: Quantity =
    named("k of the transmitted polarisation", &["k_transmitted", "k_1", "k1"], Dimension::Number);
pub(crate) static K_ABSORBED: Quantity =
    named("k of the absorbed polarisation", &["k_absorbed", "k_2", "k2"], Dimension::Number);
pub(crate) static DEPTH: Quantity =
    named("a depth", &["depth", "z", "position", "depth_fraction"], Dimension::Fraction);
pub(crate) static TILT: Quantity = named("a tilt", &["tilt", "tilt_angle"], Dimension::Angle);
pub(crate) static TWIST: Quantity = named("a twist", &["twist", "twist_angle"], Dimension::Angle);
pub(crate) static FREQUENCY: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a spatial frequency",
        &["frequency", "spatial_frequency", "f", "freq", "k"],
        Dimension::SpatialFrequency,
    )
};
pub(crate) static DENSITY: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a power spectral density",
        &["psd", "density", "power_spectral_density", "psd_2d", "w", "spectral_density"],
        Dimension::Density,
    )
};
pub(crate) static THETA_I: Quantity = named(
    "the inclination of the light",
    &[
        "theta_i",
        "theta_in",
        "theta_inc",
        "incidence",
        "angle_of_incidence",
        "aoi",
        "theta_incident",
        "incidence_angle",
        "incident_angle",
        "theta_light",
        "theta_source",
        "theta_incidence",
        "einfallswinkel",
        "incident_theta",
    ],
    Dimension::Angle,
);
pub(crate) static PHI_I: Quantity = named(
    "the azimuth of the light",
    &[
        "phi_i",
        "phi_in",
        "phi_inc",
        "phi_incident",
        "phi_light",
        "phi_source",
        "incident_azimuth",
        "phi_incidence",
        "incident_phi",
    ],
    Dimension::Angle,
);
pub(crate) static THETA_O: Quantity = named(
    "the inclination of the scattered light",
    &[
        "theta_o",
        "theta_out",
        "theta_s",
        "theta_r",
        "theta_t",
        "theta_v",
        "theta_scatter",
        "theta_scattered",
        "scatter_theta",
        "theta_view",
        "scattering_angle",
        "scatter_angle",
        "theta_outgoing",
        "theta_exit",
        "theta_viewer",
        "streuwinkel",
        "theta_e",
        "theta_d",
    ],
    Dimension::Angle,
);
pub(crate) static PHI_O: Quantity = named(
    "the azimuth of the scattered light",
    &[
        "phi_o",
        "phi_out",
        "phi_s",
        "phi_r",
        "phi_t",
        "phi_v",
        "phi_scatter",
        "phi_scattered",
        "scatter_phi",
        "phi_view",
        "phi_outgoing",
        "phi_exit",
        "phi_viewer",
        "scatter_azimuth",
        "phi_e",
        "phi_d",
    ],
    Dimension::Angle,
);
pub(crate) static D_PHI: Quantity = named(
    "the azimuth of the scattered light from that of the light",
    &["dphi", "delta_phi", "phi_diff", "relative_azimuth", "phi_rel", "phi_relative"],
    Dimension::Angle,
);
pub(crate) static BSDF: Quantity = Quantity {
    by_unit: true,
    ..named(
        "a BSDF",
        &["value", "bsdf", "brdf", "btdf", "f", "fr", "ft", "f_r", "f_t", "bsdf_value"],
        Dimension::Bsdf,
    )
};
pub(crate) static CHANNEL: Quantity = named("a channel", &["channel"], Dimension::Text);
pub(crate) static WAY: Quantity = named("a part", &["way", "part"], Dimension::Text);
/// What no reader uses: it is passed over, with a note.
pub(crate) static REMARK: Quantity = named(
    "a remark",
    &[
        "comment",
        "comments",
        "note",
        "notes",
        "remark",
        "remarks",
        "source",
        "date",
        "time",
        "timestamp",
        "operator",
        "instrument",
        "serial_number",
        "description",
        "bemerkung",
        "datum",
        "kommentar",
        "no",
        "nr",
        "number",
        "index_number",
        "id",
        "#",
    ],
    Dimension::Text,
);
/// The standard deviation of the value of a row, in the unit of the value.
pub(crate) static STANDARD_DEVIATION: Quantity = named(
    "the standard deviation of a value",
    &[
        "standard_deviation",
        "standard_deviations",
        "standard_uncertainty",
        "std_dev",
        "stdev",
        "std",
        "sd",
        "sigma",
    ],
    Dimension::Fraction,
);
/// The name of a metric.
pub(crate) static METRIC: Quantity = named("the name of a metric", &["metric"], Dimension::Text);
/// The value of a metric, in the unit of the metric.
pub(crate) static METRIC_VALUE: Quantity = named("the value of a metric", &["value"], Dimension::Number);
/// The standard deviation of the value of a metric, in the unit of the metric.
pub(crate) static METRIC_DEVIATION: Quantity =
    named(STANDARD_DEVIATION.what, STANDARD_DEVIATION.names, Dimension::Number);
/// An uncertainty of another column.
pub(crate) static ERROR: Quantity = named(
    "an uncertainty",
    &[
        "error",
        "uncertainty",
        "sigma",
        "std",
        "stdev",
        "sd",
        "standard_deviation",
        "standard_error",
        "n_error",
        "k_error",
        "sigma_n",
        "sigma_k",
        "dn",
        "dk",
        "n_err",
        "k_err",
        "delta_n",
        "delta_k",
        "u",
        "fehler",
        "mse",
    ],
    Dimension::Text,
);
/// Quantities that are easily taken for others, and are never read.
pub(crate) static ABSORBANCE: Quantity = named(
    "an absorbance, which is the negative logarithm of a transmittance",
    &["absorbance", "optical_density", "od", "abs", "density_status_t", "extinktion"],
    Dimension::Fraction,
);
pub(crate) static ABSORPTION: Quantity = named(
    "an absorption coefficient; k is the coefficient times the wavelength over 4 pi",
    &["alpha", "absorption_coefficient", "abs_coeff", "absorption_coeff"],
    Dimension::Number,
);

const fn of_colour(what: &'static str, names: &'static [&'static str]) -> Quantity {
    Quantity { with_case: true, ..named(what, names, Dimension::Fraction) }
}

const fn of_lab(what: &'static str, names: &'static [&'static str]) -> Quantity {
    named(what, names, Dimension::Number)
}

/// Quantities by which a column that a reader does not take is recognised in messages.
pub(crate) static KNOWN: [&Quantity; 20] = [
    &WAVELENGTH,
    &N,
    &K,
    &EPS_1,
    &EPS_2,
    &ABSORBANCE,
    &ABSORPTION,
    &REFLECTANCE,
    &FRACTION,
    &LIGHT,
    &STATE,
    &THETA_I,
    &PHI_I,
    &THETA,
    &PHI,
    &THETA_O,
    &PHI_O,
    &X,
    &Y,
    &Z,
];
