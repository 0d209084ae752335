//! Pages and answers: what is on them, what they take.

use super::{Table, walk_plan};
use gaitway::study::plan::{Ending, Role};
use gaitway::study::protocol::{Answer, Content, Entry, Event, Refusal, Session};
use std::collections::BTreeSet;

#[test]
fn a_participant_goes_through_all_pages_of_both_studies() {
    for (name, pages) in [("eva-gaits", 1 + 3 + 3 + 12 + 2), ("eva-agents", 1 + 3 + 1 + 12 + 4 + 1 + 8 + 3)] {
        let plan = crate::plan(name, 342);
        let mut table = Table::new(&plan, 7);
        let mut ids = Vec::new();
        while table.ending().is_none() {
            let id = table.page().id;
            if ids.last() != Some(&id) {
                ids.push(id);
            }
            table.pass();
        }
        assert_eq!(table.ending(), Some(Ending::Finished));
        assert_eq!(ids.len(), pages, "{ids:?}");
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), pages, "no page comes twice");
        let Content::Ended { ending: Ending::Finished, code } = table.page().content else { panic!() };
        assert_eq!(code.is_some(), name == "eva-gaits");
        // under the same link the code is given again, and what is sent again changes nothing
        let length = table.log.len();
        let again = table.send(Event::Next { page: "debrief".to_owned() }).unwrap();
        assert_eq!((again, table.log.len()), (vec![], length));
    }
}

#[test]
fn a_rest_and_the_questions_after_a_block_come_where_the_file_says() {
    let plan = crate::plan("eva-agents", 0);
    let mut table = Table::new(&plan, 3);
    table.until("scenes/3");
    table.pass();
    table.pass();
    assert_eq!(table.page().id, "scenes/after/1");
    assert!(table.page().content.questions()[0].id == "fms.sickness");
    table.pass();
    assert_eq!(table.page().id, "scenes/4");
    table.until("scenes/after/2");
    table.pass();
    assert_eq!((table.page().id.as_str(), table.page().content), ("scenes/rest/2", Content::Rest));
    table.until("scenes/after/4");
    table.pass();
    assert_eq!(table.page().id, "identify/1", "no rest after the last block");
}

#[test]
fn a_place_is_given_after_consent_and_check_and_not_before() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    while table.page().part != "walks" {
        assert!(table.session.placed().is_none());
        assert_eq!(table.ledger.places(), 0);
        table.pass();
    }
    let trials = table.session.placed().unwrap();
    assert_eq!((trials.len(), table.ledger.places()), (12, 1));
    let count = |is: fn(&Role) -> bool| trials.iter().filter(|trial| is(&trial.role)).count();
    assert_eq!(count(|role| *role == Role::Ordinary), 10);
    assert_eq!(count(|role| matches!(role, Role::Repeat { .. })), 1);
    assert_eq!(count(|role| matches!(role, Role::Catch { .. })), 1);
}

#[test]
fn an_answer_sent_twice_counts_once_and_the_last_one_of_a_question_counts() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("walks/1");
    if matches!(table.page().content, Content::Show { .. }) {
        table.shown();
    }
    table.answer("emotions.happy", 2).unwrap();
    let Some(Entry { event: Event::Answer(first), .. }) = table.log.last().cloned() else { panic!() };
    table.answer("emotions.happy", 4).unwrap();
    let length = table.log.len();
    // the first one again, late: it was stored before
    assert_eq!(table.send(Event::Answer(first.clone())).unwrap(), []);
    assert_eq!(table.log.len(), length);
    let key = ("walks/1".to_owned(), "emotions.happy".to_owned());
    assert_eq!(table.session.answers()[&key].value, Some(4));
    // a log that holds it twice, as of a store without the rule, means the same
    let mut doubled = table.log.clone();
    doubled.push(Entry { at: table.now, event: Event::Answer(first) });
    assert_eq!(Session::replay(&plan, &doubled), table.session);
}

#[test]
fn a_page_ends_only_when_all_is_answered_and_earlier_ones_are_closed() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("practice/1");
    assert_eq!(table.next(), Err(Refusal::Misplaced), "nothing is asked before the stimulus was seen");
    assert!(matches!(table.answer("emotions.sad", 1), Err(Refusal::NoSuchQuestion { .. })));
    table.shown();
    for question in ["emotions.happy", "emotions.angry", "emotions.sad"] {
        table.answer(question, 5).unwrap();
    }
    let lacking = vec!["emotions.neutral".to_owned()];
    assert_eq!(table.next(), Err(Refusal::Unanswered { questions: lacking.clone() }));
    for value in [0, 6, -1] {
        let question = "emotions.neutral".to_owned();
        assert_eq!(table.answer(&question, value), Err(Refusal::OffScale { question }));
    }
    table.answer("emotions.neutral", 1).unwrap();
    // an answer can be taken back
    let taken_back = Answer {
        page: "practice/1".to_owned(),
        question: lacking[0].clone(),
        value: None,
        text: None,
        first_ms: 0,
        ms: 0,
        key: "back".to_owned(),
    };
    table.send(Event::Answer(taken_back)).unwrap();
    assert!(matches!(table.next(), Err(Refusal::Unanswered { .. })));
    table.answer("emotions.neutral", 3).unwrap();
    table.next().unwrap();
    assert_eq!(table.page().id, "practice/2");
    // no way back: an answer to an earlier trial changes nothing
    let before = table.session.clone();
    let late = Answer {
        page: "practice/1".to_owned(),
        question: "emotions.happy".to_owned(),
        value: Some(1),
        text: None,
        first_ms: 0,
        ms: 0,
        key: "late".to_owned(),
    };
    assert_eq!(table.send(Event::Answer(late)).unwrap(), []);
    assert_eq!(table.session, before);
    let ahead = Event::Next { page: "practice/3".to_owned() };
    assert!(matches!(table.send(ahead), Err(Refusal::WrongPage { .. })));
}

#[test]
fn built_in_questions_and_free_text_may_be_left_out() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("about-you");
    assert!(table.page().content.questions().iter().all(|question| question.optional));
    table.next().unwrap();
    assert_eq!(table.page().id, "how-it-works");
    table.until("comments");
    let long = Answer {
        page: "comments".to_owned(),
        question: "remarks".to_owned(),
        value: None,
        text: Some("x".repeat(2001)),
        first_ms: 0,
        ms: 0,
        key: "long".to_owned(),
    };
    assert!(matches!(table.send(Event::Answer(long.clone())), Err(Refusal::OffScale { .. })));
    table.send(Event::Answer(Answer { text: Some("all well".to_owned()), ..long })).unwrap();
    table.next().unwrap();
    assert_eq!(table.page().id, "debrief");
}
