//! Requests to the pages of a study: every route of participants and of operators, through the whole server but its sockets.
//!
//! An input is a request as HTTP/1.1 writes it, with lines that end in `\n`. Words such as `@token3@` stand for what only the
//! running server knows: secret, mark, page, film and code of a participant who is at one of ten [`Stage`]s, and `@key0@` and
//! `@seal0@` for an operator's. So an input means the same in every run. A participant that a request has moved on is replaced.

use crate::mutate::Form;
use crate::requests::{FORM, STUDY, operations, visits};
use crate::targets::Target;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, Request, Response, Uri};
use gaitway::gait::Gait;
use gaitway::study::file::Front;
use gaitway::study::plan::Scale;
use gaitway::study::protocol::{Answer, Content, Event, Exposure, Page};
use gaitway::study::serve::{Server, Settings};
use gaitway::study::store::{Arrival, Opening, Store, Turn, wait};
use gaitway::study::{Materials, Study};
use gaitway::{Emotion, GaitLibrary};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

pub(crate) static TARGETS: [Target; 3] = [
    Target {
        name: "visit",
        form: Form::Text,
        seeds: || visits("prolific"),
        read: |bytes| ask(Door::Participants("prolific"), bytes),
    },
    Target {
        name: "visit-mturk",
        form: Form::Text,
        seeds: || visits("mturk"),
        read: |bytes| ask(Door::Participants("mturk"), bytes),
    },
    Target {
        name: "operate",
        form: Form::Text,
        seeds: operations,
        read: |bytes| ask(Door::Operators, bytes),
    },
];

/// What no participant may read: part of the names of all gaits.
const SECRET: &str = "Zyxgait";
/// What stands in seeds where a page has to escape it.
const MARKUP: &str = "<zyx>";
/// Replies that are right to a request that may be wrong.
const STATUSES: [u16; 17] =
    [200, 206, 303, 400, 401, 403, 404, 405, 409, 410, 411, 413, 414, 415, 416, 422, 431];
/// Requests that changed something, after which a study begins with an empty store: it would only grow.
const MOST_CHANGES: usize = 1500;

/// Where a participant is whose words stand in a request.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Consent,
    Form,
    Check,
    FilmOfPractice,
    Practice,
    FilmOfWalk,
    Walk,
    FilmOfScene,
    Remarks,
    End,
}

impl Stage {
    const ALL: [Self; 10] = [
        Self::Consent,
        Self::Form,
        Self::Check,
        Self::FilmOfPractice,
        Self::Practice,
        Self::FilmOfWalk,
        Self::Walk,
        Self::FilmOfScene,
        Self::Remarks,
        Self::End,
    ];

    fn is(self, page: &Page) -> bool {
        let shows = matches!(page.content, Content::Show { .. });
        match self {
            Self::Consent => matches!(page.content, Content::Consent { .. }),
            Self::Form => page.part == "about-you",
            Self::Check => matches!(page.content, Content::Check { attempt: 1, .. }),
            Self::FilmOfPractice => page.part == "practice" && shows,
            Self::Practice => page.part == "practice" && !shows,
            Self::FilmOfWalk => page.part == "walks" && shows,
            Self::Walk => page.part == "walks" && !shows,
            Self::FilmOfScene => page.part == "scenes" && shows,
            Self::Remarks => page.part == "remarks",
            Self::End => matches!(page.content, Content::Ended { .. }),
        }
    }
}

/// Whose address a request goes to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Door {
    /// Participants of a study on this platform.
    Participants(&'static str),
    Operators,
}

/// Words of a participant or of an operator.
type Words = BTreeMap<&'static str, String>;

/// A study that is served.
struct Lab {
    door: Door,
    server: Server,
    store: Store,
    /// By stage, or the one operator's.
    words: Vec<Words>,
    changes: usize,
    _folder: TempDir,
}

thread_local! { static LAB: RefCell<Option<Lab>> = const { RefCell::new(None) }; }

/// Seven walkers whose names and styles no participant may read.
static LIBRARY: LazyLock<(Vec<u8>, Vec<String>)> = LazyLock::new(|| {
    let renamed = |(index, gait): (usize, &Gait)| Gait {
        name: format!("{SECRET}-{}-{index}", gait.label.unwrap()),
        acted: Some(format!("{SECRET}-acted")),
        ..gait.clone()
    };
    let walkers = GaitLibrary::generated(7, 1).unwrap();
    let library = GaitLibrary::from_gaits(walkers.gaits().iter().enumerate().map(renamed).collect()).unwrap();
    (library.to_glb_bytes(), library.gaits().iter().map(|gait| gait.name.clone()).collect())
});

/// In memory where the system has such a folder: each of a thousand participants is committed.
fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory).unwrap() } else { tempfile::tempdir().unwrap() }
}

impl Lab {
    fn new(door: Door) -> Self {
        let folder = folder();
        let platform = if let Door::Participants(platform) = door { platform } else { "none" };
        let library: PathBuf = folder.path().join("library.glb");
        std::fs::write(&library, &LIBRARY.0).unwrap();
        let opening = Opening {
            study: Study::parse(&STUDY.replace("PLATFORM", platform), "test").unwrap(),
            materials: Materials::default()
                .with_gaits("library.glb", LIBRARY.1.clone())
                .with_text("consent.md", "# Taking part\n\nYou may <b>stop</b>.\n"),
            libraries: BTreeMap::from([("library.glb".to_owned(), library)]),
            rows: None,
        };
        let store = Store::open(&folder.path().join("run"), &opening).unwrap();
        let free = std::net::SocketAddr::from(([127, 0, 0, 1], 0));
        let settings = Settings {
            listen: free,
            console: (door == Door::Operators).then_some(free),
            requests_per_minute: 0,
            requests_of_one: 0,
            clips: folder.path().join("clips"),
            ..Settings::default()
        };
        std::fs::create_dir_all(&settings.clips).unwrap();
        for name in store.current().stimuli.keys() {
            std::fs::write(settings.clips.join(format!("{name}.mp4")), [7; 1000]).unwrap();
        }
        let server = Server::bind(store.clone(), &settings).unwrap();
        let mut lab = Self { door, server, store, words: Vec::new(), changes: 0, _folder: folder };
        lab.words = match door {
            Door::Participants(_) => Stage::ALL.iter().map(|&stage| lab.participant(stage)).collect(),
            Door::Operators => vec![lab.operator()],
        };
        lab
    }

    /// A new participant, brought to a stage.
    fn participant(&self, stage: Stage) -> Words {
        let arrival = Arrival { front: Front::Web, language: "en".to_owned(), platform: None };
        let arrived = wait(|then| self.store.arrive(arrival, then)).unwrap();
        let mut turn = arrived.turn;
        while !stage.is(&turn.page) {
            for event in events(&turn) {
                turn = wait(|then| self.store.submit(&arrived.token, event, then)).unwrap();
            }
        }
        let film = match &turn.page.content {
            Content::Show { name, .. } => name.clone(),
            Content::Ask { replay, .. } => replay.clone().unwrap_or_default(),
            _ => String::new(),
        };
        let request = format!(
            "GET /s/looks/go HTTP/1.1\nhost: localhost\ncookie: gaitway={}\naccept: application/json\n\n",
            arrived.token
        );
        let told = self.send(&parsed(request.as_bytes()).unwrap());
        let told: serde_json::Value = serde_json::from_slice(told.body()).unwrap();
        let mark = told["mark"].as_str().unwrap().to_owned();
        let Turn { page, code, .. } = turn;
        let pairs =
            [("token", arrived.token), ("mark", mark), ("page", page.id), ("film", film), ("code", code)];
        BTreeMap::from(pairs)
    }

    /// The first operator, signed in, and a participant's code.
    fn operator(&self) -> Words {
        let arrival = Arrival { front: Front::Web, language: "en".to_owned(), platform: None };
        let code = wait(|then| self.store.arrive(arrival, then)).unwrap().turn.code;
        let key = self.server.first_link().unwrap().split_once("key=").unwrap().1.to_owned();
        let form =
            format!("POST /admin/first HTTP/1.1\n{FORM}\nkey={key}&name=ann&password=a+long+enough+password");
        let entered = self.send(&parsed(form.as_bytes()).unwrap());
        let cookie = entered.headers()["set-cookie"].to_str().unwrap();
        let key = cookie.split([';', '=']).nth(1).unwrap().to_owned();
        let page =
            format!("GET /admin/participants HTTP/1.1\nhost: localhost\ncookie: gaitway-admin={key}\n\n");
        let page = self.send(&parsed(page.as_bytes()).unwrap());
        let page = String::from_utf8_lossy(page.body()).into_owned();
        let seal = page.split("name=\"mark\" value=\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
        BTreeMap::from([("key", key), ("seal", seal), ("code", code)])
    }

    fn send(&self, request: &Request<Vec<u8>>) -> Response<Vec<u8>> {
        let request = request.clone();
        match self.door {
            Door::Participants(_) => self.server.answer(request).unwrap().unwrap(),
            Door::Operators => self.server.answer_operator(request).unwrap().unwrap(),
        }
    }

    /// The input with words in the places of `@name0@`; the stages that it names.
    fn filled(&self, input: &[u8]) -> (Vec<u8>, Vec<usize>) {
        let (mut text, mut named) = (Vec::with_capacity(input.len()), Vec::new());
        let mut rest = input;
        while let Some(at) = rest.iter().position(|&byte| byte == b'@') {
            text.extend(&rest[..at]);
            rest = &rest[at..];
            let word = rest[1..].iter().take(8).position(|&byte| byte == b'@').map(|end| &rest[1..=end]);
            let found = word.and_then(|word| {
                let (digit, name) = word.split_last()?;
                let index = usize::from(digit.checked_sub(b'0')?);
                Some((index, self.words.get(index)?.get(std::str::from_utf8(name).ok()?)?, word.len() + 2))
            });
            match found {
                Some((index, value, length)) => {
                    text.extend(value.as_bytes());
                    named.push(index);
                    rest = &rest[length..];
                }
                None => {
                    text.push(b'@');
                    rest = &rest[1..];
                }
            }
        }
        text.extend(rest);
        named.sort_unstable();
        named.dedup();
        (text, named)
    }

    /// Replaces the participants that a request has moved.
    fn restore(&mut self, named: &[usize]) {
        self.changes += 1;
        for &index in named {
            let (stage, token) = (Stage::ALL[index], self.words[index]["token"].clone());
            let page = wait(|then| self.store.turn(&token, then)).map(|turn| turn.page);
            if page.is_ok_and(|page| stage.is(&page) && page.id == self.words[index]["page"]) {
                continue;
            }
            self.words[index] = self.participant(stage);
            self.changes += 1;
        }
    }
}

/// The events that answer a page rightly.
fn events(turn: &Turn) -> Vec<Event> {
    let page = turn.page.id.clone();
    match &turn.page.content {
        Content::Consent { .. } => return vec![Event::Consented { text: "hash".to_owned() }],
        Content::Show { .. } => return vec![Event::Shown { page, exposure: Exposure::default() }],
        _ => {}
    }
    let answer = |question: &gaitway::study::protocol::PageQuestion| {
        let (value, text) = match &question.scale {
            Scale::Points { least, .. } | Scale::Number { least, .. } => (Some(*least), None),
            Scale::Options { options } => (Some(options[0].0), None),
            Scale::Text { .. } => (None, Some("fine".to_owned())),
        };
        let (page, question) = (page.clone(), question.id.clone());
        Event::Answer(Answer { key: question.clone(), page, question, value, text, first_ms: 1, ms: 2 })
    };
    let answers = turn.page.content.questions().iter().map(answer);
    answers.chain([Event::Next { page: page.clone() }]).collect()
}

/// A request as text; the message says why it is none, as the server's reader of connections would.
fn parsed(text: &[u8]) -> Result<Request<Vec<u8>>, String> {
    let end = text.windows(2).position(|two| two == b"\n\n").unwrap_or(text.len());
    let (head, body) = (&text[..end], text.get(end + 2..).unwrap_or_default());
    let mut lines = head.split(|&byte| byte == b'\n');
    let mut words = lines.next().unwrap_or_default().split(|&byte| byte == b' ');
    let mut word = || words.next().unwrap_or_default();
    let method = Method::from_bytes(word()).map_err(|_invalid| "no request: method".to_owned())?;
    let address = Uri::try_from(word()).map_err(|error| format!("no request: {error}"))?;
    let mut headers = HeaderMap::new();
    for line in lines {
        let colon = line.iter().position(|&byte| byte == b':').ok_or("no request: header")?;
        let name =
            HeaderName::from_bytes(&line[..colon]).map_err(|_invalid| "no request: name".to_owned())?;
        let value = line[colon + 1..].trim_ascii();
        headers
            .append(name, HeaderValue::from_bytes(value).map_err(|_invalid| "no request: value".to_owned())?);
    }
    let mut request = Request::new(body.to_vec());
    (*request.method_mut(), *request.uri_mut(), *request.headers_mut()) = (method, address, headers);
    Ok(request)
}

fn ask(door: Door, input: &[u8]) -> Result<String, String> {
    LAB.with_borrow_mut(|lab| {
        if lab.as_ref().is_none_or(|lab| lab.door != door || lab.changes > MOST_CHANGES) {
            *lab = None;
            *lab = Some(Lab::new(door));
        }
        let open = lab.as_mut().unwrap();
        let (text, named) = open.filled(input);
        let request = parsed(&text)?;
        let response = open.send(&request);
        let status = response.status().as_u16();
        let said = judge(door, &text, &response);
        if request.method() == Method::POST && status < 400 {
            match door {
                Door::Participants(_) => open.restore(&named),
                Door::Operators => open.changes += 20,
            }
        }
        Ok(format!("{status} {said}"))
    })
}

/// Asserts what holds for every reply; its heading.
fn judge(door: Door, asked: &[u8], response: &Response<Vec<u8>>) -> String {
    let status = response.status().as_u16();
    let is_busy = door == Door::Operators && status == 429;
    assert!(
        STATUSES.contains(&status) || is_busy,
        "status {status}: {}",
        String::from_utf8_lossy(response.body())
    );
    let header = |name: &str| response.headers().get(name).map_or("", |value| value.to_str().unwrap_or("?"));
    assert!(header("content-security-policy").starts_with("default-src 'none'"), "no policy: {response:?}");
    assert_eq!(header("x-content-type-options"), "nosniff");
    let mut body = String::new();
    if header("content-encoding") == "gzip" {
        flate2::read::GzDecoder::new(response.body().as_slice()).read_to_string(&mut body).unwrap();
    } else {
        body = String::from_utf8_lossy(response.body()).into_owned();
    }
    let kind = header("content-type");
    assert!(
        kind.is_empty() || !kind.starts_with("text/plain") || body == "ok\n",
        "bare words: {status} {body}"
    );
    if kind.starts_with("text/html") {
        assert!(!body.contains(&MARKUP[..4]), "what was sent is not escaped: {body}");
    }
    if matches!(door, Door::Participants(_)) {
        let head: String =
            response.headers().iter().map(|(name, value)| format!("{name}: {value:?}\n")).collect();
        let told = told(&body).into_iter().chain(told(&head));
        // what the request itself says may come back
        let asked =
            [asked.to_vec(), decoded(asked)].map(|text| String::from_utf8_lossy(&text).to_lowercase());
        let known = told.filter(|word| !asked.iter().any(|text| text.contains(&word.to_lowercase())));
        let known: Vec<String> = known.collect();
        assert!(known.is_empty(), "tells {known:?}: {body}");
    }
    let heading = body.split_once("<h1").and_then(|(_, rest)| rest.split_once('>')?.1.split_once('<'));
    heading.map_or_else(|| kind.to_owned(), |(heading, _)| heading.chars().take(40).collect())
}

/// The bytes that `%3A` and the like stand for.
fn decoded(text: &[u8]) -> Vec<u8> {
    let (mut found, mut rest) = (Vec::with_capacity(text.len()), text);
    while let Some((&first, behind)) = rest.split_first() {
        let digits = behind.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let byte = digits.filter(|_| first == b'%').and_then(|two| u8::from_str_radix(two, 16).ok());
        found.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &behind[2..] } else { behind };
    }
    found
}

/// What a text tells of what is shown: names of gaits, labels, conditions, scenes, the study's seed.
fn told(text: &str) -> Vec<String> {
    let phrases = [SECRET, "practice 1", "practice 2", "practice 3", "library.glb", "4815162342"];
    let mut found: Vec<String> =
        phrases.iter().filter(|phrase| text.contains(*phrase)).map(|&phrase| phrase.to_owned()).collect();
    let is_label = |word: &&str| {
        let rest = ["emotion", "baseline", "eva", "garden", "ordinary", "counted"];
        rest.iter().any(|own| own.eq_ignore_ascii_case(word))
            || Emotion::ALL.iter().any(|emotion| emotion.name().eq_ignore_ascii_case(word))
    };
    let words = text.split(|letter: char| !letter.is_ascii_alphanumeric());
    found.extend(words.filter(is_label).map(str::to_owned));
    found
}
