//! `web/openapi.json`, from which the page's types are made, is what the code describes.

use papilio_web::openapi;

/// Set, it writes the file anew.
const REWRITE: &str = "PAPILIO_REWRITE";

#[test]
fn openapi_json_is_what_the_code_describes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
    let described = serde_json::to_string_pretty(&openapi()).unwrap() + "\n";
    if std::env::var_os(REWRITE).is_some() {
        std::fs::write(path, &described).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        kept.lines().eq(described.lines()),
        "web/openapi.json is behind the code: {REWRITE}=1 cargo test --workspace --test site openapi"
    );
}
