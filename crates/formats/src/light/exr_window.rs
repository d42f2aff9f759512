//! Windows of OpenEXR: the places of pixels on the sphere.

use exr::math::Vec2;
use exr::meta::attribute::{EnvironmentMap, IntegerBounds};
use exr::meta::header::Header;
use papilio_diagnostics::Diagnostic;

use super::cube::equirectangular;
use super::map::{MapChannel, Shape};

/// Window that is the map.
pub(super) enum Window {
    /// Six faces of a cube, one below the other.
    Cube,
    Display,
    /// The data window, because the display window is no map.
    Data,
}

fn data_window(header: &Header) -> IntegerBounds {
    IntegerBounds { position: header.own_attributes.layer_position, size: header.layer_size }
}

pub(super) fn window(header: &Header, shape: Shape) -> Result<Window, Diagnostic> {
    let (data, display) = (header.layer_size, header.shared_attributes.display_window.size);
    if shape == Shape::Sphere && header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        let fits = data.0 >= 2 && data.0 <= 1024 && data.0.checked_mul(6) == Some(data.1);
        let wrong = || Diagnostic::new(format!("this cube has {} x {} pixels", data.0, data.1));
        let expected = "six square faces of 2 to 1024 pixels, one below the other";
        return if fits { Ok(Window::Cube) } else { Err(wrong().expected(expected)) };
    }
    if shape.check_size(display.0, display.1).is_ok() {
        return Ok(Window::Display);
    }
    shape.check_size(data.0, data.1).map(|()| Window::Data)
}

/// Moves the pixels to their places on the sphere; returns width and height of the map. `rest` is what pixels outside the data window are, in
/// words.
pub(super) fn place(
    header: &Header,
    shape: Shape,
    channels: &mut [MapChannel],
    rest: &str,
    notes: &mut Vec<String>,
) -> Result<(usize, usize), Diagnostic> {
    let (data, display) = (data_window(header), header.shared_attributes.display_window);
    match window(header, shape)? {
        Window::Cube => {
            let (width, height) = equirectangular(data.size.0, channels);
            notes.push(format!(
                "its six faces of {} pixels are resampled to {width} x {height} pixels",
                data.size.0
            ));
            Ok((width, height))
        }
        Window::Data => {
            notes.push(match shape {
                Shape::Sphere => {
                    "the display window is no map of the sphere and is not used: the data window is taken as the whole sphere".to_owned()
                }
                Shape::Picture => "the display window is not used: the data window is the picture".to_owned(),
            });
            Ok((data.size.0, data.size.1))
        }
        Window::Display if data == display => Ok((data.size.0, data.size.1)),
        Window::Display => {
            let outside = moved(data, display, channels, rest);
            let is_map = if shape == Shape::Sphere { ", which is the whole sphere" } else { "" };
            notes.push(format!("the data window differs from the display window{is_map}: {outside}"));
            Ok((display.size.0, display.size.1))
        }
    }
}

/// Moves pixels of the data window to the display window; returns in words what is missing and what is cut
/// off.
fn moved(data: IntegerBounds, display: IntegerBounds, channels: &mut [MapChannel], rest: &str) -> String {
    let Vec2(width, height) = display.size;
    let off = |at: i32, from: i32| i64::from(at) - i64::from(from);
    let (right, down) = (off(data.position.0, display.position.0), off(data.position.1, display.position.1));
    let mut covered = 0;
    for channel in channels {
        let mut map = vec![0.0; width * height];
        covered = 0;
        for (k, value) in channel.radiance.iter().enumerate() {
            let (row, column) = ((k / data.size.0) as i64 + down, (k % data.size.0) as i64 + right);
            if (0..height as i64).contains(&row) && (0..width as i64).contains(&column) {
                map[row as usize * width + column as usize] = *value;
                covered += 1;
            }
        }
        channel.radiance = map;
    }
    match (covered == width * height, covered == data.size.area()) {
        (false, true) => format!("the rest is {rest}"),
        (true, _) => "pixels outside are not used".to_owned(),
        (false, false) => format!("the rest is {rest}, and pixels outside are not used"),
    }
}
