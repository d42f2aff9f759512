//! A separate server for each test, and a client that can send any bytes.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc;
use std::time::Duration;

use papilio_web::{Options, Site};
use serde_json::Value;

/// A server on a free port; it ends with the test.
pub(crate) struct Server {
    pub(crate) address: SocketAddr,
}

/// A response.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&self.body)))
    }

    /// Returns the message and the path of the first error.
    pub(crate) fn error(&self) -> (String, Option<String>) {
        let error = &self.json()["errors"][0];
        (error["message"].as_str().unwrap().to_owned(), error["path"].as_str().map(str::to_owned))
    }
}

impl Server {
    pub(crate) fn start() -> Self {
        Self::with(Options { port: 0, ..Options::default() })
    }

    pub(crate) fn with(options: Options) -> Self {
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || {
            let runtime =
                tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
            runtime.block_on(async {
                let (site, listener) = Site::bind(options).await.unwrap();
                sender.send(site.address()).unwrap();
                site.serve(listener).await;
            });
        });
        Self { address: receiver.recv().unwrap() }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.address.port())).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    /// Sends bytes as they are, and reads to the end.
    pub(crate) fn raw(&self, request: &[u8]) -> Answer {
        let mut stream = self.connect();
        // The server may close the connection before the request is complete.
        let _ = stream.write_all(request);
        read(&mut stream)
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        let port = self.address.port();
        self.raw(
            format!("GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\n\r\n").as_bytes(),
        )
    }

    /// Sends a request in JSON to a path below `/api/v1`.
    pub(crate) fn post(&self, path: &str, body: &Value) -> Answer {
        self.send(&format!("/api/v1{path}"), "application/json", body.to_string().as_bytes())
    }

    pub(crate) fn send(&self, path: &str, kind: &str, body: &[u8]) -> Answer {
        self.raw(&self.request(path, kind, body))
    }

    pub(crate) fn request(&self, path: &str, kind: &str, body: &[u8]) -> Vec<u8> {
        let (port, length) = (self.address.port(), body.len());
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\nContent-Type: {kind}\r\n\
             Content-Length: {length}\r\n\r\n"
        );
        [head.as_bytes(), body].concat()
    }
}

/// Reads a complete response; status 0 if there is none.
pub(crate) fn read(stream: &mut TcpStream) -> Answer {
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap_or(bytes.len());
    let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
    let status = head.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
    let body = bytes.get(end + 4..).unwrap_or_default().to_vec();
    let body = if head.contains("transfer-encoding: chunked") { unchunked(&body) } else { body };
    Answer { status, head, body }
}

fn unchunked(mut rest: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    while let Some(line) = rest.windows(2).position(|two| two == b"\r\n") {
        let size =
            std::str::from_utf8(&rest[..line]).ok().and_then(|hex| usize::from_str_radix(hex, 16).ok());
        let Some(size) = size.filter(|size| *size > 0 && line + 2 + size <= rest.len()) else { break };
        body.extend(&rest[line + 2..][..size]);
        rest = rest.get(line + 4 + size..).unwrap_or_default();
    }
    body
}
