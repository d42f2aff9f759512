//! Destinations of links, in the repository and in the site.

use std::fmt::Write as _;

use papilio_diagnostics::Diagnostic;

/// What a link refers to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Destination {
    /// A page of the web, which is not requested.
    Web,
    /// A file or folder of the repository, and an anchor there.
    Local {
        /// Path in the repository, with `/`, without `.` and `..`; "" is the repository itself.
        path: String,
        /// The part after `#`, if there is one.
        anchor: Option<String>,
    },
}

impl Destination {
    /// Reads a link of the page `source`, a path in the repository.
    pub(crate) fn read(source: &str, link: &str) -> Result<Self, Diagnostic> {
        if let Some((scheme, _)) = link.split_once(':').filter(|(scheme, _)| is_scheme(scheme)) {
            return match scheme {
                "http" | "https" | "mailto" => Ok(Self::Web),
                _ => Err(Diagnostic::new(format!("links cannot begin with `{scheme}:`"))
                    .expected("a path relative to the page, or a page of the web")),
            };
        }
        if link.starts_with('/') || link.contains('\\') {
            return Err(Diagnostic::new("this is no path relative to the page")
                .expected("a path like `films.md#materials` or `../scenarios/indoor.toml`"));
        }
        let (path, anchor) = match link.split_once('#') {
            Some((path, anchor)) => (path, Some(decoded(anchor))),
            None => (link, None),
        };
        let path = if path.is_empty() { source.to_owned() } else { joined(folder(source), &decoded(path))? };
        Ok(Self::Local { path, anchor })
    }
}

fn is_scheme(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

/// Folder of a path; "" for a path without folder.
pub(crate) fn folder(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Path of a file relative to a folder of the repository.
fn joined(folder: &str, path: &str) -> Result<String, Diagnostic> {
    let mut all: Vec<&str> = folder.split('/').filter(|name| !name.is_empty()).collect();
    for name in path.split('/') {
        match name {
            "" | "." => {}
            ".." => {
                all.pop().ok_or_else(|| Diagnostic::new("this path leaves the repository"))?;
            }
            _ => all.push(name),
        }
    }
    Ok(all.join("/"))
}

/// A text without its `%20`s.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let digits =
            after.get(..2).filter(|_| *first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        match digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => (bytes.push(byte), rest = &after[2..]).1,
            None => (bytes.push(*first), rest = after).1,
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A path as part of a URL.
pub(crate) fn encoded(path: &str) -> String {
    let mut url = String::with_capacity(path.len());
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            url.push(char::from(byte));
        } else {
            let _ = write!(url, "%{byte:02X}");
        }
    }
    url
}

/// URL of one file of the site relative to another.
pub(crate) fn relative(from: &str, to: &str) -> String {
    let from: Vec<&str> = from.split('/').collect();
    let to: Vec<&str> = to.split('/').collect();
    let folders = from.len() - 1;
    let common = from[..folders].iter().zip(&to[..to.len() - 1]).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..", folders - common);
    encoded(&up.chain(to[common..].iter().copied()).collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn local(path: &str, anchor: Option<&str>) -> Destination {
        Destination::Local { path: path.to_owned(), anchor: anchor.map(str::to_owned) }
    }

    #[test]
    fn link_is_resolved_from_the_folder_of_its_page() {
        for (source, link, expected) in [
            ("docs/films.md", "#speed", local("docs/films.md", Some("speed"))),
            ("docs/films.md", "light.md", local("docs/light.md", None)),
            ("docs/how-to/x.md", "../light.md#a-b", local("docs/light.md", Some("a-b"))),
            ("docs/x.md", "../scenarios/a%20b.toml", local("scenarios/a b.toml", None)),
            ("README.md", "docs/README.md", local("docs/README.md", None)),
            ("docs/x.md", "..", local("", None)),
            ("docs/x.md", "https://example.org/a#b", Destination::Web),
        ] {
            assert_eq!(Destination::read(source, link).unwrap(), expected, "{source} {link}");
        }
        for link in ["/docs/x.md", "../../x.md", "ftp://x", "javascript:x", "a\\b.md"] {
            assert!(Destination::read("docs/x.md", link).is_err(), "{link}");
        }
    }

    #[test]
    fn url_is_relative_to_the_page() {
        for (from, to, expected) in [
            ("index.html", "films.html", "films.html"),
            ("how-to/a.html", "films.html", "../films.html"),
            ("how-to/a.html", "how-to/b.html", "b.html"),
            ("a/b/c.html", "a/d/e f.html", "../d/e%20f.html"),
            ("a.html", "a.html", "a.html"),
        ] {
            assert_eq!(relative(from, to), expected);
        }
    }
}
