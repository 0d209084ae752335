//! The harness itself, on a page of its own: what it says it does, the page sees.

use super::driver::{Browser, Network, Options};
use fantoccini::key::Key;
use serde_json::json;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// As studies have it.
const POLICY: &str =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'";

const PAGE: &str = r#"<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Harness</title>
<meta name="viewport" content="width=device-width"><link rel="stylesheet" href="/page.css"></head><body><main>
<h1>Harness</h1><noscript><p id="without">without scripts</p></noscript><p id="with"></p>
<button id="count">0</button>
<fieldset><legend>How many</legend>
<label><input type="radio" name="n" id="one" value="1">one</label>
<label><input type="radio" name="n" id="two" value="2">two</label>
<label><input type="radio" name="n" id="three" value="3">three</label></fieldset>
<label>Words <input id="words"></label>
<button id="ask">ask</button><p id="reply"></p></main><script type="module" src="/page.js"></script></body></html>"#;

const SCRIPT: &str = "
const at = id => document.getElementById(id);
at('with').textContent = 'with scripts';
let frames = 0;
requestAnimationFrame(function next() { document.body.dataset.frames = ++frames; requestAnimationFrame(next); });
at('count').onclick = event => { if (event.isTrusted) event.target.textContent++; };
at('ask').onclick = () => fetch('/now').then(got => got.text(), () => 'no answer').then(text => { at('reply').textContent = text; });
";

const STYLE: &str = "body { background: #fff; color: #000 }
@media (prefers-color-scheme: dark) { body { background: #000; color: #fff } }";

/// Its image has no text in place of it. Its script is forbidden by the policy.
const PLANTED: &str = r#"<!doctype html><html lang="en"><head><title>Planted</title><link rel="icon" href="/dot.svg"></head><body>
<main><h1>Planted</h1><img id="dot" src="/dot.svg" width="20" height="20"></main><script>document.title = 'run'</script></body></html>"#;

const DOT: &str =
    r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 2 2"><circle cx="1" cy="1" r="1"/></svg>"#;

/// Size of the page `/large` (bytes).
const LARGE: usize = 250_000;

/// Serves the pages until the process ends; their address.
fn serve() -> String {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            std::thread::spawn(move || answer(stream));
        }
    });
    address
}

fn answer(mut stream: TcpStream) {
    let mut lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
    let request = lines.next().unwrap_or_default();
    lines.take_while(|line| !line.is_empty()).for_each(drop);
    let large = || format!("<!doctype html><title>{}</title>large", "x".repeat(LARGE));
    let (status, kind, body) = match request.split(' ').nth(1) {
        Some("/") => (200, "text/html", PAGE.to_owned()),
        Some("/planted") => (200, "text/html", PLANTED.to_owned()),
        Some("/large") => (200, "text/html", large()),
        Some("/page.js") => (200, "text/javascript", SCRIPT.to_owned()),
        Some("/page.css") => (200, "text/css", STYLE.to_owned()),
        Some("/dot.svg") => (200, "image/svg+xml", DOT.to_owned()),
        Some("/now") => (200, "text/plain", "here".to_owned()),
        _ => (404, "text/plain", "not here".to_owned()),
    };
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status} .\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         Content-Security-Policy: {POLICY}\r\nConnection: close\r\n\r\n"
    );
    // a browser that goes away in between is no failure
    let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body.as_bytes()));
}

fn open(options: Options) -> Option<(Browser, String)> {
    let browser = Browser::open(options)?;
    let address = serve();
    browser.go(&address);
    Some((browser, address))
}

#[test]
fn clicks_and_keys_reach_the_page_as_a_persons_do() {
    let Some((browser, _)) = open(Options::default()) else { return };
    browser.wait_for_text("#with", "with scripts");
    browser.click("#count");
    browser.press(Key::Enter);
    browser.wait_for_text("#count", "2");

    browser.press(Key::Tab);
    browser.press(Key::Space);
    assert_eq!(browser.focus(), "one");
    for (key, chosen) in [(Key::Right, "two"), (Key::Down, "three"), (Key::Left, "two")] {
        browser.press(key);
        assert_eq!((browser.focus().as_str(), browser.count("input:checked")), (chosen, 1));
    }
    browser.press(Key::Tab);
    browser.type_text("in words");
    assert_eq!(browser.property("#words", "value").as_deref(), Some("in words"));
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn a_page_is_as_wide_as_asked_and_a_screenshot_shows_it() {
    let Some((mut browser, _)) = open(Options { size: [320, 568], ..Options::default() }) else { return };
    for size in [[320, 568], [1280, 720]] {
        browser.set_size(size);
        assert_eq!(browser.run("return [innerWidth, innerHeight]", &[]), json!(size));
        let png = browser.shot(&format!("harness-{}", size[0]));
        let info = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap().info().clone();
        assert_eq!([info.width, info.height], size);
    }
    assert_ne!(browser.shot_of("#count", "harness-count"), browser.shot_of("#ask", "harness-ask"));
}

#[test]
fn dark_mode_is_seen_by_styles_in_every_tab() {
    let Some((mut browser, address)) = open(Options { dark: true, ..Options::default() }) else { return };
    let ground = |browser: &Browser| browser.style("body", "background-color");
    assert_eq!(ground(&browser), "rgba(0, 0, 0, 1)");
    let first = browser.tab();
    browser.open_tab();
    browser.go(&address);
    assert_eq!(ground(&browser), "rgba(0, 0, 0, 1)");
    browser.close_tab(&first);
    browser.set_dark(false);
    assert_eq!(ground(&browser), "rgba(255, 255, 255, 1)");
}

#[test]
fn offline_is_offline_until_it_is_online_again() {
    let Some((mut browser, address)) = open(Options::default()) else { return };
    browser.set_network(Network::Offline);
    browser.click("#ask");
    browser.wait_for_text("#reply", "no answer");
    assert_eq!(browser.run("return navigator.onLine", &[]), json!(false));
    browser.set_network(Network::Full);
    browser.click("#ask");
    browser.wait_for_text("#reply", "here");
    browser.set_network(Network::Offline);
    assert!(browser.try_go(&address).is_err());
}

#[test]
fn a_slow_network_is_as_slow_as_asked() {
    let Some((mut browser, address)) = open(Options::default()) else { return };
    browser.set_network(Network::Slow(2.0));
    let begin = Instant::now();
    browser.go(&format!("{address}/large"));
    // 250,000 bytes at 2 Mbit/s
    assert!(begin.elapsed().as_secs_f64() > 0.9, "{:?}", begin.elapsed());
}

#[test]
fn without_scripts_a_page_still_can_be_used() {
    let Some((mut browser, _)) = open(Options { scripts: false, ..Options::default() }) else { return };
    assert_eq!(browser.text("#without"), "without scripts");
    browser.click("#count");
    browser.click("#two");
    assert_eq!((browser.text("#with"), browser.text("#count")), (String::new(), "0".to_owned()));
    assert_eq!(browser.property("#two", "checked").as_deref(), Some("true"));
    assert_eq!(browser.violations(), []);
    browser.reload();
    assert_eq!(browser.count("#without"), 1, "axe-core left scripts on");
    browser.set_scripts(true);
    browser.reload();
    browser.wait_for_text("#with", "with scripts");
    assert_eq!(browser.count("#without"), 0);
}

#[test]
fn a_hidden_page_knows_it_and_draws_nothing() {
    let Some((browser, _)) = open(Options::default()) else { return };
    let is_hidden = |browser: &Browser| browser.run("return document.hidden", &[]) == json!(true);
    let frames = |browser: &Browser| browser.run("return Number(document.body.dataset.frames)", &[]).as_u64();
    browser.until("no frames", |browser| (frames(browser) > Some(2)).then_some(()));
    assert!(!is_hidden(&browser));
    browser.hide();
    browser.until("not hidden", |browser| is_hidden(browser).then_some(()));
    let before = frames(&browser);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(frames(&browser), before);
    browser.show();
    browser.until("still hidden", |browser| (!is_hidden(browser)).then_some(()));
    browser.until("no frames", |browser| (frames(browser) > before).then_some(()));
}

#[test]
fn axe_finds_an_image_without_words_and_the_log_what_the_policy_forbids() {
    let Some((browser, address)) = open(Options::default()) else { return };
    assert_eq!(browser.violations(), []);
    assert_eq!(browser.complaints(), Vec::<String>::new());

    browser.go(&format!("{address}/planted"));
    assert_eq!(browser.title(), "Planted");
    let found = browser.violations();
    let seen: Vec<_> =
        found.iter().map(|violation| (violation.rule.as_str(), violation.element.as_str())).collect();
    assert_eq!(seen, [("image-alt", "#dot")], "{found:?}");
    let complaints = browser.complaints();
    assert!(complaints.len() == 1 && complaints[0].contains("Content Security Policy"), "{complaints:?}");
}

#[test]
fn what_a_page_has_stored_is_there_after_a_reload_a_close_and_a_crash() {
    let Some((browser, address)) = open(Options::default()) else { return };
    const STORED: &str = "return [localStorage.getItem('answer'), document.cookie]";
    let expected = json!(["4", "visit=7"]);
    browser.run("localStorage.setItem('answer', '4'); document.cookie = 'visit=7; max-age=9999'", &[]);
    browser.reload();
    assert_eq!(browser.run(STORED, &[]), expected);
    let profile = Some(browser.close());

    let browser = Browser::open(Options { profile, ..Options::default() }).unwrap();
    browser.go(&address);
    assert_eq!(browser.run(STORED, &[]), expected);
    let profile = Some(browser.kill());

    let browser = Browser::open(Options { profile, ..Options::default() }).unwrap();
    browser.go(&address);
    assert_eq!(browser.run(STORED, &[]), expected);
    browser.go(&format!("{address}/planted"));
    browser.back();
    assert_eq!(browser.address(), format!("{address}/"));
    let another = Browser::open(Options::default()).unwrap();
    another.go(&address);
    assert_eq!(another.run(STORED, &[]), json!([null, ""]), "an empty profile remembers");
}
