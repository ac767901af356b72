//! Serves a built site on localhost with the headers of a deployment.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::thread;

use anyhow::{Context, Result, bail};
use axum::Router;
use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use tower_http::services::ServeDir;

use crate::headers;

/// The first port that `serve` tries.
pub(crate) const PORT: u16 = 8460;

/// How many ports are tried, one after the other.
const PORTS: u16 = 100;

/// A port of localhost that is held but not answered yet.
pub(crate) struct Door {
    port: u16,
    listeners: Vec<TcpListener>,
}

/// Takes the first free port from `first` on.
pub(crate) fn open(first: u16) -> Result<Door> {
    for port in (first..=u16::MAX).take(PORTS.into()) {
        if let Some(listeners) = listen(port)? {
            return Ok(Door { port, listeners });
        }
    }
    bail!("no port is free from {first} on");
}

/// Listens on both addresses of localhost, or `None` where one of them is taken: a browser would pick either.
fn listen(port: u16) -> Result<Option<Vec<TcpListener>>> {
    let bind = |address: SocketAddr| match TcpListener::bind(address) {
        Err(error) if error.kind() == ErrorKind::AddrInUse => Ok(None),
        other => other.map(Some),
    };
    let Some(four) = bind((Ipv4Addr::LOCALHOST, port).into()).with_context(|| format!("cannot listen on {port}"))?
    else {
        return Ok(None);
    };
    match bind((Ipv6Addr::LOCALHOST, port).into()) {
        Ok(Some(six)) => Ok(Some(vec![four, six])),
        Ok(None) => Ok(None),
        // This machine has no IPv6.
        Err(_) => Ok(Some(vec![four])),
    }
}

impl Door {
    pub(crate) fn port(&self) -> u16 {
        self.port
    }

    /// Answers until the program ends.
    pub(crate) fn serve(self, site: PathBuf) -> Result<()> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        runtime.block_on(async move {
            let mut servers = Vec::new();
            for listener in self.listeners {
                listener.set_nonblocking(true)?;
                let listener = tokio::net::TcpListener::from_std(listener)?;
                servers.push(tokio::spawn(axum::serve(listener, router(site.clone())).into_future()));
            }
            for server in servers {
                server.await??;
            }
            Ok(())
        })
    }

    /// Answers in the background until the program ends.
    pub(crate) fn serve_in_background(self, site: PathBuf) {
        thread::spawn(move || {
            if let Err(error) = self.serve(site) {
                eprintln!("error: the site is served no more: {error:#}");
            }
        });
    }
}

/// Files with their types, their compressed forms and the table's headers.
fn router(site: PathBuf) -> Router {
    let files = ServeDir::new(site).precompressed_br().precompressed_gzip();
    Router::new().fallback_service(files).layer(middleware::from_fn(add_headers))
}

async fn add_headers(request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let mut response = if path == "/_headers" {
        // For hosts to read, not for visitors.
        StatusCode::NOT_FOUND.into_response()
    } else {
        next.run(request).await
    };
    let missing = !response.status().is_success() && response.status() != StatusCode::NOT_MODIFIED;
    for (name, value) in headers::of(&path) {
        if let (Ok(name), false) = (HeaderName::try_from(name), missing && name == "Cache-Control") {
            response.headers_mut().insert(name, HeaderValue::from_static(value));
        }
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_port_is_taken_when_one_is_busy() {
        let held = open(20_000).unwrap();
        let next = open(held.port()).unwrap();
        assert!(next.port() > held.port());
    }

    #[test]
    fn a_port_is_busy_if_either_address_is() {
        let held = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        assert!(listen(held.local_addr().unwrap().port()).unwrap().is_none());
        if let Ok(held) = TcpListener::bind((Ipv6Addr::LOCALHOST, 0)) {
            assert!(listen(held.local_addr().unwrap().port()).unwrap().is_none());
        }
    }
}
