//! Coverages of the sub-pixels of the reference pixel, for colours of a picture.

use papilio_colour::mapping::{DisplayColours, GamutMapping, Intent, MapSpace, SourceSpace};
use papilio_colour::states::{StateHull, SubPixels};
use papilio_colour::{CORNERS, Corners, D65_WHITE, Xyz};
use papilio_display::palette::Palette;

use crate::common::{run, scenario};

/// Values of a separate program for the bare pixel at 8 deg in D65: white and black of the display,
/// adaptation by CAT16. Outside of 0 to 1 are colours that the display cannot show.
///
/// Its X, Y, Z of the states had four decimals: coverages are off by up to 0.002 of the largest. Neutral
/// colours have equal coverages exactly: those of grey 128 are 0.21586, and not 0.217 0.216 0.217.
const COVERAGES: [([u8; 3], [f64; 3]); 8] = [
    ([255, 255, 255], [1.0, 1.0, 1.0]),
    ([128, 128, 128], [0.217, 0.216, 0.217]),
    ([0, 0, 0], [0.0, 0.0, 0.0]),
    ([255, 0, 0], [1.572, -0.047, 0.457]),
    ([0, 255, 0], [-0.556, 1.111, -1.551]),
    ([0, 0, 255], [-0.013, -0.066, 2.097]),
    ([200, 150, 125], [0.736, 0.298, 0.221]),
    ([120, 160, 200], [0.093, 0.344, 0.752]),
];

#[test]
fn reference_pixel_shows_colours_by_known_coverages() {
    let result = run(&scenario("reference-pixel", &[]).unwrap().scene).unwrap();
    let palette = Palette::of(&result, 0).unwrap();
    let xyz = CORNERS.map(|name| {
        let one = palette.colours.iter().find(|one| one.state == name).unwrap();
        Xyz { x: one.X, y: one.Y, z: one.Z }
    });
    let sub_pixels = SubPixels::new(&Corners { xyz }).unwrap();
    assert!(sub_pixels.misfit() < 1e-9, "{}", sub_pixels.misfit());
    let display = DisplayColours { white: xyz[7], black: xyz[0], perfect_white: D65_WHITE };
    let hull = StateHull::new(&xyz).unwrap();
    let mapping =
        GamutMapping::new(hull.clone(), display, SourceSpace::Srgb, Intent::Relative, MapSpace::Oklab)
            .unwrap();
    for (colour, expected) in COVERAGES {
        let light = colour.map(|byte| {
            let encoded = f64::from(byte) / 255.0;
            if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
        });
        let target = mapping.target(light);
        let found = sub_pixels.coverages(target);
        let largest = expected.iter().fold(1.0, |most: f64, part| most.max(part.abs()));
        let is_near = |(ours, theirs): (&f64, f64)| (ours - theirs).abs() < 5e-4 + 2e-3 * largest;
        assert!(found.iter().zip(expected).all(is_near), "{colour:?}: {found:?}");
        if colour[0] == colour[1] && colour[1] == colour[2] {
            assert!(found.iter().all(|part| (part - light[0]).abs() < 1e-9), "{colour:?}: {found:?}");
        }
        let inside = expected.iter().all(|part| (0.0..=1.0).contains(part));
        assert_eq!(hull.contains_within(target, 1e-6), inside, "{colour:?}");
        let shown = sub_pixels.coverages(mapping.map(light));
        assert!(shown.iter().all(|part| (-1e-6..=1.0 + 1e-6).contains(part)), "{colour:?}: {shown:?}");
    }
}
