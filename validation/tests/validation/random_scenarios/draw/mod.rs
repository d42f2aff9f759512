//! Random scenario files, drawn from the whole grammar. A number identifies a file permanently.
//!
//! **Excluded**: lobes narrower than 0.07 between general layers, Ward lobes below alpha 0.1 and rough
//! interfaces below alpha 0.2, for which *adding* takes minutes or refuses; values of `sampler` and
//! `scattering` whose errors are known to be too small with few paths
//! ([sampling](../../../../docs/sampling.md)); sweeps and searches, which are many runs of such files.

mod display;
mod layers;
mod light;
mod pixel;
mod reflection;
pub(crate) mod wide;

use std::fmt::Write as _;

use papilio_testing::Dice;

/// A scenario file.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    /// Number of the scenario.
    pub(crate) number: u64,
    /// Description of display and light.
    pub(crate) name: String,
    /// The text of the file.
    pub(crate) text: String,
    /// Number of Monte Carlo paths, for about a second.
    pub(crate) paths: u64,
    /// Smallest target of adding.
    pub(crate) least_error: f64,
    /// Whether adding takes seconds.
    pub(crate) is_slow: bool,
}

/// Kind of a display, as needed to draw its light and pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// The ordinary panel without a diffuser.
    Bare,
    /// The ordinary panel with a lobe.
    Lobe,
    /// General layers: those of `[[display.layers]]`, and panels with measured kernels, slabs or absorbing
    /// glass.
    Layers,
}

/// A display without its pixel.
#[derive(Debug)]
struct Above {
    form: Form,
    /// Whether the medium above the pixel has one index at all wavelengths.
    is_constant: bool,
    name: String,
    text: String,
}

impl Above {
    /// Returns whether the display is computed as an ordinary panel; with the BRDF of a pixel it is not.
    fn is_panel(&self, of_pixel: &str) -> bool {
        self.form != Form::Layers && of_pixel != "paper"
    }
}

/// Number of the family's stream of random numbers.
const FAMILY: u64 = 5;

/// Returns a scenario file by its number.
pub(crate) fn drawn(number: u64) -> Drawn {
    let mut dice = Dice::new(FAMILY, number);
    let above = display::above(&mut dice);
    let (of_pixel, pixel) = pixel::pixel(&mut dice, above.is_constant);
    let (of_light, light) = light::lighting(&mut dice, above.form == Form::Lobe && of_pixel != "paper");
    let solver = solver(&mut dice, &above, of_pixel);
    let is_panel = above.is_panel(of_pixel);
    let mut text =
        format!("title = \"random scenario {number}\"\n[spectrum]\nrange_nm = [400, 700]\nstep_nm = 50\n");
    text += &match above.form {
        Form::Layers => reflection::with_reflection(number, &above.text),
        Form::Bare | Form::Lobe => above.text,
    };
    text += &pixel;
    text += &light;
    text += &solver;
    // Few paths meet the light that a thin slab traps by total reflection: with fewer paths, the errors would
    // be too small.
    let paths = match () {
        () if is_panel => 1 << 15,
        () if text.contains("\"slab\"") => 1 << 14,
        () => 1 << 12,
    };
    // Between general layers, each level of adding costs a factor of ten; for rough interfaces and BRDFs, it
    // gains little.
    let is_slow = text.contains("\"rough\"") || of_pixel == "paper";
    let least_error = match above.form {
        _ if is_slow => 2e-3,
        Form::Bare | Form::Lobe => 1e-5,
        Form::Layers => 2e-4,
    };
    Drawn { number, name: format!("{}/{of_pixel}/{of_light}", above.name), text, paths, least_error, is_slow }
}

/// Draws some keys that change the computation.
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

/// Writes a line `key = value`.
fn key(text: &mut String, key: &str, value: impl std::fmt::Display) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{key} = {value}");
}

/// Writes a line with a number with four decimals.
fn number(text: &mut String, name: &str, value: f64) {
    key(text, name, format_args!("{value:.4}"));
}

/// Writes a line with a random number between two others.
fn between(dice: &mut Dice, text: &mut String, name: &str, [low, high]: [f64; 2]) {
    number(text, name, dice.between(low, high));
}
