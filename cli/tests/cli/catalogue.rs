//! `papilio materials` and `papilio illuminants`.

use std::fs;

use crate::common::{names, papilio, papilio_command, stderr, stdout};

#[test]
fn lists_have_all_names_as_text_json_and_csv() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, first, words) in [
        ("materials", "a-Si", ["TiO2", "Cr:Johnson", "PMMA", "437 to 1052", "2.4360"]),
        ("illuminants", "A", ["FL3.15", "LED-RGB1", "0.3127", "6504", "83"]),
    ] {
        let text = stdout(&papilio(&[kind]));
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
        let json: serde_json::Value = serde_json::from_str(&stdout(&papilio(&[kind, "--json"]))).unwrap();
        let all = json[kind].as_array().unwrap();
        assert_eq!((all[0]["name"].as_str(), all.len() > 45), (Some(first), true));
        let out = folder.path().join(kind);
        assert!(papilio(&[kind, "--out", out.to_str().unwrap()]).status.success());
        let table = fs::read_to_string(out.join(format!("{kind}.csv"))).unwrap();
        assert_eq!(table.lines().count(), all.len() + 1);
    }
}

#[test]
fn one_name_has_a_sheet_a_table_and_a_figure() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = papilio_command().args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    let text = run(&["materials", "tio2"]);
    assert!(
        text.contains("main/TiO2/Siefke") && text.contains("CC0") && text.contains("other data: TiO2:Franta")
    );
    run(&["materials", "a-Si:H"]);
    let text = run(&["illuminants", "TL84"]);
    assert!(
        text.contains("FL11: fluorescent") && text.contains("4001 K") && text.contains("Ra 82.9"),
        "{text}"
    );
    assert_eq!(
        names(&folder.path().join("out/materials")),
        ["TiO2.csv", "TiO2.svg", "a-Si-H.csv", "a-Si-H.svg"]
    );
    assert_eq!(names(&folder.path().join("out/illuminants")), ["FL11.csv", "FL11.svg"]);
    let table = fs::read_to_string(folder.path().join("out/materials/TiO2.csv")).unwrap();
    assert!(table.starts_with("wavelength_nm,n,k\n300,"), "{table}");
    // The files can be used as a material and as a spectrum of light.
    let json: serde_json::Value = serde_json::from_str(&run(&["materials", "PMMA", "--json"])).unwrap();
    assert_eq!(json["measured_nm"], serde_json::json!([436.8, 1052.0]));
    assert_eq!(json["n"].as_array().unwrap().len(), json["wavelength_nm"].as_array().unwrap().len());
}

#[test]
fn words_list_materials_and_unknown_names_are_answered() {
    let text = stdout(&papilio(&["materials", "Aluminium"]));
    assert!(text.contains("Al:McPeak") && !text.contains("SiO2"), "{text}");
    let wrong = |arguments: &[&str], hint: &str| {
        let output = papilio(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(hint) && output.stdout.is_empty(), "{}", stderr(&output));
    };
    let text = stdout(&papilio(&["materials", "MoCr"]));
    assert!(text.contains("Mo ") && text.contains("Cr:Sytchkova"), "{text}");
    let text = stdout(&papilio(&["illuminants", "fluorescent"]));
    assert!(text.contains("FL3.15") && !text.contains("LED-B1"), "{text}");
    assert!(stderr(&papilio(&["illuminants", "TL84", "--json"])).contains("TL84 is taken as FL11"));
    wrong(&["materials", "kryptonite"], "names are listed by `papilio materials`");
    wrong(&["illuminants", "D93"], "{ daylight_K = 9305 }");
    wrong(&["illuminants", "FL13"], "did you mean");
}

/// The liquid crystals of cells, with the indices of the published formula n = A + B/l^2 + C/l^4 at 0.55 um.
#[test]
fn materials_list_the_liquid_crystals() {
    let square = 0.55_f64.powi(-2);
    let n = |[a, b, c]: [f64; 3]| format!("{:.4}", a + b * square + c * square * square);
    let (n_o, n_e) = (n([1.4990, 0.0072, 0.0003]), n([1.6933, 0.0078, 0.0028]));
    for arguments in [&["materials"][..], &["materials", "e7"], &["materials", "nematic"]] {
        let text = stdout(&papilio(arguments));
        let row = text.lines().find(|line| line.starts_with("E7 ")).unwrap();
        assert!(row.contains(&n_o) && row.contains(&n_e) && row.contains("J. Disp. Technol."), "{row}");
    }
    let json: serde_json::Value = serde_json::from_str(&stdout(&papilio(&["materials", "--json"]))).unwrap();
    assert_eq!(json["liquid_crystals"].as_array().unwrap().len(), 3);
}
