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
