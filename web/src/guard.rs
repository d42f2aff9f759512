//! Access control: requests must come from this page on this machine, or contain the token.
//!
//! - **Host** must name this machine or be an address, with the server's port. A foreign name that was made
//!   to resolve to this machine (DNS rebinding) is refused. An absolute address in the request line must name
//!   the same host.
//! - **Origin**, if the browser sends it, must be the same host; `Sec-Fetch-Site` must not be another site.
//!   If a header occurs several times, each of them is checked.
//! - **Token**: required for every request to the API if other machines can reach the server. The page
//!   receives it in the fragment of its address, which the browser does not send.

use std::net::{IpAddr, SocketAddr};

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::fault::{Fault, shortened};
use crate::listen::ServeError;
use crate::site::Site;

/// Length of a token in bytes.
const TOKEN_BYTES: usize = 24;

/// Security headers of every response.
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

/// The rules by which requests are accepted.
#[derive(Debug)]
pub(crate) struct Guard {
    port: u16,
    /// Required if other machines can reach the server.
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

    /// Returns an error if a request must be refused.
    fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Fault> {
        let is_api = is_api(uri);
        let foreign = |what: &str, found: &str| {
            let message = format!("requests with {what} \"{}\" are refused", shortened(found));
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
                match sent {
                    Some(sent) if equal_in_constant_time(sent, token) => Ok(()),
                    _ => Err(no_token()),
                }
            }
            _ => Ok(()),
        }
    }

    /// Returns true for a host that no foreign name server can resolve.
    fn is_ours(&self, host: &str) -> bool {
        let Some((name, port)) = host.rsplit_once(':') else { return false };
        // Compared as text: a parser would also accept `+7417` and `07417`.
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
        "the token is missing or wrong: this server accepts connections from other machines",
        "open the page at the complete address that papilio serve printed, including the part after #",
    )
}

fn new_token() -> Result<String, ServeError> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(ServeError::Token)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares two texts in constant time, so that the time does not reveal where they differ.
fn equal_in_constant_time(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |bits, (a, b)| bits | (a ^ b)) == 0
}

fn is_api(uri: &Uri) -> bool {
    uri.path().starts_with("/api/")
}

/// Refuses requests that the guard does not accept, and adds the security headers to every response.
pub(crate) async fn check_request(State(site): State<Site>, request: Request, next: Next) -> Response {
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
    fn request_from_other_host_or_site_is_refused() {
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
    fn server_reachable_from_other_machines_requires_token() {
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
