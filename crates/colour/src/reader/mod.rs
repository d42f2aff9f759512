//! Models of a reader's vision: the contrast that is just visible.
//!
//! - [`VisibilityTask`]: luminance threshold of a small detail (Adrian 1989), with its size, the time to see
//!   it and the reader's age.
//! - [`contrast_sensitivity`]: contrast sensitivity of the eye to a grating (Barten 1999).
//! - [`square_root_integral`]: what a display's sharpness is worth, in just noticeable differences (Barten
//!   1999).
//! - [`age_factor`]: how much more contrast an older reader needs (Adrian 1989). It applies to both.
//!
//! **Range.** Luminances of [`LUMINANCES_CD_M2`], readers of [`AGES_YEARS`]. Outside, the functions return
//! the value that their documentation states, and `in_range` is false.

mod age;
mod grating;
mod quality;
mod visibility;

pub use age::{AGES_YEARS, age_factor};
pub use grating::contrast_sensitivity;
pub use quality::square_root_integral;
pub use visibility::{DIAMETERS_ARCMIN, Polarity, VisibilityTask};

/// Luminances of the background between which the models are used, cd/m2. The data of Adrian's model begin
/// far below; those of Blackwell, on which it is based, end near 3400 cd/m2, and paper in the sun has up to
/// 1e4 cd/m2. Above the upper limit the threshold contrast of the limit is used.
pub const LUMINANCES_CD_M2: [f64; 2] = [0.1, 1e4];

/// Returns true for a luminance for which the models are used.
pub fn is_luminance_in_range(luminance_cd_m2: f64) -> bool {
    let [least, most] = LUMINANCES_CD_M2;
    (least..=most).contains(&luminance_cd_m2)
}

/// Returns true for a reader's age for which [`age_factor`] is known.
pub fn is_age_in_range(age_years: f64) -> bool {
    let [least, most] = AGES_YEARS;
    (least..=most).contains(&age_years)
}
