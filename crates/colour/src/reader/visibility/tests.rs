//! Tests of the visibility of details.

use super::*;

/// Time of a fixation, s.
const FIXATION_S: f64 = 0.2;

fn task(diameter_arcmin: f64, age_years: f64, polarity: Polarity) -> VisibilityTask {
    VisibilityTask { diameter_arcmin, time_s: FIXATION_S, polarity, age_years }
}

fn threshold(luminance: f64, diameter_arcmin: f64, age_years: f64) -> f64 {
    task(diameter_arcmin, age_years, Polarity::Darker).threshold_cd_m2(luminance).unwrap()
}

/// Luminance of the background, cd/m2, diameter, minutes of arc, age, years, and the thresholds of dark and
/// bright details, cd/m2: values of the expressions in the visibility level script of Radiance, evaluated in
/// Python.
const OF_RADIANCE: [[f64; 5]; 11] = [
    [0.1, 3.0, 25.0, 0.136_035_016, 0.168_483_359],
    [0.3, 10.0, 40.0, 0.029_678_179_6, 0.049_072_626_6],
    [0.7, 2.0, 60.0, 1.365_723_23, 1.505_009_43],
    [1.0, 1.0, 30.0, 3.649_488_96, 3.800_134_93],
    [10.0, 2.2, 60.0, 5.189_060_33, 5.631_734_75],
    [10.0, 5.0, 75.0, 3.261_195_39, 3.977_482_5],
    [100.0, 1.5, 50.0, 53.023_115_9, 53.783_254_3],
    [100.0, 20.0, 64.0, 2.993_884_23, 3.377_598_38],
    [1000.0, 2.2, 60.0, 331.554_298, 332.555_959],
    [7800.0, 2.2, 70.0, 5_008.863_39, 5_010.657_27],
    [1e4, 60.0, 25.0, 91.452_192, 91.755_533],
];

#[test]
fn thresholds_agree_with_the_expressions_of_radiance() {
    for [luminance, diameter, age, dark, bright] in OF_RADIANCE {
        for (polarity, expected) in [(Polarity::Darker, dark), (Polarity::Brighter, bright)] {
            let found = task(diameter, age, polarity).threshold_cd_m2(luminance).unwrap();
            assert!(
                (found / expected - 1.0).abs() < 1e-8,
                "{luminance} cd/m2, {diameter}', {age} years: {found}"
            );
        }
    }
}

/// Log10 of the threshold contrasts of Blackwell, J. Opt. Soc. Am. 36, 624 (1946), for discs of 0.595, 3.60,
/// 9.68 and 18.2 minutes of arc on backgrounds of 4 to 12 mag per square second of arc, as tabulated by
/// Clark, *Visual Astronomy of the Deep Sky* (1990).
const OF_BLACKWELL: [[f64; 4]; 9] = [
    [-0.3769, -1.8064, -2.3368, -2.4601],
    [-0.3315, -1.7747, -2.3337, -2.4608],
    [-0.2682, -1.7345, -2.3310, -2.4605],
    [-0.1982, -1.6851, -2.3140, -2.4572],
    [-0.1238, -1.6252, -2.2791, -2.4462],
    [-0.0424, -1.5529, -2.2297, -2.4214],
    [0.0498, -1.4655, -2.1659, -2.3763],
    [0.1596, -1.3581, -2.0810, -2.3036],
    [0.2934, -1.2256, -1.9674, -2.1965],
];

/// Blackwell's discs were shown for 6 s to young readers and seen in half of all cases. Adrian's formula
/// averages his data with others: it is within a factor of 1.8 of them, and within 7 % for 3.6 minutes of arc
/// in moderate light. In brighter light it is higher (see the head of this module).
#[test]
fn thresholds_agree_with_the_data_of_blackwell() {
    for (row, logs) in OF_BLACKWELL.iter().enumerate() {
        // 0 mag per square second of arc is 1.08e5 cd/m2.
        let luminance = 1.08e5 * 10_f64.powf(-0.4 * (4.0 + row as f64));
        for (diameter_arcmin, log) in [0.595, 3.60, 9.68, 18.2].into_iter().zip(logs) {
            let seen = VisibilityTask { time_s: 6.0, ..task(diameter_arcmin, 23.0, Polarity::Brighter) };
            let half = seen.threshold_cd_m2(luminance).unwrap() / CERTAIN;
            let ratio = half / (luminance * 10_f64.powf(*log));
            let bound = match (diameter_arcmin, luminance) {
                (3.60, ..200.0) => 1.07,
                (3.60, _) => 1.4,
                _ => 1.8,
            };
            assert!((1.0 / bound..bound).contains(&ratio), "{luminance} cd/m2, {diameter_arcmin}': {ratio}");
        }
    }
}

#[test]
fn larger_details_and_younger_readers_have_lower_thresholds() {
    for step in 0..=40 {
        let luminance = 10_f64.powf(-1.0 + 0.125 * f64::from(step));
        for size in 0..60 {
            let diameter = 0.2 * 1.1_f64.powi(size);
            let here = threshold(luminance, diameter, 25.0);
            assert!(threshold(luminance, 1.05 * diameter, 25.0) < here, "{luminance} cd/m2, {diameter}'");
            assert!(
                threshold(luminance, diameter, 45.0) > here && here > 0.0,
                "{luminance} cd/m2, {diameter}'"
            );
        }
    }
}

/// Up to 350 cd/m2, brighter text of the same contrast is easier to see. The threshold contrast of coarse
/// details is constant within 7 % from 10 cd/m2 (Weber's law).
#[test]
fn light_improves_vision() {
    for step in 0..35 {
        let luminance = 10_f64.powf(-1.0 + 0.1 * f64::from(step));
        for diameter in [0.5, 1.0, 2.0, 3.0, 5.0] {
            let [here, lit] = [luminance, 1.2 * luminance].map(|l| threshold(l, diameter, 30.0));
            assert!(lit / 1.2 < here, "{luminance} cd/m2, {diameter}'");
        }
    }
    let coarse = [10.0, 100.0, 1000.0, 1e4].map(|l| threshold(l, 20.0, 30.0) / l);
    assert!(coarse.iter().all(|contrast| (contrast / coarse[0] - 1.0).abs() < 0.07), "{coarse:?}");
}

#[test]
fn threshold_contrast_is_held_in_bright_light_and_undefined_without_light() {
    let (limit, beyond) = (threshold(1e4, 3.0, 60.0), threshold(3e4, 3.0, 60.0));
    assert!((beyond / limit - 3.0).abs() < 1e-12);
    for dark in [0.0, -1.0, f64::NAN] {
        assert_eq!(task(3.0, 60.0, Polarity::Darker).threshold_cd_m2(dark), None);
    }
    assert!([1e-12, 1e-6].iter().all(|tiny| threshold(100.0, *tiny, 30.0) > 1e6));
}

#[test]
fn range_is_that_of_luminance_diameter_and_age() {
    let in_range = |l: f64, diameter: f64, age: f64| task(diameter, age, Polarity::Darker).in_range(l);
    assert!(in_range(0.1, 0.3, 23.0) && in_range(1e4, 60.0, 75.0));
    for (l, diameter, age) in
        [(0.09, 3.0, 30.0), (1.1e4, 3.0, 30.0), (10.0, 0.2, 30.0), (10.0, 61.0, 30.0), (10.0, 3.0, 22.0)]
    {
        assert!(!in_range(l, diameter, age), "{l} cd/m2, {diameter}', {age} years");
    }
}
