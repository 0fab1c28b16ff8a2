//! Who may speak to the engine: this machine's own browser on this page, and, from elsewhere, whoever has the token.

use std::io;
use std::net::{IpAddr, SocketAddr};

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::Shared;

/// Bytes of a token, before they are written as text.
const TOKEN_BYTES: usize = 16;

/// Tells friends from strangers. A page of another site that a browser of this machine shows could otherwise speak to the engine:
/// from its own address (`Origin`), or from a name that it makes lead to this machine (`Host`).
#[derive(Clone, Debug)]
pub struct Guard {
    address: SocketAddr,
    /// Asked for where others than this machine can come.
    token: Option<String>,
}

impl Guard {
    /// For an address: with a token unless only this machine can come.
    ///
    /// # Errors
    /// The system gives no random numbers.
    pub fn new(address: SocketAddr) -> io::Result<Self> {
        let token = if address.ip().is_loopback() { None } else { Some(token()?) };
        Ok(Self { address, token })
    }

    /// The token that the engine asks for, if any.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// Whether these headers are those of somebody who came to this address. With a token the machine may have any name.
    fn knows_host(&self, headers: &HeaderMap) -> bool {
        let Some(host) = text(headers, header::HOST) else { return false };
        self.token.is_some() || own_names(self.address).iter().any(|own| own.eq_ignore_ascii_case(host))
    }

    /// Whether a page asks that came from here.
    fn knows_origin(headers: &HeaderMap) -> bool {
        match (text(headers, header::ORIGIN), text(headers, header::HOST)) {
            // Browsers always say from where a socket is opened; a program on this machine need not.
            (None, _) => true,
            (Some(origin), Some(host)) => origin.eq_ignore_ascii_case(&format!("http://{host}")),
            (Some(_), None) => false,
        }
    }

    /// Whether the engine may be spoken to with this token. Takes as long for every wrong one.
    pub fn admits(&self, given: Option<&str>) -> bool {
        let Some(token) = &self.token else { return true };
        let given = given.unwrap_or_default().as_bytes();
        let differ = token.bytes().zip(given).fold(0, |differ, (a, &b)| differ | (a ^ b));
        given.len() == token.len() && differ == 0
    }
}

/// What this address is called by browsers on this machine.
fn own_names(address: SocketAddr) -> Vec<String> {
    let port = address.port();
    let mut names = vec![address.to_string()];
    if address.ip().is_loopback() {
        names.push(format!("localhost:{port}"));
        if address.ip() == IpAddr::from([127, 0, 0, 1]) {
            names.push(format!("127.0.0.1:{port}"));
        }
    }
    names
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

fn token() -> io::Result<String> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Refuses strangers, and tells browsers what a page of the studio may do: nothing that leads elsewhere.
pub async fn check(State(shared): State<Shared>, request: Request, next: Next) -> Response {
    let headers = request.headers();
    if !shared.guard.knows_host(headers) {
        let here = format!("this studio is at {}; it was asked for by another name\n", shared.guard.address);
        return (StatusCode::FORBIDDEN, here).into_response();
    }
    if !Guard::knows_origin(headers) {
        return (StatusCode::FORBIDDEN, "a page of another site may not speak to this studio\n").into_response();
    }
    let mut response = next.run(request).await;
    let policy = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; media-src 'self' blob:; \
                  connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
    let rules = [
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    for (name, rule) in rules {
        response.headers_mut().insert(name, HeaderValue::from_static(rule));
    }
    response
}
