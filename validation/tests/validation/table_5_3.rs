//! The derived rows of table 5.3 (Feng 2012) follow from its white and black.

use papilio_display::readability::{AGES_YEARS, Text};
use papilio_validation::table_5_3::{Column, TABLE_5_3};

fn text(column: &Column) -> Text {
    Text::new(column.white_cd_m2, column.black_cd_m2).unwrap()
}

/// They agree within the rounding of the printed numbers.
#[test]
fn luminance_and_contrast_of_text_follow_from_luminances() {
    for column in &TABLE_5_3 {
        let text = text(column);
        let off = (text.luminance_cd_m2 - column.text_luminance_cd_m2).abs();
        assert!(off <= 0.5, "{}: {text:?}", column.name);
        assert!((text.contrast - column.text_contrast).abs() <= 0.005, "{}: {text:?}", column.name);
    }
    // The text at eq. 5-14 prints 0.879.
    assert!((text(&TABLE_5_3[2]).contrast - 0.879).abs() < 1e-3);
}

/// The printed 10.08 of the third column is an error: its 2973/277 is 10.73.
#[test]
fn contrast_ratios_follow_from_luminances_except_one() {
    for (k, column) in TABLE_5_3.iter().enumerate() {
        let ratio = column.white_cd_m2 / column.black_cd_m2;
        let as_printed = (ratio - column.contrast_ratio).abs() <= if k < 2 { 0.05 } else { 0.01 };
        assert_eq!(as_printed, k != 2, "{}: {ratio}", column.name);
    }
    assert!((TABLE_5_3[2].white_cd_m2 / TABLE_5_3[2].black_cd_m2 - 10.73).abs() < 0.005);
}

/// The surrogate reproduces its calibration data to the integer per cent that was read from the chart.
#[test]
fn surrogate_reproduces_performances_of_table() {
    for column in &TABLE_5_3 {
        for (age, printed) in AGES_YEARS.into_iter().zip(column.performance_percent) {
            let performance = 100.0 * text(column).reading_surrogate(age).unwrap();
            assert!((performance - printed).abs() < 0.5, "{}, {age} years: {performance}", column.name);
        }
    }
}
