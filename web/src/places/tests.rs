//! Tests of places for connections, of late bodies and their memory.

use super::*;

const PEERS: [IpAddr; 2] =
    [IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), IpAddr::V4(std::net::Ipv4Addr::UNSPECIFIED)];

fn places(total: usize, per_peer: usize, idle_ms: u64) -> Places {
    let [idle, unread] = [idle_ms, 50].map(Duration::from_millis);
    Places::new(Limits { total, per_peer, idle, patience: idle, unread, body_bytes: 4 * UNIT })
}

#[test]
fn longest_idle_connection_is_replaced_and_active_ones_are_protected() {
    let places = places(2, 2, 0);
    let first = places.take(PEERS[0]).unwrap();
    let second = places.take(PEERS[0]).unwrap();
    let request = first.begin_request();
    let third = places.take(PEERS[1]).unwrap();
    assert!(!first.state().is_ended && second.state().is_ended && !third.state().is_ended);
    let (_busy, _other) = (third.begin_request(), &second);
    assert!(places.take(PEERS[1]).is_none());
    drop(request);
    assert!(places.take(PEERS[1]).is_some() && first.state().is_ended);
}

#[test]
fn connection_beyond_the_limit_of_its_peer_replaces_one_of_this_peer() {
    let places = places(9, 2, 0);
    let other = places.take(PEERS[1]).unwrap();
    let own: Vec<_> = (0..3).map(|_| places.take(PEERS[0]).unwrap()).collect();
    assert!(own[0].state().is_ended && !own[1].state().is_ended && !other.state().is_ended);
}

#[test]
fn new_connection_is_not_replaced_before_the_idle_limit() {
    let places = places(1, 1, 60_000);
    let first = places.take(PEERS[0]).unwrap();
    assert!(places.take(PEERS[0]).is_none() && !first.state().is_ended);
    drop(first);
    assert!(places.take(PEERS[0]).is_some());
}

#[test]
fn connection_with_unread_response_is_closed() {
    let places = places(2, 2, 0);
    let (stuck, slow) = (places.take(PEERS[0]).unwrap(), places.take(PEERS[0]).unwrap());
    let _requests = [stuck.begin_request(), slow.begin_request()];
    stuck.record_write(&Poll::Pending, 10);
    slow.record_write(&Poll::Pending, 10);
    std::thread::sleep(Duration::from_millis(60));
    slow.record_write(&Poll::Ready(Ok(5)), 10);
    places.close_unread();
    assert!(stuck.state().is_ended && !slow.state().is_ended);
    assert!(slow.state().blocked_since.is_some());
    slow.record_write(&Poll::Ready(Ok(5)), 5);
    assert!(slow.state().blocked_since.is_none());
}

#[tokio::test]
async fn connection_whose_body_is_late_is_replaced() {
    let places = places(2, 2, 20);
    let [slow, fast] = [(); 2].map(|()| places.take(PEERS[0]).unwrap());
    let _requests = [slow.begin_request(), fast.begin_request()];
    let mut bodies =
        [&slow, &fast].map(|one| Receipt { places: places.clone(), connection: one.clone() }.begin_body());
    bodies[1].record(BODY_RATE as usize).await.unwrap();
    assert!(places.take(PEERS[0]).is_none());
    std::thread::sleep(Duration::from_millis(40));
    bodies[0].record(1).await.unwrap();
    assert!(places.take(PEERS[0]).is_some() && slow.state().is_ended && !fast.state().is_ended);
    // A request whose body has arrived is processed: its connection is active.
    drop(bodies);
    assert!(fast.state().waiting_since().is_none());
}

#[tokio::test]
async fn memory_of_bodies_is_limited() {
    let places = places(9, 9, 20);
    let receipt = || Receipt { places: places.clone(), connection: places.take(PEERS[0]).unwrap() };
    let (first, second) = (receipt(), receipt());
    let _requests = [&first, &second].map(|one| one.connection.begin_request());
    let mut body = first.begin_body();
    body.record(5 * UNIT).await.unwrap();
    let memory = body.complete();
    // The first MiB of each body is free; beyond it, the memory of others is not available.
    let mut body = second.begin_body();
    body.record(UNIT).await.unwrap();
    assert!(body.record(1).await.is_none());
    drop(memory);
    body.record(1).await.unwrap();
}

#[tokio::test]
async fn late_body_loses_its_memory_to_others() {
    let places = places(9, 9, 20);
    let receipt = || Receipt { places: places.clone(), connection: places.take(PEERS[0]).unwrap() };
    let (late, other) = (receipt(), receipt());
    let _requests = [&late, &other].map(|one| one.connection.begin_request());
    let mut held = late.begin_body();
    held.record(5 * UNIT).await.unwrap();
    late.connection.state().body_until = Some(Instant::now());
    tokio::time::sleep(Duration::from_millis(30)).await;
    assert!(other.begin_body().record(2 * UNIT).await.is_none() && late.connection.state().is_ended);
}
