//! Table 5.3 of Feng 2012: daylight readability of four displays, as printed.
//!
//! Luminances of white and black are in cd/m2. All other rows follow from them, except the
//! reading performances, which were read by eye from charts of CIE 145:2002.

/// A column of the table: one display.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Name of the display.
    pub name: &'static str,
    /// "Kw": luminance of white, cd/m2.
    pub white_cd_m2: f64,
    /// "Kk": luminance of black, cd/m2.
    pub black_cd_m2: f64,
    /// "D": contrast ratio.
    pub contrast_ratio: f64,
    /// "Lave": mean luminance of the text, cd/m2.
    pub text_luminance_cd_m2: f64,
    /// "C": contrast of the text.
    pub text_contrast: f64,
    /// "P": reading performance at 20, 50 and 75 years, %. (The head of the table has 70 years, but the chart
    /// from which it was read, figure 5.20, has 75.)
    pub performance_percent: [f64; 3],
}

/// The columns: an LCD, a transflective display, and the dissertation's reflective display in two set-ups.
pub const TABLE_5_3: [Column; 4] = [
    Column {
        name: "LCD",
        white_cd_m2: 1291.0,
        black_cd_m2: 749.0,
        contrast_ratio: 1.7,
        text_luminance_cd_m2: 1156.0,
        text_contrast: 0.35,
        performance_percent: [82.0, 67.0, 30.0],
    },
    Column {
        name: "transflective",
        white_cd_m2: 6331.0,
        black_cd_m2: 1487.0,
        contrast_ratio: 4.3,
        text_luminance_cd_m2: 5120.0,
        text_contrast: 0.71,
        performance_percent: [100.0, 87.0, 53.0],
    },
    Column {
        name: "reflective, 45 deg to 0 deg",
        white_cd_m2: 2973.0,
        black_cd_m2: 277.0,
        contrast_ratio: 10.08,
        text_luminance_cd_m2: 2299.0,
        text_contrast: 0.88,
        performance_percent: [100.0, 87.0, 59.0],
    },
    Column {
        name: "reflective, 35 deg to 20 deg, a tenth of the sun",
        white_cd_m2: 4030.0,
        black_cd_m2: 359.0,
        contrast_ratio: 11.22,
        text_luminance_cd_m2: 3112.25,
        text_contrast: 0.88,
        performance_percent: [100.0, 89.0, 60.0],
    },
];
