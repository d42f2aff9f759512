//! Layers in any order, slabs and absorbing glass: resolved layers, and refused input.

use std::f64::consts::{PI, SQRT_2};
use std::path::Path;

use crate::common::{GOOD, LAYERED, NO_REFLECTION, changed, changed_in, resolve};
use papilio_display::scene::{Distribution, Interface, Layer, Lobe, Particles, Ready, Thickness};
use papilio_scenario::Resolved;

fn resolved(text: &str, sets: &[&str]) -> Resolved {
    resolve(text, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn layers_of(resolved: &Resolved) -> &[Layer] {
    &resolved.scene.display.layers
}

/// Each interface in one word, with the index of the medium below it.
pub(crate) fn outline(layers: &[Layer]) -> Vec<(&'static str, f64)> {
    let word = |interface: &Interface| match interface {
        Interface::Ready(Ready::Open) => "open",
        Interface::Ready(Ready::IdealAr) => "coated",
        Interface::Ready(Ready::Fresnel | Ready::FresnelOf(_)) => "fresnel",
        Interface::Ready(Ready::Component(_)) => "sheet",
        Interface::Coating(_) | Interface::Ready(Ready::Coating(_)) => "coating",
        Interface::Ready(Ready::Diffuser(_)) => "diffuser",
        Interface::Rough { .. } | Interface::Ready(Ready::Rough(_)) => "rough",
        Interface::Ready(Ready::Scatter(_)) => "scatter",
        Interface::Ready(Ready::Wave(_)) => "wave",
        Interface::Ready(Ready::Reflecting(_)) => "reflecting",
        Interface::OfSurface(_) => "surface",
        Interface::Ready(Ready::Run(_)) => "run",
    };
    layers.iter().map(|layer| (word(&layer.interface), layer.medium.index[0])).collect()
}

fn pixel_under(layers: &str) -> String {
    let pixel = &LAYERED[LAYERED.find("[display.pixel]").unwrap()..];
    format!("display.layers = [{layers}]\n{pixel}")
}

#[test]
fn layers_of_all_kinds_resolve() {
    let resolved = resolved(LAYERED, &[]);
    let layers = layers_of(&resolved);
    let expected = [
        ("sheet", 1.0), // in the air, for the coating is the next face
        ("coating", 1.5),
        ("rough", 1.0),
        ("diffuser", 1.6),
        ("fresnel", 1.48),
        ("coated", 1.48),
        ("diffuser", 1.5),
        ("open", 1.5), // a bare face with the same glass on both sides is none
    ];
    assert_eq!(outline(layers), expected);
    let Interface::Ready(Ready::Component(sheet)) = &layers[0].interface else { panic!("not a sheet") };
    assert_eq!((sheet.reflectance[0], sheet.absorptance[0]), (0.005, 0.01));
    let Interface::Coating(coating) = &layers[1].interface else { panic!("not a coating") };
    assert_eq!((coating.films.len(), coating.films[0].thickness), (1, Thickness::Fixed(90.0)));
    let Interface::Rough { alpha, distribution } = layers[2].interface else { panic!("not rough") };
    assert_eq!((alpha, distribution), (0.3, Distribution::Ggx));
    let Interface::Ready(Ready::Diffuser(diffuser)) = &layers[3].interface else { panic!("not a diffuser") };
    assert_eq!((diffuser.lobe, diffuser.transmittance[0]), (Lobe::KCorrelation { width: 0.06 }, 0.95));
    // exp(-4 pi k d / lambda) of 0.7 mm at 380 nm.
    let expected = (-4.0 * std::f64::consts::PI * 1e-7 * 0.7e6 / 380.0_f64).exp();
    assert!((layers[1].medium.transmittance[0] - expected).abs() < 1e-12);
    assert_eq!(layers[3].medium.transmittance[40], 0.9);
    let slab = layers[4].medium.scattering.as_ref().unwrap();
    assert_eq!((slab.optical_thickness, slab.anisotropy, slab.albedo[0]), (2.0, 0.8, 0.99));
    assert!(layers.iter().filter(|layer| layer.medium.scattering.is_some()).count() == 1);
    let note = "display.layers.7: an optical thickness of 2 with anisotropy 0.8 scatters light back about as much \
                as one of 0.4 with anisotropy 0 (similarity)";
    assert_eq!(resolved.notes, [note, NO_REFLECTION]);
}

/// A Ward diffuser, in a panel and as a layer: T is the total transmittance over the total of the kernel at
/// normal incidence.
#[test]
fn ward_diffuser_in_panel_and_layer_has_its_transmittance() {
    let lobe = "model = \"k-correlation\"\nhaze = 0.78";
    let ward = "model = \"ward\"\nalpha = 0.2\nnormalisation = \"ward\"\nregular_fraction = 0.1";
    let panel = resolved(&GOOD.replace(lobe, ward), &[]);
    let layers = layers_of(&panel);
    assert_eq!(outline(layers), [("sheet", 1.0), ("scatter", 1.5)]);
    let Interface::Ready(Ready::Scatter(face)) = &layers[1].interface else { panic!("no face") };
    // Of rho = 1 the lobe sends 0.895 along the normal, and a tenth passes straight.
    let expected = 0.1 * 0.9 / (0.9 * 0.895 + 0.1);
    assert!((face.straight()[3] - expected).abs() < 1e-4, "{} {expected}", face.straight()[3]);
    let layer =
        "{ kind = \"diffuser\", model = \"ward\", alpha = 0.1, transmittance = 0.9 }, { kind = \"medium\" }";
    assert_eq!(outline(layers_of(&resolved(&pixel_under(layer), &[]))), [("scatter", 1.5)]);
    for (wrong, right) in
        [("alpha = 2", "a number from 0.005 to 1"), ("alpha = 0.1\nwidth = 0.1", "k-correlation")]
    {
        let text = GOOD.replace(lobe, &format!("model = \"ward\"\n{wrong}"));
        let errors = resolve(&text, Path::new(""), &[]).unwrap_err().to_string();
        assert!(errors.contains(right), "{errors}");
    }
}

#[test]
fn interfaces_between_media_are_completed() {
    let outline = |layers: &str| outline(layers_of(&resolved(&pixel_under(layers), &[])));
    let glass = "{ kind = \"medium\", index = 1.5 }";
    let air = "{ kind = \"medium\", index = \"air\" }";
    let sheet = "{ kind = \"component\", reflectance = 0.1 }";
    assert_eq!(outline(glass), [("fresnel", 1.5)]);
    assert_eq!(outline(air), [("open", 1.0)]);
    assert_eq!(
        outline(&format!("{glass}, {glass}, {air}")),
        [("fresnel", 1.5), ("open", 1.5), ("fresnel", 1.0)]
    );
    // Components in air; a face below them leaves them there.
    assert_eq!(outline(&format!("{sheet}, {sheet}")), [("sheet", 1.0), ("sheet", 1.0)]);
    assert_eq!(
        outline(&format!("{sheet}, {{ kind = \"fresnel\" }}, {glass}")),
        [("sheet", 1.0), ("fresnel", 1.5)]
    );
    assert_eq!(outline(&format!("{glass}, {sheet}")), [("fresnel", 1.5), ("sheet", 1.5)]);
    assert_eq!(outline(&format!("{glass}, {sheet}, {glass}")), [("fresnel", 1.5), ("sheet", 1.5)]);
    // A dispersive glass and its number at one wavelength are two media.
    let bk7 = "{ kind = \"medium\", index = \"BK7\" }";
    let faces = |layers: &str| outline(layers).iter().map(|(face, _)| *face).collect::<Vec<_>>();
    assert_eq!(faces(&format!("{bk7}, {bk7}, {glass}")), ["fresnel", "open", "fresnel"]);
}

#[test]
fn slab_as_diffuser_has_interfaces() {
    let slab = "model = \"slab\"\noptical_thickness = 1\nanisotropy = 0.9";
    let text = changed(&[("model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9", slab)]);
    let layers = |sets: &[&str]| outline(layers_of(&resolved(&text, sets)));
    assert_eq!(layers(&[]), [("sheet", 1.0), ("fresnel", 1.5), ("open", 1.5)]);
    assert_eq!(
        layers(&["display.diffuser.index=1.6", "display.front=[]"]),
        [("fresnel", 1.6), ("fresnel", 1.5)]
    );
    assert_eq!(layers(&["display.diffuser.index=1"]), [("sheet", 1.0), ("open", 1.0), ("fresnel", 1.5)]);
    let scattering = layers_of(&resolved(&text, &[]))[1].medium.scattering.clone().unwrap();
    assert!(scattering.albedo.iter().all(|albedo| *albedo == 1.0));
}

/// Spheres have the size parameter and the relative index that they have in their binder; exactly one of `anisotropy` and `particles` is given.
#[test]
fn particles_are_those_of_their_binder() {
    let with =
        |keys: &str| changed(&[("model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9", keys)]);
    let slab = "model = \"slab\"\noptical_thickness = 1\n";
    let spheres =
        with(&format!("{slab}particles = {{ kind = \"mie\", radius_um = 0.55, index = 3, variance = 0.1 }}"));
    let all = resolved(&spheres, &[]);
    let Some(Particles::Spheres { size_parameter, index, variance }) = layers_of(&all)[1].medium.particles
    else {
        panic!("spheres")
    };
    assert!((size_parameter - 3.0 * PI).abs() < 1e-12 && index.re == 2.0 && variance == 0.1);
    let molecules = with(&format!("{slab}particles = {{ kind = \"rayleigh\" }}"));
    let all = resolved(&molecules, &["display.diffuser.particles.depolarisation_factor=0.1"]);
    assert_eq!(layers_of(&all)[1].medium.particles, Some(Particles::Molecules { depolarisation: 0.1 }));
    let (neither, large) = (with(slab), spheres.replace("0.55", "5"));
    for (text, set, says) in [
        (&neither, None, "the key `anisotropy` is missing"),
        (&molecules, Some("display.diffuser.anisotropy=0"), "both `anisotropy` and `particles` are given"),
        (
            &large,
            Some("display.diffuser.index=2"),
            "spheres of 5 um have a size parameter of 114 in this binder",
        ),
        (
            &spheres,
            Some("display.diffuser.particles.index=1.5"),
            "spheres of the binder's index do not scatter",
        ),
    ] {
        let errors = resolve(text, Path::new(""), set.as_slice()).unwrap_err();
        assert!(errors.to_string().contains(says), "{errors}");
    }
    assert!(resolve(&large, Path::new(""), &[]).is_ok());
}

#[test]
fn absorbing_glass_resolves_to_general_layers() {
    let is_panel = |sets: &[&str]| resolved(GOOD, sets).scene.display.panel().is_some();
    assert!(is_panel(&[]) && is_panel(&["display.glass.internal_transmittance=1"]));
    let absorbing = resolved(GOOD, &["display.glass.internal_transmittance=0.9"]);
    assert_eq!(outline(layers_of(&absorbing)), [("sheet", 1.0), ("diffuser", 1.5)]);
    assert_eq!(layers_of(&absorbing)[1].medium.transmittance[0], 0.9);
    let (start, end) = (GOOD.find("[display.diffuser]").unwrap(), GOOD.find("[display.glass]").unwrap());
    let bare = format!("{}{}", &GOOD[..start], &GOOD[end..]);
    for face in ["coated", "fresnel"] {
        let surface = format!("display.glass.surface={face}");
        let layers = resolved(
            &bare,
            &["display.glass.index={ n = 1.5, k = 1e-4 }", "display.glass.thickness_mm=0.1", &surface],
        );
        assert_eq!(outline(layers_of(&layers)), [("sheet", 1.0), (face, 1.5)]);
    }
    // A glass without k stays clear, whatever its thickness; a note says so.
    let thick = resolved(GOOD, &["display.glass.thickness_mm=2"]);
    assert!(thick.scene.display.panel().is_some());
    assert!(
        thick.notes.iter().any(|note| note.contains("display.glass.thickness_mm has no effect on colours"))
    );
    // With a transmittance, the thickness is geometry: k is not used, in whichever order the two are given.
    let absorbs = "index = { n = 1.5, k = 1e-4 }";
    for (file, set) in [
        ("thickness_mm = 2", "display.glass.internal_transmittance=0.9"),
        ("internal_transmittance = 0.9", "display.glass.thickness_mm=2"),
    ] {
        let text = changed(&[("index = 1.5", &format!("{absorbs}\n{file}"))]);
        let both = resolved(&text, &[set]);
        assert!(layers_of(&both)[1].medium.transmittance.iter().all(|t| *t == 0.9), "{set}");
        assert!(both.notes.iter().any(|note| note.contains("the transmittance of this thickness")));
    }
}

/// A change of `LAYERED`, the place of the error, and parts of its text.
type Case = (&'static str, &'static str, (usize, usize), &'static [&'static str]);

const WRONG: &[Case] = &[
    // Ranges.
    (
        "optical_thickness = 2",
        "optical_thickness = 9e-7",
        (10, 40),
        &["from 1e-6 to 1e6 (optical thickness)"],
    ),
    ("optical_thickness = 2", "optical_thickness = 2e6", (10, 40), &["2e6 is out of range"]),
    ("optical_thickness = 2", "optical_thickness = 0", (10, 40), &["0 is out of range"]),
    ("anisotropy = 0.8", "anisotropy = 1", (10, 56), &["from -0.99 to 0.99"]),
    ("anisotropy = 0.8", "anisotropy = -1", (10, 56), &["from -0.99 to 0.99"]),
    ("albedo = 0.99", "albedo = 1.01", (10, 70), &["from 0 to 1", "not per cent"]),
    ("albedo = 0.99", "albedo = -0.1", (10, 70), &["from 0 to 1"]),
    ("index = 1.48", "index = 0.9", (10, 84), &["0.9 + 0i", "n from 1 to 10"]),
    ("index = 1.6", "index = 0.5", (9, 30), &["0.5 + 0i", "n from 1 to 10"]),
    ("alpha = 0.3", "alpha = 0.0009", (6, 29), &["from 0.001 to 1 (roughness)"]),
    ("alpha = 0.3", "alpha = 1.1", (6, 29), &["from 0.001 to 1 (roughness)"]),
    ("thickness_mm = 0.7", "thickness_mm = 0", (5, 68), &["above 0, at most 1000 (mm)"]),
    ("thickness_mm = 0.7", "thickness_mm = 1001", (5, 68), &["above 0, at most 1000 (mm)"]),
    ("internal_transmittance = 0.9", "internal_transmittance = 90", (9, 60), &["not per cent"]),
    ("reflectance = 0.005", "reflectance = 0.995", (3, 3), &["sum to 1.005"]),
    ("thickness_nm = 90", "thickness_nm = -90", (4, 67), &["from 0 to 1e6 (nm)"]),
    // Keys and kinds.
    (
        "kind = \"rough\", ",
        "",
        (6, 3),
        &["the key `kind` is missing", "\"medium\" or \"slab\" or \"diffuser\""],
    ),
    ("\"rough\"", "\"ruogh\"", (6, 12), &["did you mean `rough`?"]),
    ("alpha = 0.3", "", (6, 3), &["the key `alpha` is missing"]),
    (
        "alpha = 0.3",
        "alpha = 0.3, distribution = \"gauss\"",
        (6, 49),
        &["`gauss` is not one of the choices", "expected \"ggx\" or \"beckmann\" or \"student-t\""],
    ),
    (
        "alpha = 0.3",
        "alpha = 0.3, distribution = \"student-t\"",
        (6, 3),
        &["the key `tail` is missing", "from 2"],
    ),
    ("alpha = 0.3", "alpha = 0.3, tail = 3", (6, 41), &["`tail` describes slopes", "\"student-t\""]),
    ("alpha = 0.3", "alpha = 0.3, slope_kurtosis = 6", (6, 51), &["`slope_kurtosis` describes slopes"]),
    (
        "alpha = 0.3",
        "alpha = 0.3, distribution = \"student-t\", slope_kurtosis = 3",
        (6, 79),
        &["Gaussian: distribution = \"beckmann\""],
    ),
    (
        "alpha = 0.3",
        "alpha = 0.3, distribution = \"student-t\", tail = 1.9",
        (6, 69),
        &["1.9 is out of range", "from 2 to 100"],
    ),
    ("alpha = 0.3", "alpha = 0.3, slope_mean = 0.1", (6, 3), &["more than one of `alpha`, `slope_mean`"]),
    ("alpha = 0.3", "slope_rms = 0.1", (6, 33), &["these slopes have no root mean square", "`slope_mean`"]),
    ("alpha = 0.3", "slope_mean = 0.0005", (6, 34), &["this slope is a roughness alpha of 5.00e-4"]),
    (
        "alpha = 0.3",
        "alpha = 0.3, index = 1.5",
        (6, 42),
        &["`index` cannot be combined with kind = \"rough\"", "kind = \"medium\" and kind = \"slab\""],
    ),
    (
        "index = \"air\"",
        "index = \"air\", alpha = 0.1",
        (7, 45),
        &[
            "`alpha` cannot be combined with kind = \"medium\"",
            "a key of kind = \"diffuser\" and kind = \"rough\"",
        ],
    ),
    ("index = \"air\"", "inedx = \"air\"", (7, 22), &["no key `inedx`", "did you mean `index`?"]),
    (
        "{ kind = \"ideal-ar\" }",
        "{ kind = \"ideal-ar\", index = 1.3 }",
        (11, 32),
        &["`index` cannot be combined with kind = \"ideal-ar\""],
    ),
    ("{ kind = \"ideal-ar\" }", "\"coated\"", (11, 3), &["a string", "kind = \"ideal-ar\""]),
    ("optical_thickness = 2, ", "", (10, 3), &["the key `optical_thickness` is missing"]),
    ("anisotropy = 0.8, ", "", (10, 3), &["the key `anisotropy` is missing"]),
    ("width = 0.06, ", "", (8, 3), &["none of `haze` and `width`"]),
    (
        "width = 0.06, ",
        "optical_thickness = 1, ",
        (8, 69),
        &["`optical_thickness` cannot be combined with kind = \"diffuser\"", "a key of kind = \"slab\""],
    ),
    ("\"k-correlation\"", "\"slab\"", (8, 32), &["a slab is a layer of its own: kind = \"slab\""]),
    (
        "model = \"lambertian\", ",
        "model = \"lambertian\", haze = 0.5, ",
        (12, 53),
        &["`haze` cannot be combined with model = \"lambertian\""],
    ),
    ("film = [{ material = \"SiO2\", thickness_nm = 90 }]", "film = []", (4, 30), &["this list is empty"]),
    ("thickness_nm = 90", "thickness_nm = \"gap\"", (4, 67), &["a string", "expected a number from 0"]),
    // What does not fit together.
    (
        "index = 1.6, internal_transmittance = 0.9",
        "index = { n = 1.6, k = 1e-5 }",
        (9, 30),
        &["k below 1e-6", "specify `thickness_mm`"],
    ),
    ("k = 1e-7", "k = 2e-3", (5, 30), &["k below 1e-3"]),
    ("index = 1.6, internal_transmittance = 0.9", "index = \"Al\"", (9, 30), &["k below 1e-6"]),
    (
        "index = 1.48",
        "index = \"BK7\"",
        (10, 84),
        &["this refractive index is 1.511183 to 1.533745", "one real index", "at 550 nm as a number"],
    ),
    (
        "index = 1.48",
        "index = { n = 1.48, k = 1e-5 }",
        (10, 84),
        &["k up to 0.00001", "one real index", "1 - `albedo`"],
    ),
    ("index = \"air\"", "index = { n = 1.5 }", (6, 3), &["have the same index", "another index"]),
    (
        "index = \"air\"",
        "index = \"BK7\"",
        (6, 3),
        &["has an index of 1.51", "the same index at all wavelengths"],
    ),
    (
        "{ kind = \"coating\", film = [{ material = \"SiO2\", thickness_nm = 90 }] },\n",
        "",
        (3, 3),
        &["media of different index", "{ kind = \"fresnel\" }"],
    ),
    (
        "[display.pixel]",
        "[[display.front]]\n[display.pixel]",
        (17, 1),
        &["`front` cannot be combined with `layers`", "kind = \"component\""],
    ),
    (
        "[display.pixel]",
        "[display.glass]\n[display.pixel]",
        (17, 1),
        &["`glass` cannot be combined with `layers`", "kind = \"medium\""],
    ),
    (
        "[display.pixel]",
        "[display.diffuser]\nmodel = \"lambertian\"\ntransmittance = 1\n[display.pixel]",
        (17, 1),
        &["`diffuser` cannot be combined with `layers`", "kind = \"diffuser\""],
    ),
    (
        "[display.pixel]",
        "[solver]\nangle_medium = \"glass\"\n[display.pixel]",
        (18, 16),
        &["angle_medium = \"glass\" is for the ordinary panel only", "angle_medium = \"air\""],
    ),
    (
        "[display.pixel]",
        "[solver]\nangle_medium = \"unrefracted\"\n[display.pixel]",
        (18, 16),
        &["\"unrefracted\" is for the ordinary panel"],
    ),
    (
        "[display.pixel]",
        "[solver]\napproximation = \"single-pass\"\n[display.pixel]",
        (18, 17),
        &["\"single-pass\" is for the ordinary panel", "approximation = \"none\""],
    ),
];

/// Adding accepts any optical thickness, Monte Carlo at most 200. The error is at the thickness, or at the
/// `--set` that causes it.
#[test]
fn thick_slab_is_refused_for_monte_carlo() {
    let thick = changed_in(LAYERED, &[("optical_thickness = 2", "optical_thickness = 1000")]);
    let walked = format!("{thick}[solver]\nmethod = \"monte-carlo\"\n");
    let behind = changed(&[(
        "model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9",
        "model = \"slab\"\noptical_thickness = 1000\nanisotropy = 0",
    )]);
    let walk = "solver.method=monte-carlo";
    let cases = [
        (&walked, None, "test.toml", Some((10, 40))),
        (&thick, Some(walk), "--set #1", None),
        (&behind, Some(walk), "--set #1", None),
    ];
    for (text, set, name, place) in cases {
        let errors = resolve(text, Path::new(""), set.as_slice()).unwrap_err();
        let [error] = errors.iter().collect::<Vec<_>>()[..] else { panic!("{errors}") };
        let said = "the Monte Carlo solver would take hours with an optical thickness of 1000";
        assert_eq!(error.diagnostic.message, said);
        assert_eq!(
            error.diagnostic.expected.as_deref(),
            Some("expected at most 200 with method = \"monte-carlo\"")
        );
        assert_eq!(error.place.name, name);
        assert!(place.is_none() || error.place.line_column() == place, "{errors}");
        assert!(errors.to_string().contains("use method = \"adding\""), "{errors}");
    }
    for text in [&thick, &behind] {
        assert!(resolve(text, Path::new(""), &["solver.method=adding"]).is_ok());
    }
    assert!(resolve(LAYERED, Path::new(""), &[walk, "display.layers.7.optical_thickness=200"]).is_ok());
}

#[test]
fn mistakes_are_reported_at_their_places() {
    let mut wrong = Vec::new();
    for (from, to, place, says) in WRONG {
        let text = changed_in(LAYERED, &[(from, to)]);
        let Err(errors) = resolve(&text, Path::new(""), &[]) else {
            wrong.push(format!("{to}: no error"));
            continue;
        };
        let shown = errors.to_string();
        let at = errors.iter().next().and_then(|error| error.place.line_column());
        if errors.iter().count() != 1 || at != Some(*place) || !says.iter().all(|words| shown.contains(words))
        {
            wrong.push(format!("{to}: expected at {place:?}, {says:?}\n{shown}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn impossible_stacks_are_refused() {
    let problem = |layers: &str| {
        let errors = resolve(&pixel_under(layers), Path::new(""), &[]).unwrap_err();
        errors.iter().next().unwrap().diagnostic.message.clone()
    };
    assert_eq!(problem(""), "this list is empty");
    let many = "{ kind = \"ideal-ar\" }, ".repeat(65);
    assert_eq!(problem(&many), "these are 65 layers");
    assert!(resolve(&pixel_under(&many[..64 * 23]), Path::new(""), &[]).is_ok());
    // A rough face right above the pixel stands in one medium.
    let no_face = "the media on both sides of this interface have the same index";
    assert_eq!(problem("{ kind = \"medium\" }, { kind = \"rough\", alpha = 0.1 }"), no_face);
    assert_eq!(problem("{ kind = \"rough\", alpha = 0.1 }"), no_face);
    let films = "{ material = 1.4, thickness_nm = 1 }, ".repeat(250);
    let coatings = format!("{{ kind = \"coating\", film = [{films}] }}, ").repeat(10);
    assert!(problem(&coatings).ends_with(" coating films x wavelengths"));
}

#[test]
fn coating_without_medium_below_is_noted() {
    let coating = "{ kind = \"coating\", film = [{ material = \"MgF2\", thickness_nm = 100 }] }";
    let glass = "{ kind = \"medium\" }";
    let notes = |layers: &str| resolved(&pixel_under(layers), &[]).notes;
    let alone = notes(coating);
    assert!(
        alone[0].starts_with("display.layers.0: no medium follows this coating, so the air"),
        "{alone:?}"
    );
    let below = notes(&format!("{glass}, {coating}, {{ kind = \"ideal-ar\" }}"));
    assert!(below[0].contains("so the medium above it is on both sides"), "{below:?}");
    assert_eq!((alone.len(), below.len()), (1, 1));
    assert!(notes(&format!("{coating}, {glass}")).is_empty());
}

#[test]
fn rough_interface_with_beckmann_slopes_resolves() {
    for set in ["display.layers.3.distribution=beckmann", "display.layers.3.distribution='beckmann'"] {
        let resolved = resolved(LAYERED, &[set]);
        let Interface::Rough { alpha, distribution } = layers_of(&resolved)[2].interface else {
            panic!("not rough")
        };
        assert_eq!((alpha, distribution), (0.3, Distribution::Beckmann));
    }
}

/// alpha from what a profilometer prints: GGX has the mean slope alpha, Gaussian slopes have alpha/sqrt(pi) and
/// alpha/sqrt 2; Student's t with 4 degrees of freedom has twice the variance of its core, with 8 a kurtosis of
/// 4.5.
#[test]
fn roughness_follows_from_measured_slopes() {
    for (keys, alpha, distribution) in [
        ("slope_mean = 0.1", 0.1, Distribution::Ggx),
        ("slope_mean = 0.1, distribution = \"beckmann\"", 0.1 * PI.sqrt(), Distribution::Beckmann),
        ("slope_rms = 0.1, distribution = \"beckmann\"", 0.1 * SQRT_2, Distribution::Beckmann),
        (
            "slope_rms = 0.1, distribution = \"student-t\", tail = 3",
            0.1,
            Distribution::StudentT { tail: 3.0 },
        ),
        (
            "alpha = 0.2, distribution = \"student-t\", slope_kurtosis = 4.5",
            0.2,
            Distribution::StudentT { tail: 5.0 },
        ),
    ] {
        let resolved = resolved(&LAYERED.replace("alpha = 0.3", keys), &[]);
        let Interface::Rough { alpha: found, distribution: slopes } = layers_of(&resolved)[2].interface
        else {
            panic!("not rough")
        };
        assert!((found - alpha).abs() < 1e-12 && slopes == distribution, "{keys}: {found} {slopes:?}");
    }
}

/// The file alone is valid: the error is at the `--set`.
#[test]
fn mistakes_caused_by_set_are_reported_at_the_set() {
    let unrefracted = format!("{GOOD}[solver]\napproximation = \"unrefracted\"\n");
    let cases = [
        (LAYERED, "display.layers.3.kind=medium", "`alpha` cannot be combined"),
        (LAYERED, "display.layers.4.index=1.5", "the same index"),
        (LAYERED, "display.layers.13.index=1.5", "has the indices 0 to 11"),
        (LAYERED, "display.layers.12={ kind = \"rough\", alpha = 0.1 }", "the same index"),
        (LAYERED, "display.glass.index=1.5", "cannot be combined with `layers`"),
        (GOOD, "display.layers=[{ kind = \"medium\" }]", "`front` cannot be combined with `layers`"),
        (GOOD, "display.diffuser.model=slab", "`haze` cannot be combined with model = \"slab\""),
        (&unrefracted, "display.glass.internal_transmittance=0.5", "for the ordinary panel only"),
    ];
    for (text, set, says) in cases {
        let errors = resolve(text, Path::new(""), &[set]).unwrap_err();
        assert!(errors.to_string().contains(says), "{set}: {errors}");
        let elsewhere = errors.iter().find(|error| error.place.name != "--set #1");
        assert!(elsewhere.is_none(), "{set}: {elsewhere:#?}");
    }
}

/// The canonical form of every kind of layer is a scenario with the same hash.
#[test]
fn canonical_form_reads_back_with_the_same_hash() {
    let slab = changed(&[(
        "model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9",
        "model = \"slab\"\noptical_thickness = 1\nanisotropy = 0.9",
    )]);
    let particles =
        slab.replace("anisotropy = 0.9", "particles = { kind = \"mie\", radius_um = 1, index = 1.6 }");
    for text in [LAYERED, &slab, &particles] {
        let first = resolved(text, &[]);
        let mut canonical = first.canonical.clone();
        canonical.as_object_mut().unwrap().remove("inputs");
        let again = resolved(&toml::to_string(&canonical).unwrap(), &[]);
        assert_eq!(again.hash, first.hash);
        assert_ne!(resolved(text, &["viewer.theta_deg=5"]).hash, first.hash);
    }
    let kinds = &resolved(LAYERED, &[]).canonical["display"]["layers"];
    assert_eq!((&kinds[5]["kind"], &kinds[5]["model"]), (&"diffuser".into(), &"k-correlation".into()));
}

#[test]
fn pixel_table_below_layers_that_does_not_cover_the_light_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "white,0,380,0.5\nwhite,0,780,0.5\nwhite,42,380,0.5\nwhite,42,780,0.5\n";
    std::fs::write(
        folder.path().join("42.csv"),
        format!("state,theta_deg,wavelength_nm,reflectance\n{rows}"),
    )
    .unwrap();
    let pixel = "[display.pixel]\nmodel = \"table\"\nfile = \"42.csv\"\nangles = \"glass\"\n";
    let refused =
        |layers: &str| resolve(&format!("display.layers = [{layers}]\n{pixel}"), folder.path(), &[]).is_err();
    let glass = "{ kind = \"medium\", index = 1.5 }";
    assert!(!refused(glass));
    assert!(!refused(&format!(
        "{{ kind = \"diffuser\", model = \"lambertian\", transmittance = 1 }}, {glass}"
    )));
    for wide in [
        "{ kind = \"rough\", alpha = 0.1 }",
        "{ kind = \"slab\", optical_thickness = 1, anisotropy = 0 }",
        "{ kind = \"diffuser\", model = \"k-correlation\", width = 0.01, transmittance = 1 }",
    ] {
        assert!(refused(&format!("{wide}, {glass}")), "{wide}");
    }
}

/// A slab without faces is one of the index of air; an index beside it is refused at its place.
#[test]
fn slab_without_faces_is_one_in_air() {
    let of = |keys: &str| {
        let lobe = "model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9";
        let slab = format!("model = \"slab\"\noptical_thickness = 2\nanisotropy = 0\n{keys}");
        resolve(&changed(&[(lobe, &slab)]), Path::new(""), &[])
    };
    let layers = |keys: &str| of(keys).unwrap().scene.display;
    assert_eq!(layers("faces = false"), layers("index = 1.0"));
    assert_eq!(layers("faces = true"), layers("index = 1.5"));
    let wrong = of("index = 1.2\nfaces = false").unwrap_err().to_string();
    assert!(wrong.contains("test.toml:15:9") && wrong.contains("this one has none"), "{wrong}");
}
