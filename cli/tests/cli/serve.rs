//! `papilio serve` as a process: its address, the scenario that it opens, and what a kill loses (nothing that
//! was saved).

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};

/// A running server; killed when it is dropped.
struct Server {
    child: Child,
    port: u16,
    url: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        // Equivalent to kill -9.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join("scenarios")
}

fn papilio(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    command.arg("serve").args(arguments).current_dir(scenarios());
    command
}

impl Server {
    fn start(arguments: &[&str]) -> Self {
        let mut child = papilio(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let url = line.trim().rsplit(' ').next().unwrap().to_owned();
        let port = url.split(':').nth(2).unwrap().split('/').next().unwrap().parse().unwrap();
        Self { child, port, url }
    }

    /// Returns status and JSON of a request.
    fn ask(&self, method: &str, path: &str, kind: &str, body: &[u8]) -> (u16, Value) {
        let (status, body) = self.bytes(method, path, kind, body);
        (status, serde_json::from_slice(&body).unwrap())
    }

    /// Returns status and body of a request.
    fn bytes(&self, method: &str, path: &str, kind: &str, body: &[u8]) -> (u16, Vec<u8>) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let (port, length) = (self.port, body.len());
        let head = format!(
            "{method} /api/v1{path} HTTP/1.1\r\nHost: localhost:{port}\r\nConnection: close\r\nContent-Type: {kind}\r\n\
             Content-Length: {length}\r\n\r\n"
        );
        stream.write_all(&[head.as_bytes(), body].concat()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let status = String::from_utf8_lossy(&answer[..end]).split(' ').nth(1).unwrap().parse().unwrap();
        (status, answer.split_off(end + 4))
    }

    fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        self.ask("POST", path, "application/json", body.to_string().as_bytes())
    }

    fn upload(&self, name: &str, bytes: &[u8]) -> Value {
        let (status, kept) =
            self.ask("POST", &format!("/files?name={name}"), "application/octet-stream", bytes);
        assert_eq!(status, 200, "{kept}");
        kept["id"].clone()
    }
}

/// The report of the page is the file of the command line, to the last byte.
#[test]
fn report_of_the_page_is_that_of_the_command_line() {
    let server = Server::start(&["indoor.toml", "--port", "0"]);
    // A coarse grid of wavelengths: the maps over all directions are most of the work.
    let indoor = std::fs::read_to_string(scenarios().join("indoor.toml")).unwrap();
    let scenario = format!("{indoor}\n[spectrum]\nstep_nm = 20\n");
    let request = json!({ "scenario": scenario, "what": "report.html" }).to_string();
    let (status, of_page) = server.bytes("POST", "/export", "application/json", request.as_bytes());
    assert_eq!(status, 200);
    let out = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    std::fs::write(out.path().join("indoor.toml"), scenario).unwrap();
    command.args(["run", "indoor.toml", "--solver", "adding", "--cone", "--report", "--out", "."]);
    let run = command.current_dir(out.path()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let of_program = std::fs::read(out.path().join("report.html")).unwrap();
    assert!(of_page == of_program, "{} and {} bytes", of_page.len(), of_program.len());
}

/// The files of a scenario are opened with it.
#[test]
fn page_opens_the_named_scenario() {
    let server = Server::start(&["measured-diffused.toml", "--port", "0"]);
    let (_, start) = server.ask("GET", "/start", "", b"");
    assert_eq!(start["name"], "measured-diffused.toml");
    assert_eq!(start["files"].as_object().unwrap().len(), 2, "{}", start["files"]);
    let asked = json!({ "scenario": start["scenario"], "files": start["files"] });
    assert_eq!(server.post("/live", &asked).0, 200);
}

/// Surfaces of layers, and the heights that these name, are opened with a scenario.
#[test]
fn page_opens_surfaces_of_layers_and_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let write = |name: &str, text: &str| std::fs::write(out.join(name), text).unwrap();
    std::fs::create_dir_all(out.join("surfaces")).unwrap();
    write("surfaces/map.csv", "0,0.1,0\n0,0.1,0.05\n0,0,0\n");
    write(
        "surfaces/map.toml",
        "[microgeometry]\nsurface = \"height-map\"\nfile = \"map.csv\"\npixel_um = [1]\nrays = 64\n",
    );
    let layers = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nsurface = \"surfaces/map.toml\"\n\
                  [[display.layers]]\nkind = \"medium\"\nindex = 1.5\n";
    let rest = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.5, black = 0.02 }\n\
                [lighting]\npreset = \"indoor\"\n";
    write("display.toml", &format!("{layers}{rest}"));
    let server = Server::start(&[out.join("display.toml").to_str().unwrap(), "--port", "0"]);
    let (_, start) = server.ask("GET", "/start", "", b"");
    let files: Vec<&String> = start["files"].as_object().unwrap().keys().collect();
    assert_eq!(files, ["map.csv", "surfaces/map.toml"]);
    let asked = json!({ "scenario": start["scenario"], "files": start["files"] });
    let (status, layers) = server.post("/gonio/layers", &asked);
    assert!(status == 200 && layers[0]["file"] == "surfaces/map.toml", "{layers}");
}

/// The design is stored in the browser: after kill -9 and a restart, the same request has the same answer
/// once the page has sent its files again.
#[test]
fn kill_loses_nothing_that_was_saved() {
    let server = Server::start(&["--port", "0"]);
    let bytes = std::fs::read(scenarios().join("data").join("H65.bsdf")).unwrap();
    let id = server.upload("mine.bsdf", &bytes);
    let text = std::fs::read_to_string(scenarios().join("measured-h65.toml")).unwrap();
    let scenario = text.replace("data/H65.bsdf", "mine.bsdf").replace("theta_deg = {", "theta_deg = 8 #");
    let asked = json!({ "scenario": scenario, "files": { "mine.bsdf": id } });
    let (status, before) = server.post("/live", &asked);
    assert_eq!(status, 200, "{before}");
    let port = server.port.to_string();
    drop(server);
    let server = Server::start(&["--port", &port]);
    let (status, gone) = server.post("/live", &asked);
    assert_eq!((status, &gone["missing"]), (410, &json!([id])));
    assert_eq!(server.upload("mine.bsdf", &bytes), id);
    let (_, after) = server.post("/live", &asked);
    assert_eq!(before["result"], after["result"]);
}

#[test]
fn server_for_other_machines_has_a_token_and_a_warning() {
    let server = Server::start(&["--listen", "0.0.0.0", "--port", "0"]);
    assert!(server.url.contains("/#token="), "{}", server.url);
    assert_eq!(server.ask("GET", "/health", "", b"").0, 401);
    let own = Server::start(&["--port", "0"]);
    assert!(own.url.starts_with("http://127.0.0.1:") && !own.url.contains('#'));
    assert_eq!(own.ask("GET", "/health", "", b"").0, 200);
    // The port is in use.
    let second = papilio(&["--port", &own.port.to_string()]).output().unwrap();
    let said = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(2));
    assert!(said.contains("cannot listen on") && said.contains("--port"), "{said}");
}

/// A job writes the files of the command line, survives a kill of the server, and reads no file outside of its folder.
#[test]
fn job_equals_the_command_and_survives_a_kill_of_the_server() {
    let folder = tempfile::tempdir().unwrap();
    let jobs = folder.path().join("jobs");
    let start = |port: &str| Server::start(&["--port", port, "--jobs", jobs.to_str().unwrap()]);
    let server = start("0");
    let indoor = std::fs::read_to_string(scenarios().join("indoor.toml")).unwrap();
    let job =
        |command: &str, scenario: &str| json!({ "command": command, "scenario": scenario, "name": "indoor" });
    let (status, first) = server.post("/jobs/start", &job("pixel", &indoor));
    assert_eq!((status, &first["line"]), (200, &json!("papilio pixel indoor.toml")), "{first}");
    let (_, second) = server.post("/jobs/start", &job("study sampling", &indoor));
    assert_eq!(second["phase"], "waiting");
    let outside = format!("{indoor}\n[image]\nfile = '{}'\n", scenarios().join("data/chelsea.png").display());
    assert_eq!(server.post("/jobs/start", &job("image", &outside)).0, 422);
    let port = server.port.to_string();
    drop(server);

    let server = start(&port);
    let find = |id: &Value| {
        let (_, list) = server.post("/jobs", &json!({}));
        list["jobs"].as_array().unwrap().iter().find(|job| job["id"] == *id).cloned()
    };
    let began = std::time::Instant::now();
    let done = loop {
        let job = find(&first["id"]).unwrap();
        if job["phase"] == "done" {
            break job;
        }
        assert!(began.elapsed() < Duration::from_secs(60), "{job}");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(done["report"].as_str().unwrap().contains("peak wavelength"), "{done}");
    let request = json!({ "id": first["id"], "name": "pixel.csv" }).to_string();
    let (_, of_job) = server.bytes("POST", "/jobs/file", "application/json", request.as_bytes());
    let out = folder.path().join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    command.args(["pixel", "indoor.toml", "--out", out.to_str().unwrap()]).current_dir(scenarios());
    assert!(command.output().unwrap().status.success());
    assert!(of_job == std::fs::read(out.join("pixel.csv")).unwrap());
    let inputs = json!({ "id": first["id"], "name": "../designs/indoor.toml" });
    assert_eq!(server.post("/jobs/file", &inputs).0, 404);
    assert_eq!(server.post("/jobs/cancel", &json!({ "id": second["id"] })).0, 200);
    assert_eq!(server.post("/jobs/remove", &json!({ "id": first["id"] })).0, 200);
    assert!(find(&first["id"]).is_none());
}
