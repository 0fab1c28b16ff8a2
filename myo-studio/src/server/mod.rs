//! An engine and its page behind a socket of this machine.

mod guard;
mod pages;
mod socket;

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, Uri};
use axum::middleware::from_fn_with_state;
use axum::response::Response;
use axum::routing::get;
use tokio::net::TcpListener;

use crate::engine::Engine;
pub use guard::Guard;

/// Port that is tried first; the next free ones after it.
pub const PORT: u16 = 7117;
/// Ports that are tried, where none is asked for.
const PORTS: u16 = 20;

/// A server that listens and does not serve yet.
pub struct Server {
    listener: std::net::TcpListener,
    guard: Guard,
    engine: Arc<Engine>,
}

/// What the parts of a server share.
#[derive(Clone)]
struct Shared {
    engine: Arc<Engine>,
    guard: Arc<Guard>,
}

impl Server {
    /// Listens at an address of this machine. Without a port the first that is free from [`PORT`] on is taken.
    ///
    /// # Errors
    /// The address is not one of this machine, or the port is taken.
    pub fn bind(engine: Engine, host: IpAddr, port: Option<u16>) -> io::Result<Self> {
        let listener = match port {
            Some(port) => std::net::TcpListener::bind((host, port))?,
            None => first_free(host)?,
        };
        listener.set_nonblocking(true)?;
        let guard = Guard::new(listener.local_addr()?)?;
        Ok(Self { listener, guard, engine: Arc::new(engine) })
    }

    /// Where it listens.
    ///
    /// # Errors
    /// The system does not tell.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    /// What to open in a browser: with the token where one is needed.
    ///
    /// # Errors
    /// The system does not tell where it listens.
    pub fn url(&self) -> io::Result<String> {
        let address = self.address()?;
        let token = self.guard.token().map(|token| format!("?token={token}")).unwrap_or_default();
        Ok(format!("http://{address}/{token}"))
    }

    /// Serves until the process ends or `stop` is done; then the training that is under way is left with a checkpoint.
    ///
    /// # Errors
    /// The system cannot wait for connections.
    pub fn serve(self, stop: impl Future<Output = ()> + Send + 'static) -> io::Result<()> {
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
        let engine = Arc::clone(&self.engine);
        let shared = Shared { engine: self.engine, guard: Arc::new(self.guard) };
        let served = runtime.block_on(async move {
            let listener = TcpListener::from_std(self.listener)?;
            let router = Router::new()
                .route("/engine", get(socket::accept))
                .fallback(page)
                .layer(from_fn_with_state(shared.clone(), guard::check))
                .with_state(shared);
            tokio::select! {
                served = axum::serve(listener, router) => served,
                () = stop => Ok(()),
            }
        });
        runtime.shutdown_background();
        // Trainings go on in a thread of their own: what it has learnt is written down first.
        engine.close();
        served
    }
}

fn first_free(host: IpAddr) -> io::Result<std::net::TcpListener> {
    let mut last = io::Error::from(io::ErrorKind::AddrInUse);
    for port in PORT..PORT + PORTS {
        match std::net::TcpListener::bind((host, port)) {
            Ok(listener) => return Ok(listener),
            Err(error) if error.kind() == io::ErrorKind::AddrInUse => last = error,
            Err(error) => return Err(error),
        }
    }
    Err(last)
}

async fn page(State(_): State<Shared>, uri: Uri) -> Result<Response, StatusCode> {
    pages::serve(uri.path()).ok_or(StatusCode::NOT_FOUND)
}
