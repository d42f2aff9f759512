//! Load test with fifty clients, for `PAPILIO_LOAD_SECONDS`; `cargo xtask full` sets a minute.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::answers::indoor;
use crate::client::Server;

const CLIENTS: usize = 50;

/// Resident memory of the process, kB.
pub(crate) fn resident_kb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?.trim().split(' ').next()?.parse().ok()
}

/// Every response is a result or an intended refusal, memory stays bounded, and another user, who moves a
/// slider, is served at the same time.
///
/// The load lasts until it is heavy enough, too: on a busy machine that takes longer. Waiting times are
/// compared with a limit only where `PAPILIO_LOAD_SECONDS` is set, for a machine that does nothing else.
#[test]
fn fifty_clients_do_not_block_another_user() {
    let set = std::env::var("PAPILIO_LOAD_SECONDS").ok().and_then(|text| text.parse().ok());
    let seconds = set.unwrap_or(1);
    let server = Server::start();
    let scenario = indoor(&server);
    let live = |theta: f64| {
        let edits = json!([{ "op": "set", "path": "viewer.theta_deg", "value": theta }]);
        server.post("/live", &json!({ "scenario": scenario, "edits": edits }))
    };
    assert_eq!(live(0.0).status, 200);
    let before = resident_kb();
    let begun = Instant::now();
    let end = begun + Duration::from_secs(seconds);
    // A server that no longer answers is a failure, not an endless test.
    let is_hung = || begun.elapsed() > Duration::from_secs(300 + seconds);
    let (answered, refused) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let enough = || is_hung() || (Instant::now() > end && answered.load(Ordering::Relaxed) > CLIENTS);
    let mut waits = Vec::new();
    std::thread::scope(|scope| {
        for client in 0..CLIENTS {
            let (answered, refused, live, enough) = (&answered, &refused, &live, &enough);
            scope.spawn(move || {
                for turn in 0.. {
                    if enough() {
                        break;
                    }
                    match live(((client * 7 + turn * 3) % 120) as f64 - 60.0).status {
                        200 => answered.fetch_add(1, Ordering::Relaxed),
                        503 => refused.fetch_add(1, Ordering::Relaxed),
                        other => panic!("status {other}"),
                    };
                    std::thread::sleep(Duration::from_millis(100));
                }
            });
        }
        while !enough() {
            let started = Instant::now();
            // On a busy machine the wait for a place may end in a refusal: the page asks again, too.
            let status = loop {
                match live(8.0).status {
                    503 if set.is_none() && !is_hung() => std::thread::sleep(Duration::from_millis(100)),
                    other => break other,
                }
            };
            assert_eq!(status, 200);
            waits.push(started.elapsed());
            std::thread::sleep(Duration::from_millis(50));
        }
    });
    assert!(!is_hung(), "{answered:?} responses in {:?}", begun.elapsed());
    waits.sort_unstable();
    let grown_mb = before.zip(resident_kb()).map(|(before, after)| after.saturating_sub(before) / 1024);
    let quantile = |fraction: f64| waits[((waits.len() - 1) as f64 * fraction) as usize];
    println!(
        "{} responses, {} refusals in {seconds} s; another user waited {:?} (median), {:?} (95 %); memory grew by {grown_mb:?} MB",
        answered.load(Ordering::Relaxed),
        refused.load(Ordering::Relaxed),
        quantile(0.5),
        quantile(0.95),
    );
    assert!(grown_mb.is_none_or(|grown| grown < 500), "{grown_mb:?} MB");
    assert!(set.is_none() || quantile(0.95) < Duration::from_secs(2), "{:?}", quantile(0.95));
}
