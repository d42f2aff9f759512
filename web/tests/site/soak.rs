//! Fifty clients that send mutated, slow and huge requests, for `PAPILIO_SOAK_SECONDS`; `cargo xtask full` sets an hour.

use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use papilio_testing::Dice;
use papilio_web::openapi;
use serde_json::{Value, json};

use crate::client::{Server, read};
use crate::load::resident_kb;

/// In the long test, and in every day's.
const CLIENTS: [u64; 2] = [50, 8];

/// Memory that the process may take besides its clients: MB.
const MOST_MB: u64 = 1000;

/// Points of the memory curve.
const POINTS: u32 = 30;

/// What the clients send.
struct Requests {
    /// Scenarios of the examples.
    scenarios: Vec<String>,
    /// Paths of the API that take JSON.
    paths: Vec<String>,
    /// Bytes of huge requests, of which each takes a part.
    huge: Vec<u8>,
}

/// A number at an extreme, or near one.
fn extreme(dice: &mut Dice) -> Value {
    let values = [0.0, -1.0, 1e-300, 1e-6, 0.5, 1.0, 89.9, 1000.0, 1e6, 1e18, 1e300];
    Value::from(dice.of(values))
}

/// Changes, cuts, repeats or inserts some bytes.
fn mutated(dice: &mut Dice, mut bytes: Vec<u8>) -> Vec<u8> {
    for _ in 0..1 + dice.below(4) {
        let (at, length) = (dice.below(bytes.len().max(1)), 1 + dice.below(40));
        let end = (at + length).min(bytes.len());
        match dice.below(4) {
            _ if bytes.is_empty() => {}
            0 => bytes[at] = dice.bits() as u8,
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

impl Requests {
    fn of(server: &Server) -> Self {
        let scenario = |name: &str| {
            let answer = server.get(&format!("/api/v1/examples/{name}"));
            answer.json()["scenario"].as_str().unwrap().to_owned()
        };
        let paths = openapi()["paths"].as_object().unwrap().clone();
        let json = "/post/requestBody/content/application~1json";
        Self {
            scenarios: ["indoor", "epaper", "cover-glass", "matrix", "readability", "sky"]
                .map(scenario)
                .into(),
            paths: paths
                .into_iter()
                .filter(|(_, it)| it.pointer(json).is_some())
                .map(|(path, _)| path)
                .collect(),
            huge: vec![b'1'; 70 << 20],
        }
    }

    /// A body of a computation with a key at an extreme.
    fn body(&self, dice: &mut Dice) -> Value {
        let keys = [
            "viewer.theta_deg",
            "display.diffuser.haze",
            "display.glass.index",
            "display.pixel.film.0.thickness_nm",
            "lighting.diffuse",
            "lighting.directed.0.theta_deg",
            "spectrum.step_nm",
            "solver.paths",
            "solver.relative_error",
        ];
        let edits = json!([{ "op": "set", "path": dice.of(keys), "value": extreme(dice) }]);
        json!({ "scenario": self.scenarios[dice.below(self.scenarios.len())], "edits": edits })
    }

    /// Sends one request of a random kind; returns its kind and the status, 0 without a response.
    fn send(&self, server: &Server, dice: &mut Dice, is_long: bool) -> (&'static str, u16) {
        let json = "application/json";
        let path = &self.paths[dice.below(self.paths.len())];
        // Without those that wait for time limits.
        let kinds = if is_long { 8 } else { 5 };
        match dice.below(kinds) {
            0 | 1 => ("extreme", server.post("/live", &self.body(dice)).status),
            2 => ("other path", server.send(path, json, self.body(dice).to_string().as_bytes()).status),
            3 => {
                let body = self.body(dice).to_string().into_bytes();
                let body = mutated(dice, body);
                ("mutated body", server.send(path, json, &body).status)
            }
            5 => {
                let body = self.body(dice).to_string();
                let request = mutated(dice, server.request(path, json, body.as_bytes()));
                // What a mutated length promises does not arrive: the server gives up after ten seconds.
                ("mutated request", server.raw(&request).status)
            }
            6 => {
                let mut stream = server.connect();
                let request = server.request("/api/v1/live", json, self.body(dice).to_string().as_bytes());
                for part in request.chunks(1 + dice.below(request.len())) {
                    if stream.write_all(part).is_err() {
                        break;
                    }
                    std::thread::sleep(Duration::from_millis(dice.below(300) as u64));
                }
                // Some do not wait for the response.
                ("slow", if dice.one_in(3) { 0 } else { read(&mut stream).status })
            }
            7 if dice.one_in(8) => {
                let (path, kind) = dice.of([
                    ("/api/v1/live", json),
                    ("/api/v1/files?name=a.csv", "application/octet-stream"),
                    ("/api/v1/files?name=a.bsdf", "application/octet-stream"),
                ]);
                // Not copied: the memory is that of the server.
                let body = &self.huge[..dice.below(self.huge.len())];
                let port = server.address.port();
                let head = format!(
                    "POST {path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\nContent-Type: {kind}\r\n\
                     Content-Length: {}\r\n\r\n",
                    body.len()
                );
                let mut stream = server.connect();
                let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body));
                ("huge", read(&mut stream).status)
            }
            7 if dice.one_in(2) => {
                let text = mutated(dice, b"wavelength_nm,value\n400,0.1\n550,0.7\n700,1\n".to_vec());
                ("file", server.send("/api/v1/files?name=a.csv", "application/octet-stream", &text).status)
            }
            4 | 7.. => {
                let junk: Vec<u8> = (0..dice.below(2000)).map(|_| dice.bits() as u8).collect();
                ("junk", server.raw(&[&junk[..], b"\r\n\r\n"].concat()).status)
            }
        }
    }
}

/// No response has an internal error, memory stays bounded, and another user is served at the same time and in the end.
#[test]
fn fifty_hostile_clients_neither_stop_the_server_nor_fill_its_memory() {
    let set = std::env::var("PAPILIO_SOAK_SECONDS").ok().and_then(|text| text.parse().ok());
    let duration = Duration::from_secs(set.unwrap_or(1));
    let server = Server::start();
    let requests = Requests::of(&server);
    let (begun, before) = (Instant::now(), resident_kb().unwrap_or(0));
    let statuses: Mutex<BTreeMap<(&str, u16), u64>> = Mutex::default();
    let (sent, most_kb) = (AtomicU64::new(0), AtomicU64::new(0));
    std::thread::scope(|scope| {
        for client in 0..CLIENTS[usize::from(set.is_none())] {
            let (server, requests, statuses, sent) = (&server, &requests, &statuses, &sent);
            scope.spawn(move || {
                let mut dice = Dice::new(0x736f_616b, client);
                while begun.elapsed() < duration {
                    let answer = requests.send(server, &mut dice, set.is_some());
                    sent.fetch_add(1, Ordering::Relaxed);
                    *statuses.lock().unwrap().entry(answer).or_default() += 1;
                }
            });
        }
        for point in 1..=POINTS {
            std::thread::sleep((duration * point / POINTS).saturating_sub(begun.elapsed()));
            let kb = resident_kb().unwrap_or(0);
            most_kb.fetch_max(kb, Ordering::Relaxed);
            if set.is_some() {
                let sent = sent.load(Ordering::Relaxed);
                println!("{:.0} s: {} MB, {sent} requests", begun.elapsed().as_secs_f64(), kb / 1024);
                // Other users wait, but are served.
                assert_eq!(server.get("/api/v1/health").status, 200);
            }
        }
    });
    let statuses = statuses.into_inner().unwrap();
    statuses.iter().for_each(|((kind, status), count)| println!("{kind}: {count} times {status}"));
    let wrong: Vec<_> = statuses.keys().filter(|(_, status)| *status >= 500 && *status != 503).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    assert_eq!(server.get("/api/v1/health").status, 200);
    let most_mb = most_kb.load(Ordering::Relaxed).saturating_sub(before) / 1024;
    assert!(most_mb < MOST_MB, "{most_mb} MB");
}
