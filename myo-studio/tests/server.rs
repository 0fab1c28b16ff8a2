//! Who may speak to the engine.

use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

use myo_lab::Backend;
use myo_studio::engine::Engine;
use myo_studio::server::Server;

/// A server on a free port of an address; the address at which this machine finds it, and its token.
fn serve(folder: &tempfile::TempDir, host: Ipv4Addr) -> (SocketAddr, Option<String>) {
    let engine = Engine::open(folder.path().to_owned(), Backend::Cpu).unwrap();
    let server = Server::bind(engine, IpAddr::V4(host), Some(0)).unwrap();
    let port = server.address().unwrap().port();
    let token = server.url().unwrap().split_once("?token=").map(|(_, token)| token.to_owned());
    std::thread::spawn(move || server.serve(std::future::pending()).unwrap());
    (SocketAddr::from((Ipv4Addr::LOCALHOST, port)), token)
}

/// The status of an answer.
fn status(address: SocketAddr, path: &str, headers: &[(&str, &str)]) -> u16 {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    let headers: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
    write!(stream, "GET {path} HTTP/1.1\r\n{headers}\r\n").unwrap();
    let mut start = [0; 12];
    stream.read_exact(&mut start).unwrap();
    std::str::from_utf8(&start[9..]).unwrap().parse().unwrap()
}

const SOCKET: [(&str, &str); 4] = [
    ("Connection", "Upgrade"),
    ("Upgrade", "websocket"),
    ("Sec-WebSocket-Version", "13"),
    ("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="),
];

fn socket(address: SocketAddr, path: &str, host: &str, origin: Option<&str>) -> u16 {
    let own = [("Host", host)].into_iter().chain(origin.map(|origin| ("Origin", origin))).chain(SOCKET);
    status(address, path, &own.collect::<Vec<_>>())
}

#[test]
fn pages_of_other_sites_and_other_names_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (address, token) = serve(&folder, Ipv4Addr::LOCALHOST);
    assert_eq!(token, None, "this machine needs none");
    let own = address.to_string();
    let local = format!("localhost:{}", address.port());
    for host in [&own, &local] {
        assert_eq!(socket(address, "/engine", host, Some(&format!("http://{host}"))), 101, "{host}");
        assert_eq!(socket(address, "/engine", host, None), 101, "a program of this machine");
    }
    // Another site in a browser of this machine, and a name that leads here.
    assert_eq!(socket(address, "/engine", &own, Some("http://evil.example")), 403);
    assert_eq!(socket(address, "/engine", &own, Some("null")), 403);
    assert_eq!(socket(address, "/engine", &own, Some(&format!("https://{own}"))), 403);
    assert_eq!(socket(address, "/engine", "evil.example", Some("http://evil.example")), 403);
    assert_eq!(status(address, "/", &[("Host", "evil.example")]), 403);
    assert_eq!(status(address, "/..%2f..%2fetc/passwd", &[("Host", &own)]), 404);
}

#[test]
fn those_who_come_from_elsewhere_need_the_token() {
    let folder = tempfile::tempdir().unwrap();
    let (address, token) = serve(&folder, Ipv4Addr::UNSPECIFIED);
    let token = token.unwrap();
    assert_eq!(token.len(), 32);
    let host = "workstation.example:7117";
    let origin = format!("http://{host}");
    assert_eq!(socket(address, "/engine", host, Some(&origin)), 401);
    assert_eq!(socket(address, "/engine?token=", host, Some(&origin)), 401);
    assert_eq!(socket(address, &format!("/engine?token={}", &token[1..]), host, Some(&origin)), 401);
    assert_eq!(socket(address, &format!("/engine?token={token}"), host, Some(&origin)), 101);
    assert_eq!(socket(address, &format!("/engine?token={token}"), host, Some("http://evil.example")), 403);
}

/// Whoever does not listen holds nobody up.
#[test]
fn a_listener_that_is_stuck_or_gone_does_not_hold_up_those_who_tell() {
    use myo_studio::engine::Hub;
    use myo_studio::protocol::Event;
    let hub = Hub::default();
    let (stuck, listens) = (hub.listen(|| ()), hub.listen(|| ()));
    drop(hub.listen(|| ()));
    for _ in 0..10_000 {
        hub.tell(&Event::Runs);
        assert!(listens.hear().is_some());
    }
    assert!(stuck.has_lost() && !listens.has_lost());
    assert!(!stuck.has_lost(), "it is told once");
    let kept = std::iter::from_fn(|| stuck.hear()).count();
    assert!((1..1000).contains(&kept), "{kept}");
}
