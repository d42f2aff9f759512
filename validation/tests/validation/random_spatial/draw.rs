//! Random displays with places: layers with their thicknesses, pixels on a matrix, light, a view and
//! patterns, as scenario files. A number identifies a file permanently.
//!
//! **Excluded**: what one of the solvers refuses by its nature (slabs and pixels with a measured kernel by
//! adding; narrow lobes between layers, which take minutes), and lamps behind the view, whose images no path
//! finds.

use papilio_testing::Dice;

/// Seed of the family; it is never changed.
const FAMILY: u64 = 0x5ace_0002;

/// Narrowest lobe of a panel and between general layers.
const NARROWEST: [f64; 2] = [0.03, 0.15];

/// A scenario file.
#[derive(Debug, Clone)]
pub(super) struct Drawn {
    /// Number of the scenario.
    pub(super) number: u64,
    /// Text of the file.
    pub(super) text: String,
    /// Target of adding: general layers take seconds.
    pub(super) target: f64,
    /// Whether adding takes seconds: layers that scatter.
    pub(super) is_slow: bool,
    /// Whether a colour filter lies above the pixels: it has no modulation transfer by adding.
    pub(super) has_filter: bool,
}

impl Drawn {
    /// Whether a picture on the display is computed through all orders: on Lambertian pixels without filter,
    /// not below the lobe of an ordinary panel.
    pub(super) fn has_picture(&self) -> bool {
        let is_lambertian = self.text.contains("kind = \"lambertian\"");
        is_lambertian && !self.has_filter && !self.text.contains("[display.diffuser]")
    }
}

/// The part of the display above the pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Above {
    /// The ordinary panel: a flat face.
    Flat,
    /// The ordinary panel: a lobe.
    Lobe,
    Layers,
}

/// Returns a file by its number.
pub(super) fn drawn(number: u64) -> Drawn {
    let mut dice = Dice::new(FAMILY, number);
    let mut text = format!("title = \"random display with places {number}\"\n");
    text += "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 50\n";
    let above = dice.of([Above::Flat, Above::Lobe, Above::Lobe, Above::Layers, Above::Layers]);
    let thickness = dice.log_between(0.05, 1.5);
    match above {
        Above::Flat | Above::Lobe => panel(&mut dice, &mut text, above == Above::Lobe, thickness),
        Above::Layers => layers(&mut dice, &mut text, thickness),
    }
    pixel(&mut dice, &mut text, above, thickness);
    let has_filter = matrix(&mut dice, &mut text, above, (thickness, number));
    lighting(&mut dice, &mut text, above);
    let (theta, phi) = (dice.between(0.0, 60.0), dice.between(0.0, 360.0));
    let along_normal = dice.one_in(3);
    let field = if dice.one_in(3) { 0.0 } else { dice.log_between(0.1, 15.0) };
    text += &match along_normal {
        true => format!("[viewer]\ntheta_deg = 0\nfield_deg = {field:.2}\n"),
        false => format!("[viewer]\ntheta_deg = {theta:.2}\nphi_deg = {phi:.2}\nfield_deg = {field:.2}\n"),
    };
    if !has_filter {
        let periods = [0.3, 4.0].map(|times| thickness * dice.between(times, 3.0 * times));
        text += "[pattern]\ntext = \"it\"\nkind = [\"stripes\", \"checkerboard\"]\n";
        text += &format!("period_mm = [{:.4}, {:.4}]\n", periods[0], periods[1]);
    }
    let target = if above == Above::Layers { 5e-3 } else { 1e-3 };
    Drawn { number, text, target, is_slow: above != Above::Flat, has_filter }
}

fn front(dice: &mut Dice, text: &mut String, thickness: f64) {
    let reflectance = dice.of([0.005, 0.04, 0.1, 0.3]);
    *text += &format!("[[display.front]]\nreflectance = {reflectance}\nabsorptance = 0.02\n");
    *text += &format!("gap_mm = {:.4}\n", thickness * dice.of([0.0, 0.3, 1.0, 2.0]));
}

fn panel(dice: &mut Dice, text: &mut String, has_lobe: bool, thickness: f64) {
    for _ in 0..dice.of([0, 0, 1, 1, 2]) {
        front(dice, text, thickness);
    }
    if has_lobe {
        *text += "[display.diffuser]\n";
        lobe(dice, text, NARROWEST[0]);
    }
    let index = dice.of(["1.3", "1.5", "1.5", "1.7", "\"BK7\""]);
    *text += &format!("[display.glass]\nindex = {index}\nthickness_mm = {thickness:.4}\n");
    if !has_lobe {
        *text += &format!("surface = \"{}\"\n", dice.of(["fresnel", "fresnel", "ideal-ar"]));
    }
}

fn lobe(dice: &mut Dice, text: &mut String, narrowest: f64) {
    if dice.one_in(5) {
        *text += "model = \"lambertian\"\n";
    } else {
        let width = dice.log_between(narrowest, 0.4);
        *text += &format!("model = \"k-correlation\"\nwidth = {width:.4}\n");
    }
    *text += &format!("transmittance = {:.3}\n", dice.between(0.6, 0.98));
    if dice.one_in(4) {
        *text += &format!("regular_fraction = {:.3}\n", dice.between(0.05, 0.3));
    }
}

/// One to three media below flat interfaces and diffusers, at most two of which scatter.
fn layers(dice: &mut Dice, text: &mut String, thickness: f64) {
    let entry = |text: &mut String, kind: &str| *text += &format!("[[display.layers]]\nkind = \"{kind}\"\n");
    if dice.one_in(3) {
        entry(text, "component");
        *text += &format!("reflectance = {}\n", dice.of([0.005, 0.04, 0.1]));
        entry(text, "medium");
        *text += &format!("index = 1\nthickness_mm = {:.4}\n", thickness * dice.of([0.2, 1.0]));
    }
    let count = 1 + dice.below(3);
    let mut scatterers = 0;
    for _ in 0..count {
        if scatterers < 2 && dice.one_in(2) {
            scatterers += 1;
            entry(text, "diffuser");
            lobe(dice, text, NARROWEST[1]);
            if dice.one_in(3) {
                *text += &format!("reflection = {{ reflectance = {:.3} }}\n", dice.between(0.005, 0.045));
            }
        } else if dice.one_in(2) {
            entry(text, "fresnel");
        }
        entry(text, "medium");
        *text += &format!("index = {}\n", dice.of(["1.3", "1.5", "1.5", "1.7"]));
        *text += &format!("thickness_mm = {:.4}\n", thickness * dice.between(0.2, 0.8));
        if dice.one_in(5) {
            *text += &format!("internal_transmittance = {:.3}\n", dice.between(0.8, 1.0));
        }
    }
}

/// Pixels of a film, mirror-like or Lambertian ones.
fn pixel(dice: &mut Dice, text: &mut String, above: Above, thickness: f64) {
    *text += "[display.pixel]\n";
    if above != Above::Layers && dice.one_in(5) {
        *text += "model = \"film\"\nsubstrate = \"Al\"\narea = { red = 0.4, green = 0.35, blue = 0.25 }\n";
        *text += "gap_nm = { red = 276, green = 192, blue = 138, dark = 20 }\nfill_factor = 0.9\n";
        *text += "film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
        return;
    }
    let is_lambertian = dice.one_in(2);
    let kind = if is_lambertian { "lambertian" } else { "mirror" };
    let (white, black) = (dice.between(0.3, 0.9), dice.between(0.01, 0.2));
    *text += &format!("model = \"uniform\"\nkind = \"{kind}\"\n");
    *text += &format!("reflectance = {{ white = {white:.3}, black = {black:.3} }}\n");
    if is_lambertian && above == Above::Flat && dice.one_in(3) {
        *text += &format!("spread_um = {:.2}\n", 1e3 * thickness * dice.log_between(0.03, 1.0));
    }
}

/// Returns whether there is a colour filter.
fn matrix(dice: &mut Dice, text: &mut String, above: Above, (thickness, number): (f64, u64)) -> bool {
    let pitch = thickness * dice.log_between(0.1, 5.0);
    *text += &format!("[display.matrix]\npitch_um = {:.2}\n", 1e3 * pitch);
    // Films, mirrors and glass that absorbs have one by their number, so that all other displays are those that
    // were drawn before these were computed.
    let is_drawn = text.contains("kind = \"lambertian\"") && !text.contains("BK7");
    let may_have = above != Above::Layers && !text.contains("spread_um");
    let has_filter = may_have && if is_drawn { dice.one_in(3) } else { number.is_multiple_of(3) };
    if has_filter {
        let part = if is_drawn { dice.between(0.05, 0.4) } else { 0.05 + 0.05 * (number % 8) as f64 };
        let height = 1e3 * part * thickness.min(pitch);
        *text += &format!("[display.matrix.filter]\nheight_um = {height:.2}\n");
        *text += "transmittance = { red = 0.8, green = 0.5, blue = 0.3 }\n";
    }
    has_filter
}

fn lighting(dice: &mut Dice, text: &mut String, above: Above) {
    let (diffuse, others) = dice.of([(1.0, 0), (1.0, 0), (0.0, 1), (0.4, 1), (0.2, 2)]);
    *text += &format!("[lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = {diffuse:.1}\n");
    let has_guide = dice.one_in(8) && above != Above::Layers;
    if has_guide {
        *text += "[lighting.front_light]\nilluminance_lx = 300\nupward_leak = 0.1\n";
    }
    for _ in 0..others {
        let share = (1.0 - diffuse) / f64::from(others);
        let (theta, phi) = (dice.between(0.0, 60.0), dice.between(0.0, 360.0));
        match dice.below(6) {
            0 => {
                *text +=
                    &format!("[[lighting.environment]]\nshare = {share:.1}\nmodel = \"sky\"\nnumber = 12\n");
                *text += &format!("sun_elevation_deg = {:.1}\n", 90.0 - theta);
            }
            1 => {
                *text += &format!("[[lighting.environment]]\nshare = {share:.1}\nmodel = \"ring\"\n");
                *text += &format!("theta_deg = {:.1}\nwidth_deg = 15\n", theta.max(10.0));
            }
            kind => {
                *text += &format!("[[lighting.directed]]\nshare = {share:.1}\n");
                *text += &format!("theta_deg = {theta:.2}\nphi_deg = {phi:.2}\n");
                if kind == 2 {
                    *text += &format!("radius_deg = {:.2}\n", dice.log_between(0.5, 12.0));
                }
            }
        }
    }
}
