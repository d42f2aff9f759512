//! The manifests of the workspace, as cargo reads them.

use std::path::PathBuf;
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

use crate::root;

/// A package of the workspace.
pub(crate) struct Manifest {
    pub(crate) name: String,
    /// Folder of the package.
    pub(crate) folder: PathBuf,
    /// What `cargo metadata` says of it.
    pub(crate) about: Value,
}

impl Manifest {
    /// True if it can be published.
    pub(crate) fn is_public(&self) -> bool {
        self.about["publish"].is_null()
    }

    /// A list of texts, for example `keywords`.
    pub(crate) fn list(&self, key: &str) -> Vec<&str> {
        self.about[key].as_array().unwrap().iter().map(|item| item.as_str().unwrap()).collect()
    }
}

/// All packages that are compiled, those of others too, as `cargo metadata` describes them.
pub(crate) static METADATA: LazyLock<Value> = LazyLock::new(|| {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version", "1", "--offline"]).current_dir(root());
    let output = cargo.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
});

/// The packages of the workspace.
pub(crate) fn all() -> Vec<Manifest> {
    let packages = METADATA["packages"].as_array().unwrap();
    let own = packages.iter().filter(|package| package["source"].is_null()).map(|about| Manifest {
        name: about["name"].as_str().unwrap().to_owned(),
        folder: PathBuf::from(about["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned(),
        about: about.clone(),
    });
    own.collect()
}

/// The packages that can be published.
pub(crate) fn public() -> Vec<Manifest> {
    all().into_iter().filter(Manifest::is_public).collect()
}
