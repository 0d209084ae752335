//! What is refused, and the headers of what is not.

use crate::client::{Browser, Reply};
use crate::lab::{Lab, begin, go_on};
use gaitway::study::serve::{Error, Server};

const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");

#[test]
fn every_reply_has_the_headers_of_the_design() {
    let lab = Lab::plain();
    let mut browser = lab.browser();
    let film = lab.store.current().stimuli.keys().next().unwrap().clone();
    let page = browser.open("/s/looks");
    let style =
        page.body.split("rel=\"stylesheet\" href=\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
    for path in ["/s/looks", "/nothing", "/healthz", &style, &format!("/stimuli/{film}")] {
        let reply = browser.get(path);
        assert_eq!(
            reply.header("content-security-policy"),
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; media-src 'self'; connect-src 'self'; \
             form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
            "{path}"
        );
        assert_eq!(reply.header("x-content-type-options"), "nosniff");
        assert_eq!(reply.header("referrer-policy"), "same-origin");
        assert_eq!(reply.header("strict-transport-security"), "", "not without TLS");
    }
    for path in [&style, &format!("/stimuli/{film}")] {
        let reply = browser.get(path);
        assert_eq!(reply.header("cache-control"), "public, max-age=31536000, immutable");
        assert_eq!((reply.header("content-encoding"), reply.status), ("gzip", 200));
        let plain = browser.send(&format!("GET {path} HTTP/1.1\r\n"), &[("accept-encoding", "identity")], "");
        assert_eq!(plain.body, reply.body);
    }
    assert_eq!(browser.get("/s/looks").header("cache-control"), "no-store");
    let files = style.rsplit_once('/').unwrap().0;
    for module in ["page.mjs", "queue.mjs", "walk.mjs"] {
        let reply = browser.get(&format!("{files}/{module}"));
        assert_eq!((reply.status, reply.header("content-type")), (200, "text/javascript; charset=utf-8"));
    }
    assert_eq!(browser.get("/static/0000000000000000/page.mjs").status, 404);
    assert_eq!(browser.get("/healthz").body, "ok\n");
}

#[test]
fn the_cookie_is_kept_from_scripts_and_needs_tls_where_there_is_some() {
    let lab = Lab::plain();
    let reply = lab.browser().post("/s/looks/begin", &[]);
    let cookie = reply.header("set-cookie");
    assert!(cookie.starts_with("gaitway=") && cookie.contains("; HttpOnly; SameSite=Lax"), "{cookie}");
    let lab = Lab::new(&[], |settings| {
        settings.public_url = Some("https://lab.example.org".to_owned());
        settings.is_behind_proxy = true;
    });
    let mut browser = lab.browser();
    let from = |origin| [("origin", origin), ("host", "lab.example.org"), FORM];
    let line = "POST /s/looks/begin HTTP/1.1\r\n";
    assert_eq!(browser.send(line, &from("https://evil.example.org"), "").status, 403);
    let reply = browser.send(line, &from("https://lab.example.org"), "");
    let cookie = reply.header("set-cookie");
    assert!(
        cookie.starts_with("__Host-gaitway=")
            && cookie.ends_with("; Path=/; Max-Age=2592000; HttpOnly; SameSite=Lax; Secure")
    );
    assert_eq!(reply.header("strict-transport-security"), "max-age=31536000");
}

#[test]
fn other_origins_and_other_types_change_nothing() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let own = format!("http://{}", lab.address);
    let mark = page.attribute("data-mark");
    let body = format!("mark={mark}&sure=yes");
    let line = "POST /s/looks/withdraw HTTP/1.1\r\n";
    let cases: [(&[(&str, &str)], u16); 7] = [
        (&[("origin", "https://evil.example.org"), FORM], 403),
        (&[("origin", "null"), FORM], 403),
        (&[FORM], 403),
        (&[("origin", &own), ("sec-fetch-site", "cross-site"), FORM], 403),
        (&[("origin", &own), ("host", "evil.example.org"), FORM], 403),
        (&[("origin", &own), ("content-type", "text/plain")], 415),
        (&[("origin", &own), ("content-type", "multipart/form-data; boundary=x")], 415),
    ];
    for (headers, status) in cases {
        let reply = browser.send(line, headers, &body);
        assert_eq!(reply.status, status, "{headers:?}");
        assert!(reply.body.contains("<h1"), "a page with a way out");
    }
    // a form without the page's mark, as another host would have to make it
    assert_eq!(browser.post("/s/looks/withdraw", &[("sure", "yes")]).status, 403);
    assert_eq!(
        browser.post("/s/looks/withdraw", &[("sure", "yes"), ("mark", "0123456789abcdef")]).status,
        403
    );
    assert_eq!(browser.json("/s/looks/event", "", r#"{"event":"withdrawn"}"#).status, 403);
    assert_eq!(browser.open("/s/looks/go").attribute("data-page"), "about-you");
    assert_eq!(
        browser.send(line, &[("origin", &own), FORM], &body).status,
        200,
        "the same from its own page"
    );
}

#[test]
fn a_page_of_an_earlier_participation_does_not_answer_for_the_next_one() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let mark = page.attribute("data-mark");
    browser.cookies.clear();
    let consent = begin(&mut browser);
    assert_ne!(consent.attribute("data-mark"), mark);
    let answer = r#"{"page":"about-you","question":"age","value":40,"first_ms":1,"ms":1,"key":"k"}"#;
    assert_eq!(browser.json("/s/looks/answer", &mark, answer).status, 403);
    let form = browser.post("/s/looks/answer", &[("mark", &mark), ("page", "about-you"), ("q:age", "40")]);
    assert!(form.status == 403 && form.body.contains("Another participation was begun"), "{form:?}");
}

#[test]
fn long_bodies_and_broken_ones_are_refused() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let mark = page.attribute("data-mark");
    let long = "x".repeat(16 << 10);
    let answer =
        format!(r#"{{"page":"about-you","question":"age","text":"{long}","first_ms":1,"ms":1,"key":"k"}}"#);
    assert_eq!(browser.json("/s/looks/answer", &mark, &answer).status, 413);
    let form = browser.post("/s/looks/answer", &[("mark", &mark), ("page", "about-you"), ("q:age", &long)]);
    assert!(form.status == 413 && form.body.contains("This is too long"));
    let empty = r#"{"page":"about-you","question":"age","value":1,"first_ms":1,"ms":1,"key":""}"#;
    let unknown =
        r#"{"page":"about-you","question":"age","value":1,"first_ms":1,"ms":1,"key":"k","label":1}"#;
    for broken in ["", "{", "[]", "null", r#"{"page":1}"#, empty, unknown] {
        assert_eq!(browser.json("/s/looks/answer", &mark, broken).status, 400, "{broken}");
        assert_eq!(browser.json("/s/looks/event", &mark, broken).status, 400, "{broken}");
    }
    for route in ["begin", "answer", "withdraw"] {
        let own = format!("http://{}", lab.address);
        let line = format!("POST /s/looks/{route} HTTP/1.1\r\n");
        let reply = browser.send(&line, &[("origin", &own), FORM], "\u{1}\u{fffd}%ff&&=&a");
        assert!((400..500).contains(&reply.status), "{route}: {}", reply.status);
    }
}

#[test]
fn only_what_fronts_may_send_is_taken() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let mark = page.attribute("data-mark");
    for event in [
        r#"{"event":"arrived","person":1,"front":"simulated","language":"en"}"#,
        r#"{"event":"placed","place":0,"trials":[]}"#,
        r#"{"event":"full"}"#,
        r#"{"event":"lapsed"}"#,
        r#"{"event":"returned","swaps":[]}"#,
        r#"{"event":"paused"}"#,
        r#"{"event":"resumed"}"#,
        r#"{"event":"excluded","reason":"x"}"#,
        r#"{"event":"replaced","part":"walks","position":1,"item":null}"#,
    ] {
        assert_eq!(browser.json("/s/looks/event", &mark, event).status, 403, "{event}");
    }
    let sign = r#"{"event":"sign","page":"about-you","kind":"hidden"}"#;
    assert_eq!(browser.json("/s/looks/event", &mark, sign).status, 200);
    let skip = r#"{"event":"next","page":"debrief"}"#;
    assert_eq!(browser.json("/s/looks/event", &mark, skip).status, 409);
}

#[test]
fn too_many_requests_are_refused_by_secret_and_by_neighbourhood() {
    let lab = Lab::plain();
    let (mut browser, _) = lab.agreed();
    assert!((0..200).all(|_| browser.get("/s/looks/go").status == 200), "fewer than 300 are fine");
    assert!((0..3000).any(|_| browser.get("/s/looks/go").status == 429), "more are not");
    assert_eq!(lab.browser().get("/s/looks").status, 200, "others are not concerned");

    let lab = Lab::new(&[], |settings| {
        settings.requests_per_minute = 20;
        settings.is_behind_proxy = true;
    });
    let ask = |address: &str| -> Vec<Reply> {
        let mut browser = lab.browser();
        browser.extra.push(("x-forwarded-for".to_owned(), format!("203.0.113.7, {address}")));
        (0..25).map(|_| browser.get("/s/looks")).collect()
    };
    let refused = |replies: &[Reply]| replies.iter().filter(|reply| reply.status == 429).count();
    let first = ask("198.51.100.1");
    assert!((1..=5).contains(&refused(&first)), "{}", refused(&first));
    assert!(first.last().unwrap().body.contains("Please wait a minute"));
    assert!(refused(&ask("198.51.100.99")) >= 15, "a neighbour shares the count");
    assert!(refused(&ask("192.0.2.1")) <= 5, "another network does not");
}

#[test]
fn what_is_written_is_shown_as_text_and_never_runs() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "remarks").pop().unwrap();
    let attack = "</textarea><script>alert(1)</script>\"'><img src=x onerror=alert(1)>";
    let mark = page.attribute("data-mark");
    // too long with the attack in it: the page comes again and shows what was written
    let long = format!("{attack}{}", "y".repeat(400));
    let again = browser.post("/s/looks/answer", &[("mark", &mark), ("page", "remarks"), ("q:words", &long)]);
    assert_eq!(again.status, 422);
    assert!(!again.body.contains("<script>alert") && !again.body.contains("<img"), "{}", again.body);
    assert!(again.body.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    let stored =
        browser.post("/s/looks/answer", &[("mark", &mark), ("page", "remarks"), ("q:words", attack)]);
    assert_eq!(stored.status, 303);
    // addresses and headers that are shown back
    for path in [
        "/s/%3Cscript%3Ealert(1)%3C/script%3E",
        "/s/looks?lang=%22%3E%3Cscript%3E",
        "/s/looks?code=%3Cscript%3E",
    ] {
        assert!(!lab.browser().open(path).body.contains("<script>"), "{path}");
    }
}

#[test]
fn a_taken_port_and_a_console_that_others_reach_are_refused() {
    let lab = Lab::plain();
    let taken = gaitway::study::serve::Settings { listen: lab.address, console: None, ..Default::default() };
    let error = Server::bind(lab.store.clone(), &taken).unwrap_err();
    assert!(matches!(error, Error::Listen { address, .. } if address == lab.address), "{error}");
    let open =
        gaitway::study::serve::Settings { console: Some(([0, 0, 0, 0], 0).into()), ..Default::default() };
    assert!(matches!(Server::bind(lab.store.clone(), &open), Err(Error::Console { .. })));
}

#[test]
fn only_pages_of_participants_go_into_frames_and_only_of_the_origins_of_the_file() {
    let named = "platform = \"none\"\nembed_in = [\"https://a.example.org\", \"https://b.example.org:8443\"]";
    let lab = Lab::new(&[("platform = \"none\"", named)], |_| {});
    let page = lab.browser().get("/s/looks");
    let policy = page.header("content-security-policy").to_owned();
    assert!(
        policy.ends_with("; frame-ancestors https://a.example.org https://b.example.org:8443"),
        "{policy}"
    );
    assert_eq!(page.header("x-frame-options"), "", "it knows no origins");
    let cookie = lab.browser().post("/s/looks/begin", &[]).header("set-cookie").to_owned();
    assert!(cookie.ends_with("; HttpOnly; SameSite=None; Partitioned; Secure"), "{cookie}");
    let console = Browser::new(lab.console).get("/admin/login");
    assert!(console.header("content-security-policy").ends_with("; frame-ancestors 'none'"), "{console:?}");
    assert_eq!(console.header("x-frame-options"), "DENY");
    assert_eq!(Lab::plain().browser().get("/s/looks").header("x-frame-options"), "DENY");
}
