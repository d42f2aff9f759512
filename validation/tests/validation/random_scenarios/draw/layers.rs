//! General layers, in any order.

use papilio_testing::Dice;

use super::display::{absorption, diffuser, measured_keys, slab};
use super::{Above, Form, between, key, number};

/// Smallest width of a lobe between general layers.
pub(super) const NARROWEST: f64 = 0.07;

/// Draws one to three media with their interfaces; at most two of them scatter.
pub(super) fn layers(dice: &mut Dice) -> Above {
    let mut stack = Stack {
        text: String::new(),
        names: Vec::new(),
        above: "1.0",
        scatterers: 0,
        is_component_last: false,
    };
    if dice.one_in(3) {
        stack.component(dice);
    }
    for _ in 0..=dice.below(3) {
        stack.medium(dice);
    }
    if dice.one_in(5) {
        stack.component(dice);
    }
    let is_constant = !stack.above.starts_with('"');
    Above { form: Form::Layers, is_constant, name: stack.names.join("+"), text: stack.text }
}

#[derive(Debug)]
struct Stack {
    text: String,
    names: Vec<String>,
    /// Index of the medium above, as text.
    above: &'static str,
    scatterers: usize,
    is_component_last: bool,
}

impl Stack {
    fn entry(&mut self, kind: &str) {
        self.text += "[[display.layers]]\n";
        key(&mut self.text, "kind", format_args!("\"{kind}\""));
        self.is_component_last = kind == "component";
    }

    /// A component has the same index on both sides. A medium without an interface of its own needs one below
    /// a component.
    fn interface_below_component(&mut self) {
        if self.is_component_last {
            self.entry("fresnel");
        }
    }

    fn component(&mut self, dice: &mut Dice) {
        self.entry("component");
        between(dice, &mut self.text, "absorptance", [0.0, 0.1]);
        between(dice, &mut self.text, "reflectance", [0.0, 0.2]);
        self.names.push("component".to_owned());
    }

    /// Draws a medium, and the interface between it and the medium above.
    fn medium(&mut self, dice: &mut Dice) {
        let may_scatter = self.scatterers < 2;
        match dice.below(if may_scatter { 9 } else { 4 }) {
            0 => {
                let interface = dice.of(["fresnel", "ideal-ar"]);
                self.entry(interface);
                self.names.push(interface.to_owned());
            }
            1 | 2 => self.coating(dice),
            3 => self.interface_below_component(),
            4 | 5 => return self.rough(dice),
            6 | 7 => self.diffuser(dice),
            _ => return self.slab(dice),
        }
        let index = dice.of(["1.0", "1.3", "1.5", "1.5", "1.7", "\"BK7\""]);
        self.clear(dice, index);
    }

    fn clear(&mut self, dice: &mut Dice, index: &'static str) {
        self.entry("medium");
        key(&mut self.text, "index", index);
        let absorbs = absorption(dice, &mut self.text);
        self.names.push(if absorbs { format!("{index} absorbing") } else { index.to_owned() });
        self.above = index;
    }

    fn coating(&mut self, dice: &mut Dice) {
        self.entry("coating");
        let thickness = dice.between(5.0, 200.0);
        let metal = if dice.one_in(2) {
            format!(", {{ material = \"Cr\", thickness_nm = {:.2} }}", dice.between(1.0, 8.0))
        } else {
            String::new()
        };
        let films = format_args!("[{{ material = \"MgF2\", thickness_nm = {thickness:.2} }}{metal}]");
        key(&mut self.text, "film", films);
        self.names.push("coating".to_owned());
    }

    /// Draws a rough interface between two different indices.
    fn rough(&mut self, dice: &mut Dice) {
        if self.above.starts_with('"') {
            return self.clear(dice, "1.5");
        }
        self.scatterers += 1;
        self.entry("rough");
        let alpha = dice.log_between(0.2, 0.8);
        number(&mut self.text, "alpha", alpha);
        let distribution = dice.of(["ggx", "beckmann", "student-t"]);
        key(&mut self.text, "distribution", format_args!("\"{distribution}\""));
        if distribution == "student-t" {
            number(&mut self.text, "tail", 2.0 + alpha);
        }
        self.names.push(format!("{distribution} {alpha:.2}"));
        self.clear(dice, if self.above == "1.5" { "1.0" } else { "1.5" });
    }

    fn diffuser(&mut self, dice: &mut Dice) {
        self.scatterers += 1;
        self.entry("diffuser");
        let name = match dice.of(["k-correlation", "k-correlation", "lambertian", "ward", "measured"]) {
            "measured" => measured_keys(dice, &mut self.text, false),
            model => diffuser(dice, &mut self.text, model, NARROWEST),
        };
        self.names.push(name);
    }

    fn slab(&mut self, dice: &mut Dice) {
        self.scatterers += 1;
        self.interface_below_component();
        self.entry("slab");
        self.above = slab(dice, &mut self.text);
        self.names.push("slab".to_owned());
    }
}
