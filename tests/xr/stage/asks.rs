//! Panels and their answers: by laser, stick and look.

use super::super::presented::{EYE, differs, screen};
use super::super::service::{Head, Live, Service, Stick, is_there, until};
use super::act::{PICTURE, Seen, Teller, see_post, square, tell};
use super::{folder, play, told as told_of};
use gaitway::xr::{Answered, Panel, Stage, World};
use serde_json::{Value, json};
use std::path::Path;
use std::time::{Duration, Instant};

/// A question with seven cells and two buttons.
pub(super) fn likert(title: &str) -> Panel {
    Panel {
        title: title.to_owned(),
        question: "The people seemed to notice me, and to differ in what they felt".to_owned(),
        cells: (1..=7).map(|cell| cell.to_string()).collect(),
        ends: ["disagree strongly".to_owned(), "agree strongly".to_owned()],
        chosen: None,
        back: Some("Back".to_owned()),
        next: Some("Next".to_owned()),
    }
}

pub(super) fn told(answered: &Answered) -> Value {
    let Answered { choice, means, seconds, frames } = answered;
    json!({ "choice": format!("{choice:?}"), "means": means.name(), "seconds": seconds, "frames": frames })
}

/// Pixels of the middle of a cell of seven, and of the buttons.
pub(in super::super) fn cell(number: u8) -> [f32; 2] {
    [20.0 + 180.0 * (f32::from(number) + 0.5), 555.0]
}
pub(in super::super) const NEXT: [f32; 2] = [1060.0, 885.0];

/// The place in the room of a pixel of a panel that stands before a head at (0, 1.6, 0) that looks ahead.
fn place([x, y]: [f32; 2]) -> [f32; 3] {
    let tilt = glam::Quat::from_rotation_x(-10.0_f32.to_radians());
    let at = tilt * glam::Vec3::new(x * 1e-3 - 0.65, 0.48 - y * 1e-3, -1.5);
    (at + glam::Vec3::new(0.0, 1.6, 0.0)).to_array()
}

/// Points straight ahead at a pixel with the right hand, which pulls its trigger or not.
pub(in super::super) fn point(head: &mut Head, pixel: [f32; 2], trigger: bool) {
    let [x, y, _] = place(pixel);
    head.set_hand(1, [x, y, -0.3], 0.0, Stick { trigger, ..Stick::default() });
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
}

/// Waits until the actor has drawn four frames that know all that was done before. Time alone says nothing on a busy machine.
fn frames(live: &mut Live) {
    live.hear_anew(PICTURE, 3);
}

/// Points at a pixel of a panel that is there, and pulls the trigger until that is heard.
fn choose(head: &mut Head, live: &mut Live, pixel: [f32; 2], words: &str) {
    for trigger in [false, true] {
        frames(live);
        point(head, pixel, trigger);
    }
    live.hear(words);
}

/// Asks for six answers, and tells each.
pub(super) fn asks(folder: &Path) {
    let (mut teller, seen) = (Teller::default(), Seen::default());
    let world = World::new(&square(0.0)).unwrap();
    let mut stage = Stage::open(&world, seen.plan(640)).unwrap();
    see_post(&mut stage, &seen, 0.0, &mut teller);
    for number in 1..=6 {
        let mut panel = likert(&format!("Crossing · {number} of 6"));
        panel.chosen = (number == 3).then_some(5);
        eprintln!("asking {number}");
        let (begin, uncounted) = (Instant::now(), seen.uncounted());
        let answered = stage.ask(&panel, &mut teller).unwrap().unwrap();
        let mut answer = told(&answered);
        answer["wall"] = json!(begin.elapsed().as_secs_f64());
        answer["slowest"] = json!(seen.slowest());
        answer["uncounted"] = json!(seen.uncounted() - uncounted);
        tell("answer", &answer);
        if let Some(image) = seen.newest() {
            let path = folder.join(format!("asked-{number}.png"));
            gaitway::export::image::write_png(&path, &image).unwrap();
        }
    }
    eprintln!("all asked");
    stage.clear();
    see_post(&mut stage, &seen, 0.0, &mut teller);
    tell("outcome", &json!(stage.close(&mut teller).unwrap()));
}

/// One trigger is pulled and held over six panels.
pub(super) fn asked_on(_: &Path) {
    let (mut teller, seen) = (Teller::default(), Seen::default());
    let world = World::new(&square(0.0)).unwrap();
    let mut stage = Stage::open(&world, seen.plan(320)).unwrap();
    see_post(&mut stage, &seen, 0.0, &mut teller);
    eprintln!("asking 1");
    tell("answer", &told(&stage.ask(&likert("one"), &mut teller).unwrap().unwrap()));
    eprintln!("asking 2");
    tell("answer", &told(&stage.ask(&likert("two"), &mut teller).unwrap().unwrap()));
    tell("outcome", &json!(stage.close(&mut teller).unwrap()));
}

#[test]
fn panels_are_answered_by_laser_by_stick_and_by_a_look() {
    if !is_there() {
        return;
    }
    let service = Service::start("asks");
    let folder = folder("asks");
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = play(&service, "asks", &folder);
    // what is pulled before the panel is there, or beside it, is no answer
    live.hear("asking 1");
    for (pixel, trigger) in
        [([2000.0, 500.0], false), ([2000.0, 500.0], true), (cell(3), true), (cell(3), false)]
    {
        frames(&mut live);
        point(&mut head, pixel, trigger);
    }
    choose(&mut head, &mut live, cell(3), "asking 2");
    choose(&mut head, &mut live, cell(6), "asking 3");
    choose(&mut head, &mut live, NEXT, "asking 4");
    // the left stick to the right, twice, and A of the right hand; the lasers are beside the panel
    let mut hold = |head: &mut Head, left: [f32; 2], a: bool| {
        frames(&mut live);
        head.set_hand(0, [-3.0, 1.2, -0.3], 0.0, Stick { stick: left, ..Stick::default() });
        head.set_hand(1, [3.0, 1.2, -0.3], 0.0, Stick { a, ..Stick::default() });
        head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    };
    for x in [0.0, 1.0, 0.0, 0.9, 0.0, 1.0, 0.0] {
        hold(&mut head, [x, 0.0], false);
    }
    hold(&mut head, [0.0, 0.0], true);
    live.hear("asking 5");
    // no hands: the head looks at a cell until it is chosen
    head.show_hand(0, None);
    head.show_hand(1, None);
    frames(&mut live);
    let begin = Instant::now();
    head.set(0.0, -12.9, [0.0, 1.6, 0.0]);
    live.hear("asking 6");
    assert!(begin.elapsed() >= Duration::from_millis(1200), "{:?}", begin.elapsed());
    // the same cell under the same look is no answer; elsewhere and back it is
    frames(&mut live);
    std::thread::sleep(Duration::from_millis(2500));
    head.set(0.0, 5.0, [0.0, 1.6, 0.0]);
    frames(&mut live);
    head.set(0.0, -12.9, [0.0, 1.6, 0.0]);
    live.hear("all asked");
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let (_, notes) = live.over();
    let answers = told_of(&notes, "answer");
    println!("{answers:#?}");
    let given: Vec<(&str, &str)> = answers
        .iter()
        .map(|answer| (answer["choice"].as_str().unwrap(), answer["means"].as_str().unwrap()))
        .collect();
    let wanted = [
        ("Cell(3)", "laser"),
        ("Cell(6)", "laser"),
        ("Next", "laser"),
        ("Cell(2)", "stick"),
        ("Cell(3)", "gaze"),
        ("Cell(3)", "gaze"),
    ];
    assert_eq!(given, wanted);
    for answer in &answers {
        let [seconds, wall, two_frames, uncounted] =
            ["seconds", "wall", "slowest", "uncounted"].map(|key| answer[key].as_f64().unwrap());
        // by the frames that showed the panel: some are lost before the first and after the last
        let lost = 5.0 * two_frames + uncounted + 0.3;
        assert!(seconds <= wall + 0.2 && wall - seconds <= lost, "{answer}");
    }
    // a look rests for 1.2 s; the second one had to be elsewhere first, for 3.2 s
    let seconds = |answer: usize| answers[answer]["seconds"].as_f64().unwrap();
    assert!(seconds(4) > 0.9 && seconds(5) > 2.5, "{answers:#?}");
    assert_eq!(told_of(&notes, "outcome")[0]["sessions"], 1);
}

#[test]
fn a_trigger_that_is_held_answers_one_panel() {
    if !is_there() {
        return;
    }
    let service = Service::start("held");
    let folder = folder("held");
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = play(&service, "asked-on", &folder);
    live.hear("asking 1");
    choose(&mut head, &mut live, cell(0), "asking 2");
    std::thread::sleep(Duration::from_millis(3500));
    choose(&mut head, &mut live, cell(1), "outcome");
    let (_, notes) = live.over();
    let answers = told_of(&notes, "answer");
    assert_eq!(answers[1]["choice"], "Cell(1)", "{answers:?}");
    assert!(answers[1]["seconds"].as_f64().unwrap() > 2.0, "{answers:?}");
}

/// A panel stands until the test has seen it; the pictures go into the folder.
pub(super) fn stands(folder: &Path) {
    let (mut teller, seen) = (Teller::default(), Seen::default());
    let world = World::new(&square(0.0)).unwrap();
    let mut plan = seen.plan(480);
    plan.eye_size = Some(EYE);
    let mut stage: Stage = Stage::open(&world, plan).unwrap();
    while seen.count() < 3 {
        stage.rest(0.1, &mut teller);
    }
    for (number, fade) in [(1, 0.0), (2, 1.0)] {
        stage.fade(fade);
        eprintln!("asking {number}");
        let before = seen.count();
        let answered = stage.ask(&likert("Standing"), &mut teller).unwrap().unwrap();
        assert!(seen.count() > before);
        tell("answer", &told(&answered));
        let path = folder.join(format!("ours-{number}.png"));
        gaitway::export::image::write_png(&path, &seen.newest().unwrap()).unwrap();
        std::fs::rename(&path, folder.join(format!("stands-{number}.png"))).unwrap();
        eprintln!("stands {number}");
        while !folder.join(format!("presented-{number}")).exists() {
            assert!(stage.rest(0.1, &mut teller), "the session is over");
        }
    }
    tell("outcome", &json!(stage.close(&mut teller).unwrap()));
}

#[test]
fn the_compositor_shows_the_panel_where_our_pictures_do() {
    if !is_there() {
        return;
    }
    let folder = folder("stands");
    let Some(screen) = screen(&folder) else { return };
    let service = Service::start_on("stands", &screen.display);
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = play(&service, "stands", &folder);
    for number in [1_u8, 2] {
        live.hear(&format!("asking {number}"));
        choose(&mut head, &mut live, cell(number), &format!("stands {number}"));
        let ours = super::super::picture(&folder.join(format!("stands-{number}.png")));
        let off = until(|| {
            let shown = screen.shows([2 * EYE[0], EYE[1]]);
            gaitway::export::image::write_png(&folder.join(format!("presented-{number}.png")), &shown)
                .unwrap();
            let off = differs(&shown, &ours, 40);
            if off.iter().all(|share| *share < 0.03) { Ok(off) } else { Err(format!("{off:?} differ")) }
        });
        println!("{number}: {off:.4?} of the pixels differ");
        std::fs::write(folder.join(format!("presented-{number}")), "").unwrap();
        // the panel covers about a fifth of the picture: without it, that many would differ
        let dark =
            ours.pixels.chunks_exact(4).filter(|p| p[0].abs_diff(28) < 4 && p[1].abs_diff(32) < 4).count();
        assert!(dark as f32 > 0.05 * (2 * EYE[0] * EYE[1]) as f32, "{dark} pixels of the panel");
    }
    let (_, notes) = live.over();
    assert_eq!(told_of(&notes, "outcome")[0]["sessions"], 1);
}
