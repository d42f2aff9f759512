//! Chapter 2: dipoles for light that is scattered below a surface (figure 2.18, eq. 2-22 to 2-29), against
//! exact transfer.

use crate::displays::{Bench, ReproductionError, of};
use crate::report::{Section, Table, fixed};

/// A very thick slab of isotropic scatterers without a surface.
const SLAB: &str = r#"# A very thick slab of isotropic scatterers without a surface, above black.
title = "A thick slab"

[[display.layers]]
kind = "slab"
index = 1
optical_thickness = 400
anisotropy = 0
albedo = 0.9

[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0, black = 0 }

[lighting]
illuminance_lx = 500
spectrum = "E"
diffuse = 1

[viewer]
theta_deg = 0
"#;

/// Albedos and reflectances of a half space for light along the normal, 1 - (1 - w)^(1/2) H(1), after S.
/// Chandrasekhar, Radiative Transfer (1950), computed by a separate program.
const EXACT: [(f64, f64); 3] = [(0.9, 0.414_947_48), (0.99, 0.752_720_72), (0.999, 0.912_845_33)];

/// Reflectance by the standard dipole (H. W. Jensen et al., SIGGRAPH 2001), of the same half space.
fn standard(albedo: f64) -> f64 {
    let decay = (3.0 * (1.0 - albedo)).sqrt();
    0.5 * albedo * ((-decay).exp() + (-decay * (1.0 + 4.0 / 3.0)).exp())
}

/// Reflectance by the better dipole (E. d'Eon, 2012), with Grosjean's diffusion coefficient.
fn better(albedo: f64) -> f64 {
    let diffusion = (2.0 - albedo) / 3.0;
    let decay = ((1.0 - albedo) / diffusion).sqrt();
    let [near, far] = [(-decay).exp(), (-decay * (1.0 + 4.0 * diffusion)).exp()];
    albedo * albedo * ((near - far) / (8.0 * diffusion * decay) + 0.25 * (near + far))
}

/// Figure 2.18.
pub(crate) fn section(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    bench.write("thick-slab.toml", SLAB)?;
    let mut table = Table::new(&[
        "albedo",
        "exact, closed form",
        "Papilio (adding)",
        "standard dipole",
        "its error (%)",
        "better dipole",
        "its error (%)",
    ]);
    for (albedo, exact) in EXACT {
        let set = format!("display.layers.0.albedo={albedo}");
        let result = bench.run("thick-slab", &[&set, "solver.method=adding"])?;
        let ours = of(&result.views[0], "white", |values| Some(values.Y));
        let error = |value: f64| fixed(100.0 * (value / exact - 1.0), 2);
        table.row([
            albedo.to_string(),
            fixed(exact, 5),
            fixed(ours, 5),
            fixed(standard(albedo), 5),
            error(standard(albedo)),
            fixed(better(albedo), 5),
            error(better(albedo)),
        ]);
    }
    Ok(Section::new("figure-2-18", "Figure 2.18: dipoles for light that is scattered below a surface")
        .say(
            "Reflectance of a half space of isotropic scatterers without a surface, for light along the normal, by exact transfer \
             and by dipoles. A dipole is a diffusion approximation: its total is wrong by several per cent where light is \
             absorbed, and most where it meets few scatterers, as in a thin diffuser. Papilio has no dipoles: slabs are computed \
             exactly (papilio run scenarios/thick-slab.toml).",
        )
        .table(table))
}
