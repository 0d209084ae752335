//! A study in a headset: the whole protocol on one stage, answered by hands that are moved from here.
//!
//! The participant's store is that of simulated participants, with its events in a file, so that a program that is killed goes on
//! where it was.

use super::service::{Head, Live, Service, is_there};
use super::stage::{act, asks, play, told};
use super::{folder, steps};
use gaitway::library::GaitLibrary;
use gaitway::study::headset::{
    ConsentText, Front, Operator, Order, Participation, Setup, Showing, Theatre, Typed,
};
use gaitway::study::plan::{Plan, Scale};
use gaitway::study::protocol::{Content, Entry, Event, Page, PageQuestion};
use gaitway::study::simulate::Store;
use gaitway::study::{Materials, Study};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Two places under two conditions, two questions each.
const SMALL: &str = r#"
[study]
id = "small"
version = 1
title = "Small"
seed = 5
languages = ["en"]
minutes = 2
contact = "nowhere"
where = ["headset"]
flow = ["consent", "how", "scenes", "identify", "debrief"]
[consent]
text = "consent.en.md"
[recruit]
platform = "none"
most_participants = 4
lease_minutes = 120
[crowd]
library = "rated.glb"
avatars = ["female", "male"]
[headset]
answer = ["laser", "stick", "gaze"]
[part.how]
kind = "text"
text = "You will walk among people. You may stop at any time."
[part.scenes]
kind = "trials"
show = { scenes = ["crossing", "garden"], conditions = ["eva-o", "eva-g"], seconds = 1.5 }
design = { kind = "blocks", blocks = "scenes", within = "conditions" }
seeds = "per-block"
ask = "presence"
rest_after_blocks = 1
[part.identify]
kind = "trials"
show = { agents = { each_of = ["happy", "sad"], bodies = ["female"] }, condition = "eva-g", seconds = 1.5 }
design = { kind = "square" }
ask = "which"
[part.debrief]
kind = "text"
text = "Thank you."
[questions.presence]
kind = "likert"
points = { 1 = "disagree strongly", 7 = "agree strongly" }
items = [{ id = "q1", text = "It was as if the people and I were in one place" }, { id = "q2", text = "The people seemed to notice me" }]
[questions.which]
kind = "choice"
text = "How does this person feel?"
options = ["happy", "angry", "sad", "neutral"]
"#;

/// The study of the paper, with short trials.
fn whole() -> String {
    let text = gaitway::study::BUILTIN.iter().find(|study| study.name == "eva-agents").unwrap().toml;
    text.replace("seconds = 45", "seconds = 2")
        .replace("seconds = 20,", "seconds = 2,")
        .replace("seconds = 8", "seconds = 2")
}

/// The bits by which the plan draws.
const PERSON: u64 = 7;

/// One participant of a store, whose events are in a file.
struct Kept<'p> {
    plan: &'p Plan,
    store: Store<'p>,
    file: PathBuf,
    /// Entries that the file has.
    written: usize,
}

impl<'p> Kept<'p> {
    fn open(plan: &'p Plan, file: PathBuf) -> Self {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let entries: Vec<Entry> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        let written = entries.len();
        let logs = (written > 0).then_some((PERSON, entries));
        let mut kept = Self { plan, store: Store::rebuilt(plan, logs), file, written };
        kept.store.arrive(PERSON, "en", now()).unwrap();
        kept.write();
        kept
    }

    fn write(&mut self) {
        let (_, entries) = self.store.logs().find(|(person, _)| *person == PERSON).unwrap();
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&self.file).unwrap();
        for entry in &entries[self.written..] {
            writeln!(file, "{}", serde_json::to_string(entry).unwrap()).unwrap();
        }
        self.written = entries.len();
    }
}

fn now() -> i64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_millis() as i64
}

impl Participation for Kept<'_> {
    fn page(&mut self) -> gaitway::Result<Page> {
        Ok(self.store.session(PERSON).unwrap().page(self.plan))
    }

    fn submit(&mut self, event: Event) -> gaitway::Result<Page> {
        let page = self.store.submit(PERSON, event, now()).unwrap();
        self.write();
        if let Content::Show { .. } = page.content {
            eprintln!("page {}", page.id);
        }
        Ok(page)
    }

    fn consent(&mut self, name: &str) -> gaitway::Result<ConsentText> {
        Ok(ConsentText { text: name.to_owned(), hash: format!("hash of {name}") })
    }

    fn trial(&mut self) -> gaitway::Result<Option<Showing>> {
        let session = self.store.session(PERSON).unwrap();
        Ok(session.trial().map(|(trial, _)| Showing {
            trial: trial.clone(),
            stimulus: session.stimulus(self.plan, trial).cloned(),
        }))
    }

    fn next_trial(&mut self) -> gaitway::Result<Option<Showing>> {
        let session = self.store.session(PERSON).unwrap();
        Ok(session.next_trial().map(|trial| Showing {
            trial: trial.clone(),
            stimulus: session.stimulus(self.plan, trial).cloned(),
        }))
    }
}

/// An operator who agrees, types and orders what the test wants.
struct Desk {
    orders: Vec<Order>,
    asked: u32,
}

impl Operator for Desk {
    fn note(&mut self, line: &str) {
        eprintln!("{line}");
    }

    fn order(&mut self) -> Option<Order> {
        self.asked += 1;
        // some time after the beginning
        if self.asked.is_multiple_of(4000) { self.orders.pop() } else { None }
    }

    fn agreed(&mut self, _: &str, _: u32) -> Option<bool> {
        Some(true)
    }

    fn asks(&mut self, _: &str, _: &PageQuestion) {}

    fn typed(&mut self, question: &PageQuestion) -> Typed {
        match question.scale {
            Scale::Text { .. } if question.optional => Typed::LeftOut,
            Scale::Text { .. } => Typed::Text("nothing".to_owned()),
            Scale::Number { least, .. } => Typed::Number(least),
            // the hands answer
            _ => Typed::Waiting,
        }
    }
}

/// Shows the study of a file to its end.
pub(super) fn act(folder: &Path) {
    let text = std::fs::read_to_string(folder.join("study.toml")).unwrap();
    let study = Study::parse(&text, "study.toml").unwrap();
    let plan = Plan::of(&study.file, &Materials::default()).unwrap();
    let mut kept = Kept::open(&plan, folder.join("events.jsonl"));
    let mut desk = Desk { orders: Vec::new(), asked: 0 };
    let library = GaitLibrary::built_in().unwrap();
    let theatre = Theatre { library, is_own: false, avatars: Vec::new(), agents: Some(20) };
    let setup = Setup {
        study: study.file.study.id.clone(),
        participant: "k7".to_owned(),
        language: "en".to_owned(),
        recordings: folder.to_owned(),
        stop_at: BTreeMap::from([("presence".to_owned(), 4)]),
    };
    let plan = gaitway::xr::Plan { eye_size: Some([200; 2]), waits: true, ..Default::default() };
    let front = Front::open(plan, &mut kept, &mut desk, theatre, setup).unwrap();
    let outcome = front.run().unwrap();
    act::tell("outcome", &json!(outcome));
    act::tell("end", &json!(kept.page().unwrap()));
}

/// Chooses the fourth cell and Next in turn until `is_over` is set.
fn keep_answering(head: &mut Head, is_over: &AtomicBool) {
    let pause = || std::thread::sleep(Duration::from_millis(500));
    while !is_over.load(Ordering::Relaxed) {
        for pixel in [asks::cell(3), asks::NEXT] {
            for pulled in [false, true] {
                asks::point(head, pixel, pulled);
                pause();
            }
        }
    }
}

/// Plays an act to its end while hands answer everything.
fn answered(service: &Service, folder: &Path) -> Vec<String> {
    let (is_over, mut head) = (AtomicBool::new(false), service.head());
    std::thread::scope(|scope| {
        scope.spawn(|| keep_answering(&mut head, &is_over));
        let live = play(service, "study", folder);
        let (_, notes) = live.over();
        is_over.store(true, Ordering::Relaxed);
        notes
    })
}

/// The events that the store has.
fn events(folder: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.join("events.jsonl")).unwrap_or_default();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn count(events: &[Value], kind: &str) -> usize {
    events.iter().filter(|event| event["event"] == kind).count()
}

/// Asserts that the participation is whole: trials shown, questions answered, each trial recorded to its end.
fn is_whole(folder: &Path, notes: &[String], trials: usize) {
    let events = events(folder);
    assert_eq!(count(&events, "shown"), trials, "{notes:#?}");
    let end = &told(notes, "end")[0];
    assert_eq!(end["content"], "ended", "{end}");
    for event in events.iter().filter(|event| event["event"] == "shown") {
        let seconds = event["exposure"]["seconds_visible"].as_f64().unwrap();
        assert!(seconds > 1.0 && event["exposure"]["frames"].as_u64().unwrap() > 1, "{event}");
    }
}

/// Replays a recording of a scene: the header names everything that is needed.
fn replay(service: &Service, recording: &Path) -> Value {
    let text = std::fs::read_to_string(recording).unwrap();
    let field = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("# {key} ")));
        line.unwrap().to_owned()
    };
    let [scene, condition, seed] = ["scene", "condition", "seed"].map(field);
    let run = ["xr", &scene, "--agents", "20", "--backend", "cpu", "--json", "--seed", &seed];
    let more = ["--condition", &condition, "--replay", recording.to_str().unwrap()];
    let output = service.gaitway(&[&run[..], &more[..]].concat()).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

#[test]
fn a_study_runs_from_consent_to_its_end_in_one_session() {
    if !is_there() {
        return;
    }
    let service = Service::start("study");
    let folder = folder("study");
    std::fs::write(folder.join("study.toml"), SMALL).unwrap();
    let notes = answered(&service, &folder);
    is_whole(&folder, &notes, 6);
    let events = events(&folder);
    assert_eq!((count(&events, "consented"), count(&events, "fault")), (1, 0));
    // two questions after each of four scenes, one after each of two people
    let questions: std::collections::BTreeSet<String> = events
        .iter()
        .filter(|event| event["event"] == "answer")
        .map(|event| format!("{} {}", event["page"], event["question"]))
        .collect();
    assert_eq!(questions.len(), 4 * 2 + 2, "{questions:#?}");
    let outcome = &told(&notes, "outcome")[0];
    assert_eq!(outcome["sessions"], 1, "{outcome}");
    assert!(notes.iter().any(|line| line.contains("ask whether to end")), "{notes:#?}");
    for position in 1..=4 {
        let found = replay(&service, &folder.join(format!("scenes-{position}.csv")));
        assert!(found["equal"] == true && found["trial"].is_string(), "{found}");
    }
}

#[test]
fn a_study_that_is_killed_in_mid_trial_goes_on_with_that_trial() {
    if !is_there() {
        return;
    }
    let service = Service::start("study-killed");
    let folder = folder("study-killed");
    let text = SMALL.replace(
        "seconds = 1.5 }\ndesign = { kind = \"blocks\"",
        "seconds = 4.0 }\ndesign = { kind = \"blocks\"",
    );
    std::fs::write(folder.join("study.toml"), text).unwrap();
    let (is_over, mut head) = (AtomicBool::new(false), service.head());
    let kept = std::thread::scope(|scope| {
        scope.spawn(|| keep_answering(&mut head, &is_over));
        let mut live: Live = play(&service, "study", &folder);
        live.hear("page scenes/2");
        let recording = folder.join("scenes-2.csv");
        // more than a second, so that there is a hash to compare with
        super::recorded(&recording, 45, |_| true);
        let before = steps(&recording).len();
        live.kill();
        is_over.store(true, Ordering::Relaxed);
        assert!(steps(&recording).len() >= before);
        events(&folder)
    });
    drop(head); // Monado hears one at a time
    let notes = answered(&service, &folder);
    is_whole(&folder, &notes, 6);
    // nothing that was stored is lost, and no trial was shown twice to its end
    assert_eq!(events(&folder)[..kept.len()], kept);
    let first = std::fs::read_to_string(folder.join("scenes-2.broken-off.csv")).unwrap();
    assert!(first.contains("# trial 2") && !first.contains("# end"), "{first}");
    assert_eq!(replay(&service, &folder.join("scenes-2.broken-off.csv"))["equal"], true);
    assert_eq!(replay(&service, &folder.join("scenes-2.csv"))["equal"], true);
}

#[test]
#[ignore = "takes many minutes"]
fn the_whole_study_of_the_paper_outlives_a_runtime_that_is_killed_twice() {
    if !is_there() {
        return;
    }
    let mut service = Service::start("study-whole");
    let folder = folder("study-whole");
    std::fs::write(folder.join("study.toml"), whole()).unwrap();
    let mut live = play(&service, "study", &folder);
    for page in ["page scenes/2", "page scenes/7", ""] {
        let is_over = AtomicBool::new(false);
        let mut head = service.head();
        std::thread::scope(|scope| {
            scope.spawn(|| keep_answering(&mut head, &is_over));
            live.hear(if page.is_empty() { "outcome" } else { page });
            is_over.store(true, Ordering::Relaxed);
        });
        if !page.is_empty() {
            service.kill();
            live.hear("lost the headset");
            service.restart();
            live.hear("the headset is back");
        }
    }
    let (_, notes) = live.over();
    is_whole(&folder, &notes, 1 + 12 + 8);
    let outcome = &told(&notes, "outcome")[0];
    assert_eq!(outcome["sessions"], 3, "{outcome}");
}
