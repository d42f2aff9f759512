//! The reflection of a diffuser, from a stream of random numbers of its own: the rest of a file does not
//! depend on it.

use papilio_testing::Dice;

/// Number of the stream.
const FAMILY: u64 = 7;

/// Largest reflectance: with the largest transmittance, no diffuser returns more light than arrives.
const MOST: f64 = 0.045;

/// Returns the text of layers in which the diffusers given by formulas reflect, in half of all scenarios.
/// (Ward's lobe with Duer's normalisation transmits more than all light near the horizon, and is refused with
/// a reflection.)
pub(super) fn with_reflection(number: u64, text: &str) -> String {
    let mut dice = Dice::new(FAMILY, number);
    let mut drawn = String::with_capacity(text.len());
    let models = ["k-correlation", "lambertian", "ward"].map(|model| format!("model = \"{model}\""));
    let reflects = dice.one_in(2) && !text.contains("\"duer\"");
    for line in text.lines() {
        drawn += line;
        drawn += "\n";
        if reflects && models.iter().any(|model| line == model) {
            drawn += &format!("reflection = {{ {} }}\n", keys(&mut dice));
        }
    }
    drawn
}

fn keys(dice: &mut Dice) -> String {
    let level = |dice: &mut Dice| format!("reflectance = {:.4}", dice.between(0.0, MOST));
    let mirror = |dice: &mut Dice| format!("mirror = {:.2}", dice.of([0.0, 0.0, 0.3, 1.0]));
    let lobe = |dice: &mut Dice, below: bool| match dice.below(if below { 2 } else { 3 }) {
        0 => String::new(),
        1 => format!(", model = \"k-correlation\", width = {:.3}", dice.log_between(0.07, 0.5)),
        _ => format!(", model = \"ward\", alpha = {:.3}", dice.log_between(0.1, 0.5)),
    };
    let above = format!("{}, {}{}", level(dice), mirror(dice), lobe(dice, false));
    // Ward's lobe below needs a glass with one index: the lobe from below is another one then.
    if above.contains("ward") || dice.one_in(3) {
        return format!("{above}, below = {{ {}, {}{} }}", level(dice), mirror(dice), lobe(dice, true));
    }
    above
}
