//! Whose answers an analysis is of: people and simulated participants apart, browser and headset apart unless it is said.

use super::analyse::{answer, people, person};
use gaitway::study::Error;
use gaitway::study::Study;
use gaitway::study::analyse::{analyse_chosen, markdown};
use gaitway::study::file::Front;
use gaitway::study::tables::{Fronts, Role, Tables};
use std::collections::BTreeMap;

/// So many people in a browser, in a headset, and simulated participants.
fn of(web: usize, headset: usize, simulated: usize) -> Tables {
    let mut tables = people(&vec![[1, 2, 3]; web], &["garden"], &["q1"]);
    for (front, letter, count) in [(Front::Headset, "h", headset), (Front::Simulated, "s", simulated)] {
        for number in 0..count {
            let name = format!("{letter}{number}");
            let mut one = answer(&name, "scenes/1", Role::Ordinary, "presence.q1", 5);
            one.front = front;
            tables.participants.push(person(&name, front));
            tables.answers.push(one);
        }
    }
    tables
}

/// Numbers of the participants in a choice by front, and of those left out.
fn chosen(tables: &Tables, wanted: Option<Fronts>) -> [BTreeMap<Front, usize>; 2] {
    let chosen = tables.choose(wanted).unwrap();
    let names: Vec<&str> = chosen.tables.participants.iter().map(|one| one.participant.as_str()).collect();
    assert!(chosen.tables.answers.iter().all(|row| names.contains(&row.participant.as_str())));
    [chosen.tables.fronts(), chosen.left_out]
}

#[test]
fn people_are_chosen_before_simulated_participants_and_never_with_them() {
    use Front::{Headset, Simulated, Web};
    let some = |fronts: &[(Front, usize)]| fronts.iter().copied().collect::<BTreeMap<_, _>>();
    let mixed = of(3, 0, 2);
    assert_eq!(chosen(&mixed, None), [some(&[(Web, 3)]), some(&[(Simulated, 2)])]);
    assert_eq!(chosen(&mixed, Some(Fronts::Web)), [some(&[(Web, 3)]), some(&[(Simulated, 2)])]);
    assert_eq!(chosen(&mixed, Some(Fronts::Simulated)), [some(&[(Simulated, 2)]), some(&[(Web, 3)])]);
    assert_eq!(chosen(&of(0, 0, 2), None), [some(&[(Simulated, 2)]), some(&[])]);
    assert_eq!(chosen(&of(0, 4, 0), None), [some(&[(Headset, 4)]), some(&[])]);
    assert_eq!(chosen(&of(0, 0, 0), None), [some(&[]), some(&[])]);
    // what was seen differs, so the choice is made by a person
    let all = of(3, 4, 2);
    assert!(matches!(all.choose(None), Err(Error::SeveralFronts { web: 3, headset: 4 })));
    assert_eq!(
        chosen(&all, Some(Fronts::Headset)),
        [some(&[(Headset, 4)]), some(&[(Web, 3), (Simulated, 2)])]
    );
    assert_eq!(
        chosen(&all, Some(Fronts::People)),
        [some(&[(Web, 3), (Headset, 4)]), some(&[(Simulated, 2)])]
    );
    let wrong = of(3, 0, 0).choose(Some(Fronts::Headset)).unwrap_err();
    assert!(matches!(&wrong, Error::NoFront { found, .. } if found == &["web"]), "{wrong}");
}

#[test]
fn an_analysis_says_who_is_left_out() {
    let study = Study::builtin("eva-agents").unwrap().file;
    let found = analyse_chosen(&study, &of(3, 0, 2).choose(None).unwrap()).unwrap();
    assert_eq!((found.participants.arrived, found.participants.is_simulated), (3, false));
    assert_eq!(found.participants.left_out, BTreeMap::from([(Front::Simulated, 2)]));
    assert!(markdown(&found).contains("Left out of this analysis: 2 simulated."));
    let found = analyse_chosen(&study, &of(3, 0, 0).choose(None).unwrap()).unwrap();
    assert!(!markdown(&found).contains("Left out of this analysis"));
}
