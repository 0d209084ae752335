//! Scores beside figures and keys that others have published. Each test names where they stand. What could be found:
//!
//! | questionnaire | worked figures of others | key |
//! | --- | --- | --- |
//! | SSQ | 18 totals of a published data set; the published greatest score of each scale | two published scoring keys |
//! | IPQ | none; the lines of the authors' syntax, worked by hand | the authors' syntax, as a published test quotes it |
//! | VRSQ | none | the published list of its items; Kim et al. 2018 for the formula |
//! | CSQ-VR | none | the published sheet: six items of 1 to 7, two a kind |
//! | SUS | none | the published sheet: six items of 1 to 7; Usoh et al. 2000 for the count |

use super::questionnaires::{answers, instrument, scores};

/// Raw sums of nausea, oculomotor and disorientation, and the total, of participants before or after walking in a maze.
///
/// Data set: `Jyotinag/VRWalking_Dataset` on GitHub, `SSQ_scores_NASA_Reaction_Time.csv` of commit 7f559d05, columns `n, o, d, TS`
/// and `n_p, o_p, d_p, TS_p`: 18 of its rows, from small to large sums.
const WALKING: [([i64; 3], f64); 18] = [
    ([4, 9, 5], 67.32),
    ([1, 1, 0], 7.48),
    ([4, 3, 3], 37.4),
    ([0, 1, 0], 3.74),
    ([4, 5, 5], 52.36),
    ([1, 2, 0], 11.22),
    ([6, 14, 6], 97.24),
    ([5, 4, 5], 52.36),
    ([2, 1, 0], 11.22),
    ([2, 5, 3], 37.4),
    ([4, 7, 4], 56.1),
    ([5, 10, 4], 71.06),
    ([2, 3, 2], 26.18),
    ([5, 8, 3], 59.84),
    ([0, 3, 1], 14.96),
    ([4, 9, 8], 78.54),
    ([4, 13, 7], 89.76),
    ([6, 7, 9], 82.28),
];

/// Answers to the SSQ with these sums: symptoms of one scale alone, and where they do not suffice those of two.
fn with_sums([n, o, d]: [i64; 3]) -> Vec<(&'static str, i64)> {
    let mut given = Vec::new();
    let mut fill = |items: &[&'static str], mut sum: i64| {
        for &item in items {
            let value = sum.min(3);
            given.push((item, value));
            sum -= value;
        }
        assert_eq!(sum, 0, "{items:?} hold no more");
    };
    // three symptoms are of the oculomotor scale alone
    let both = (o - 9).max(0);
    fill(&["difficulty-focusing", "blurred-vision"], both);
    fill(&["increased-salivation", "sweating", "stomach-awareness", "burping"], n);
    fill(&["fatigue", "headache", "eyestrain"], o - both);
    fill(&["fullness-of-head", "dizzy-eyes-open", "dizzy-eyes-closed", "vertigo"], d - both);
    given
}

#[test]
fn ssq_totals_are_those_of_a_published_data_set() {
    for (sums, total) in WALKING {
        let found = scores("ssq", &answers("ssq", 0, &with_sums(sums)), &[]);
        // to two decimals, as `scores` gives them
        let round = |value: f64| (value * 100.0).round() / 100.0;
        let [n, o, d] = sums.map(|sum| sum as f64);
        assert_eq!(found, [round(n * 9.54), round(o * 7.58), round(d * 13.92), total], "{sums:?}");
    }
}

/// Numbers of the items, from 1, that a score of the SSQ rises with.
fn numbers(score: usize, variants: &[&str]) -> Vec<usize> {
    let items = instrument("ssq").items;
    let rises = |number: &usize| {
        let one = answers("ssq", 0, &[(items[number - 1].id.as_str(), 1)]);
        scores("ssq", &one, variants)[score] > 0.0
    };
    (1..=items.len()).filter(rises).collect()
}

#[test]
fn ssq_items_count_where_published_keys_say() {
    // colleyRstats (M-Colley/colleyRstats, commit 27244709), tests/testthat/test-questionnaires.R, "SSQ item-to-subscale map"
    assert_eq!(numbers(0, &[]), [1, 6, 7, 8, 9, 15, 16]);
    assert_eq!(numbers(1, &[]), [1, 2, 3, 4, 5, 9, 11]);
    assert_eq!(numbers(2, &[]), [5, 8, 10, 11, 12, 13, 14]);
    // the other habit: scoring instructions of A. Oiknine (ashleyoiknine.wixsite.com), step 1
    assert_eq!(numbers(2, &["d_without_nausea"]), [5, 10, 11, 12, 13, 14]);
    // the same tests of colleyRstats, "SSQ applies the weights": 21 x 9.54, 21 x 7.58, 21 x 13.92, 63 x 3.74; the greatest total is
    // printed as 235.62 by the University of Siena ("Scores calculation", UX in VR), after Johnson 2005
    assert_eq!(scores("ssq", &answers("ssq", 3, &[]), &[]), [200.34, 159.18, 292.32, 235.62]);
}

#[test]
fn ipq_items_are_turned_as_the_authors_syntax_turns_them() {
    // colleyRstats, "IPQ key matches the igroup scoring syntax": `compute sp2u = -1 * sp2 + 6`, likewise inv3 and real1, and no
    // others; one general item, 5 of spatial presence, 4 of involvement, 4 of realism. Worked by hand with it:
    let given = [
        ("g1", 4),
        ("sp1", 5),
        ("sp2", 1), // 5
        ("sp3", 6),
        ("sp4", 3),
        ("sp5", 5),
        ("inv1", 2),
        ("inv2", 4),
        ("inv3", 5), // 1
        ("inv4", 3),
        ("real1", 2), // 4
        ("real2", 3),
        ("real3", 1),
        ("real4", 0),
    ];
    let ids: Vec<String> = instrument("ipq").items.into_iter().map(|item| item.id).collect();
    assert_eq!(ids, given.map(|(id, _)| id), "all items, in the order of the form");
    assert_eq!(scores("ipq", &answers("ipq", 0, &given), &[]), [4.0, 24.0 / 5.0, 10.0 / 4.0, 8.0 / 4.0]);
}

#[test]
fn vrsq_has_the_published_items_and_formula() {
    // No worked example was found. Items: README of Terascale-All-sensing-Research-Studio/vr-queue-waiting-sound-dataset,
    // Cybersickness/, after Kim et al. 2018. Formula: oculomotor sum / 12 x 100, disorientation sum / 15 x 100, and their mean.
    let published = [
        ("general-discomfort", 0),
        ("fatigue", 0),
        ("headache", 1),
        ("eyestrain", 0),
        ("difficulty-focusing", 0),
        ("fullness-of-head", 1),
        ("blurred-vision", 1),
        ("dizzy-eyes-closed", 1),
        ("vertigo", 1),
    ];
    assert_eq!(instrument("vrsq").items.len(), published.len());
    for (item, scale) in published {
        let found = scores("vrsq", &answers("vrsq", 0, &[(item, 3)]), &[]);
        let expected = if scale == 0 { [25.0, 0.0, 12.5] } else { [0.0, 20.0, 10.0] };
        assert_eq!(found, expected, "{item}");
    }
}

#[test]
fn csq_vr_and_sus_have_the_published_form() {
    // No worked example was found for either. CSQ-VR (Kourtesis et al. 2023): nausea, vestibular and oculomotor, two items each of 1
    // (absent) to 7; sums of 2 to 14, and of 6 to 42.
    assert_eq!(scores("csq-vr", &answers("csq-vr", 1, &[]), &[]), [2.0, 2.0, 2.0, 6.0]);
    assert_eq!(scores("csq-vr", &answers("csq-vr", 7, &[]), &[]), [14.0, 14.0, 14.0, 42.0]);
    for (index, kind) in ["nausea", "vestibular", "oculomotor"].into_iter().enumerate() {
        let (a, b) = (format!("{kind}-a"), format!("{kind}-b"));
        let found = scores("csq-vr", &answers("csq-vr", 1, &[(&a, 4), (&b, 6)]), &[]);
        assert_eq!((found[index], found[3]), (10.0, 14.0), "{kind}");
    }
    // SUS (Usoh et al. 2000): six items of 1 to 7 (sheet: A. Oiknine, "Slater-Usoh-Steed Presence"); answers of 6 or 7 are counted
    for (value, count) in [(5, 0.0), (6, 6.0), (7, 6.0)] {
        assert_eq!(scores("sus", &answers("sus", value, &[]), &[]), [count, value as f64]);
    }
}
