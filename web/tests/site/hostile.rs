//! Hostile requests: each of them has a response, and the server continues to run.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, TcpStream};
use std::time::{Duration, Instant};

use papilio_scenario::Edit;
use papilio_testing::{Dice, laws, sized};
use papilio_web::{Options, openapi};
use serde_json::{Value, json};

use crate::answers::indoor;
use crate::client::{Server, read};
use crate::load::resident_kb;

fn is_alive(server: &Server) -> bool {
    server.get("/api/v1/health").status == 200
}

#[test]
fn path_outside_the_api_and_the_page_is_refused() {
    let server = Server::start();
    for path in [
        "/../Cargo.toml",
        "/..%2f..%2fCargo.toml",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/assets/../../Cargo.toml",
        "/api/v1/examples/..%2f..%2fCargo",
        "/api/v1/examples/%2fetc%2fpasswd",
        "/api/v1/presets/..%2findoor",
        "/api/v1/../../etc/passwd",
        "/api/v2/health",
    ] {
        let answer = server.get(path);
        assert!((400..500).contains(&answer.status), "{path}: {answer:?}");
        assert!(!String::from_utf8_lossy(&answer.body).contains("root:"), "{path}");
    }
    // A scenario cannot use such a path either.
    for file in ["/etc/passwd", "../Cargo.toml", "data/../../Cargo.toml", "Cargo.toml"] {
        let edits = json!([{ "op": "set", "path": "lighting.spectrum", "value": file }]);
        let answer = server.post("/live", &json!({ "scenario": indoor(&server), "edits": edits }));
        let (message, path) = answer.error();
        assert_eq!((answer.status, path.as_deref()), (422, Some("lighting.spectrum")), "{file}: {message}");
    }
    for name in ["", "..", "a/b", "a%2Fb", "a%5Cb", "a%00b", "%", "%zz"] {
        let path = format!("/api/v1/files?name={name}");
        assert_eq!(server.send(&path, "application/octet-stream", b"400,1\n500,1\n").status, 400, "{name}");
    }
}

#[test]
fn foreign_host_origin_or_method_is_refused() {
    let server = Server::start();
    let port = server.address.port();
    let ask = |lines: &str| server.raw(format!("{lines}\r\nConnection: close\r\n\r\n").as_bytes()).status;
    let health = "GET /api/v1/health HTTP/1.1\r\n";
    assert_eq!(ask(&format!("{health}Host: localhost:{port}")), 200);
    assert_eq!(ask(&format!("{health}Host: evil.example:{port}")), 403);
    assert_eq!(ask(&format!("{health}Host: localhost:{port}\r\nHost: evil.example")), 403);
    assert_eq!(ask(&format!("{health}Host: localhost:{port}\r\nOrigin: http://evil.example")), 403);
    assert_eq!(ask(&format!("{health}Host: localhost:{port}\r\nOrigin: http://localhost:{port}")), 200);
    assert_eq!(ask(&format!("{health}Accept: */*")), 403);
    assert_eq!(ask(&format!("GET / HTTP/1.1\r\nHost: evil.example:{port}")), 403);
    assert_eq!(ask(&format!("DELETE /api/v1/health HTTP/1.1\r\nHost: localhost:{port}")), 405);
    assert_eq!(ask(&format!("GET /api/v1/live HTTP/1.1\r\nHost: localhost:{port}")), 405);
    assert_eq!(ask(&format!("OPTIONS /api/v1/live HTTP/1.1\r\nHost: localhost:{port}")), 405);
    assert_eq!(ask(&format!("GET http://evil.example/ HTTP/1.1\r\nHost: localhost:{port}")), 403);
    let origin = format!("Origin: http://localhost:{port}\r\nOrigin: http://evil.example");
    assert_eq!(ask(&format!("{health}Host: localhost:{port}\r\n{origin}")), 403);
    assert_eq!(ask("BREW / COFFEE"), 400);
    // A form of another site can send text, but not JSON.
    assert_eq!(server.send("/api/v1/live", "text/plain", b"{}").status, 415);
    let head = server.get("/").head;
    assert!(
        head.contains("default-src 'none'") && head.contains("nosniff") && !head.contains("allow-origin")
    );
}

#[test]
fn server_reachable_from_other_machines_requires_token() {
    let everywhere: IpAddr = "0.0.0.0".parse().unwrap();
    let server = Server::with(Options { listen: everywhere, port: 0, ..Options::default() });
    assert_eq!(server.get("/api/v1/health").status, 401);
    assert_eq!(server.post("/live", &json!({ "scenario": "" })).status, 401);
    // The page itself loads without the token, which it reads from its address.
    assert_eq!(server.get("/").status, 200);
}

#[test]
fn request_that_exceeds_a_limit_is_refused() {
    let server = Server::start();
    let long = "#".repeat(300 << 10);
    assert_eq!(server.post("/live", &json!({ "scenario": long })).status, 413);
    let longer = "#".repeat(2 << 20);
    assert_eq!(server.post("/live", &json!({ "scenario": longer })).status, 413);
    let huge = vec![b'1'; (64 << 20) + 1];
    assert_eq!(server.send("/api/v1/files?name=a.csv", "application/octet-stream", &huge).status, 413);
    let deep = format!(
        "{{\"scenario\":\"\",\"edits\":[{{\"op\":\"set\",\"path\":\"a\",\"value\":{}",
        "[".repeat(100_000)
    );
    assert_eq!(server.send("/api/v1/live", "application/json", deep.as_bytes()).status, 400);
    let nested = format!("a = {}1{}", "[".repeat(2000), "]".repeat(2000));
    assert_eq!(server.post("/live", &json!({ "scenario": nested })).status, 422);
    let dotted = format!("{} = 1", vec!["a"; 20_000].join("."));
    assert_eq!(server.post("/live", &json!({ "scenario": dotted })).status, 422);
    let header = format!("[{}a]", "a.".repeat(20_000));
    for (path, scenario) in [("/edit", &dotted), ("/edit", &header), ("/live", &header), ("/edit", &nested)] {
        let edits = json!([{ "op": "set", "path": "title", "value": "x" }]);
        assert_eq!(server.post(path, &json!({ "scenario": scenario, "edits": edits })).status, 422, "{path}");
    }
    let edits = vec![json!({ "op": "remove", "path": "title" }); 201];
    assert_eq!(server.post("/edit", &json!({ "scenario": "", "edits": edits })).status, 400);
    let many = indoor(&server).replace("theta_deg = 8", "theta_deg = { from = -80, to = 80, step = 0.1 }");
    let (message, _) = server.post("/live", &json!({ "scenario": many })).error();
    assert!(message.contains("too many for the page"), "{message}");
    let slow = server.get("/api/v1/examples/two-diffusers").json()["scenario"].as_str().unwrap().to_owned();
    let slow = slow.replace("width = 0.04", "width = 0.02").replace("width = 0.03", "width = 0.02");
    let slow = slow.replace("index = 1.5", "index = \"fused-silica.yml\"");
    let (message, _) = server.post("/live", &json!({ "scenario": slow })).error();
    assert!(message.contains("the page allows 20 s"), "{message}");
    let header = format!("GET / HTTP/1.1\r\nHost: localhost\r\nX: {}\r\n\r\n", "y".repeat(64 << 10));
    assert!((400..500).contains(&server.raw(header.as_bytes()).status));
    assert!(is_alive(&server));
}

/// Runs the two tests that wait for time limits at the same time.
#[test]
fn slow_clients_and_clients_that_never_read_are_disconnected() {
    let never_read = std::thread::spawn(clients_that_never_read_do_not_block_others);
    slow_clients_are_disconnected();
    never_read.join().unwrap();
}

/// Connections with an incomplete body or header are closed after ten seconds, not before; others are served
/// at the same time.
fn slow_clients_are_disconnected() {
    let server = Server::start();
    let started = Instant::now();
    let (mut body, mut header) = (server.connect(), server.connect());
    let port = server.address.port();
    let head = format!(
        "POST /api/v1/live HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{{"
    );
    body.write_all(head.as_bytes()).unwrap();
    header.write_all(b"GET / HTTP/1.1\r\nHost: loc").unwrap();
    assert!(is_alive(&server));
    assert_eq!(read(&mut body).status, 408);
    assert!(matches!(read(&mut header).status, 0 | 408));
    // `read` gives up after a minute: until then, the server has closed both.
    let limits = Duration::from_secs(8)..Duration::from_secs(60);
    assert!(limits.contains(&started.elapsed()), "{:?}", started.elapsed());
}

/// Whether the other end has not closed the connection; `action` must not block.
fn is_open(stream: &TcpStream, action: impl Fn(&TcpStream) -> std::io::Result<usize>) -> bool {
    stream.set_nonblocking(true).unwrap();
    let open = match action(stream) {
        Ok(count) => count > 0,
        Err(error) => error.kind() == ErrorKind::WouldBlock,
    };
    stream.set_nonblocking(false).unwrap();
    open
}

/// More connections than places send many requests and never read: another client is served while they are
/// open, and each of them is closed before it is sent everything.
fn clients_that_never_read_do_not_block_others() {
    let server = Server::start();
    let port = server.address.port();
    let ask = format!("GET /api/v1/schema HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n").repeat(600);
    let before = resident_kb();
    let mut silent: Vec<_> = (0..300).map(|_| server.connect()).collect();
    for stream in &mut silent {
        // The connections that exceed the limit of one address are closed immediately.
        let _ = stream.write_all(ask.as_bytes());
    }
    std::thread::sleep(Duration::from_millis(1200));
    assert!(is_alive(&server));
    // A write fails when the server has closed the connection, even if its responses have not been read.
    let is_served = |stream: &TcpStream| is_open(stream, |mut stream| stream.write(b"\r\n"));
    assert!(silent.iter().any(is_served));
    for _ in 0..20 {
        assert!(is_alive(&server));
    }
    if let Some((before, now)) = before.zip(resident_kb()) {
        // A response takes 0.1 MB, and 64 connections hold one each; other tests run at the same time.
        assert!(now < before + (200 << 10), "{before} kB, then {now} kB");
    }
    // After ten seconds of the server's clock, which is late on a busy machine.
    let started = Instant::now();
    while silent.iter().any(is_served) {
        assert!(started.elapsed() < Duration::from_secs(60), "clients that never read are not disconnected");
        std::thread::sleep(Duration::from_secs(1));
    }
    let is_ended = |stream: &mut TcpStream| {
        let whole = 600 * server.get("/api/v1/schema").body.len();
        let answer = read(stream);
        answer.body.len() < whole
    };
    assert!(silent.iter_mut().step_by(50).all(is_ended));
}

/// An active client takes the place of an idle one: it is served before the idle connections are closed by
/// their time limit, which closes all of them together.
#[test]
fn idle_connections_are_replaced_by_active_ones() {
    let server = Server::start();
    let idle: Vec<_> = (0..300).map(|_| server.connect()).collect();
    std::thread::sleep(Duration::from_millis(1200));
    assert!(is_alive(&server));
    assert!(idle.iter().any(|stream| is_open(stream, |mut stream| stream.read(&mut [0]))));
    for _ in 0..20 {
        assert!(is_alive(&server));
    }
}

/// Requests whose bodies do not arrive take all places of an address, or the memory of bodies: others are
/// served.
#[test]
fn unfinished_requests_do_not_block_others() {
    let server = Server::start();
    let port = server.address.port();
    let begin = |path: &str, kind: &str, length: usize| {
        let mut stream = server.connect();
        let head = format!(
            "POST /api/v1/{path} HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n\r\n{{"
        );
        let _ = stream.write_all(head.as_bytes());
        stream
    };
    let _json: Vec<_> = (0..70).map(|_| begin("live", "application/json", 100)).collect();
    let started = Instant::now();
    assert!(is_alive(&server));
    let _files: Vec<_> =
        (0..70).map(|_| begin("files?name=a.csv", "application/octet-stream", 60 << 20)).collect();
    let text = b"wavelength_nm,value\n400,1\n700,1\n";
    let kept = server.send("/api/v1/files?name=b.csv", "application/octet-stream", text);
    assert_eq!(kept.status, 200);
    // Bodies in JSON would be given up after ten seconds, files after two minutes.
    assert!(started.elapsed() < Duration::from_secs(9), "{:?}", started.elapsed());
}

/// The response to a request that is too long is read after the whole request is sent: the connection is not
/// reset.
#[test]
fn response_to_a_long_request_is_readable() {
    let server = Server::start();
    let huge = vec![b'1'; 70 << 20];
    for (path, kind, status) in [
        ("/api/v1/files?name=a.csv", "application/octet-stream", 413),
        ("/api/v1/live", "application/json", 413),
        ("/api/v1/live", "text/plain", 415),
        ("/api/v1/health", "application/json", 405),
    ] {
        let mut stream = server.connect();
        let sent = stream.write_all(&server.request(path, kind, &huge));
        assert!(sent.is_ok(), "{path} {kind}: {sent:?}");
        let answer = read(&mut stream);
        assert_eq!(answer.status, status, "{path} {kind}");
        assert!(!answer.error().0.is_empty());
    }
    assert!(is_alive(&server));
}

/// Many small files that are uploaded at the same time wait for their places.
#[test]
fn many_simultaneous_uploads_are_accepted() {
    let server = Server::start();
    let upload = |k: usize| {
        let text = format!("wavelength_nm,value\n400,{k}\n700,1\n");
        server
            .send(&format!("/api/v1/files?name=a{k}.csv"), "application/octet-stream", text.as_bytes())
            .status
    };
    std::thread::scope(|scope| {
        let clients = (0..20)
            .map(|client| scope.spawn(move || (0..10).map(|k| upload(10 * client + k)).collect::<Vec<_>>()));
        let clients: Vec<_> = clients.collect();
        assert!(clients.into_iter().all(|client| client.join().unwrap().iter().all(|status| *status == 200)));
    });
}

/// Every reference of the OpenAPI description exists, and the server returns the same description.
#[test]
fn openapi_description_is_complete() {
    let all = openapi();
    assert_eq!(all["openapi"], "3.1.0");
    let schemas = all["components"]["schemas"].as_object().unwrap();
    let text = all.to_string();
    for reference in text.split("\"$ref\":\"").skip(1) {
        let reference = reference.split('"').next().unwrap();
        let name = reference.strip_prefix("#/components/schemas/").unwrap_or_else(|| panic!("{reference}"));
        assert!(schemas.contains_key(name), "{name}");
    }
    assert!(all["paths"].as_object().unwrap().len() >= 15);
    let server = Server::start();
    assert_eq!(server.get("/api/v1/openapi.json").json(), all);
}

/// Draws a path of keys and indices, most of which exist.
fn path(dice: &mut Dice) -> String {
    let keys = [
        "display",
        "pixel",
        "film",
        "lighting",
        "directed",
        "layers",
        "front",
        "title",
        "viewer",
        "theta_deg",
        "0",
        "1",
        "9",
        "",
        "a b",
    ];
    dice.several(0..=4, |dice| dice.of(keys)).join(".")
}

/// After any edits, the text is TOML, or the edits are refused: no panic, no broken text.
#[test]
fn random_edits_give_valid_toml_or_an_error() {
    let server = Server::start();
    let texts: Vec<String> = ["indoor", "cover-glass", "readability"]
        .map(|name| {
            server.get(&format!("/api/v1/examples/{name}")).json()["scenario"].as_str().unwrap().to_owned()
        })
        .into();
    let edit = |dice: &mut Dice| {
        let (path, from, to) = (path(dice), dice.below(4), dice.below(4));
        match dice.below(4) {
            0 => Edit::Set { path, value: junk(dice, 3) },
            1 => Edit::Remove { path },
            2 => Edit::Insert { path, index: (from < 3).then_some(from), value: junk(dice, 3) },
            _ => Edit::Move { path, from, to },
        }
    };
    laws(
        1500,
        |dice| (dice.below(texts.len()), dice.several(1..=4, edit)),
        |(text, edits)| {
            if let Ok(edited) = papilio_scenario::edit(&texts[*text], edits) {
                assert!(papilio_scenario::edit(&edited, &[]).is_ok_and(|again| again == edited));
            }
        },
    );
}

/// Draws a JSON value with at most `levels` levels.
fn junk(dice: &mut Dice, levels: usize) -> Value {
    let printable: String = (' '..='~').collect();
    match dice.below(if levels > 0 { 12 } else { 8 }) {
        0 => Value::Null,
        1 => Value::from(dice.one_in(2)),
        2 => Value::from(f64::from_bits(dice.bits())),
        3 => Value::from(dice.bits() as i64),
        4 => Value::from(dice.text(&printable, 12)),
        5 => json!("[display.pixel]\nmodel = \"film\""),
        6 => json!("lighting.directed.0.theta_deg"),
        7 => json!(".."),
        8 | 9 => Value::from(dice.several(0..=3, |dice| junk(dice, levels - 1))),
        _ => {
            let key = |dice: &mut Dice| dice.text("abcdefghijklmnopqrstuvwxyz_.0", 8);
            Value::Object(
                dice.several(0..=3, |dice| (key(dice), junk(dice, levels - 1))).into_iter().collect(),
            )
        }
    }
}

/// Returns the names of the properties of a schema, following its reference.
fn properties(all: &Value, schema: &Value) -> Vec<String> {
    let reference = schema["$ref"].as_str().and_then(|path| path.strip_prefix('#'));
    let schema = reference.and_then(|path| all.pointer(path)).unwrap_or(schema);
    schema["properties"].as_object().map(|all| all.keys().cloned().collect()).unwrap_or_default()
}

/// Requests generated from the description, with random values or a scenario for each property, never cause
/// an internal error.
#[test]
fn generated_request_gives_a_result_or_a_client_error() {
    let (server, all) = (Server::start(), openapi());
    // What is asked of a whole scenario is computed, too: every day, with a coarse spectrum.
    let scenario = indoor(&server) + sized("\n[spectrum]\nstep_nm = 50\n", "");
    let mut asked = 0;
    for (path, methods) in all["paths"].as_object().unwrap() {
        let Some(schema) = methods.pointer("/post/requestBody/content/application~1json/schema") else {
            continue;
        };
        let keys = properties(&all, schema);
        let values = |dice: &mut Dice| keys.iter().map(|_| (junk(dice, 3), dice.below(4))).collect();
        laws(sized(3, 12), values, |values: &Vec<(Value, usize)>| {
            let mut body = serde_json::Map::new();
            for (key, (value, kind)) in keys.iter().zip(values) {
                match (kind, key.as_str()) {
                    (0, _) => continue,
                    (1, "scenario") => drop(body.insert(key.clone(), json!(scenario))),
                    (1, "edits") => {
                        drop(body.insert(key.clone(), json!([{ "op": "set", "path": "a", "value": value }])))
                    }
                    (1, "files") => drop(body.insert(key.clone(), json!({ "a": "b" }))),
                    _ => drop(body.insert(key.clone(), value.clone())),
                }
            }
            let body = Value::Object(body).to_string();
            let answer = server.send(path, "application/json", body.as_bytes());
            assert!(answer.status == 200 || (400..500).contains(&answer.status), "{path} {body}: {answer:?}");
        });
        asked += 1;
    }
    assert!(asked >= 8 && is_alive(&server));
}
