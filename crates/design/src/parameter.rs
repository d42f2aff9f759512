//! Keys of a scenario that are parameters of its film pixel.

use papilio_display::Parameter;
use papilio_display::scene::{Drive, FilmPixel, Thickness};
use papilio_scenario::KeyPath;

/// Parameter of the pixel at a path (in the syntax of `--set`); `None` if the path is not a parameter.
pub(crate) fn parameter(path: &str, film: &FilmPixel) -> Option<Parameter> {
    let path = KeyPath::new(path);
    let keys: Vec<&str> = path.keys().collect();
    let layer = |text: &str| text.parse::<usize>().ok().filter(|layer| *layer < film.layers.len());
    let sub_pixel = |name: &str| film.sub_pixels.iter().position(|sub_pixel| sub_pixel.name == name);
    match keys.strip_prefix(&["display", "pixel"])? {
        ["film", index, "thickness_nm"] => {
            let layer = layer(index)?;
            matches!(film.layers[layer].thickness, Thickness::Fixed(_))
                .then_some(Parameter::Thickness { layer })
        }
        ["film", index, "material", "n"] => Some(Parameter::Index { layer: layer(index)? }),
        ["film", index, "material", "k"] => Some(Parameter::Extinction { layer: layer(index)? }),
        ["substrate", "n"] => Some(Parameter::SubstrateIndex),
        ["substrate", "k"] => Some(Parameter::SubstrateExtinction),
        ["gap_nm", "dark"] => film.dark_gap_nm.map(|_| Parameter::DarkGap),
        ["gap_nm", name] => Some(Parameter::Gap { sub_pixel: sub_pixel(name)? }),
        ["area", name] => Some(Parameter::Area { sub_pixel: sub_pixel(name)? }),
        ["fill_factor"] => Some(Parameter::FillFactor),
        ["states", name, driven, "gap_nm"] => {
            let state = film.states.iter().position(|state| state.name == *name)?;
            let sub_pixel = sub_pixel(driven)?;
            let drive = film.states[state].drives.get(sub_pixel)?;
            matches!(drive, Drive::Gap(_)).then_some(Parameter::StateGap { state, sub_pixel })
        }
        _ => None,
    }
}

/// Returns true if the path is a number of a material of the film.
pub(crate) fn is_of_material(path: &str) -> bool {
    let path = KeyPath::new(path);
    let keys: Vec<&str> = path.keys().collect();
    matches!(
        keys[..],
        ["display", "pixel", "film", _, "material", _, ..] | ["display", "pixel", "substrate", _, ..]
    )
}

/// Sets a parameter of a pixel; returns false if the value is outside the range that a scenario accepts.
pub(crate) fn set(film: &mut FilmPixel, parameter: Parameter, value: f64) -> bool {
    let length = (0.0..=1e6).contains(&value);
    let index = value > 0.0 && value <= 1e3;
    let extinction = (0.0..=1e3).contains(&value);
    let is_valid = match parameter {
        Parameter::Thickness { .. }
        | Parameter::Gap { .. }
        | Parameter::DarkGap
        | Parameter::StateGap { .. } => length,
        Parameter::Area { .. } => (0.0..=1.0).contains(&value),
        Parameter::FillFactor => value > 0.0 && value <= 1.0,
        Parameter::Index { .. } | Parameter::SubstrateIndex => index,
        Parameter::Extinction { .. } | Parameter::SubstrateExtinction => extinction,
    };
    if !is_valid {
        return false;
    }
    match parameter {
        Parameter::Thickness { layer } => film.layers[layer].thickness = Thickness::Fixed(value),
        Parameter::Gap { sub_pixel } => film.sub_pixels[sub_pixel].gap_nm = value,
        Parameter::DarkGap => film.dark_gap_nm = Some(value),
        Parameter::StateGap { state, sub_pixel } => film.states[state].drives[sub_pixel] = Drive::Gap(value),
        Parameter::Area { sub_pixel } => film.sub_pixels[sub_pixel].area = value,
        Parameter::FillFactor => film.fill_factor = value,
        Parameter::Index { layer } => film.layers[layer].index.iter_mut().for_each(|index| index.re = value),
        Parameter::Extinction { layer } => {
            film.layers[layer].index.iter_mut().for_each(|index| index.im = value)
        }
        Parameter::SubstrateIndex => film.substrate.iter_mut().for_each(|index| index.re = value),
        Parameter::SubstrateExtinction => film.substrate.iter_mut().for_each(|index| index.im = value),
    }
    true
}

/// Returns true if the areas of the sub-pixels sum to 1 (within 0.001), as a scenario requires.
pub(crate) fn has_unit_area(film: &FilmPixel) -> bool {
    let sum: f64 = film.sub_pixels.iter().map(|sub_pixel| sub_pixel.area).sum();
    (sum - 1.0).abs() <= 1e-3
}
