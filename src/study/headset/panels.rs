//! Pages as panels, and what is chosen on them as answers.

use super::words::Phrases;
use crate::study::plan::{Ending, Scale};
use crate::study::protocol::{Page, PageQuestion};
use crate::xr::{MOST_CELLS, MOST_CHARACTERS, Panel};

/// The cells of a question and the answer that each stands for; none for one that is not asked in the headset.
pub(super) fn cells(question: &PageQuestion) -> Option<Vec<(String, i64)>> {
    let found: Vec<(String, i64)> = match &question.scale {
        Scale::Points { least, greatest, labels } => {
            let label = |value: i64| labels.iter().find(|(of, _)| *of == value).map(|(_, text)| text.clone());
            let has_all = (*least..=*greatest).all(|value| label(value).is_some());
            let cell = |value: i64| label(value).filter(|_| has_all).unwrap_or_else(|| value.to_string());
            (*least..=*greatest).map(|value| (cell(value), value)).collect()
        }
        Scale::Options { options } => options.iter().map(|(value, text)| (text.clone(), *value)).collect(),
        Scale::Number { .. } | Scale::Text { .. } => return None,
    };
    (1..=MOST_CELLS).contains(&found.len()).then_some(found)
}

/// The panel of a question with the answer so far. `place` says which question of how many it is.
pub(super) fn question(
    words: &Phrases,
    page: &Page,
    question: &PageQuestion,
    place: [usize; 2],
    answer: Option<i64>,
) -> Panel {
    let cells = cells(question).unwrap_or_default();
    let is_answered = answer.is_some() || question.optional || cells.is_empty();
    let ends = match &question.scale {
        Scale::Points { least, greatest, labels }
            if cells.iter().all(|(text, value)| *text == value.to_string()) =>
        {
            [least, greatest].map(|end| {
                let label = labels.iter().find(|(value, _)| value == end);
                label.map(|(_, text)| text.clone()).unwrap_or_default()
            })
        }
        _ => Default::default(),
    };
    let texts = [question.heading.trim(), question.text.trim()];
    let text: Vec<&str> = texts.into_iter().filter(|text| !text.is_empty()).collect();
    Panel {
        title: title(words, page, place),
        question: short(&text.join("\n")),
        chosen: answer.and_then(|answer| cells.iter().position(|(_, value)| *value == answer)),
        cells: cells.into_iter().map(|(text, _)| short(&text)).collect(),
        ends: ends.map(|end| short(&end)),
        back: (place[0] > 0).then(|| words.back.clone()),
        next: is_answered.then(|| words.next.clone()),
    }
}

/// The panel of a question that the participant answers aloud.
pub(super) fn spoken(words: &Phrases, question: &PageQuestion, panel: Panel) -> Panel {
    let next = question.optional.then(|| words.next.clone());
    Panel { title: words.aloud.clone(), cells: Vec::new(), next, ..panel }
}

/// How far the participant is: the trial, and the question of the page.
fn title(words: &Phrases, page: &Page, [number, of]: [usize; 2]) -> String {
    let trial = page.progress.map(|progress| words.progress(progress.trial, progress.of));
    let question = (of > 1).then(|| words.question(number + 1, of));
    trial.into_iter().chain(question).collect::<Vec<_>>().join(" · ")
}

/// A text on as many panels as it needs, cut at its paragraphs, else at its words.
pub(super) fn texts(text: &str) -> Vec<String> {
    let mut pages: Vec<String> = Vec::new();
    for word in text.split_inclusive(char::is_whitespace) {
        let has_room = pages.last().is_some_and(|page| {
            let ends_paragraph = page.ends_with("\n\n") && page.chars().count() > MOST_CHARACTERS / 2;
            page.chars().count() + word.chars().count() <= MOST_CHARACTERS && !ends_paragraph
        });
        match pages.last_mut().filter(|_| has_room) {
            Some(page) => page.push_str(word),
            None => pages.push(word.chars().take(MOST_CHARACTERS).collect()),
        }
    }
    pages.iter().map(|page| page.trim().to_owned()).filter(|page| !page.is_empty()).collect()
}

/// At most as many characters as a panel has room for.
fn short(text: &str) -> String {
    text.chars().take(MOST_CHARACTERS).collect()
}

/// A panel with a text and the buttons to its neighbours.
pub(super) fn text(words: &Phrases, text: &str, has_back: bool) -> Panel {
    Panel {
        question: short(text),
        back: has_back.then(|| words.back.clone()),
        next: Some(words.next.clone()),
        ..Panel::default()
    }
}

/// A panel that nothing answers.
pub(super) fn notice(text: &str) -> Panel {
    Panel { question: short(text), ..Panel::default() }
}

/// What the participant reads at the end.
pub(super) const fn farewell(words: &Phrases, ending: Ending) -> &String {
    match ending {
        Ending::Finished => &words.finished,
        Ending::Full => &words.full,
        _ => &words.ended,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::study::protocol::{Content, Progress};

    fn phrases() -> Phrases {
        Phrases::of("en")
    }

    fn page(progress: Option<(u32, u32)>) -> Page {
        let progress = progress.map(|(trial, of)| Progress { trial, of });
        Page { id: "scenes/3".into(), part: "scenes".into(), progress, content: Content::Rest }
    }

    fn asked(scale: Scale<String>) -> PageQuestion {
        let text = "The people seemed to notice me".into();
        PageQuestion { id: "presence.q2".into(), heading: String::new(), text, scale, optional: false }
    }

    fn points(least: i64, greatest: i64, labels: &[(i64, &str)]) -> Scale<String> {
        let labels = labels.iter().map(|(value, text)| (*value, (*text).to_owned())).collect();
        Scale::Points { least, greatest, labels }
    }

    #[test]
    fn a_scale_is_a_row_of_cells_whose_ends_have_phrases() {
        let seven = asked(points(1, 7, &[(1, "not at all"), (7, "very much")]));
        let panel = question(&phrases(), &page(Some((3, 12))), &seven, [1, 5], None);
        assert_eq!(panel.title, "3 of 12 · question 2 of 5");
        assert_eq!((panel.cells.len(), panel.cells[6].as_str()), (7, "7"));
        assert_eq!(panel.ends, ["not at all", "very much"]);
        // on with an answer alone; back from the second question on
        assert_eq!((panel.next, panel.back.as_deref(), panel.chosen), (None, Some("Back"), None));
        let panel = question(&phrases(), &page(None), &seven, [0, 1], Some(4));
        assert_eq!((panel.title.as_str(), panel.chosen, panel.back), ("", Some(3), None));
        assert!(panel.next.is_some() && panel.question == seven.text);
        panel_is_good(&question(&phrases(), &page(None), &asked(points(0, 20, &[])), [0, 1], Some(20)));
        let words = asked(points(0, 1, &[(0, "no"), (1, "yes")]));
        assert_eq!(cells(&words).unwrap(), [("no".to_owned(), 0), ("yes".to_owned(), 1)]);
        assert_eq!(question(&phrases(), &page(None), &words, [0, 1], None).ends, ["", ""]);
        let optional = PageQuestion { optional: true, ..seven };
        assert!(question(&phrases(), &page(None), &optional, [0, 1], None).next.is_some());
    }

    fn panel_is_good(panel: &Panel) {
        panel.check().unwrap();
    }

    #[test]
    fn options_stand_for_their_values_and_what_is_written_is_not_asked() {
        let options = vec![(3, "sad".to_owned()), (0, "happy".to_owned())];
        let which = asked(Scale::Options { options });
        assert_eq!(cells(&which).unwrap(), [("sad".to_owned(), 3), ("happy".to_owned(), 0)]);
        assert_eq!(question(&phrases(), &page(None), &which, [0, 1], Some(0)).chosen, Some(1));
        for scale in [Scale::Text { most: 9 }, Scale::Number { least: 18, greatest: 99 }, points(0, 100, &[])]
        {
            assert_eq!(cells(&asked(scale)), None);
        }
    }

    #[test]
    fn long_texts_take_several_panels_and_lose_no_word() {
        let text = format!("{}\n\n{}", "first part ".repeat(28), "second part ".repeat(60));
        let pages = texts(&text);
        assert!(pages.len() > 2 && pages.iter().all(|page| page.chars().count() <= MOST_CHARACTERS));
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&pages.join(" ")), words(&text));
        assert!(pages[0].ends_with("first part") && pages[1].starts_with("second part"));
        assert_eq!(texts(""), Vec::<String>::new());
        assert_eq!(texts("one\n\ntwo"), ["one\n\ntwo"]);
        panel_is_good(&super::text(&phrases(), &pages[0], false));
    }
}
