//! A study in a headset by the real command: answers typed by the operator or given by hands that are moved from here.

use super::service::{Head, Live, Service, is_there};
use super::stage::asks;
use super::{folder, steps};
use gaitway::study::protocol::State;
use gaitway::study::store::{RECORDINGS, Reading};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Places under conditions, then single people: as long as a test can wait.
fn study(scenes: &str, conditions: &str, seconds: &str) -> String {
    format!(
        r#"
[study]
id = "small"
version = 1
title = "Small"
seed = 5
languages = ["en"]
minutes = 2
contact = "nowhere"
where = ["headset"]
flow = ["consent", "about-you", "how", "scenes", "identify", "debrief"]
[consent]
text = "consent.en.md"
[recruit]
platform = "none"
most_participants = 24
lease_minutes = 120
[crowd]
library = "rated.glb"
avatars = ["female", "male"]
agents = 20
[headset]
answer = ["laser", "stick", "gaze"]
stop_at = {{ presence = 6 }}
[part.about-you]
kind = "form"
ask = ["age"]
[part.how]
kind = "text"
text = "You will walk among people. You may stop at any time."
[part.scenes]
kind = "trials"
show = {{ scenes = [{scenes}], conditions = [{conditions}], seconds = {seconds} }}
design = {{ kind = "blocks", blocks = "scenes", within = "conditions" }}
seeds = "per-block"
ask = "presence"
rest_after_blocks = 2
[part.identify]
kind = "trials"
show = {{ agents = {{ each_of = ["happy", "angry", "sad", "neutral"], bodies = ["female"] }}, condition = "eva-g", seconds = {seconds} }}
design = {{ kind = "square" }}
ask = "which"
[part.debrief]
kind = "text"
text = "Thank you."
[questions.presence]
kind = "likert"
points = {{ 1 = "disagree strongly", 7 = "agree strongly" }}
items = [{{ id = "q1", text = "It was as if the people and I were in one place" }}, {{ id = "q2", text = "The people seemed to notice me" }}]
[questions.which]
kind = "choice"
text = "How does this person feel?"
options = ["happy", "angry", "sad", "neutral"]
"#
    )
}

/// The files of a study and its data.
struct Lab {
    service: Service,
    study: PathBuf,
    data: PathBuf,
}

impl Lab {
    fn open(name: &str, text: &str) -> Self {
        let (service, folder) = (Service::start(name), folder(name));
        let (study, data) = (folder.join("study"), folder.join("data"));
        let made = Command::new(env!("CARGO_BIN_EXE_gaitway"))
            .args(["study", "new", "eva-agents", "--out"])
            .arg(&study)
            .output()
            .unwrap();
        assert!(made.status.success(), "{made:?}");
        std::fs::write(study.join("study.toml"), text).unwrap();
        std::fs::write(study.join("consent.en.md"), "# Consent\n\nDo you agree?").unwrap();
        Self { service, study, data }
    }

    /// A session: of a new participant, or of one who goes on.
    fn run(&self, code: Option<&str>) -> Live {
        let paths = [self.study.to_str().unwrap(), "--data", self.data.to_str().unwrap()];
        let mut arguments = [&["study", "run"][..], &paths, &["--eye-size", "200x200", "--json"]].concat();
        arguments.extend(code.iter().flat_map(|code| ["--code", code]));
        let mut command = self.service.gaitway(&arguments);
        command.stdin(Stdio::piped());
        Live::start(command)
    }

    /// What a command says of the data, whether it ends well or not.
    fn ask(&self, arguments: &[&str]) -> (bool, String) {
        let output = self.service.gaitway(arguments).output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    }

    fn recording(&self, code: &str, name: &str) -> PathBuf {
        self.data.join(RECORDINGS).join(code).join(name)
    }
}

/// The code that a session begins with.
fn code(live: &mut Live) -> String {
    let line = live.hear_line("participant   ");
    line.split_whitespace().last().unwrap().to_owned()
}

/// Does something with every line until one has these words. Returns the answers that were acknowledged.
fn listen(live: &mut Live, until: &str, mut take: impl FnMut(&mut Live, &str)) -> Vec<String> {
    let mut acknowledged = Vec::new();
    loop {
        let line = live.hear_line("");
        if line.contains(" = ") && line.contains('/') {
            acknowledged.push(line.clone());
        }
        if line.contains(until) {
            return acknowledged;
        }
        take(live, &line);
    }
}

/// Types what answers every question, until a line has these words. Returns the answers that were acknowledged.
fn type_answers(live: &mut Live, until: &str) -> Vec<String> {
    listen(live, until, |live, line| match line.rsplit_once('(').map(|(_, allowed)| allowed) {
        Some("1 to 7)") => live.type_line("4"),
        Some(allowed) if allowed.contains("0 happy") => live.type_line("happy"),
        Some(allowed) if allowed.starts_with("0 to 120") => live.type_line("30"),
        _ if line.contains("agree / decline") => live.type_line("agree"),
        _ => {}
    })
}

/// Points at cells and buttons and pulls the trigger in turn until `is_over` is set.
fn keep_pulling(head: &mut Head, pixels: &[[f32; 2]], is_over: &AtomicBool) {
    while !is_over.load(Ordering::Relaxed) {
        for pixel in pixels {
            for pulled in [false, true] {
                asks::point(head, *pixel, pulled);
                std::thread::sleep(Duration::from_millis(500));
            }
        }
    }
}

/// Does something while a hand of the participant pulls the trigger at these places.
fn with_hand<T>(service: &Service, pixels: &[[f32; 2]], work: impl FnOnce() -> T) -> T {
    /// Ends the pulling however the work ends.
    struct End<'a>(&'a AtomicBool);
    impl Drop for End<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    let (is_over, mut head) = (AtomicBool::new(false), service.head());
    std::thread::scope(|scope| {
        scope.spawn(|| keep_pulling(&mut head, pixels, &is_over));
        let _end = End(&is_over);
        work()
    })
}

/// Asserts that the data have every answer that was acknowledged, once, and so many trials.
fn has_all(data: &Path, code: &str, acknowledged: &[String], trials: usize) {
    let reading = Reading::open(data).unwrap();
    let person = reading.people().into_iter().find(|person| person.code == code).unwrap();
    assert_eq!(person.state.name(), "finished");
    let tables = reading.tables(None);
    let named: BTreeSet<String> = acknowledged
        .iter()
        .map(|line| line.rsplit_once(" = ").unwrap().0.trim_start_matches("note: ").to_owned())
        .collect();
    let found: Vec<String> = tables
        .answers
        .iter()
        .map(|row| format!("{}: {}", row.page, row.question))
        .filter(|name| named.contains(name))
        .collect();
    assert_eq!(found.len(), named.len(), "{found:#?}\n{named:#?}");
    assert_eq!(found.iter().collect::<BTreeSet<_>>().len(), named.len());
    let shown: BTreeSet<&str> = tables
        .answers
        .iter()
        .filter(|row| row.part == "scenes" || row.part == "identify")
        .map(|row| row.page.as_str())
        .collect();
    assert_eq!(shown.len(), trials, "{shown:?}");
}

/// Asserts that all recordings replay, and that one is refused under another condition.
fn replay(lab: &Lab, code: &str, at_least: usize) {
    let data = lab.data.to_str().unwrap();
    let (is_good, said) = lab.ask(&["study", "replay", data]);
    assert!(is_good, "{said}");
    let (equal, all) = (said.matches("  equal").count(), said.matches(" steps  ").count());
    assert!(equal == all && all >= at_least, "{said}");
    // whatever it was shown under, one of two is wrong
    let first = lab.recording(code, "scenes-1.csv");
    let refused = ["baseline", "eva-o", "eva-g"]
        .into_iter()
        .filter(|condition| {
            let arguments = ["study", "replay", data, first.to_str().unwrap(), "--condition", condition];
            let (is_good, said) = lab.ask(&arguments);
            assert!(is_good || said.contains("condition"), "{said}");
            !is_good
        })
        .count();
    assert_eq!(refused, 2);
}

/// A whole study with so many trials in scenes, and four with single people: the runtime is lost after the questions about these
/// trials, and the program is killed in another one.
fn whole(name: &str, text: &str, lost_after: &[u32], killed_in: u32, in_scenes: usize) {
    if !is_there() {
        return;
    }
    let mut lab = Lab::open(name, text);
    let mut live = lab.run(None);
    let code = code(&mut live);
    let mut acknowledged = Vec::new();
    // to a line by a hand that answers: what was acknowledged until then
    let go_on = |service: &Service, live: &mut Live, until: &str| {
        with_hand(service, &[asks::cell(3), asks::NEXT], || listen(live, until, |_, _| {}))
    };
    // what the participant says aloud is typed
    acknowledged.extend(with_hand(&lab.service, &[asks::NEXT], || type_answers(&mut live, "scenes/1: seen")));
    let answered = |trial: u32| format!("scenes/{trial}: presence.q2 = 4");
    for trial in lost_after {
        acknowledged.extend(go_on(&lab.service, &mut live, &answered(*trial)));
        lab.service.kill();
        live.hear("lost the headset");
        lab.service.restart();
        live.hear("the headset is back");
    }
    acknowledged.extend(go_on(&lab.service, &mut live, &answered(killed_in - 1)));
    // killed in the middle of a trial, when there is a hash to compare with
    with_hand(&lab.service, &[asks::NEXT], || {
        let recording = lab.recording(&code, &format!("scenes-{killed_in}.csv"));
        super::until(|| match steps(&recording).len() {
            0..32 => Err("too few steps".to_owned()),
            _ => Ok(()),
        });
        live.kill();
    });
    let mut live = lab.run(Some(&code));
    acknowledged.extend(go_on(&lab.service, &mut live, "identify/4: which = "));
    let (outcome, _) = with_hand(&lab.service, &[asks::NEXT], || live.wait());
    assert_eq!(outcome["participant"], Value::from(code.as_str()));
    has_all(&lab.data, &code, &acknowledged, in_scenes + 4);
    let broken =
        std::fs::read_to_string(lab.recording(&code, &format!("scenes-{killed_in}.broken-off.csv"))).unwrap();
    assert!(broken.contains("# part scenes") && !broken.contains("# end"), "{broken}");
    // one that broke off, and perhaps some in which the headset was lost
    replay(&lab, &code, in_scenes + 5);
}

#[test]
fn a_study_outlives_a_lost_runtime_and_a_kill() {
    let text = study(r#""crossing", "garden""#, r#""eva-o", "eva-g""#, "2.5");
    whole("study-short", &text, &[2], 4, 4);
}

#[test]
#[ignore = "takes three minutes"]
fn a_study_of_sixteen_trials_outlives_two_lost_runtimes_and_a_kill() {
    let text = study(r#""crossing", "garden", "parking", "scifi""#, r#""baseline", "eva-o", "eva-g""#, "2.5");
    whole("study-whole", &text, &[4, 9], 11, 12);
}

#[test]
fn the_operator_repeats_skips_pauses_and_ends_and_the_participation_goes_on() {
    if !is_there() {
        return;
    }
    let lab = Lab::open("study-orders", &study(r#""crossing", "garden""#, r#""eva-o", "eva-g""#, "3.0"));
    let mut live = lab.run(None);
    let code = code(&mut live);
    let is_seen = |name: &str| {
        super::until(|| match steps(&lab.recording(&code, name)).len() {
            0..5 => Err(format!("{name}: too few steps")),
            _ => Ok(()),
        });
    };
    with_hand(&lab.service, &[asks::NEXT], || {
        type_answers(&mut live, "about-you: age = 30");
        is_seen("scenes-1.csv");
        live.type_line("/repeat");
        live.hear("scenes/1: again from its beginning");
        type_answers(&mut live, "scenes/1: presence.q2 = 4");
        is_seen("scenes-2.csv");
        live.type_line("/skip");
        live.hear("scenes/2: left out");
        is_seen("scenes-3.csv");
        live.type_line("/pause");
        live.hear("pause: done");
        live.type_line("/note asked for water");
        live.hear("note: done");
        live.type_line("/dance");
        live.hear("/dance is no order");
        let person = || Reading::open(&lab.data).unwrap().people().remove(0);
        assert_eq!((person().state, person().page.as_str()), (State::Paused, "scenes/3"));
        live.type_line("/resume");
        live.hear("resume: done");
        is_seen("scenes-3-2.csv");
        type_answers(&mut live, "scenes/4: presence.q2 = 4");
        // what is out of range is said and not taken
        live.hear("How does this person feel?");
        live.type_line("bored");
        live.hear("\"bored\" is no answer: 0 happy");
        live.type_line("sad");
        live.hear("identify/1: which = 2");
        is_seen("identify-2.csv");
        live.type_line("/end");
    });
    let (outcome, _) = live.wait();
    assert_eq!((&outcome["state"], &outcome["page"]), (&Value::from("placed"), &Value::from("identify/2")));
    let mut live = lab.run(Some(&code));
    with_hand(&lab.service, &[asks::NEXT], || {
        type_answers(&mut live, "identify/4: which = 0");
        assert_eq!(live.wait().0["state"], "finished");
    });
    // one was left out
    has_all(&lab.data, &code, &[], 3 + 4);
    let (is_good, said) = lab.ask(&["study", "replay", lab.data.to_str().unwrap()]);
    assert!(is_good && !said.contains("DIFFERS"), "{said}");
    // none of those that were cut is lost: repeated, skipped, paused, ended
    for name in ["scenes-1", "scenes-1-2", "scenes-2", "scenes-3", "scenes-3-2", "identify-2", "identify-2-2"]
    {
        assert!(said.contains(&format!("/{name}.csv  ")), "{name}: {said}");
    }
    let (is_good, said) = lab.ask(&[
        "study",
        "run",
        lab.study.to_str().unwrap(),
        "--data",
        lab.data.to_str().unwrap(),
        "--code",
        &code,
    ]);
    assert!(!is_good && said.contains("this participation has ended: finished"), "{said}");
}
