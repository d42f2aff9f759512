//! Who may ask: this page, on this machine, or whoever holds the token.
//!
//! - **Host** must name this machine or be an address, with our port: a foreign name that was made to resolve to this
//!   machine (DNS rebinding) is turned away.
//!   An absolute address in the request line must name the same host.
//! - **Origin**, where a browser sends it, must be that same host; `Sec-Fetch-Site` must not say that another site asks.
//!   Each of several such headers must.
//! - **Token**: demanded of every request to the API where the server listens to more than this machine. Its page gets
//!   it in the fragment of the address, which never leaves the browser.

use std::net::{IpAddr, SocketAddr};

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::fault::{Fault, shortened};
use crate::listen::ServeError;
use crate::site::Site;

/// Bytes of a token.
const TOKEN_BYTES: usize = 24;

/// What every answer says to a browser.
const HEADERS: [(HeaderName, &str); 7] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; \
         font-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-embedder-policy"), "require-corp"),
];

/// Who is let in.
#[derive(Debug)]
pub(crate) struct Guard {
    port: u16,
    /// Demanded where others can reach the server.
    token: Option<String>,
}

impl Guard {
    pub(crate) fn new(address: SocketAddr) -> Result<Self, ServeError> {
        let token = if address.ip().is_loopback() { None } else { Some(new_token()?) };
        Ok(Self { port: address.port(), token })
    }

    pub(crate) fn has_token(&self) -> bool {
        self.token.is_some()
    }

    pub(crate) fn url(&self, address: SocketAddr) -> String {
        let fragment = self.token.as_ref().map_or(String::new(), |token| format!("#token={token}"));
        format!("http://{address}/{fragment}")
    }

    /// Why a request is turned away, if it is.
    fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Fault> {
        let is_api = is_api(uri);
        let foreign = |what: &str, found: &str| {
            let message = format!("requests with {what} \"{}\" are not answered", shortened(found));
            Fault::new(
                StatusCode::FORBIDDEN,
                message,
                "open the page at the address that papilio serve printed",
            )
        };
        let all = |name: HeaderName| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("?"));
        let host = all(header::HOST).next().unwrap_or_default();
        if all(header::HOST).count() != 1 || !self.is_ours(host) {
            return Err(foreign("Host", host));
        }
        if let Some(authority) = uri.authority().filter(|authority| authority.as_str() != host) {
            return Err(foreign("the address", authority.as_str()));
        }
        if let Some(origin) = all(header::ORIGIN).find(|origin| origin.strip_prefix("http://") != Some(host))
        {
            return Err(foreign("Origin", origin));
        }
        let is_foreign = |site: &&str| is_api && !matches!(*site, "same-origin" | "none");
        if let Some(site) = all(HeaderName::from_static("sec-fetch-site")).find(is_foreign) {
            return Err(foreign("Sec-Fetch-Site", site));
        }
        match &self.token {
            Some(token) if is_api => {
                let sent = all(header::AUTHORIZATION).next().and_then(|value| value.strip_prefix("Bearer "));
                if sent.is_some_and(|sent| same(sent, token)) { Ok(()) } else { Err(no_token()) }
            }
            _ => Ok(()),
        }
    }

    /// True for a host that no foreign name server can answer for.
    fn is_ours(&self, host: &str) -> bool {
        let Some((name, port)) = host.rsplit_once(':') else { return false };
        // As a browser writes it: `+7417` and `07417` are numbers to a parser.
        if port != self.port.to_string() {
            return false;
        }
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        match bare.parse::<IpAddr>() {
            Ok(address) => address.is_loopback() || self.has_token(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        }
    }
}

fn no_token() -> Fault {
    Fault::new(
        StatusCode::UNAUTHORIZED,
        "the token is missing or wrong: this server listens to more than its own machine",
        "open the page at the whole address that papilio serve printed, with what stands behind #",
    )
}

fn new_token() -> Result<String, ServeError> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(ServeError::Token)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares in a time that says nothing of where two texts differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |seen, (a, b)| seen | (a ^ b)) == 0
}

fn is_api(uri: &Uri) -> bool {
    uri.path().starts_with("/api/")
}

/// Turns away whom the guard does, and gives every answer its headers.
pub(crate) async fn watch(State(site): State<Site>, request: Request, next: Next) -> Response {
    let is_api = is_api(request.uri());
    let mut response = match site.guard().check(request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(fault) => fault.into_response(),
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    if is_api {
        response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str) -> Guard {
        Guard::new(address.parse().unwrap()).unwrap()
    }

    fn status(guard: &Guard, headers: &[(&'static str, &str)]) -> u16 {
        status_of(guard, "/api/v1/health", headers)
    }

    fn status_of(guard: &Guard, uri: &'static str, headers: &[(&'static str, &str)]) -> u16 {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(*name, value.parse().unwrap());
        }
        guard.check(&Uri::from_static(uri), &map).map_or_else(|fault| fault.status.as_u16(), |()| 200)
    }

    #[test]
    fn only_this_machine_and_this_page() {
        let own = guard("127.0.0.1:7417");
        for host in ["127.0.0.1:7417", "localhost:7417", "[::1]:7417", "LOCALHOST:7417"] {
            assert_eq!(status(&own, &[("host", host)]), 200, "{host}");
        }
        for host in [
            "",
            "localhost",
            "localhost:80",
            "evil.example:7417",
            "192.168.1.2:7417",
            "localhost.evil:7417",
            "[::1:7417",
            "localhost:+7417",
            "localhost:07417",
        ] {
            assert_eq!(status(&own, &[("host", host)]), 403, "{host}");
        }
        let host = ("host", "localhost:7417");
        assert_eq!(status(&own, &[]), 403);
        assert_eq!(status(&own, &[host, host]), 403);
        assert_eq!(status(&own, &[host, ("origin", "http://localhost:7417")]), 200);
        for origin in ["null", "http://evil.example", "https://localhost:7417", "http://localhost:7418"] {
            assert_eq!(status(&own, &[host, ("origin", origin)]), 403, "{origin}");
        }
        let origin = ("origin", "http://localhost:7417");
        assert_eq!(status(&own, &[host, origin, ("origin", "http://evil.example")]), 403);
        assert_eq!(status(&own, &[host, ("sec-fetch-site", "cross-site")]), 403);
        let same_site = ("sec-fetch-site", "same-origin");
        assert_eq!(status(&own, &[host, same_site, ("sec-fetch-site", "cross-site")]), 403);
        assert_eq!(status_of(&own, "http://localhost:7417/api/v1/health", &[host]), 200);
        assert_eq!(status_of(&own, "http://evil.example/api/v1/health", &[host]), 403);
        assert_eq!(status(&own, &[host, ("sec-fetch-site", "same-origin")]), 200);
    }

    #[test]
    fn elsewhere_everyone_needs_the_token() {
        let open = guard("0.0.0.0:7417");
        let token = open.token.clone().unwrap();
        assert_eq!(token.len(), 2 * TOKEN_BYTES);
        assert!(open.url("0.0.0.0:7417".parse().unwrap()).ends_with(&format!("/#token={token}")));
        let host = ("host", "192.168.1.2:7417");
        assert_eq!(status(&open, &[host]), 401);
        assert_eq!(status(&open, &[host, ("authorization", "Bearer 00")]), 401);
        let bearer = format!("Bearer {token}");
        assert_eq!(status(&open, &[host, ("authorization", &bearer)]), 200);
        assert_eq!(status(&open, &[("host", "evil.example:7417"), ("authorization", &bearer)]), 403);
        assert_ne!(guard("0.0.0.0:7417").token, open.token);
    }
}
