//! The study of crowds: scenes and single agents as clips, each seen to its end.

use super::common::lab::Lab;
use super::driver::{Browser, Options};
use super::visit::{Given, Hands, Visit};
use gaitway::export::video::Video;
use gaitway::picture::Image;
use gaitway::study::store::Reading;
use serde_json::json;
use std::collections::BTreeMap;

/// Size of the clips (pixels), their frames, and frames a second.
const SIZE: [u32; 2] = [160, 120];
const FRAMES: u32 = 12;
const RATE: f64 = 15.0;

/// Brightness of the first frame of the film in the box, of 255.
const BRIGHTNESS: &str = "
const video = document.querySelector('.box video');
const canvas = Object.assign(document.createElement('canvas'), { width: 8, height: 8 });
const context = canvas.getContext('2d');
context.drawImage(video, 0, 0, 8, 8);
return context.getImageData(4, 4, 1, 1).data[1]";

/// The study of crowds with films of less than a second, and the brightness of each, by its name.
fn lab() -> (Lab, BTreeMap<String, u8>) {
    let short =
        [("seconds = 45", "seconds = 1"), ("seconds = 20", "seconds = 1"), ("seconds = 8", "seconds = 1")];
    let lab = Lab::of("eva-agents", &[], &short);
    let refusal = lab.refusal();
    assert!(refusal.contains("clips are missing") && refusal.contains(".mp4"), "{refusal}");
    let names: Vec<String> =
        Reading::open(&lab.data()).unwrap().versions()[0].stimuli.keys().cloned().collect();
    // three seeds of practice and of each scene under each condition, and of each agent
    assert_eq!(names.len(), 3 * (1 + 12 + 8), "{names:?}");
    let mut shades = BTreeMap::new();
    std::fs::create_dir_all(lab.data().join("clips")).unwrap();
    for (shade, name) in (20..).step_by(3).zip(names) {
        film(&lab, &name, shade);
        shades.insert(name, shade);
    }
    (lab, shades)
}

/// A film of one shade, that becomes lighter by its end.
fn film(lab: &Lab, name: &str, shade: u8) {
    let path = lab.data().join("clips").join(format!("{name}.mp4"));
    let mut video = Video::create(&path, SIZE[0], SIZE[1], RATE).unwrap();
    for frame in 0..FRAMES {
        let shade = shade + u8::try_from(frame).unwrap();
        let pixels = [shade, shade, shade, 255].repeat(usize::try_from(SIZE[0] * SIZE[1]).unwrap());
        video.push(&Image { width: SIZE[0], height: SIZE[1], pixels }).unwrap();
    }
    video.finish().unwrap();
}

#[test]
fn a_participant_sees_every_clip_to_its_end_and_goes_through_the_whole_study() {
    let Some(browser) = Browser::open(Options::default()) else { return };
    let (lab, shades) = lab();
    let visit = Visit::of(browser, lab, Hands::Mouse);
    visit.open();
    let mut films = Vec::new();
    let given = visit.go_through("", |visit, page| {
        visit.assert_quiet();
        visit.assert_fits();
        if !page.ends_with(":film") {
            return;
        }
        visit.wait_for_film();
        let name = visit.browser.run("return document.getElementById('main').dataset.film", &[]);
        let name = name.as_str().unwrap().to_owned();
        let wanted = u64::from(shades[&name]);
        visit.browser.until(&format!("{page} shows no film of {wanted}"), |browser| {
            let seen = browser.run(BRIGHTNESS, &[]).as_u64().unwrap();
            (seen.abs_diff(wanted) <= 1).then_some(())
        });
        films.push(name);
    });
    // one of practice, twelve scenes, eight agents, no stimulus twice
    assert_eq!(films.len(), 1 + 12 + 8);
    let different: std::collections::BTreeSet<&String> = films.iter().collect();
    assert_eq!(different.len(), films.len());
    // gender and age, two questionnaires of 16, five questions after 13 scenes, sickness after 4 blocks, 8 emotions, a remark
    assert_eq!(given.len(), 2 + 2 * 16 + 5 * 13 + 4 + 8 + 1, "{given:?}");
    visit.assert_stored(&given);
    let whole = f64::from(FRAMES) / RATE;
    let to_the_end = format!(
        "SELECT count(*) FROM exposure WHERE plays = 1 AND frames > 0 AND seconds_visible BETWEEN {} AND {}",
        0.9 * whole,
        whole + 2.0
    );
    assert_eq!(visit.stored(&to_the_end), 21, "a film was not seen to its end");
    assert_eq!(visit.stored("SELECT count(*) FROM event WHERE kind = 'fault'"), 0);
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'finished'"), 1);
    assert_eq!(visit.browser.run("return localStorage.length", &[]), json!(0));
    visit.assert_quiet();
}

#[test]
fn a_clip_that_cannot_be_played_is_a_fault_and_the_participant_is_not_stuck() {
    let Some(browser) = Browser::open(Options::default()) else { return };
    let (lab, shades) = lab();
    let clip = |lab: &Lab, name: &str| lab.data().join("clips").join(format!("{name}.mp4"));
    shades.keys().for_each(|name| std::fs::write(clip(&lab, name), [7; 1000]).unwrap());
    let visit = Visit::of(browser, lab, Hands::Mouse);
    visit.open();
    let faults = |visit: &Visit| visit.stored("SELECT count(*) FROM event WHERE kind = 'fault'");
    // pages pass over such films by themselves, perhaps before they are looked at
    let mut given = Given::new();
    while faults(&visit) == 0 {
        let page = visit.page();
        visit.pass(&mut given);
        visit.after(&page);
    }
    // from here on all can be played
    shades.iter().for_each(|(name, &shade)| film(&visit.lab, name, shade));
    visit.settle();
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
    assert_eq!(visit.stored("SELECT count(*) FROM exposure") + faults(&visit), 21, "a clip left no trace");
    let told = "SELECT count(*) FROM event WHERE kind = 'fault' AND detail LIKE '%clip%'";
    assert_eq!(visit.stored(told), faults(&visit));
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'finished'"), 1);
}
