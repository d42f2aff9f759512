//! Makes cargo rebuild the program if the page was rebuilt.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // `cargo xtask` sets this to another value for each page that it builds; without a page there is nothing
    // to watch.
    println!("cargo:rerun-if-env-changed=PAPILIO_PAGE");
    if std::path::Path::new("page/dist").is_dir() {
        println!("cargo:rerun-if-changed=page/dist");
    }
}
