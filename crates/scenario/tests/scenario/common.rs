//! What the tests of scenarios share.

use std::path::{Path, PathBuf};

use papilio_scenario::{Resolved, Scenario, ScenarioErrors};

/// A small complete scenario; the tests change a word of it at a time.
pub(crate) const GOOD: &str = r#"title = "Test"

[spectrum]
range_nm = [400, 700]
step_nm = 10

[[display.front]]
reflectance = 0.01
absorptance = 0.005

[display.diffuser]
model = "k-correlation"
haze = 0.78
total_transmittance = 0.9

[display.glass]
index = 1.5

[display.pixel]
model = "film"
substrate = "Al"
area = { red = 0.5, green = 0.3, blue = 0.2 }
gap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20 }
film = [
  { material = "Cr:Johnson", thickness_nm = 12 },
  { material = "air", thickness_nm = "gap" },
]

[lighting]
illuminance_lx = 500
spectrum = "D65"
diffuse = 0.5
[[lighting.directed]]
theta_deg = -20
share = 0.5

[viewer]
theta_deg = 8
"#;

/// Every kind of layer once; the tests change a word of it at a time.
pub(crate) const LAYERED: &str = r#"[display]
layers = [
  { kind = "component", reflectance = 0.005, absorptance = 0.01 },
  { kind = "coating", film = [{ material = "SiO2", thickness_nm = 90 }] },
  { kind = "medium", index = { n = 1.5, k = 1e-7 }, thickness_mm = 0.7 },
  { kind = "rough", alpha = 0.3 },
  { kind = "medium", index = "air" },
  { kind = "diffuser", model = "k-correlation", width = 0.06, transmittance = 0.95 },
  { kind = "medium", index = 1.6, internal_transmittance = 0.9 },
  { kind = "slab", optical_thickness = 2, anisotropy = 0.8, albedo = 0.99, index = 1.48 },
  { kind = "ideal-ar" },
  { kind = "diffuser", model = "lambertian", transmittance = 0.5 },
  { kind = "medium" },
  { kind = "fresnel" },
]

[display.pixel]
model = "uniform"
kind = "mirror"
reflectance = { white = 0.6, black = 0.05 }
"#;

/// The note on diffusers without a described reflection.
pub(crate) const NO_REFLECTION: &str = "the diffuser's own reflection is not described: it reflects nothing, and the light that it loses is counted as \
     absorbed by the diffuser; describe it by the table `reflection` of the diffuser, for example \
     reflection = { total_reflectance = 0.08 }";

/// `GOOD` with each `from` replaced by its `to`.
pub(crate) fn changed(changes: &[(&str, &str)]) -> String {
    changed_in(GOOD, changes)
}

/// A text with each `from` replaced by its `to`.
pub(crate) fn changed_in(text: &str, changes: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "nothing to change: {from}");
        text = text.replacen(from, to, 1);
    }
    text
}

/// Reads and resolves a text.
pub(crate) fn resolve(text: &str, folder: &Path, sets: &[&str]) -> Result<Resolved, ScenarioErrors> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Scenario::from_text(text, "test.toml", folder, &sets)?.resolve()
}

/// The folder of the shipped scenarios.
pub(crate) fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}
