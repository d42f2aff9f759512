//! Compares `web/openapi.json`, from which the types of the page are generated, with the code.

use papilio_web::openapi;

/// The environment variable with which the test writes the file.
const REWRITE: &str = "PAPILIO_REWRITE";

#[test]
fn openapi_json_equals_the_description_of_the_code() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    let described = serde_json::to_string_pretty(&openapi()).unwrap() + "\n";
    if std::env::var_os(REWRITE).is_some() {
        std::fs::write(path, &described).unwrap();
    }
    let stored = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        stored.lines().eq(described.lines()),
        "web/openapi.json is out of date; update it with {REWRITE}=1 cargo test --workspace --test site openapi"
    );
}

/// The page selects fields by the names of types in the schema: a type that is renamed must be renamed there,
/// too.
#[test]
fn names_of_types_in_the_page_are_those_of_the_schema() {
    let fields = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("page/src/fields");
    let known = [papilio_scenario::schema(), papilio_scenario::surface_schema()];
    let mut count = 0;
    for file in std::fs::read_dir(fields).unwrap().map(|entry| entry.unwrap().path()) {
        let text = std::fs::read_to_string(&file).unwrap();
        for name in text.split("def === \"").skip(1).filter_map(|rest| rest.split('"').next()) {
            count += 1;
            let is_known = known.iter().any(|schema| schema["$defs"].get(name).is_some());
            assert!(is_known, "{}: the schema has no type {name}", file.display());
        }
    }
    assert!(count >= 9, "{count}");
}
