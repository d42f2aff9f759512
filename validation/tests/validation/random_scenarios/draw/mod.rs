//! Random scenario files: what a user may write, drawn over the whole grammar. A number names one for ever.
//!
//! **Left out**: lobes narrower than 0.07 between general layers, Ward's below alpha 0.1 and rough faces below alpha
//! 0.2, where *adding* takes minutes or refuses; `sampler`s and `scattering`s whose errors are known to be too small with
//! few paths ([sampling](../../../../docs/sampling.md)); sweeps and searches, which are many runs of such files.

mod display;
mod layers;
mod light;
mod pixel;

use std::fmt::Write as _;

use papilio_testing::Dice;

/// A scenario file.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    /// Which one it is.
    pub(crate) number: u64,
    /// Display and light, in words.
    pub(crate) name: String,
    /// The text of the file.
    pub(crate) text: String,
    /// Paths that the walk takes for about a second.
    pub(crate) paths: u64,
    /// No better does adding have to be.
    pub(crate) least_error: f64,
    /// Whether adding takes seconds.
    pub(crate) is_slow: bool,
}

/// What is known of a display when its light and pixel are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// The ordinary panel without a diffuser.
    Bare,
    /// The ordinary panel under a lobe.
    Lobe,
    /// Any layers: those of `[[display.layers]]`, and kernels, slabs and glass that absorbs in a panel's keys.
    Layers,
}

/// A display on the way.
#[derive(Debug)]
struct Above {
    form: Form,
    /// Whether the medium above the pixel has one index at all wavelengths.
    is_constant: bool,
    name: String,
    text: String,
}

impl Above {
    /// Whether it is computed as the ordinary panel; over a BRDF nothing is.
    fn is_panel(&self, of_pixel: &str) -> bool {
        self.form != Form::Layers && of_pixel != "paper"
    }
}

/// The family's number among the streams of random numbers.
const FAMILY: u64 = 5;

/// Scenario file number `number`.
pub(crate) fn drawn(number: u64) -> Drawn {
    let mut dice = Dice::new(FAMILY, number);
    let above = display::above(&mut dice);
    let (of_pixel, pixel) = pixel::pixel(&mut dice, above.is_constant);
    let (of_light, light) = light::lighting(&mut dice, above.form == Form::Lobe && of_pixel != "paper");
    let solver = solver(&mut dice, &above, of_pixel);
    let mut text =
        format!("title = \"random scenario {number}\"\n[spectrum]\nrange_nm = [400, 700]\nstep_nm = 50\n");
    text += &above.text;
    text += &pixel;
    text += &light;
    text += &solver;
    // What light a thin slab holds by total reflection, few paths meet: of fewer the errors are too small.
    let paths = match () {
        () if above.is_panel(of_pixel) => 1 << 15,
        () if text.contains("\"slab\"") => 1 << 14,
        () => 1 << 12,
    };
    // Between any layers adding's levels cost a factor of ten, and those of rough faces and BRDFs gain little.
    let is_slow = text.contains("\"rough\"") || of_pixel == "paper";
    let least_error = match above.form {
        _ if is_slow => 2e-3,
        Form::Bare | Form::Lobe => 1e-5,
        Form::Layers => 2e-4,
    };
    Drawn { number, name: format!("{}/{of_pixel}/{of_light}", above.name), text, paths, least_error, is_slow }
}

/// Some keys that change what is computed.
fn solver(dice: &mut Dice, above: &Above, of_pixel: &str) -> String {
    let is_panel = above.is_panel(of_pixel);
    let mut text = String::from("[solver]\n");
    if is_panel && dice.one_in(12) {
        text += "approximation = \"single-pass\"\n";
    } else if is_panel && above.is_constant && of_pixel != "table" && dice.one_in(12) {
        text += "angle_medium = \"unrefracted\"\n";
    }
    let sampler = dice.of(["sobol", "sobol", "random", "stratified"]);
    key(&mut text, "sampler", format_args!("\"{sampler}\""));
    if above.form == Form::Lobe && dice.one_in(6) {
        text += "scattering = \"guided\"\n";
    }
    text
}

/// A line `key = value`.
fn key(text: &mut String, key: &str, value: impl std::fmt::Display) {
    // Writing to a text cannot fail.
    let _ = writeln!(text, "{key} = {value}");
}

/// A line with a number, to four places.
fn number(text: &mut String, name: &str, value: f64) {
    key(text, name, format_args!("{value:.4}"));
}

/// A line with a number between two others, drawn.
fn between(dice: &mut Dice, text: &mut String, name: &str, [low, high]: [f64; 2]) {
    number(text, name, dice.between(low, high));
}
