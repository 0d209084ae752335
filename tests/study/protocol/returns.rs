//! Failures, withdrawals, lapses, pauses, faults: and what no page tells.

use super::{Table, walk_plan};
use gaitway::study::file::Front;
use gaitway::study::plan::{Ending, Role};
use gaitway::study::protocol::{Content, Entry, Event, Exposure, Page, Refusal, State, Verdict, lapse};
use std::collections::BTreeSet;

#[test]
fn too_many_failed_attempts_screen_out_and_one_is_forgiven() {
    let plan = walk_plan();
    let wrong = |table: &mut Table<'_>| {
        table.answer("question-1", 1).unwrap();
        table.answer("question-2", 1).unwrap();
        table.next().unwrap();
    };
    let mut table = Table::new(&plan, 5);
    table.until("check/1");
    wrong(&mut table);
    assert_eq!(table.page().id, "check/2");
    let Content::Check { attempt: 2, attempts: 2, .. } = table.page().content else { panic!() };
    wrong(&mut table);
    assert_eq!(table.ending(), Some(Ending::ScreenedOut));
    assert!(matches!(table.page().content, Content::Ended { code: Some(code), .. } if code == "C2ABCDEF"));
    assert_eq!(table.ledger.places(), 0);
    assert_eq!(table.send(Event::Next { page: "practice/1".to_owned() }), Err(Refusal::Over));
    let mut table = Table::new(&plan, 5);
    table.until("check/1");
    wrong(&mut table);
    table.pass();
    assert_eq!(table.page().id, "practice/1");
}

#[test]
fn withdrawal_is_possible_on_every_page_and_after_the_end_and_frees_the_places() {
    let plan = walk_plan();
    for pages in 0..40 {
        let mut table = Table::new(&plan, 5);
        for _ in 0..pages {
            if table.ending().is_none() {
                table.pass();
            }
        }
        table.send(Event::Withdrawn).unwrap();
        assert_eq!(table.ending(), Some(Ending::Withdrawn));
        assert!(
            matches!(table.page().content, Content::Ended { code: Some(code), .. } if code == "C3ABCDEF")
        );
        assert!(table.ledger.counts()[0].counts.iter().all(|&count| count == 0), "after {pages} pages");
        assert_eq!(table.send(Event::Withdrawn).unwrap(), []);
        assert!(table.send(Event::Next { page: "nowhere".to_owned() }).is_err());
    }
    let mut table = Table::new(&plan, 5);
    table.send(Event::Declined).unwrap();
    assert_eq!(table.ending(), Some(Ending::Declined));
}

#[test]
fn a_lapse_frees_what_is_not_answered_and_the_participant_goes_on_at_the_same_page() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("walks/4");
    let sum = |table: &Table<'_>| table.ledger.counts()[0].counts.iter().sum::<u32>();
    assert_eq!(sum(&table), 10);
    let done =
        table.session.placed().unwrap()[..3].iter().filter(|trial| trial.item.is_some()).count() as u32;
    let until = table.session.lease_until(&plan).unwrap();
    assert_eq!(until, table.now + 30 * 60_000);
    assert!(lapse(&plan, &mut table.ledger, &mut table.session, until).is_none());
    let entry = lapse(&plan, &mut table.ledger, &mut table.session, until + 1).unwrap();
    table.log.push(entry);
    assert_eq!((table.session.state(), sum(&table)), (State::Lapsed, done));
    assert!(lapse(&plan, &mut table.ledger, &mut table.session, until + 2).is_none(), "once");
    table.now = until + 500;
    // the tab was open all the time: what it sends is kept, and the places are taken again
    let before = table.page().id;
    table.send(Event::Sign { page: before.clone(), kind: "focus".to_owned() }).unwrap();
    assert_eq!((table.page().id, sum(&table)), (before, 10));
    assert_eq!(table.session.state(), State::Placed);
    while table.ending().is_none() {
        table.pass();
    }
    assert_eq!(table.ledger.answered("walks").unwrap().iter().sum::<u32>(), 10);
}

#[test]
fn an_answer_that_comes_after_the_lapse_is_kept() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("walks/2");
    if matches!(table.page().content, Content::Show { .. }) {
        table.shown();
    }
    for question in ["emotions.happy", "emotions.angry", "emotions.sad", "emotions.neutral"] {
        table.answer(question, 4).unwrap();
    }
    let until = table.session.lease_until(&plan).unwrap();
    let entry = lapse(&plan, &mut table.ledger, &mut table.session, until + 1).unwrap();
    table.log.push(entry);
    table.now = until + 1;
    table.next().unwrap();
    assert_eq!(table.page().id, "walks/3");
    let answered = table.ledger.answered("walks").unwrap().iter().sum::<u32>();
    let items =
        table.session.placed().unwrap()[..2].iter().filter(|trial| trial.item.is_some()).count() as u32;
    assert_eq!(answered, items);
    let key = ("walks/2".to_owned(), "emotions.sad".to_owned());
    assert_eq!(table.session.answers()[&key].value, Some(4));
}

#[test]
fn a_pause_shows_the_same_page_afterwards_and_takes_no_answers_meanwhile() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("walks/3");
    let before = table.page();
    table.send(Event::Paused).unwrap();
    assert_eq!((table.page().content, table.session.state()), (Content::Paused, State::Paused));
    assert_eq!(table.next(), Err(Refusal::Paused));
    assert_eq!(table.session.lease_until(&plan), None, "a pause is not silence");
    table.send(Event::Resumed).unwrap();
    assert_eq!(table.page(), before);
    table.send(Event::Excluded { reason: "asleep".to_owned() }).unwrap();
    assert_eq!(table.ending(), Some(Ending::Excluded));
    assert!(!table.session.answers().is_empty(), "an exclusion deletes nothing");
}

#[test]
fn a_stimulus_that_cannot_be_shown_is_replaced_by_another_that_lacks_answers() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("walks/1");
    while !matches!(table.page().content, Content::Show { .. }) {
        table.pass();
    }
    let (page, first) = (table.page(), table.session.trial().unwrap().0.clone());
    let entries = table.send(Event::Fault { page: page.id.clone(), reason: "no data".to_owned() }).unwrap();
    assert!(matches!(
        entries[..],
        [Entry { event: Event::Fault { .. }, .. }, Entry { event: Event::Replaced(_), .. }]
    ));
    let second = table.session.trial().unwrap().0.clone();
    assert_eq!(table.page().id, page.id);
    assert_ne!(first.item, second.item);
    assert_ne!(table.page().content, page.content);
    let own = table.session.placed().unwrap();
    assert_eq!(own.iter().filter_map(|trial| trial.item).collect::<BTreeSet<_>>().len(), 10);
    let counts = &table.ledger.counts()[0].counts;
    assert_eq!((counts[first.item.unwrap() as usize], counts.iter().sum::<u32>()), (0, 10));
    // the books name the stimulus that was answered
    table.until("comments");
    let answered = table.ledger.answered("walks").unwrap();
    assert_eq!((answered[first.item.unwrap() as usize], answered[second.item.unwrap() as usize]), (0, 1));
    // scenes belong to a cell of the plan: the trial is left out, with a trace
    let plan = crate::plan("eva-agents", 0);
    let mut table = Table::new(&plan, 5);
    table.until("scenes/2");
    table.send(Event::Fault { page: "scenes/2".to_owned(), reason: "no data".to_owned() }).unwrap();
    assert_eq!(table.page().id, "scenes/3");
    assert!(
        table.log.iter().any(|entry| matches!(&entry.event, Event::Replaced(swap) if swap.item.is_none()))
    );
}

#[test]
fn a_study_without_a_free_place_says_so_and_takes_the_participant_when_there_is_one() {
    let mut plan = walk_plan();
    plan.most_participants = 1;
    let mut table = Table::new(&plan, 5);
    table.ledger.place(&plan, 99).unwrap();
    while table.ending().is_none() {
        table.pass();
    }
    assert_eq!(table.ending(), Some(Ending::Full));
    table.ledger.withdraw(99, plan.on_withdrawal);
    table.send(Event::Sign { page: String::new(), kind: "reload".to_owned() }).unwrap();
    assert_eq!(table.page().id, "walks/1");
}

#[test]
fn no_page_tells_what_a_stimulus_is_or_which_answer_is_right() {
    for name in ["eva-gaits", "eva-agents"] {
        let plan = crate::plan(name, 342);
        let mut table = Table::new(&plan, 11);
        let mut names = BTreeSet::new();
        while table.ending().is_none() {
            let page = table.page();
            let sent = serde_json::to_string(&page).unwrap();
            for word in [
                "walk 1",
                "walk 2",
                "\"right\"",
                "eva-o",
                "eva-g\"",
                "baseline",
                "crossing",
                "seed",
                "emotion\":",
                "repeat\"",
            ] {
                assert!(!sent.contains(word), "{word} in {sent}");
            }
            if let Content::Show { name, .. } = &page.content {
                assert!(!sent.contains("happy") && !sent.contains("angry"), "{sent}");
                assert_eq!(name.len(), 26);
                names.insert((page.id.clone(), name.clone()));
            }
            let stored = serde_json::from_str::<Page>(&sent).unwrap();
            assert_eq!(stored, page);
            table.pass();
        }
        assert!(names.len() >= 14, "{names:?}");
    }
    let (a, mut b) = (walk_plan(), walk_plan());
    b.secret = 1;
    let stimulus = &a.trials_of("walks").unwrap().stimuli[0];
    assert_ne!(a.name(stimulus, 0), b.name(stimulus, 0));
}

#[test]
fn the_repeated_walk_is_one_that_was_seen_and_the_instruction_can_be_followed() {
    let plan = walk_plan();
    for person in 0..50 {
        let mut table = Table::new(&plan, person);
        table.until("walks/1");
        let trials = table.session.placed().unwrap().to_vec();
        for trial in &trials {
            match trial.role {
                Role::Repeat { of } => {
                    assert!(of < trial.position && trials[of as usize - 1].role == Role::Ordinary);
                    assert!(trial.position - of > 3, "others lie between");
                    let seen = table.session.stimulus(&plan, &trials[of as usize - 1]);
                    assert_eq!(table.session.stimulus(&plan, trial), seen);
                }
                Role::Catch { answer } => {
                    assert!([1, 2, 4, 5].contains(&answer));
                    assert!(trial.position > 1 && table.session.stimulus(&plan, trial).is_none());
                }
                Role::Ordinary => {}
            }
        }
        let at = trials.iter().find(|trial| matches!(trial.role, Role::Catch { .. })).unwrap();
        table.until(&format!("walks/{}", at.position));
        let Content::Ask { instruction: Some(text), replay: None, .. } = table.page().content else {
            panic!()
        };
        assert!(text.contains("agree”") || text.contains("disagree”"), "{text}");
    }
}

#[test]
fn the_order_of_statements_is_a_participants_own_and_the_same_on_every_page() {
    let plan = walk_plan();
    let mut orders = BTreeSet::new();
    for person in 0..60 {
        let mut table = Table::new(&plan, person);
        table.until("practice/1");
        table.shown();
        let order = |page: Page| page.content.questions().iter().map(|q| q.id.clone()).collect::<Vec<_>>();
        let first = order(table.page());
        table.until("practice/2");
        table.shown();
        assert_eq!(order(table.page()), first);
        orders.insert(first);
    }
    assert!(orders.len() > 15, "{} of 24 orders", orders.len());
}

#[test]
fn an_event_out_of_place_changes_nothing() {
    let plan = walk_plan();
    let mut table = Table::new(&plan, 5);
    table.until("practice/1");
    let session = table.session.clone();
    let events = [
        Event::Placed { place: 0, trials: Vec::new() },
        Event::Full,
        Event::Returned { swaps: Vec::new() },
        Event::Resumed,
        Event::Consented { text: String::new() },
        Event::Declined,
        Event::Arrived { person: 9, front: Front::Web, language: "de".to_owned() },
        Event::Shown { page: "walks/1".to_owned(), exposure: Exposure::default() },
    ];
    for event in events {
        assert_ne!(session.judge(&plan, &event), Verdict::Take, "{event:?}");
        let mut other = session.clone();
        other.take(&plan, &Entry { at: 5, event });
        assert_eq!(other, session);
    }
}

#[test]
fn a_participant_who_lapses_after_the_last_trial_still_counts() {
    let mut plan = walk_plan();
    plan.most_participants = 1;
    let mut table = Table::new(&plan, 5);
    table.until("walks/2");
    let mut other = (table.ledger.clone(), table.session.clone());
    lapse(&plan, &mut other.0, &mut other.1, i64::MAX).unwrap();
    assert!(other.0.participants() == 0 && other.0.is_open(&plan));
    table.until("comments");
    lapse(&plan, &mut table.ledger, &mut table.session, i64::MAX).unwrap();
    assert!(table.ledger.participants() == 1 && !table.ledger.is_open(&plan));
}

#[test]
fn a_walk_has_one_name_for_all_participants() {
    let plan = crate::plan("eva-gaits", 10);
    let names = |person| {
        let mut table = Table::new(&plan, person);
        let mut names = BTreeSet::new();
        table.until("walks/1");
        while table.page().part == "walks" {
            if let Content::Show { name, .. } = table.page().content {
                names.insert(name);
            }
            table.pass();
        }
        names
    };
    assert_eq!(names(1).len(), 10);
    assert_eq!(names(1), names(2));
}

#[test]
fn a_walk_that_was_seen_is_kept_after_a_lapse_and_one_that_was_not_goes_where_answers_lack() {
    let plan = walk_plan();
    for is_seen in [true, false] {
        let mut table = Table::new(&plan, 5);
        table.until("walks/3");
        while !matches!(table.page().content, Content::Show { .. }) {
            table.pass();
        }
        if is_seen {
            table.shown();
        }
        let item = table.session.trial().unwrap().0.item.unwrap() as usize;
        let until = table.session.lease_until(&plan).unwrap();
        table.log.push(lapse(&plan, &mut table.ledger, &mut table.session, until + 1).unwrap());
        table.now = until + 1;
        // others come until this walk lacks nothing, and another one does
        let mut person = 100;
        loop {
            let counts = table.ledger.counts()[0].counts.clone();
            let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
            if counts[item] == *most && least < most {
                break;
            }
            table.ledger.place(&plan, person).unwrap();
            person += 1;
        }
        table.send(Event::Sign { page: String::new(), kind: "back".to_owned() }).unwrap();
        let now = table.session.trial().unwrap().0.item.unwrap() as usize;
        assert_eq!(now == item, is_seen);
        assert_eq!(matches!(table.page().content, Content::Ask { .. }), is_seen);
    }
}
