//! `--set`, presets, defaults, the hash, and the forms of values.

use std::path::Path;

use crate::common::{GOOD, changed, resolve, shipped};
use papilio_display::scene::{Approximation, Drive, Lobe, Pixel, Ready, Sampler, Scene, Stop, Thickness};
use papilio_scenario::{
    Edit, Fit, Optimisation, ParameterisedScenario, Resolved, Sweep, Tolerance, edit, label, preset_names,
};

fn set(sets: &[&str]) -> Resolved {
    resolve(GOOD, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"))
}

fn film(scene: &Scene) -> &papilio_display::scene::FilmPixel {
    let Pixel::Film(film) = &scene.display.pixel else { panic!("not a film") };
    film
}

/// A preset in a table that is set has the same effect as in the file.
#[test]
fn preset_in_a_set_table_is_expanded() {
    let table = set(&["lighting={ preset = \"sunny\" }"]).scene.lighting;
    assert_eq!((table.illuminance_lx, table.diffuse, table.directed[0].theta_deg), (1e5, 0.2, -35.0));
    let with_own = set(&["lighting={ preset = \"sunny\", illuminance_lx = 7 }"]).scene.lighting;
    assert_eq!((with_own.illuminance_lx, with_own.diffuse), (7.0, 0.2));
}

#[test]
fn preset_without_effect_is_reported() {
    let warns = |text: &str, sets: &[&str]| {
        let resolved = resolve(text, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"));
        resolved
            .warnings
            .iter()
            .any(|warning| warning.contains("has no effect: the scenario sets all of its keys"))
    };
    let indoor = std::fs::read_to_string(shipped().join("indoor.toml")).unwrap();
    assert!(warns(&indoor, &["lighting.preset=sunny"]));
    assert!(!warns(&indoor, &[]));
    assert!(!warns(&indoor, &["lighting={ preset = \"sunny\" }"]));
}

#[test]
fn set_changes_and_creates_keys() {
    let resolved = set(&[
        "display.pixel.film.0.thickness_nm=7.5",
        "lighting.directed.0.theta_deg=-30",
        "display.pixel.states.orange={ red = 1, green = 0.5 }",
        "display.pixel.states.odd.blue.gap_nm=150",
        "viewer.theta_deg=[0, 20]",
        "viewer.phi_deg={ from = 0, to = 90, step = 45 }",
        "solver.seed = 7",
        "solver.sampler=random",
        "display.front.1.reflectance=0.02",
    ]);
    let scene = &resolved.scene;
    assert_eq!(film(scene).layers[0].thickness, Thickness::Fixed(7.5));
    assert_eq!(scene.lighting.directed[0].theta_deg, -30.0);
    let state =
        |name: &str| film(scene).states.iter().find(|state| state.name == name).unwrap().drives.clone();
    assert_eq!(state("orange"), [Drive::Share(1.0), Drive::Share(0.5), Drive::Share(0.0)]);
    assert_eq!(state("odd"), [Drive::Share(0.0), Drive::Share(0.0), Drive::Gap(150.0)]);
    assert_eq!(
        (&scene.viewer.theta_deg[..], &scene.viewer.phi_deg[..]),
        (&[0.0, 20.0][..], &[0.0, 45.0, 90.0][..])
    );
    assert_eq!((scene.solver.seed, scene.solver.sampler), (7, Sampler::Random));
    assert_eq!(
        (scene.display.panel().unwrap().front.len(), scene.display.panel().unwrap().front[1].reflectance[3]),
        (2, 0.02)
    );
}

/// A name with points, in quotes, is a single key wherever a scenario names keys by their paths. The place of
/// its value is what a path without quotes would also name, if "a" were a state.
#[test]
fn name_with_points_in_quotes_is_one_key_of_every_path() {
    const PATH: &str = "display.pixel.states.\"a.b\".blue.gap_nm";
    let text = format!("{GOOD}[display.pixel.states]\n\"a.b\" = {{ blue = {{ gap_nm = 150 }} }}\n");
    let gap = |scene: &Scene| {
        let states = &film(scene).states;
        assert!(states.iter().all(|state| !["a", "\"a.b\""].contains(&&*state.name)), "{states:?}");
        states.iter().find(|state| state.name == "a.b").unwrap().drives[2]
    };
    let folder = Path::new("");
    let at = |nm: f64| Drive::Gap(nm);
    assert_eq!(gap(&resolve(&text, folder, &[]).unwrap().scene), at(150.0));
    for path in [PATH.to_owned(), PATH.replace('"', "'"), PATH.replace('.', " . ").replace("a . b", "a.b")] {
        assert_eq!(
            gap(&resolve(&text, folder, &[&format!("{path}=140")]).unwrap().scene),
            at(140.0),
            "{path}"
        );
    }
    // Edits of the text, as of the page and of Python.
    let edits = [Edit::of_set(&format!("{PATH} = 141")).unwrap()];
    assert_eq!(gap(&resolve(&edit(&text, &edits).unwrap(), folder, &[]).unwrap().scene), at(141.0));
    // Axes of a sweep, from the command line and as both forms of a key in the file.
    let axes = [
        (String::new(), vec![Sweep::axis_override(&format!("{PATH}=130,142"))]),
        (format!("[[sweep.axes]]\n'{PATH}' = [130, 142]\n"), Vec::new()),
        (format!("[[sweep.axes]]\n{PATH} = [130, 142]\n"), Vec::new()),
    ];
    for (more, overrides) in axes {
        let sweep = Sweep::from_text(&format!("{text}{more}"), "s.toml", folder, &overrides).unwrap();
        let scene = sweep.scenario(1).unwrap().resolve().unwrap().scene;
        assert_eq!((sweep.len(), gap(&scene)), (2, at(142.0)), "{more}");
    }
    // Variables of batches, and the paths of studies, which are followed to a value of their own.
    let varied = [PATH.to_owned()];
    let varied = ParameterisedScenario::from_text(&text, "s.toml", folder, &[], &varied).unwrap();
    assert_eq!(gap(&varied.scenario(&[143.into()]).unwrap().resolve().unwrap().scene), at(143.0));
    let studies = [
        format!(
            "[[optimize.variables]]\nkey = '{PATH}'\nbounds = [100, 200]\n[[optimize.objectives]]\nmetric = \"a.b.Y\"\naim = \"maximise\"\n"
        ),
        format!(
            "[tolerance]\nmetrics = [\"a.b.Y\"]\n[[tolerance.keys]]\nkey = '{PATH}'\nnormal = {{ sigma = 2 }}\n"
        ),
        format!("[[fit.variables]]\nkey = '{PATH}'\nbounds = [100, 200]\n"),
    ];
    let [search, tolerance, fit] = studies.map(|study| format!("{text}{study}"));
    let search = Optimisation::from_text(&search, "s.toml", folder, &[]).unwrap();
    assert_eq!((search.variables[0].own, &*search.variables[0].values(9.0)[0].0), (Some(150.0), PATH));
    assert_eq!(Tolerance::from_text(&tolerance, "s.toml", folder, &[]).unwrap().keys[0].paths[0].0, PATH);
    assert_eq!(Fit::from_text(&fit, "s.toml", folder, &[]).unwrap().variables[0].paths().last(), Some(PATH));
    // Choices are values, which nothing multiplies.
    let chosen =
        tolerance.replace("normal = { sigma = 2 }", "relative = true\nchoices = { values = [0.9, 1.1] }");
    let errors = Tolerance::from_text(&chosen, "s.toml", folder, &[]).unwrap_err().to_string();
    assert!(errors.contains("relative = true") && errors.contains("cannot be combined"), "{errors}");
    // What a message names is read as the same key.
    let errors = resolve(&text, folder, &[&format!("{PATH}=-1")]).unwrap_err();
    let wrong = text.replace("gap_nm = 150", "gap_nm = -1");
    let there = resolve(&wrong, folder, &[]).unwrap_err();
    for errors in [errors, there] {
        let all: Vec<_> = errors.iter().map(|error| error.path.as_deref()).collect();
        assert_eq!(all, [Some(PATH)], "{errors}");
    }
    assert_eq!(label(PATH).to_string(), "Gap of blue of a.b (nm)");
}

/// n and k of a material times factors, which a fit can determine; without factors it is the material.
#[test]
fn factors_multiply_n_and_k_of_a_material() {
    let index = |value: &str| {
        let set = set(&[&format!("display.pixel.film.0.material={value}")]);
        film(&set.scene).layers[0].index.clone()
    };
    let plain = index("Cr:Johnson");
    assert_eq!(index("{ material = \"Cr:Johnson\" }"), plain);
    let scaled = index("{ material = \"Cr:Johnson\", n_scale = 1.1, k_scale = 0.5 }");
    for (scaled, plain) in scaled.iter().zip(&plain) {
        assert!((scaled.re / plain.re - 1.1).abs() < 1e-12 && (scaled.im / plain.im - 0.5).abs() < 1e-12);
    }
    let constant = index("{ n = 2, k = 1, k_scale = 3 }");
    assert!(constant.iter().all(|index| (index.re, index.im) == (2.0, 3.0)));
}

/// Models of dispersion by their parameters, wherever a material is: those of named materials.
#[test]
fn models_of_dispersion_are_materials() {
    let index = |value: &str| {
        let set = set(&[&format!("display.pixel.film.0.material={value}")]);
        film(&set.scene).layers[0].index.clone()
    };
    let close = |model: &str, named: &str| {
        for (model, named) in index(model).iter().zip(index(named)) {
            assert!((model - named).norm() < 1e-9, "{model} {named}");
        }
    };
    let silica = "{ model = \"sellmeier\", terms = [{ b = 0.6961663, resonance_nm = 68.4043 }, \
         { b = 0.4079426, resonance_nm = 116.2414 }, { b = 0.8974794, resonance_nm = 9896.161 }] }";
    close(silica, "\"SiO2\"");
    close("{ model = \"cauchy\", a = 1.64 }", "\"AlOx\"");
    close("{ model = \"cauchy\", a = 2, k = 0.1 }", "{ n = 2, k = 0.1 }");
    close("{ model = \"oscillators\", eps_inf = 4, terms = [] }", "2");
    let set = set(&[
        "display.pixel.substrate={ model = \"oscillators\", eps_inf = 1.15, terms = [{ kind = \"tauc-lorentz\", \
         amplitude_ev = 122, energy_ev = 3.45, damping_ev = 2.54, gap_ev = 1.2 }] }",
        "display.pixel.substrate.terms.0.gap_ev=1.3",
    ]);
    let film = film(&set.scene);
    assert_eq!(film.materials.last().unwrap(), "model = \"oscillators\"");
    assert!(film.substrate.iter().all(|index| index.re > 3.0 && index.im > 0.1));
}

#[test]
fn set_accepts_numbers_without_leading_zero() {
    let straight = |value: &str| {
        let resolved =
            set(&["display.diffuser.haze=.5", &format!("display.diffuser.regular_fraction={value}")]);
        resolved.scene.display.panel().unwrap().diffuser().unwrap().clone().regular_fraction
    };
    for (value, expected) in [(".25", 0.25), (" +.25", 0.25), ("2.5e-1", 0.25), ("0.", 0.0), ("00.25", 0.25)]
    {
        assert_eq!(straight(value), expected, "{value}");
    }
    // Words remain words.
    assert_eq!(set(&["title=infinity"]).title.as_deref(), Some("infinity"));
}

/// A key that is set replaces the key of the file that it excludes, but not that of another `--set`.
#[test]
fn exclusive_keys_of_two_sets_are_refused_in_both_orders() {
    let sets = ["solver.relative_error=0.1", "solver.paths=100"];
    let rivals = [["display.diffuser.haze=0.5", "display.diffuser.width=0.1"], sets];
    let walk = format!("{GOOD}[solver]\nmethod = \"monte-carlo\"\n");
    for text in [walk.clone(), format!("{walk}paths = 64\n")] {
        for [a, b] in rivals {
            assert!(
                resolve(&text, Path::new(""), &[a]).is_ok() && resolve(&text, Path::new(""), &[b]).is_ok()
            );
            for both in [[a, b], [b, a]] {
                let wrong = resolve(&text, Path::new(""), &both).unwrap_err().to_string();
                assert!(wrong.contains("more than one of") && wrong.contains("--> --set"), "{wrong}");
            }
        }
    }
}

#[test]
fn last_set_takes_precedence() {
    assert_eq!(set(&["viewer.theta_deg=1", "viewer.theta_deg=2"]).scene.viewer.theta_deg, [2.0]);
}

const BARE: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.5, black = 0 }\n";

#[test]
fn defaults() {
    let resolved = resolve(BARE, Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    let scene = &resolved.scene;
    assert_eq!((scene.grid.start_nm(), scene.grid.stop_nm(), scene.grid.step_nm()), (380.0, 780.0, 5.0));
    assert_eq!(
        (scene.display.index_above_pixel()[0], scene.display.panel().unwrap().face),
        (1.5, &Ready::IdealAr)
    );
    assert!(
        scene.display.panel().unwrap().diffuser().is_none()
            && scene.display.panel().unwrap().front.is_empty()
    );
    assert_eq!((scene.lighting.illuminance_lx, scene.lighting.diffuse), (500.0, 1.0));
    assert_eq!((&scene.viewer.theta_deg[..], &scene.viewer.phi_deg[..]), (&[0.0][..], &[0.0][..]));
    assert_eq!((scene.viewer.field_deg, scene.viewer.distance_mm), (0.1, 500.0));
    assert_eq!(scene.solver.stop, Stop::RelativeError { target: 0.001, per_wavelength: false });
    assert_eq!((scene.solver.seed, scene.solver.sampler), (0, Sampler::Sobol));
    assert_eq!(scene.solver.approximation, Approximation::None);
    assert!(resolved.warnings.is_empty(), "{:?}", resolved.warnings);
}

/// Kubota et al. 2006, as cited by Feng 2012.
#[test]
fn presets_fill_lighting_and_viewer_and_keys_override_them() {
    let preset = |name: &str, more: &str, sets: &[&str]| {
        let text = format!("{BARE}[lighting]\npreset = \"{name}\"\n{more}");
        resolve(&text, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}")).scene
    };
    let seen = |scene: &Scene| {
        let directed = scene.lighting.directed.first().map(|source| (source.theta_deg, source.share));
        (scene.lighting.diffuse, directed, scene.viewer.theta_deg[0])
    };
    assert_eq!(seen(&preset("indoor", "", &[])), (0.5, Some((-20.0, 0.5)), 8.0));
    assert_eq!(seen(&preset("sunny", "", &[])), (0.2, Some((-35.0, 0.8)), 20.0));
    assert_eq!(seen(&preset("overcast", "", &[])), (1.0, None, 8.0));
    let names = [
        "indoor",
        "sunny",
        "overcast",
        "living-room",
        "office",
        "daylight",
        "full-sun",
        "daylight-readability",
        "iec-directional",
        "iec-ring",
        "iec-hemispherical",
        "d8-included",
        "d8-excluded",
        "45-0",
        "30-0",
    ];
    assert_eq!(preset_names().collect::<Vec<_>>(), names);
    assert_eq!(seen(&preset("iec-directional", "", &[])), (0.0, Some((-40.0, 1.0)), 30.0));
    assert_eq!(seen(&preset("45-0", "", &[])), (0.0, Some((45.0, 1.0)), 0.0));

    let scene = preset(
        "indoor",
        "illuminance_lx = 40\n[viewer]\nfield_deg = 2\n",
        &["lighting.directed.0.theta_deg=-45"],
    );
    assert_eq!((scene.lighting.illuminance_lx, scene.viewer.field_deg), (40.0, 2.0));
    assert_eq!(seen(&scene), (0.5, Some((-45.0, 0.5)), 8.0));
    // The preset itself can be set, before or after other keys.
    let scene = preset("indoor", "", &["viewer.theta_deg=3", "lighting.preset=sunny"]);
    assert_eq!(seen(&scene), (0.2, Some((-35.0, 0.8)), 3.0));
    // What the preset gives must still make sense with what is overridden.
    let text = format!("{BARE}[lighting]\npreset = \"indoor\"\ndiffuse = 0.3\n");
    let errors = resolve(&text, Path::new(""), &[]).unwrap_err();
    assert_eq!(errors.iter().next().unwrap().place.line_column(), Some((7, 11)));
}

/// K-correlation lobe truncated at the hemisphere: T = TIS/(1 - b/sqrt(1 + b^2)); with a regular fraction
/// only the rest is truncated.
#[test]
fn transmittances_of_a_diffuser_are_consistent() {
    let diffuser = |sets: &[&str]| {
        let more = ["display.diffuser={ model = \"k-correlation\", width = 0.1, total_transmittance = 0.8 }"];
        set(&[&more[..], sets].concat()).scene.display.panel().unwrap().diffuser().unwrap().clone()
    };
    let share = 1.0 - 0.1 / 1.01_f64.sqrt();
    assert!((diffuser(&[]).transmittance[0] - 0.8 / share).abs() < 1e-12);
    let half = diffuser(&["display.diffuser.regular_fraction=0.5"]);
    assert!((half.transmittance[0] - 0.8 / (0.5 * share + 0.5)).abs() < 1e-12);
    let lambertian = set(&["display.diffuser={ model = \"lambertian\", total_transmittance = 0.8 }"]);
    let lambertian = lambertian.scene.display.panel().unwrap().diffuser().unwrap().clone();
    assert_eq!((lambertian.lobe, lambertian.transmittance[0]), (Lobe::Lambertian, 0.8));
}

#[test]
fn lights_by_name_model_and_sum_resolve() {
    let light = |value: &str| set(&[&format!("lighting.spectrum={value}")]).scene.lighting.diffuse_spectrum;
    let led = light("{ led_nm = 550, width_nm = 30 }");
    assert!((led[15] - 1.0).abs() < 1e-12);
    let mixed = light("[{ led_nm = 550, width_nm = 30 }, { led_nm = 550, width_nm = 30, weight = 0.5 }]");
    assert!((mixed[15] - 1.5).abs() < 1e-12);
    assert!((light("{ daylight_K = 6504 }")[16] - 1.0).abs() < 1e-12);
    assert!((light("{ planck_K = 2856 }")[16] - 1.0).abs() < 1e-12);
    assert!(light("A")[30] > light("A")[0]);
}

#[test]
fn areas_with_a_small_deviation_are_used_and_reported() {
    let resolved = resolve(&changed(&[("red = 0.5", "red = 0.4996")]), Path::new(""), &[]).unwrap();
    assert!(
        resolved.warnings.iter().any(|warning| warning.contains("sum to 0.9996")),
        "{:?}",
        resolved.warnings
    );
    assert_eq!(film(&resolved.scene).sub_pixels[0].area, 0.4996);
}

#[test]
fn states_replace_default_states_of_their_name() {
    let states = |sets: &[&str]| -> Vec<String> {
        film(&set(sets).scene).states.iter().map(|state| state.name.clone()).collect()
    };
    assert_eq!(states(&["display.pixel.states.white.red=1"]).len(), 8);
    let own = ["display.pixel.default_states=false", "display.pixel.states.on={ red = 1 }"];
    assert_eq!(states(&own), ["on"]);
    let none = resolve(GOOD, Path::new(""), &own[..1]).unwrap_err();
    assert!(none.to_string().contains("no states"));
}

#[test]
fn hash_changes_only_with_the_computation() {
    let hash = |text: &str| resolve(text, Path::new(""), &[]).unwrap().hash;
    let good = hash(GOOD);
    assert_eq!(good.len(), 64);
    // Spelling, comments, order and spelt-out defaults do not matter.
    let same = [
        changed(&[("haze = 0.78", "haze = 7.8e-1  # a comment")]),
        changed(&[("theta_deg = 8", "field_deg = 0.1\ntheta_deg = 8.0")]),
        changed(&[("[viewer]", "[solver]\nmethod = \"adding\"\n[viewer]")]),
        GOOD.replace('\n', "\r\n"),
        format!("\u{feff}{GOOD}"),
    ];
    for text in same {
        assert_eq!(hash(&text), good, "{text}");
    }
    // Any number does.
    for (from, to) in
        [("12", "12.0001"), ("0.78", "0.79"), ("\"Al\"", "\"Ag\""), ("500", "501"), ("\"Test\"", "\"Text\"")]
    {
        assert_ne!(hash(&changed(&[(from, to)])), good);
    }
}

#[test]
fn hash_depends_on_bytes_of_files_and_not_on_their_folder() {
    let at = |value: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("r.csv"), format!("380,{value}\n780,0.1\n")).unwrap();
        resolve(&changed(&[("reflectance = 0.01", "reflectance = \"r.csv\"")]), folder.path(), &[]).unwrap()
    };
    assert_eq!(at("0.1").hash, at("0.1").hash);
    assert_ne!(at("0.1").hash, at("0.10").hash);
    assert!(at("0.1").canonical["inputs"]["r.csv"].as_str().is_some_and(|digest| digest.len() == 64));
}

/// A preset and its keys written out are the same scenario.
#[test]
fn canonical_form_of_a_preset_is_that_of_its_keys() {
    let preset = format!("{BARE}[lighting]\npreset = \"overcast\"\n");
    let spelt = format!("{BARE}[lighting]\nilluminance_lx = 1e4\n[viewer]\ntheta_deg = 8\n");
    let hash = |text: &str| resolve(text, Path::new(""), &[]).unwrap().hash;
    assert_eq!(hash(&preset), hash(&spelt));
}

#[test]
fn paths_of_files_are_relative_to_the_scenario() {
    let path = shipped().join("table-pixel.toml");
    let resolved = papilio_scenario::Scenario::load(&path, &[]).unwrap().resolve().unwrap();
    let Pixel::Table(table) = &resolved.scene.display.pixel else { panic!("not a table") };
    assert_eq!((table.theta_deg.len(), table.states.len()), (10, 3));
    // Red at normal and 780 nm: 0.02 + 0.4/(1 + exp(-(780 - 590)/12)).
    assert!((table.states[2].reflectance[0][80] - 0.42).abs() < 1e-5);
}
