//! The page itself: files that the build script made of `web/` and put into the program.

use axum::body::Body;
use axum::http::header;
use axum::response::Response;

include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// Why there are no pages in this program.
#[derive(Debug, thiserror::Error)]
#[error("this program was built without the studio's pages: {0}")]
pub struct PagesError(&'static str);

/// Refuses where there are no pages to serve.
///
/// # Errors
/// Why they could not be built, and what to do.
pub fn missing_pages() -> Result<(), PagesError> {
    MISSING.map_or(Ok(()), |reason| Err(PagesError(reason)))
}

/// A file of the page by its path; the page itself for paths that name none.
pub fn serve(path: &str) -> Option<Response> {
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    let (_, contents) = PAGES.iter().find(|(own, _)| *own == name)?;
    // Names of assets change with what is in them.
    let lasts = if name.starts_with("assets/") { "public, max-age=31536000, immutable" } else { "no-cache" };
    Response::builder()
        .header(header::CONTENT_TYPE, kind(name))
        .header(header::CONTENT_ENCODING, "gzip")
        .header(header::CACHE_CONTROL, lasts)
        .body(Body::from(*contents))
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
