//! Has cargo notice a page that was built anew.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The chores of the project set it to another value for another page; without a page there is nothing to watch.
    println!("cargo:rerun-if-env-changed=PAPILIO_PAGE");
    if std::path::Path::new("page/dist").is_dir() {
        println!("cargo:rerun-if-changed=page/dist");
    }
}
