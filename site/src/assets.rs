//! Style sheets, scripts and pictures of the site itself.

/// Name in the folder `assets` of the site, and content.
pub(crate) const ASSETS: [(&str, &str); 6] = [
    ("style.css", include_str!("../assets/style.css")),
    ("print.css", include_str!("../assets/print.css")),
    ("theme.js", include_str!("../assets/theme.js")),
    ("site.js", include_str!("../assets/site.js")),
    ("search.js", include_str!("../assets/search.js")),
    ("logo.svg", include_str!("../assets/logo.svg")),
];
