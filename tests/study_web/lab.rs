//! A study that is served, and a participant who goes through it.

use crate::client::{Browser, Reply};
use gaitway::GaitLibrary;
use gaitway::gait::Gait;
use gaitway::study::serve::{Server, Settings};
use gaitway::study::store::{Opening, Store};
use gaitway::study::{Materials, Study};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use tempfile::TempDir;

/// What no participant may read.
pub(crate) const SECRET: &str = "Zyxgait";

const STUDY: &str = r#"
[study]
id = "looks"
version = 1
title = { en = "How do they look?", de = "Wie sehen Leute aus?" }
seed = 4815162342
languages = ["en", "de"]
minutes = 7
contact = "Lab of Gaits, lab@example.org"
flow = ["consent", "about-you", "rules", "check", "practice", "walks", "remarks", "debrief"]

[consent]
text = "consent.md"

[recruit]
platform = "none"
codes = { complete = "C1DONE", screened-out = "C2OUT", withdrawn = "C3GONE" }

[part.about-you]
kind = "form"
ask = ["gender", "age"]

[part.rules]
kind = "text"
text = "Look at each figure.\n\nThen say how it looks."

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
design = { kind = "fill", each = 3, at_least = 2 }
repeat = 1
catch = 1
ask = "health"

[part.remarks]
kind = "form"
ask = "words"

[part.debrief]
kind = "text"
text = "That was all."

[questions.health]
kind = "likert"
order = "per-participant"
points = ["no", "rather no", "rather yes", "yes"]
items = [{ id = "well", text = "looks well" }, { id = "ill", text = "looks ill" }]

[questions.words]
kind = "text"
text = "Anything else?"
most = 400
"#;

const CONSENT: &str = "# Taking part\n\nYou look at figures. <b>You</b> may stop at any time.\n";

/// A study that is served until it is dropped.
pub(crate) struct Lab {
    pub(crate) address: std::net::SocketAddr,
    pub(crate) console: std::net::SocketAddr,
    pub(crate) first_link: String,
    pub(crate) store: Store,
    stop: Arc<AtomicBool>,
    server: Option<JoinHandle<()>>,
    pub(crate) folder: TempDir,
}

impl Drop for Lab {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.server.take().unwrap().join().unwrap();
    }
}

/// Walkers whose names and styles no participant may read.
fn library() -> GaitLibrary {
    let walkers = GaitLibrary::generated(7, 1).unwrap();
    let renamed = |(index, gait): (usize, &Gait)| Gait {
        name: format!("{SECRET}-{}-{index}", gait.label.unwrap()),
        acted: Some(format!("{SECRET}-acted")),
        ..gait.clone()
    };
    GaitLibrary::from_gaits(walkers.gaits().iter().enumerate().map(renamed).collect()).unwrap()
}

impl Lab {
    /// The study of the tests, with changes to its text and to how it is served.
    pub(crate) fn new(changes: &[(&str, &str)], change: impl FnOnce(&mut Settings)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let library = library();
        let path = folder.path().join("library.glb");
        library.save_glb(&path).unwrap();
        let text = changes.iter().fold(STUDY.to_owned(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        });
        let names = library.gaits().iter().map(|gait| gait.name.clone()).collect();
        let opening = Opening {
            study: Study::parse(&text, "test").unwrap(),
            materials: Materials::default().with_gaits("library.glb", names).with_text("consent.md", CONSENT),
            libraries: BTreeMap::from([("library.glb".to_owned(), path)]),
            rows: None,
        };
        let store = Store::open(&folder.path().join("run"), &opening).unwrap();
        Self::serve(folder, store, change)
    }

    pub(crate) fn serve(folder: TempDir, store: Store, change: impl FnOnce(&mut Settings)) -> Self {
        let free = std::net::SocketAddr::from(([127, 0, 0, 1], 0));
        let mut settings = Settings {
            listen: free,
            console: Some(free),
            requests_per_minute: 0,
            clips: folder.path().join("clips"),
            ..Settings::default()
        };
        change(&mut settings);
        let server = Server::bind(store.clone(), &settings).unwrap();
        let (address, console) = (server.address().unwrap(), server.console_address().unwrap());
        let first_link = server.first_link().unwrap_or_default().to_owned();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let server =
            Some(std::thread::spawn(move || server.run(move || asked.load(Ordering::Relaxed)).unwrap()));
        Self { address, console, first_link, store, stop, server, folder }
    }

    pub(crate) fn plain() -> Self {
        Self::new(&[], |_| {})
    }

    pub(crate) fn browser(&self) -> Browser {
        Browser::new(self.address)
    }

    /// A browser of a participant who has agreed.
    pub(crate) fn agreed(&self) -> (Browser, Reply) {
        let mut browser = self.browser();
        let page = begin(&mut browser);
        let page = agree(&mut browser, &page);
        (browser, page)
    }
}

/// Presses the first button.
pub(crate) fn begin(browser: &mut Browser) -> Reply {
    let reply = browser.post("/s/looks/begin", &[("language", "en")]);
    browser.follow(reply)
}

/// Agrees on the page with the consent text.
pub(crate) fn agree(browser: &mut Browser, page: &Reply) -> Reply {
    let reply = browser.post("/s/looks/begin", &[("mark", &page.attribute("data-mark")), ("agree", "yes")]);
    browser.follow(reply)
}

/// Goes from a page to the next one, with the first answer to every question. Films are watched by a script.
pub(crate) fn next(browser: &mut Browser, page: &Reply) -> Reply {
    let (id, mark) = (page.attribute("data-page"), page.attribute("data-mark"));
    let film = page.attribute("data-film");
    if !film.is_empty() && !page.body.contains("id=\"answers\"") {
        let walk = browser.get(&format!("/stimuli/{film}"));
        assert_eq!(walk.status, 200);
        let body = format!(
            r#"{{"event":"shown","page":"{id}","exposure":{{"started":1,"seconds_visible":0.5,"plays":1,"frames":30,"late_frames":1,"longest_ms":20}}}}"#
        );
        let reply = browser.json("/s/looks/event", &mark, &body);
        assert_eq!(reply.status, 200, "{reply:?}");
        return browser.open("/s/looks/go");
    }
    let mut fields = page.hidden();
    fields.extend(page.questions().into_iter().map(|(id, values)| (format!("q:{id}"), values[0].clone())));
    let fields: Vec<(&str, &str)> =
        fields.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    let reply = browser.post("/s/looks/answer", &fields);
    browser.follow(reply)
}

/// Goes on until a page's id begins so; an empty one is the end. Returns all pages on the way, the last one included.
pub(crate) fn go_on(browser: &mut Browser, page: Reply, until: &str) -> Vec<Reply> {
    let mut pages = vec![page];
    for _ in 0..60 {
        let last = pages.last().unwrap();
        assert!(last.status == 200, "{}", last.body);
        let id = last.attribute("data-page");
        if if until.is_empty() { id.is_empty() } else { id.starts_with(until) } {
            return pages;
        }
        let next = next(browser, &pages.last().unwrap().clone());
        pages.push(next);
    }
    panic!(
        "never at {until:?}: {:?}",
        pages.iter().map(|page| page.attribute("data-page")).collect::<Vec<_>>()
    );
}

/// What a store says.
pub(crate) fn wait<T: Send + 'static, E: Send + std::fmt::Debug + 'static>(
    call: impl FnOnce(Box<dyn FnOnce(Result<T, E>) + Send>),
) -> T {
    let (tell, told) = std::sync::mpsc::channel();
    call(Box::new(move |result| tell.send(result).unwrap()));
    told.recv().unwrap().unwrap()
}
