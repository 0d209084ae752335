//! Without a connection, with a slow one, and without scripts.

use super::driver::{Browser, Network, Options};
use super::visit::{Given, Hands, Visit};
use serde_json::json;
use std::time::Duration;

/// What a page may need before its first film, bytes.
const LIGHT: f64 = 60_000.0;

/// What the network has to say of a lost connection.
fn is_of_the_network(complaint: &str) -> bool {
    complaint.contains("net::ERR_INTERNET_DISCONNECTED")
}

#[test]
fn an_answer_without_a_connection_waits_and_is_counted_once() {
    let Some((mut visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    visit.browser.set_network(Network::Offline);
    let mut here = Given::new();
    visit.answer("practice/1", &mut here);
    let said = "Offline: your answer waits here and is sent again.";
    visit.browser.wait_for_text("#status", said);
    visit.press("button.next");
    std::thread::sleep(Duration::from_millis(700));
    assert_eq!((visit.page().as_str(), visit.browser.text("#status").as_str()), ("practice/1", said));
    assert_eq!(visit.stored("SELECT count(*) FROM answer WHERE page = 'practice/1'"), 0);
    visit.browser.shot("offline");
    visit.browser.set_network(Network::Full);
    assert_eq!(visit.after("practice/1"), "practice/2:film");
    given.extend(here);
    visit.assert_stored(&given);
    assert_eq!(
        visit.browser.complaints().into_iter().filter(|one| !is_of_the_network(one.as_str())).count(),
        0
    );
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
}

#[test]
fn a_server_that_is_gone_for_a_while_loses_nothing() {
    let Some((mut visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    visit.server.kill();
    visit.answer("practice/1", &mut given);
    visit.press("button.next");
    visit.browser.wait_for_text("#status", "Offline: your answer waits here and is sent again.");
    visit.server = visit.lab.serve();
    visit.after("practice/1");
    visit.assert_stored(&given);
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
}

#[test]
fn a_film_waits_for_the_connection_and_that_is_no_fault() {
    let Some((mut visit, mut given)) = Visit::at(Options::default(), "practice/1") else { return };
    visit.browser.devtools("Network.setBlockedURLs", &json!({ "urls": ["*/stimuli/*"] }));
    visit.pass(&mut given);
    visit.after("practice/1");
    visit.browser.set_network(Network::Offline);
    visit.browser.devtools("Network.setBlockedURLs", &json!({ "urls": [] }));
    // longer than a film may take with a connection
    std::thread::sleep(Duration::from_secs(13));
    assert!(visit.browser.text(".film-status").starts_with("There is no connection."));
    visit.browser.set_network(Network::Full);
    visit.wait_for_film();
    assert_eq!(
        (visit.page().as_str(), visit.browser.text(".film-status").is_empty()),
        ("practice/2:film", false)
    );
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
    assert_eq!(visit.stored("SELECT count(*) FROM event WHERE kind = 'fault'"), 0);
}

/// How long it takes from nothing to a film that can be started, ms.
fn cold_start(browser: &Browser) -> f64 {
    browser.reload();
    let ready = "
        const done = arguments[0];
        const look = () => document.querySelector('.play:enabled') ? done(performance.now()) : requestAnimationFrame(look);
        look()";
    browser.run_async(ready, &[]).as_f64().unwrap()
}

#[test]
fn the_first_film_is_light_and_fast_on_a_slow_connection() {
    let options = Options { listens: true, network: Network::Slow(3.0), ..Options::default() };
    let Some(visit) = Visit::new(options, Hands::Mouse) else { return };
    visit.open();
    visit.go_on("practice/1:film");
    visit.wait_for_film();
    let received = |browser: &Browser| -> f64 {
        let events = browser.network_events();
        let ended = events.iter().filter(|event| event["method"] == "Network.loadingFinished");
        ended.map(|event| event["params"]["encodedDataLength"].as_f64().unwrap()).sum()
    };
    let bytes = received(&visit.browser);
    assert!((10_000.0..LIGHT).contains(&bytes), "{bytes} bytes before the first film");
    visit.browser.devtools("Network.setCacheDisabled", &json!({ "cacheDisabled": true }));
    // the best of some, as the machine has other work to do
    let fastest = (0..6).map(|_| cold_start(&visit.browser)).fold(f64::INFINITY, f64::min);
    let alone = received(&visit.browser) / 6.0;
    println!(
        "{bytes} bytes before the first film; its page alone {alone} bytes, ready after {fastest:.0} ms"
    );
    assert!(fastest < 1000.0, "{fastest} ms");
    assert!(alone > 5_000.0, "the cache was on");
    visit.assert_quiet();
}

#[test]
fn without_scripts_forms_work_and_a_film_says_what_it_needs() {
    let Some(mut visit) = Visit::new(Options { scripts: false, ..Options::default() }, Hands::Mouse) else {
        return;
    };
    visit.open();
    let mut given = visit.go_through("practice/1:film", |visit, page| {
        assert_eq!(visit.browser.violations(), [], "{page}");
    });
    assert!(visit.browser.text("main").contains("for that it needs JavaScript"));
    assert_eq!(visit.browser.count(".play"), 1);
    visit.browser.shot("without-scripts");
    assert_eq!(visit.browser.violations(), []);
    visit.browser.click("form[action$='/withdraw'] button");
    visit.browser.wait_for_text("h1", "Do you want to stop and withdraw?");
    visit.browser.click("a.button");
    visit.browser.wait_for_text("h1", "Please watch");
    assert_eq!(visit.page(), "practice/1:film");
    visit.assert_stored(&given);
    visit.browser.set_scripts(true);
    visit.browser.reload();
    given.extend(visit.go_on("practice/1"));
    // from here on without them again, as far as the next film
    visit.browser.set_scripts(false);
    visit.browser.reload();
    given.extend(visit.go_on("practice/2:film"));
    visit.assert_stored(&given);
    visit.assert_quiet();
}
