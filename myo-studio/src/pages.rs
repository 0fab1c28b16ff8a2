//! The pages: files that the build script made of `web/` and put into the program.

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

/// A file of the studio's page by its path, compressed by gzip.
pub fn file(name: &str) -> Option<&'static [u8]> {
    PAGES.iter().find(|(own, _)| *own == name).map(|(_, contents)| *contents)
}

/// The page of reports, without what it reports on.
///
/// # Errors
/// There are no pages in this program.
pub fn report() -> Result<&'static str, PagesError> {
    missing_pages().map(|()| REPORT)
}
