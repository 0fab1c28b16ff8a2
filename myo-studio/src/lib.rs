//! The studio: a local web application in which tasks are set up, users trained, watched and compared.
//!
//! Three parts that know little of each other:
//! - [`protocol`]: what a page may ask and what it is told, as data. The page's types are written from it;
//! - [`engine`]: answers, trains in threads of its own, keeps tasks and runs in a folder. It knows no network;
//! - [`server`]: a socket of this machine between a page and an engine, and who may use it.
//!
//! The page is in `web/`. It speaks to whatever answers the protocol, and knows nothing of this server.
//!
//! This crate does not know how people draw or click, nor what a training computes: it hands texts, runs and motions on.
pub mod engine;
pub mod pages;
pub mod protocol;
pub mod server;
