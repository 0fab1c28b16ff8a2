//! The page itself, as a server hands it out.

use axum::body::Body;
use axum::http::header;
use axum::response::Response;

use crate::pages;

/// A file of the page by its path; the page itself for paths that name none.
pub fn serve(path: &str) -> Option<Response> {
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let contents = pages::file(name)?;
    // Names of assets change with what is in them.
    let lasts = if name.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
    Response::builder()
        .header(header::CONTENT_TYPE, kind(name))
        .header(header::CONTENT_ENCODING, "gzip")
        .header(header::CACHE_CONTROL, lasts)
        .body(Body::from(contents))
        .ok()
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("woff2") => "font/woff2",
        Some("json" | "webmanifest") => "application/json",
        _ => "application/octet-stream",
    }
}
