//! Protects callers in browsers. A request under a foreign host name is refused. Every answer forbids a
//! browser to guess its type, and all but the page of the documentation forbid it to load anything.

use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::http::error::{ApiError, Code};
use crate::http::request::arrival::Arrival;

/// What a browser may load for an answer: nothing. Styles may stand in the answer itself, as in pages and
/// pictures.
pub const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'self'";

/// The paths of health checks and metrics.
const PROBES: [&str; 3] = ["/livez", "/readyz", "/metrics"];

/// The host names under which the service may be called.
#[derive(Debug)]
pub struct Hosts(Vec<String>);

impl Hosts {
    /// Of the setting `--host`.
    pub fn new(names: &[String]) -> Self {
        Self(names.iter().map(|name| name.to_ascii_lowercase()).collect())
    }

    /// Whether a page under `authority`, a host with or without a port, may be a page of this service. Names
    /// with a dot may belong to anybody: an attacker can point a name of its own at this machine, so that a
    /// browser takes the attacker's page for one of this service (DNS rebinding).
    fn allow(&self, authority: &str) -> bool {
        let host = match authority.rsplit_once(':') {
            Some((host, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => host,
            _ => authority,
        };
        let host = host.strip_suffix('.').unwrap_or(host).to_ascii_lowercase();
        let is_address = host.parse::<std::net::Ipv4Addr>().is_ok() || host.starts_with('[');
        let is_local = !host.is_empty() && !host.contains('.') || host.ends_with(".localhost");
        is_address || is_local || self.0.iter().any(|name| *name == host || name == "*")
    }
}

/// The layer that refuses requests under a foreign host name. On a connection beyond the limits it refuses
/// all but health checks and metrics.
pub async fn check_host(State(hosts): State<Arc<Hosts>>, request: Request, next: Next) -> Response {
    match refusal(&hosts, &request) {
        Some(refused) => refused.into_response(),
        None => next.run(request).await,
    }
}

fn refusal(hosts: &Hosts, request: &Request) -> Option<ApiError> {
    let mut named = request.headers().get_all(header::HOST).iter();
    let host = named.next();
    if named.next().is_some() {
        return Some(ApiError::new(Code::BadRequest, "the request has several `host` headers: send one"));
    }
    let of_path = request.uri().authority().map(|authority| authority.as_str());
    let arrival = request.extensions().get::<Arrival>();
    if host.is_none() && of_path.is_none() && arrival.is_some() {
        return Some(ApiError::new(Code::BadRequest, "the request has no `host` header"));
    }
    for name in host.map(|host| host.to_str().unwrap_or_default()).into_iter().chain(of_path) {
        if !hosts.allow(name) {
            let detail = format!("this service is not known as `{name}`; list the name in `--host`");
            return Some(ApiError::new(Code::HostRefused, detail));
        }
    }
    if arrival == Some(&Arrival::BeyondLimit) && !PROBES.contains(&request.uri().path()) {
        let detail =
            "too many connections are open; close connections that are not in use, or try again later";
        return Some(ApiError::new(Code::Overloaded, detail));
    }
    None
}

/// Adds the headers for browsers to an answer. An answer may have a policy of its own.
pub fn protect(headers: &mut HeaderMap) {
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_local_names_pass_and_other_names_must_be_listed() {
        let hosts = Hosts::new(&["cam.Example.com".to_owned()]);
        for good in [
            "localhost",
            "LOCALHOST:8080",
            "127.0.0.1",
            "10.1.2.3:80",
            "[::1]:8080",
            "toolpathd",
            "toolpathd:8080",
            "mill.localhost",
            "CAM.example.com",
            "cam.example.com.:443",
        ] {
            assert!(hosts.allow(good), "{good}");
        }
        for bad in
            ["", "attacker.example", "attacker.example:8080", "127.0.0.1.attacker.example", "x.example.com"]
        {
            assert!(!hosts.allow(bad), "{bad}");
        }
        assert!(Hosts::new(&["*".to_owned()]).allow("attacker.example"));
    }
}
