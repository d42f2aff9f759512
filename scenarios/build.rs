//! Compiles this crate again when an example changes, or a new one is added.

fn main() {
    for folder in ["scenarios", "surfaces"] {
        println!("cargo::rerun-if-changed={folder}");
    }
}
