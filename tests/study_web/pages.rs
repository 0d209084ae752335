//! Pages as browsers and screen readers need them.

use crate::client::Reply;
use crate::lab::{Lab, go_on};

/// All pages of a participation.
fn pages() -> Vec<Reply> {
    let lab = Lab::plain();
    let mut browser = lab.browser();
    let mut all = vec![browser.open("/s/looks"), crate::lab::begin(&mut browser)];
    let first = crate::lab::agree(&mut browser, &all[1].clone());
    all.extend(go_on(&mut browser, first, ""));
    all.push(browser.open("/nothing"));
    all
}

/// Tags that are opened and not closed, or the other way round.
fn unbalanced(html: &str) -> Vec<String> {
    let void = ["!DOCTYPE", "meta", "link", "input", "br", "hr"];
    let mut open: Vec<String> = Vec::new();
    let mut wrong = Vec::new();
    for tag in html.split('<').skip(1).filter_map(|rest| rest.split('>').next()) {
        let name = tag.split([' ', '\n']).next().unwrap();
        if let Some(name) = name.strip_prefix('/') {
            if open.last().is_some_and(|last| last == name) {
                open.pop();
            } else {
                wrong.push(format!("/{name} within {open:?}"));
            }
        } else if !void.contains(&name) && !tag.ends_with('/') {
            open.push(name.to_owned());
        }
    }
    wrong.extend(open);
    wrong
}

#[test]
fn every_page_is_whole_has_one_heading_and_runs_nothing_of_its_own() {
    for page in pages() {
        let html = &page.body;
        assert_eq!(unbalanced(html), Vec::<String>::new(), "{html}");
        assert_eq!(html.matches("<h1").count(), 1, "{html}");
        assert_eq!(html.matches("<main").count(), 1);
        assert!(html.contains("lang=\"en\" dir=\"ltr\"") && html.contains("Lab of Gaits, lab@example.org"));
        assert!(html.contains("aria-live=\"polite\"") && html.contains("href=\"#main\""));
        // what the policy of the pages would forbid
        for inline in [" style=", " onclick=", " onload=", "javascript:", "<style", "http://", "//cdn"] {
            assert!(!html.contains(inline), "{inline}: {html}");
        }
        let scripts: Vec<&str> = html.split("<script").skip(1).collect();
        assert!(scripts.len() == 1 && scripts[0].contains("src=\"/static/"), "{html}");
    }
    assert_eq!(unbalanced("<p><b>x</p>"), ["/p within [\"p\", \"b\"]", "p", "b"]);
}

#[test]
fn answers_are_native_groups_with_legends_and_labels() {
    let mut seen = 0;
    for page in pages() {
        let html = &page.body;
        assert_eq!(html.matches("<fieldset").count(), html.matches("<legend>").count());
        for group in html.split("<fieldset").skip(1) {
            let group = group.split("</fieldset>").next().unwrap();
            let radios = group.matches("type=\"radio\"").count();
            assert!(radios >= 2 && group.matches("<label>").count() == radios, "{group}");
            let names: std::collections::BTreeSet<&str> =
                group.split("name=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
            assert_eq!(names.len(), 1, "{group}");
            seen += 1;
        }
        for field in html.split("<div class=\"field\"").skip(1) {
            let label = field.split("for=\"").nth(1).unwrap().split('"').next().unwrap();
            assert!(field.contains(&format!("id=\"{label}\"")), "{field}");
        }
    }
    assert!(seen > 12, "{seen} groups");
}

#[test]
fn each_page_of_a_participation_can_be_left_for_good() {
    let pages = pages();
    for page in &pages[1..pages.len() - 2] {
        assert!(page.body.contains("action=\"/s/looks/withdraw\""), "{}", page.body);
        assert!(page.body.contains("Your code"));
    }
    let finished = &pages[pages.len() - 2];
    assert!(finished.body.contains("Thank you") && finished.body.contains("action=\"/s/looks/withdraw\""));
}

#[test]
fn the_style_has_targets_of_44_pixels_and_a_contrast_of_four_and_a_half() {
    let css = include_str!("../../assets/web/web.css");
    assert!(
        css.contains("--target: 44px")
            && css.contains("prefers-reduced-motion")
            && css.contains(":focus-visible")
    );
    let colour = |theme: &str, name: &str| {
        let hex = theme.split(&format!("--{name}: #")).nth(1).unwrap().get(..6).unwrap();
        let channel = |at: usize| f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
        let linear = |c: f64| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        0.2126 * linear(channel(0)) + 0.7152 * linear(channel(2)) + 0.0722 * linear(channel(4))
    };
    let (light, dark) = css.split_once("prefers-color-scheme: dark").unwrap();
    for theme in [light, dark] {
        let contrast = |a: &str, b: &str| {
            let (a, b) = (colour(theme, a), colour(theme, b));
            (a.max(b) + 0.05) / (a.min(b) + 0.05)
        };
        for ink in ["ink", "soft", "accent", "wrong"] {
            for paper in ["paper", "card"] {
                assert!(contrast(ink, paper) >= 4.5, "{ink} on {paper}: {}", contrast(ink, paper));
            }
        }
        assert!(contrast("on-accent", "accent") >= 4.5 && contrast("line", "paper") >= 3.0);
    }
}
