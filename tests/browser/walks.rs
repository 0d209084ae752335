//! A whole participation, from the first page to the code: by keys, by mouse, narrow, dark, large.

use super::driver::{Browser, Options};
use super::visit::{Hands, Visit};
use serde_json::json;
use std::collections::BTreeMap;

/// Whether what has the focus shows it.
const SEES_FOCUS: &str = "
const style = getComputedStyle(document.activeElement);
return document.activeElement.matches(':focus-visible') && style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2";

/// Everything that can be pressed and is smaller than 44 pixels one way; a radio button is pressed by its label. Links in a
/// sentence may be as high as its line.
const SMALL: &str = "
return [...document.querySelectorAll('button, a.button, summary, label:has(input), input:not([type=radio], [type=hidden]), textarea')]
    .filter(one => { const { width, height } = one.getBoundingClientRect(); return height > 0 && Math.min(width, height) < 43.9; })
    .map(one => one.outerHTML)";

/// Goes through the whole study, with a look at every page. Nothing may be complained of, and all answers are stored.
fn whole(options: Options, hands: Hands, mut look: impl FnMut(&Visit, &str)) {
    let Some(visit) = Visit::new(options, hands) else { return };
    visit.open();
    let mut pages = Vec::new();
    let given = visit.go_through("", |visit, page| {
        visit.assert_quiet();
        visit.assert_fits();
        look(visit, page);
        pages.push(page.to_owned());
    });
    // a form of two, two checks, three films of practice, two walks, one again, an instruction, remarks
    assert_eq!(given.len(), 2 + 2 + 3 * 4 + 4 * 4 + 1, "{given:?}");
    assert_eq!(pages.first().map(String::as_str), Some("welcome"));
    assert!(pages.iter().filter(|page| page.starts_with("walks/")).count() == 3 * 2 + 1, "{pages:?}");
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
    visit.assert_stored(&given);
    assert_eq!(visit.stored("SELECT count(*) FROM exposure"), 6);
    assert_eq!(
        visit.stored("SELECT count(*) FROM exposure WHERE plays != 1 OR frames < 1 OR seconds_visible < 0.4"),
        0
    );
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'finished'"), 1);
    assert_eq!(
        visit.browser.run("return localStorage.length", &[]),
        json!(0),
        "something stays in the browser"
    );
    visit.assert_quiet();
}

#[test]
fn by_keys_alone() {
    whole(Options::default(), Hands::Keys, |visit, page| {
        if !["welcome", "consent", "end"].contains(&page) {
            let is_heading = visit.browser.run("return document.activeElement.tagName", &[]);
            // the page that the consent's form led to was loaded as a whole
            assert!(is_heading == json!("H1") || page == "about-you", "{page}: focus at {is_heading}");
        }
        visit.tab_to("button:enabled");
        assert_eq!(visit.browser.run(SEES_FOCUS, &[]), json!(true), "{page}: the focus is not seen");
        visit.browser.run("document.activeElement.blur()", &[]);
    });
}

#[test]
fn by_mouse_alone_on_targets_of_44_pixels() {
    whole(Options::default(), Hands::Mouse, |visit, page| {
        assert_eq!(visit.browser.run(SMALL, &[]), json!([]), "{page}");
    });
}

#[test]
fn on_a_page_of_320_pixels() {
    let options = Options { size: [320, 568], ..Options::default() };
    whole(options, Hands::Mouse, |visit, page| {
        assert_eq!(visit.browser.run(SMALL, &[]), json!([]), "{page}");
        visit.browser.shot(&name("narrow", page));
    });
}

#[test]
fn in_dark_mode_with_the_film_as_it_is_in_light() {
    let mut seen = BTreeMap::new();
    whole(Options { dark: true, ..Options::default() }, Hands::Mouse, |visit, page| {
        visit.browser.shot(&name("dark", page));
        if page == "practice/1:film" {
            visit.wait_for_film();
            seen.insert("box", visit.browser.style(".film .box", "background-color"));
            let pixel =
                "return [...document.querySelector('canvas').getContext('2d').getImageData(1, 1, 1, 1).data]";
            seen.insert("paper", visit.browser.run(pixel, &[]).to_string());
        }
    });
    if !seen.is_empty() {
        assert_eq!(
            (seen["box"].as_str(), seen["paper"].as_str()),
            ("rgba(128, 128, 128, 1)", "[240,240,238,255]")
        );
    }
}

#[test]
fn at_twice_the_size() {
    // as the zoom of 200 % of a window of 1280 x 800 does it: half as many pixels of the style, each twice as large
    let zoom = |browser: &Browser| {
        let metrics = json!({ "width": 640, "height": 400, "deviceScaleFactor": 2, "mobile": false });
        browser.devtools("Emulation.setDeviceMetricsOverride", &metrics);
    };
    whole(Options::default(), Hands::Mouse, |visit, page| {
        zoom(&visit.browser);
        visit.browser.shot(&name("zoom", page));
        visit.assert_fits();
        // twice the size of text alone
        visit.browser.run("document.documentElement.style.fontSize = '200%'", &[]);
        visit.assert_fits();
        visit.browser.run("document.documentElement.style.fontSize = ''", &[]);
    });
}

#[test]
fn keys_1_to_9_choose_in_the_group_that_has_the_focus() {
    let Some((visit, _)) = Visit::at(Options::default(), "practice/1") else { return };
    visit.choose("emotions.sad", 0);
    for (key, value) in [("4", "4"), ("2", "2"), ("9", "2")] {
        visit.browser.type_text(key);
        let checked =
            "return [...document.querySelectorAll('input:checked')].map(input => [input.name, input.value])";
        assert_eq!(visit.browser.run(checked, &[]), json!([["q:emotions.sad", value]]));
    }
    let last =
        "SELECT ifnull((SELECT value FROM answer WHERE question = 'emotions.sad' ORDER BY seq DESC), 0)";
    visit.browser.until("not stored", |_| (visit.stored(last) == 2).then_some(()));
    visit.assert_quiet();
}

/// The name of a picture of a page.
fn name(way: &str, page: &str) -> String {
    format!("{way}-{}", page.replace(['/', ':'], "-"))
}
