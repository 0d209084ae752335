//! A participant of the built-in study of gaits, in a browser, at the real program: short films, few walks.

use super::common::lab::{Lab, Server};
use super::driver::{Browser, Options, Profile};
use fantoccini::key::Key;
use rusqlite::{Connection, OpenFlags};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// How a participant reaches what is on a page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Hands {
    Mouse,
    /// Tab, Enter, Space, arrows; letters only in fields of text.
    Keys,
}

/// What was answered: value or text by page and question.
pub(crate) type Given = BTreeMap<(String, String), String>;

/// Server, study and browser.
pub(crate) struct Visit {
    pub(crate) browser: Browser,
    pub(crate) server: Server,
    pub(crate) lab: Lab,
    hands: Hands,
}

/// A study of eight generated walks, of which each participant sees two.
pub(crate) fn small(changes: &[(&str, &str)]) -> Lab {
    let mut all =
        vec![("each = 10, at_least = 10", "each = 2, at_least = 2"), ("seconds = 4.0", "seconds = 0.5")];
    all.extend_from_slice(changes);
    Lab::with(&["--gaits", "8"], &all)
}

impl Visit {
    /// A browser that has shown nothing yet; none where there is no browser.
    pub(crate) fn new(options: Options, hands: Hands) -> Option<Self> {
        Self::to(options, hands, &[])
    }

    /// The same, to a study with changes to its file.
    pub(crate) fn to(options: Options, hands: Hands, changes: &[(&str, &str)]) -> Option<Self> {
        let browser = Browser::open(options)?;
        Some(Self::of(browser, small(changes), hands))
    }

    /// The same, to any study.
    pub(crate) fn of(browser: Browser, lab: Lab, hands: Hands) -> Self {
        let server = lab.serve();
        Self { browser, server, lab, hands }
    }

    /// A participant who uses the mouse and has come to a page, as `go_on` finds it.
    pub(crate) fn at(options: Options, page: &str) -> Option<(Self, Given)> {
        let visit = Self::new(options, Hands::Mouse)?;
        visit.open();
        let given = visit.go_on(page);
        Some((visit, given))
    }

    /// Closes the browser, and opens it again with what it remembers; it shows nothing.
    pub(crate) fn reopen(&mut self) {
        self.reopen_after(Browser::close);
    }

    /// The same after `kill -9` of the browser.
    pub(crate) fn reopen_after_a_crash(&mut self) {
        self.reopen_after(Browser::kill);
    }

    fn reopen_after(&mut self, end: impl FnOnce(Browser) -> Profile) {
        // one browser at a time uses a profile
        let Some(next) = Browser::open(Options::default()) else { return };
        let profile = Some(end(std::mem::replace(&mut self.browser, next)));
        self.browser = Browser::open(Options { profile, ..Options::default() }).unwrap();
    }

    /// Opens the first page.
    pub(crate) fn open(&self) {
        self.browser.go(&self.lab.address());
    }

    /// Presses a button, or what else is pressed.
    pub(crate) fn press(&self, css: &str) {
        if self.hands == Hands::Mouse {
            return self.browser.click(css);
        }
        self.tab_to(css);
        self.browser.press(Key::Enter);
    }

    /// Presses Tab until the focus is there, or in it.
    pub(crate) fn tab_to(&self, css: &str) {
        for _ in 0..40 {
            let here = self
                .browser
                .run("return Boolean(document.activeElement.closest(arguments[0]))", &[json!(css)]);
            if here == json!(true) {
                return;
            }
            self.browser.press(Key::Tab);
        }
        panic!("Tab never comes to {css} on {}: {}", self.page(), self.browser.text("body"));
    }

    /// The current page's id, with `:film` where a film is to be seen before the questions; empty on the first and last page.
    pub(crate) fn page(&self) -> String {
        let script = "const { page, plays } = document.getElementById('main')?.dataset ?? {}; \
            return (page ?? '') + (plays > 0 ? ':film' : '')";
        self.browser.run(script, &[]).as_str().unwrap().to_owned()
    }

    /// Whether the participation is over.
    pub(crate) fn is_over(&self) -> bool {
        self.browser.count("main[data-ended]") == 1
    }

    /// Waits for another page than this one; its id.
    pub(crate) fn after(&self, page: &str) -> String {
        self.browser.until(&format!("still at {page:?}"), |_| {
            let now = self.page();
            (now != page || self.is_over()).then_some(now)
        })
    }

    /// Waits until the page does not pass on by itself any more.
    pub(crate) fn settle(&self) {
        self.browser.until("the page passes on by itself", |browser| {
            let page = self.page();
            std::thread::sleep(std::time::Duration::from_secs(1));
            let waits = browser.count("form#answers") == 1 || browser.count(".play:enabled") == 1;
            (waits && self.page() == page).then_some(())
        });
    }

    /// Waits for the film to be ready.
    pub(crate) fn wait_for_film(&self) {
        self.browser.until("no film", |browser| (browser.count(".play:enabled") == 1).then_some(()));
    }

    /// Waits until the film of this page is ready; false if the page was left, as it is where a film cannot be played.
    fn film_is_ready(&self, page: &str) -> bool {
        self.browser.until("neither a film nor another page", |browser| {
            let is_ready = browser.count(".play:enabled") == 1;
            (is_ready || self.page() != page).then_some(is_ready)
        })
    }

    /// Goes on to this page, in which `*` stands for anything, or to the end if it is empty. Returns what was answered.
    pub(crate) fn go_on(&self, to: &str) -> Given {
        self.go_through(to, |_, _| {})
    }

    /// The same with a look at every page before it is answered; the first page is called `welcome`, the last one `end`.
    pub(crate) fn go_through(&self, to: &str, mut look: impl FnMut(&Self, &str)) -> Given {
        let mut given = Given::new();
        for _ in 0..90 {
            let page = self.page();
            let (begin, end) = to.split_once('*').unwrap_or((to, ""));
            let is_there = page.starts_with(begin) && page.ends_with(end) && (to.contains('*') || page == to);
            if is_there && !page.is_empty() {
                return given;
            }
            if self.is_over() {
                assert!(to.is_empty(), "never at {to}");
                look(self, "end");
                return given;
            }
            look(self, if page.is_empty() { "welcome" } else { &page });
            self.pass(&mut given);
            self.after(&page);
        }
        panic!("never at {to:?}");
    }

    /// Does on the current page what leads to the next one.
    pub(crate) fn pass(&self, given: &mut Given) {
        match self.page().as_str() {
            "" => self.press("form[action$='/begin'] button"),
            "consent" => self.press("button[value=yes]"),
            page if self.browser.count("form#answers") == 0 => {
                if self.film_is_ready(page) {
                    self.press(".play");
                }
            }
            page => {
                self.answer(page, given);
                self.press("button.next");
            }
        }
    }

    /// Answers all questions of a page.
    pub(crate) fn answer(&self, page: &str, given: &mut Given) {
        for question in self.questions() {
            let id = question[0].as_str().unwrap().to_owned();
            let values = question[1].as_array().unwrap();
            let answer = match question[2].as_str().unwrap() {
                "radio" => {
                    let choice = self.choice(page, &id, values.len());
                    self.choose(&id, choice);
                    values[choice].as_str().unwrap().to_owned()
                }
                kind => {
                    let text = if kind == "number" { "33" } else { "all was clear" };
                    self.write(&id, text);
                    text.to_owned()
                }
            };
            given.insert((page.to_owned(), id), answer);
        }
    }

    /// Id, values and kind of every question on the page.
    fn questions(&self) -> Vec<Value> {
        let script = "return [...document.querySelectorAll('[data-question]')].map(group => [group.dataset.question, \
            [...group.querySelectorAll('input[type=radio]')].map(input => input.value), \
            group.querySelector('input, textarea').type])";
        self.browser.run(script, &[]).as_array().unwrap().clone()
    }

    /// What to choose: what is right or asked for, else something else on each page.
    fn choice(&self, page: &str, question: &str, count: usize) -> usize {
        if page.starts_with("check/") {
            return usize::from(question == "question-2");
        }
        let words = "return [document.querySelector('.instruction')?.textContent ?? '', \
            ...document.querySelectorAll('fieldset:first-of-type label span')].map(one => one.textContent ?? one)";
        let words = self.browser.run(words, &[]);
        let words: Vec<&str> = words.as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        let wanted = words[1..].iter().position(|word| words[0].contains(&format!("“{word}”")));
        wanted.unwrap_or_else(|| (page.bytes().map(usize::from).sum::<usize>() + question.len()) % count)
    }

    /// Chooses one of a group of answers.
    pub(crate) fn choose(&self, question: &str, choice: usize) {
        let group = format!("[data-question='{question}']");
        if self.hands == Hands::Mouse {
            return self.browser.click(&format!("{group} label:nth-of-type({})", choice + 1));
        }
        self.tab_to(&group);
        self.browser.press(Key::Space);
        for _ in 0..choice {
            self.browser.press(Key::Right);
        }
    }

    fn write(&self, question: &str, text: &str) {
        let field = format!("[data-question='{question}'] :is(input, textarea)");
        match self.hands {
            Hands::Mouse => self.browser.click(&field),
            Hands::Keys => self.tab_to(&field),
        }
        self.browser.type_text(text);
    }

    /// The store of answers, to look into.
    pub(crate) fn store(&self) -> Connection {
        let path = self.lab.data().join(gaitway::study::store::STORE);
        Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap()
    }

    /// A number that the store has.
    pub(crate) fn stored(&self, select: &str) -> i64 {
        self.store().query_row(select, [], |row| row.get(0)).unwrap()
    }

    /// Asserts that the store has these answers and no others, and that none that was chosen once is there twice.
    pub(crate) fn assert_stored(&self, given: &Given) {
        let store = self.store();
        let mut select =
            store.prepare("SELECT page, question, ifnull(text, value) FROM answer ORDER BY seq").unwrap();
        let rows = select.query_map([], |row| {
            let value: rusqlite::types::Value = row.get(2)?;
            let value = match value {
                rusqlite::types::Value::Integer(number) => number.to_string(),
                rusqlite::types::Value::Text(text) => text,
                other => format!("{other:?}"),
            };
            Ok(((row.get(0)?, row.get(1)?), value))
        });
        let rows: Vec<((String, String), String)> = rows.unwrap().map(Result::unwrap).collect();
        if self.hands == Hands::Mouse {
            assert_eq!(rows.len(), given.len(), "an answer is missing or doubled: {rows:?}, {given:?}");
        }
        assert_eq!(rows.into_iter().collect::<Given>(), *given);
    }

    /// Asserts that the browser complained of nothing.
    pub(crate) fn assert_quiet(&self) {
        assert_eq!(self.browser.complaints(), Vec::<String>::new(), "at {:?}", self.page());
    }

    /// Asserts that nothing is wider than the page.
    pub(crate) fn assert_fits(&self) {
        let wide = "return [document.documentElement.scrollWidth, document.documentElement.clientWidth]";
        let wide = self.browser.run(wide, &[]);
        assert!(wide[0].as_u64() <= wide[1].as_u64(), "{} is {wide} pixels wide", self.page());
    }
}
