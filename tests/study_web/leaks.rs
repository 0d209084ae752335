//! Nothing that a browser gets names a gait, an emotion of a stimulus, a condition or the order of the library.

use crate::client::Reply;
use crate::lab::{Lab, SECRET, go_on};
use gaitway::Emotion;
use std::collections::BTreeSet;

/// What a text tells that it should not.
fn told(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for word in [SECRET, "practice 1", "practice 2", "practice 3", "library.glb", "4815162342", "acted"] {
        if text.contains(word) {
            found.push(word.to_owned());
        }
    }
    let words: BTreeSet<String> =
        text.split(|letter: char| !letter.is_ascii_alphanumeric()).map(str::to_lowercase).collect();
    let labels = Emotion::ALL.iter().map(|emotion| emotion.name());
    let rest = ["emotion", "seed", "counted", "catch", "repeat", "baseline", "ordinary"];
    found.extend(labels.chain(rest).filter(|word| words.contains(*word)).map(str::to_owned));
    found
}

#[test]
fn no_byte_of_a_whole_participation_tells_what_is_shown() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "");
    assert!(page.last().unwrap().body.contains("C1DONE"));
    let sent = browser.received.join("\n");
    assert!(sent.len() > 100_000 && sent.matches("\"poses\"").count() >= 7, "{} bytes", sent.len());
    assert_eq!(told(&sent), Vec::<String>::new());
    let walks = browser.received.iter().filter(|sent| sent.contains("\"poses\""));
    assert_eq!(walks.filter(|walk| walk.contains("label")).count(), 0, "pages have labels of fields");
    assert_eq!(
        told("a Zyxgait, SAD.\"seed\":1"),
        ["Zyxgait", "sad", "seed"],
        "the search finds what is there"
    );
}

#[test]
fn no_refusal_of_any_route_tells_what_is_shown() {
    let lab = Lab::plain();
    let (mut browser, page) = lab.agreed();
    let page = go_on(&mut browser, page, "walks/").pop().unwrap();
    let mark = page.attribute("data-mark");
    let id = page.attribute("data-page");
    let long = "x".repeat(20_000);
    let mut statuses = BTreeSet::new();
    let mut note = |reply: Reply| {
        assert_eq!(told(&format!("{:?} {}", reply.headers, reply.body)), Vec::<String>::new(), "{reply:?}");
        assert!(!reply.header("content-type").starts_with("text/plain"), "bare words: {reply:?}");
        statuses.insert(reply.status);
    };
    for path in
        ["/nothing", "/s/other", "/s/%ff", "/s/looks?code=NO", "/stimuli/no", "/stimuli/%ff", "/static/%ff/x"]
    {
        note(browser.get(path));
    }
    for method in ["PUT", "DELETE", "POST", "OPTIONS"] {
        note(browser.send(&format!("{method} /s/looks/go HTTP/1.1\r\n"), &[], ""));
    }
    let off_scale =
        format!(r#"{{"page":"{id}","question":"health.well","value":99,"first_ms":1,"ms":1,"key":"k"}}"#);
    let other_page = off_scale.replace(&id, "walks/99");
    for (route, body) in [
        ("answer", off_scale.as_str()),
        ("answer", &other_page),
        ("answer", "{"),
        ("answer", &long),
        ("event", r#"{"event":"next","page":"walks/77"}"#),
        ("event", r#"{"event":"placed","place":1,"trials":[]}"#),
        ("event", r#"{"event":"nonsense"}"#),
        ("begin", "{}"),
    ] {
        note(browser.json(&format!("/s/looks/{route}"), &mark, body));
        note(browser.json(&format!("/s/looks/{route}"), "0123456789abcdef", body));
    }
    let page_field = ("page", id.as_str());
    for fields in [
        vec![("mark", mark.as_str()), page_field, ("q:health.well", "99")],
        vec![("mark", "wrong"), page_field],
        vec![("mark", mark.as_str()), ("page", "walks/99")],
        vec![("long", long.as_str())],
    ] {
        for route in ["begin", "answer", "withdraw", "event"] {
            note(browser.post(&format!("/s/looks/{route}"), &fields));
        }
    }
    let evil = [("origin", "https://evil.example.org"), ("content-type", "application/json")];
    note(browser.send("POST /s/looks/answer HTTP/1.1\r\n", &evil, "{}"));
    note(lab.browser().json("/s/looks/answer", &mark, &off_scale));
    for status in [400, 401, 403, 404, 409, 413, 415] {
        assert!(statuses.contains(&status), "no refusal of status {status}: {statuses:?}");
    }
}

#[test]
fn names_of_stimuli_differ_between_studies_of_the_same_file() {
    let names = || Lab::plain().store.current().stimuli.keys().cloned().collect::<BTreeSet<_>>();
    let (one, two) = (names(), names());
    assert_eq!((one.len(), one.intersection(&two).count()), (11, 0));
    let lab = Lab::plain();
    let mut browser = lab.browser();
    for name in &one {
        assert_eq!(browser.get(&format!("/stimuli/{name}")).status, 404);
    }
    for path in ["/stimuli/..%2f..%2fstudy.sqlite", "/stimuli/%2e%2e", "/stimuli/"] {
        assert_eq!(browser.get(path).status, 404, "{path}");
    }
}

#[test]
fn a_walk_is_drawn_from_the_constants_of_the_renderer() {
    use gaitway::export::figure;
    let lab = Lab::plain();
    let version = lab.store.current();
    let name = version.stimuli.keys().next().unwrap();
    let reply = lab.browser().get(&format!("/stimuli/{name}"));
    let walk: serde_json::Value = serde_json::from_str(&reply.body).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let close = |value: &serde_json::Value, own: f32| (number(value) - f64::from(own)).abs() < 1e-6;
    assert!(close(&walk["focus"], figure::FOCUS) && close(&walk["stripes"]["every"], figure::STRIPES));
    assert!(close(&walk["camera"][2], figure::CAMERA.z) && close(&walk["thick"][1], figure::THICK[1]));
    assert_eq!(walk["poses"].as_array().unwrap().len(), 64);
    assert!(walk["poses"].as_array().unwrap().iter().all(|pose| pose.as_array().unwrap().len() == 16));
}
