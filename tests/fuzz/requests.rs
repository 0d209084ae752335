//! The study whose pages are asked for, and right requests to every route of it.

/// What is served; `PLATFORM` stands for where people come from.
pub(crate) const STUDY: &str = r#"
[study]
id = "looks"
version = 1
title = { en = "How do they look?", de = "Wie sehen Leute aus?" }
seed = 4815162342
languages = ["en", "de"]
minutes = 7
contact = "Lab"
flow = ["consent", "about-you", "check", "practice", "walks", "scenes", "remarks"]
[consent]
text = "consent.md"
[recruit]
platform = "PLATFORM"
codes = { complete = "C1DONE", screened-out = "C2OUT", withdrawn = "C3GONE" }
most_participants = 1000000
[part.about-you]
kind = "form"
ask = ["gender", "age"]
[part.check]
kind = "comprehension"
attempts = 2
questions = [{ text = "What do you look at?", options = ["figures", "clouds"], right = 0 }]
[part.practice]
kind = "trials"
show = { gaits = "practice", seconds = 0.5 }
ask = "health"
counted = false
[part.walks]
kind = "trials"
show = { gaits = "library.glb", seconds = 0.5, replay = true }
design = { kind = "fill", each = 2, at_least = 100000 }
ask = "health"
[part.scenes]
kind = "trials"
show = { scenes = ["garden"], conditions = ["baseline", "eva-g"], seconds = 2 }
ask = "which"
[part.remarks]
kind = "form"
ask = "words"
[crowd]
library = "library.glb"
avatars = ["female"]
[questions.health]
kind = "likert"
points = ["no", "rather", "yes"]
items = [{ id = "well", text = "looks well" }, { id = "ill", text = "looks ill" }]
[questions.which]
kind = "choice"
options = ["one", "two"]
[questions.words]
kind = "text"
text = "Anything else?"
most = 400
"#;

/// Headers of a form from its own page.
pub(crate) const FORM: &str = "host: localhost\norigin: http://localhost\nsec-fetch-site: same-origin\n\
                    content-type: application/x-www-form-urlencoded\n";
/// Headers of JSON from a script of its own page.
const JSON: &str = "host: localhost\norigin: http://localhost\nsec-fetch-site: same-origin\n\
                    content-type: application/json\n";

/// Requests of participants: one or more of every route.
pub(crate) fn visits(platform: &str) -> Vec<Vec<u8>> {
    let get = |path: &str, headers: &str| format!("GET {path} HTTP/1.1\nhost: localhost\n{headers}\n");
    let form = |route: &str, stage: usize, body: &str| {
        let cookie = format!("cookie: a=b; gaitway=@token{stage}@\n");
        format!("POST /s/looks/{route} HTTP/1.1\n{FORM}{cookie}\nmark=@mark{stage}@&{body}")
    };
    let json = |route: &str, stage: usize, body: &str| {
        let cookie = format!("cookie: gaitway=@token{stage}@\nx-participation: @mark{stage}@\n");
        format!("POST /s/looks/{route} HTTP/1.1\n{JSON}{cookie}\n{body}")
    };
    let answer = |stage: usize, question: &str, value: &str| {
        let body = format!(
            r#"{{"page":"@page{stage}@","question":"{question}",{value},"first_ms":10,"ms":20,"key":"ab12"}}"#
        );
        json("answer", stage, &body)
    };
    let link = match platform {
        "mturk" => {
            "/s/looks?workerId=W1&assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=h&turkSubmitTo=https%3A%2F%2Fx"
        }
        _ => "/s/looks?PROLIFIC_PID=p1%3Czyx%3E&STUDY_ID=x&SESSION_ID=s1",
    };
    let mut all = vec![
        get("/s/looks", "accept-language: de-AT,de;q=0.8,en;q=0.5\n"),
        get(link, ""),
        get("/s/looks?new&lang=de", "cookie: gaitway=@token1@\n"),
        get("/s/looks?code=@code3@", ""),
        get("/stimuli/@film3@", "accept-encoding: gzip, br;q=0\n"),
        get("/stimuli/@film7@", "range: bytes=100-299\n"),
        get("/static/0000000000000000/page.mjs", ""),
        get("/healthz", ""),
        get("/nothing/%3Czyx%3E", "cookie: gaitway=x\n"),
        get("/s/looks/go", "cookie: gaitway=@token6@\naccept: application/json\n"),
        format!(
            "POST /s/looks/begin HTTP/1.1\n{FORM}\nlanguage=de&PROLIFIC_PID=p2&SESSION_ID=%3Czyx%3E&workerId=w"
        ),
        form("begin", 0, "agree=yes"),
        form("begin", 0, "agree=no"),
        form("answer", 1, "page=@page1@&shown=1700000000000&q%3Aage=33&q%3Agender=1"),
        form("answer", 1, "page=@page1@&shown=x&q%3Aage=%3Czyx%3E"),
        form("answer", 2, "page=@page2@&shown=1&q%3Aquestion-1=0"),
        form("answer", 4, "page=@page4@&q%3Ahealth.well=2"),
        form("answer", 6, "page=@page6@&shown=1&q%3Ahealth.well=1&q%3Ahealth.ill=3"),
        form("answer", 8, "page=@page8@&q%3Awords=%3Czyx%3E+%22a%22%0D%0A%C3%A9"),
        form("withdraw", 1, "x=y"),
        form("withdraw", 4, "sure=yes"),
        answer(1, "age", r#""value":30"#),
        answer(6, "health.ill", r#""value":2"#),
        answer(8, "words", r#""text":"=1+1 <zyx>""#),
        json("event", 8, r#"{"event":"next","page":"@page8@"}"#),
        json("event", 6, r#"{"event":"sign","page":"@page6@","kind":"hidden <zyx>"}"#),
        json("event", 0, r#"{"event":"consented","text":"x"}"#),
        json("event", 9, r#"{"event":"withdrawn"}"#),
        json("event", 5, r#"{"event":"fault","page":"@page5@","reason":"status 500 <zyx>"}"#),
        json("event", 2, r#"{"event":"excluded","reason":"x"}"#),
    ];
    for stage in [3, 5, 7] {
        let shown = r#""exposure":{"started":1,"seconds_visible":0.5,"plays":1,"frames":30,"late_frames":1,"longest_ms":20.5}"#;
        all.push(json("event", stage, &format!(r#"{{"event":"shown","page":"@page{stage}@",{shown}}}"#)));
    }
    all.extend((0..10).map(|stage| get("/s/looks/go", &format!("cookie: gaitway=@token{stage}@\n"))));
    all.into_iter().map(String::into_bytes).collect()
}

/// Requests of operators: one or more of every route. Passwords are too short or wrong, as a hash takes its time by design.
pub(crate) fn operations() -> Vec<Vec<u8>> {
    let get = |path: &str| format!("GET {path} HTTP/1.1\nhost: localhost\ncookie: gaitway-admin=@key0@\n\n");
    let form = |route: &str, body: &str| {
        format!("POST /admin/{route} HTTP/1.1\n{FORM}cookie: gaitway-admin=@key0@\n\nmark=@seal0@&{body}")
    };
    let act = |act: &str, text: &str| form("participants", &format!("code=@code0@&act={act}&text={text}"));
    let pages =
        ["live", "live/events", "participants?said=act", "balance", "operators?said=operator", "login"];
    let mut all: Vec<String> = pages.iter().map(|page| get(&format!("/admin/{page}"))).collect();
    all.extend([
        get("/"),
        get("/admin/first?key=%3Czyx%3E"),
        get("/static/0000000000000000/admin.mjs"),
        act("pause", ""),
        act("resume", ""),
        act("note", "tired+%3Czyx%3E"),
        act("exclude", ""),
        act("exclude", "slept+%3Czyx%3E"),
        act("withdraw", "with"),
        form("admission", "open=yes"),
        form("admission", "open=no"),
        form("operators", "name=bob+%3Czyx%3E&password=short&role=run"),
        format!("POST /admin/backup HTTP/1.1\n{FORM}cookie: gaitway-admin=@key0@\n\nmark=x"),
        format!("POST /admin/first HTTP/1.1\n{FORM}\nkey=0&name=eve&password=another+long+password"),
        format!("POST /admin/login HTTP/1.1\n{FORM}\nname=ann%3Czyx%3E&password=wrong"),
        format!("POST /admin/logout HTTP/1.1\n{FORM}cookie: gaitway-admin=x\n\nmark=x"),
    ]);
    all.into_iter().map(String::into_bytes).collect()
}

/// Requests that ask for much: reader, what they do, bytes.
pub(crate) fn hostile() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let long = "x".repeat(1 << 18);
    let many = "a=b&".repeat(4000);
    let deep = "[".repeat(16_000);
    vec![
        ("visit", "a body that is too long", format!("POST /s/looks/begin HTTP/1.1\n{FORM}\n{long}").into_bytes()),
        ("visit", "many fields", format!("POST /s/looks/answer HTTP/1.1\n{FORM}cookie: gaitway=@token1@\n\n{many}").into_bytes()),
        (
            "visit",
            "nested brackets",
            format!("POST /s/looks/event HTTP/1.1\n{JSON}cookie: gaitway=@token1@\nx-participation: @mark1@\n\n{{\"event\":{deep}")
                .into_bytes(),
        ),
        ("visit", "a long cookie", format!("GET /s/looks HTTP/1.1\nhost: localhost\ncookie: gaitway={long}\n\n").into_bytes()),
        ("operate", "a body that is too long", format!("POST /admin/login HTTP/1.1\n{FORM}\n{long}").into_bytes()),
    ]
}
