//! What a film shows, and what becomes of one that does not.

use super::driver::{Browser, Options};
use super::visit::{Given, Hands, Visit};
use gaitway::export::figure;
use gaitway::picture::Image;
use gaitway::{Emotion, GaitLibrary};
use serde_json::json;
use std::time::Instant;

/// Mean difference of two pictures, of 255.
fn difference(image: &Image, rgb: impl Iterator<Item = [u8; 3]>) -> f64 {
    let own = image.pixels.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]);
    let sum: u64 =
        own.zip(rgb).map(|(a, b)| a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(b))).sum::<u64>()).sum();
    f64::from(u32::try_from(sum).unwrap()) / f64::from(3 * image.width * image.height)
}

/// The film of the page, drawn by the page's own code at a size and at a time, s.
const DRAWN: &str = "
const [[width, height], time, done] = arguments;
(async () => {
    const script = document.querySelector('script').src.replace('page.mjs', 'walk.mjs');
    const { draw } = await import(script);
    const walk = await (await fetch(`/stimuli/${document.getElementById('main').dataset.film}`)).json();
    const canvas = Object.assign(document.createElement('canvas'), { width, height });
    const context = canvas.getContext('2d', { alpha: false });
    draw(context, walk, time);
    return [...context.getImageData(0, 0, width, height).data];
})().then(done, error => done(String(error)))";

fn drawn(browser: &Browser, time: f32) -> Vec<[u8; 3]> {
    let found = browser.run_async(DRAWN, &[json!([figure::SIZE.0, figure::SIZE.1]), json!(time)]);
    let bytes =
        found.as_array().unwrap_or_else(|| panic!("{found}")).iter().map(|byte| byte.as_u64().unwrap());
    let bytes: Vec<u8> = bytes.map(|byte| u8::try_from(byte).unwrap()).collect();
    bytes.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

#[test]
fn a_canvas_shows_what_the_renderer_of_pictures_draws() {
    // as wide as it takes for a canvas of the size of the renderer's picture
    let Some((visit, _)) = Visit::at(Options { size: [312, 2400], ..Options::default() }, "walks/*:film")
    else {
        return;
    };
    visit.wait_for_film();
    let library = GaitLibrary::load_glb(visit.lab.study().join("library.glb")).unwrap();
    for time in [0.0, 0.21, 0.93, 3.7] {
        let page = drawn(&visit.browser, time);
        let mut apart: Vec<f64> = library
            .gaits()
            .iter()
            .map(|gait| difference(&figure::picture(gait, time), page.iter().copied()))
            .collect();
        apart.sort_by(f64::total_cmp);
        println!("at {time} s: {:.3} of 255, another walk {:.3}", apart[0], apart[1]);
        assert!(apart[0] < 2.0, "at {time} s the page differs by {} of 255", apart[0]);
        assert!(apart[1] > 2.0 * apart[0], "the nearest walk is not clear: {apart:?}");
    }
    let png = visit.browser.shot_of("canvas", "canvas");
    let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), figure::SIZE);
    let seen: Vec<[u8; 3]> =
        bytes.chunks_exact(info.color_type.samples()).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let of = |gait| difference(&figure::picture(gait, 0.0), seen.iter().copied());
    let apart = library.gaits().iter().map(of).fold(f64::INFINITY, f64::min);
    assert!(apart < 2.0, "the screen differs by {apart} of 255");
}

#[test]
fn a_film_on_a_hidden_page_stops_and_counts_again() {
    let changes = [("view = \"front\", seconds = 0.5", "view = \"front\", seconds = 2.5")];
    let Some(visit) = Visit::to(Options::default(), Hands::Mouse, &changes) else { return };
    visit.open();
    visit.go_on("walks/*:film");
    let film = visit.page();
    visit.wait_for_film();
    let before = visit.stored("SELECT count(*) FROM exposure");
    visit.press(".play");
    visit.browser.wait_for_text(".film-status", "Playing");
    visit.browser.hide();
    let is_hidden = |browser: &Browser| browser.run("return document.hidden", &[]) == json!(true);
    visit.browser.until("not hidden", |browser| is_hidden(browser).then_some(()));
    visit.browser.show();
    let said = "The film stopped because this page was hidden. Please play it again.";
    visit.browser.wait_for_text(".film-status", said);
    assert_eq!(visit.page(), film);
    assert_eq!(visit.stored("SELECT count(*) FROM exposure"), before, "half a film counts");
    visit.press(".play");
    visit.after(&film);
    let whole = "SELECT count(*) FROM exposure WHERE page LIKE 'walks/%' AND plays = 1 AND seconds_visible BETWEEN 2.2 AND 3";
    assert_eq!(visit.stored(whole), 1);
    let hidden = "SELECT count(*) FROM event WHERE kind = 'sign' AND detail LIKE '%hidden%'";
    assert!(visit.stored(hidden) >= 1);
    visit.assert_quiet();
}

#[test]
fn a_film_that_does_not_start_is_reported_and_another_one_follows() {
    let Some((visit, mut given)) = Visit::at(Options::default(), "practice/3") else { return };
    let block = |what: &str| visit.browser.devtools("Network.setBlockedURLs", &json!({ "urls": [what] }));
    block("*/stimuli/*");
    let begin = Instant::now();
    // the walk that comes next, or, where the instruction comes first, the one after it
    while !visit.page().starts_with("walks/") || !visit.page().ends_with(":film") {
        let page = visit.page();
        visit.pass(&mut given);
        visit.after(&page);
    }
    let film =
        |visit: &Visit| visit.browser.run("return document.getElementById('main').dataset.film ?? null", &[]);
    let (page, name) = (visit.page(), film(&visit));
    block(&format!("*{}*", name.as_str().unwrap()));
    visit
        .browser
        .until("no other film", |_| (film(&visit) != name && film(&visit).is_string()).then_some(()));
    let waited = begin.elapsed().as_secs_f64();
    assert!((9.0..40.0).contains(&waited), "after {waited} s");
    assert_eq!(visit.page(), page, "the place in the part is the same");
    assert_eq!(visit.stored("SELECT count(*) FROM event WHERE kind = 'fault'"), 1);
    block("nothing");
    given.extend(visit.go_on(""));
    visit.assert_stored(&given);
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
}

#[test]
fn no_byte_of_a_whole_participation_tells_what_is_shown() {
    let Some(visit) = Visit::new(Options { listens: true, ..Options::default() }, Hands::Mouse) else {
        return;
    };
    let library = GaitLibrary::load_glb(visit.lab.study().join("library.glb")).unwrap();
    let mut bodies: Vec<(String, String)> = Vec::new();
    let mut collect = |visit: &Visit| {
        for event in visit.browser.network_events() {
            let params = &event["params"];
            if event["method"] != "Network.responseReceived" {
                continue;
            }
            let id = json!({ "requestId": params["requestId"] });
            let address = params["response"]["url"].as_str().unwrap().to_owned();
            // of what the page that is left behind had fetched nothing is kept
            if let Some(body) = visit.browser.try_devtools("Network.getResponseBody", &id) {
                bodies.push((address, format!("{} {}", params["response"]["headers"], body["body"])));
            }
        }
    };
    visit.open();
    let given: Given = visit.go_through("", |visit, _| {
        if visit.browser.count(".film") == 1 {
            visit.wait_for_film();
        }
        collect(visit);
    });
    let walks = bodies.iter().filter(|(_, body)| body.contains("poses")).count();
    assert!(walks >= 5 && bodies.len() > 20 && given.len() > 20, "{walks} walks of {} replies", bodies.len());
    let mut found = Vec::new();
    for (address, body) in &bodies {
        // the questions ask for emotions; a walk has no words but names of fields
        let labels =
            Emotion::ALL.iter().map(|emotion| emotion.name()).filter(|_| address.contains("/stimuli/"));
        let names = library.gaits().iter().map(|gait| gait.name.as_str());
        found.extend(
            labels.chain(names).chain(["library.glb", "20190919"]).filter(|word| body.contains(*word)),
        );
    }
    assert_eq!(found, Vec::<&str>::new());
    assert!(
        bodies.iter().any(|(_, body)| body.contains("This person looks happy")),
        "the search reads nothing"
    );
}
