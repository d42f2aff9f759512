//! An empty folder outside the repository, in which a package is installed and run without Rust.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, Outcome};

/// An empty folder of the system's temporary files, removed at the end.
pub(super) struct Sandbox {
    folder: PathBuf,
}

impl Sandbox {
    pub(super) fn new(name: &str) -> Result<Self, String> {
        let folder = std::env::temp_dir().join(format!("papilio-{name}-{}", std::process::id()));
        let sandbox = Self { folder };
        fs::create_dir(&sandbox.folder).map_err(|error| format!("{}: {error}", sandbox.folder.display()))?;
        Ok(sandbox)
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// A command that runs in the folder with no variables of this environment, so that it finds neither Rust
    /// nor this repository.
    pub(super) fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.env_clear().current_dir(&self.folder);
        // Windows programs do not start without the first; the certificates are for pip.
        for name in ["SYSTEMROOT", "TEMP", "TMP", "SSL_CERT_FILE", "PIP_CONFIG_FILE", "PIP_INDEX_URL"] {
            std::env::var_os(name).map(|value| command.env(name, value));
        }
        command
    }

    /// A command that sees nothing but a folder in this one, as the root of its files. `None` where the
    /// system does not allow it: on Linux, root may (`chroot`), and others where they may create user
    /// namespaces (`unshare`).
    pub(super) fn in_empty_root(&self, root: &Path, program: &str) -> Option<Command> {
        if !cfg!(target_os = "linux") {
            return None;
        }
        let arguments: [&[&OsStr]; 2] = [
            &["chroot".as_ref(), root.as_os_str()],
            &["unshare".as_ref(), "--map-root-user".as_ref(), "chroot".as_ref(), root.as_os_str()],
        ];
        arguments.into_iter().find_map(|words| {
            let wrapped = || {
                let mut command = self.command(words[0]);
                command.env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin").args(&words[1..]).arg(program);
                command
            };
            let mut version = wrapped();
            version.arg("--version");
            shell::run_apart(version).outcome.is_ok().then(wrapped)
        })
    }

    /// Unpacks an archive here.
    pub(super) fn unpack(&self, archive: &Path) -> Outcome {
        let mut tar = Command::new(tar());
        tar.arg("-xf").arg(archive).arg("-C").arg(&self.folder);
        shell::run(tar)
    }
}

/// The program `tar`; that of Windows, which knows zip files, and not another one of its path.
pub(super) fn tar() -> PathBuf {
    let system = std::env::var_os("SYSTEMROOT").filter(|_| cfg!(windows));
    system.map_or_else(|| PathBuf::from("tar"), |root| Path::new(&root).join("System32").join("tar.exe"))
}

impl Drop for Sandbox {
    fn drop(&mut self) {
        // Left in the folder of temporary files if it cannot be removed.
        let _ = fs::remove_dir_all(&self.folder);
    }
}
