//! What an analysis says of questionnaires, ratings and answers, and the report with figures.

use super::analyse::{answer, identify, people, person};
use gaitway::emotion::Emotion;
use gaitway::perception::ratings as rule;
use gaitway::study::Study;
use gaitway::study::analyse::{Analysis, Questionnaire, analyse, html, kept, markdown, rating_sheet, scores};
use gaitway::study::file::{Front, Scoring};
use gaitway::study::plan::Ending;
use gaitway::study::protocol::State;
use gaitway::study::simulate::{Habits, Minds, RatingModel, Setup, run};
use gaitway::study::tables::{Role, Tables};

const SSQ: [&str; 16] = [
    "general-discomfort",
    "fatigue",
    "headache",
    "eyestrain",
    "difficulty-focusing",
    "increased-salivation",
    "sweating",
    "nausea",
    "difficulty-concentrating",
    "fullness-of-head",
    "blurred-vision",
    "dizzy-eyes-open",
    "dizzy-eyes-closed",
    "vertigo",
    "stomach-awareness",
    "burping",
];

/// Fills in the SSQ: every symptom alike.
fn ssq(tables: &mut Tables, name: &str, part: &str, value: i64) {
    for item in SSQ {
        let mut one = answer(name, &format!("{part}/1"), Role::Ordinary, &format!("ssq.{item}"), value);
        (one.page, one.trial) = (part.to_owned(), None);
        tables.answers.push(one);
    }
}

fn near(found: f64, known: f64) {
    assert!((found - known).abs() < 1e-9 * known.abs().max(1.0), "{found} is not {known}");
}

fn questionnaire<'a>(analysis: &'a Analysis, id: &str) -> &'a Questionnaire {
    analysis.questionnaires.kept.iter().find(|one| one.questionnaire == id).unwrap()
}

/// A study of gaits with 40 walks and simulated raters, a part of them careless.
fn rated(careless: f64) -> (Study, Tables) {
    let plan = super::plan("eva-gaits", 40);
    let minds = Minds { ratings: RatingModel::drawn(&super::walks(40), 5), ..Minds::default() };
    let habits = Habits { careless, ..Habits::default() };
    let (_, found) = run(&plan, &minds, Setup { participants: 200, at_once: 20, habits, seed: 3 }).unwrap();
    (Study::builtin("eva-gaits").unwrap(), Tables::simulated(&found))
}

#[test]
fn questionnaires_are_scored_by_page_and_compared_before_and_after() {
    let mut study = Study::builtin("eva-agents").unwrap().file;
    let mut tables = Tables::default();
    // seven people: from 0 to 1, and one from 1 to 3; an eighth leaves one symptom out
    for number in 0..8 {
        let name = format!("p{number}");
        tables.participants.push(person(&name, Front::Headset));
        ssq(&mut tables, &name, "sickness-before", i64::from(number == 6));
        ssq(&mut tables, &name, "sickness-after", if number == 6 { 3 } else { 1 });
        for (block, sickness) in [(1, 2), (2, 4), (10, 9)] {
            let page = format!("scenes/after/{block}");
            let mut one = answer(&name, "scenes/1", Role::Ordinary, "fms.sickness", sickness);
            (one.page, one.trial) = (page, None);
            tables.answers.push(one);
        }
    }
    tables.answers.iter_mut().for_each(|one| one.front = Front::Headset);
    let last = tables.answers.iter().rposition(|one| one.question == "ssq.burping").unwrap();
    tables.answers.remove(last);
    let analysis = analyse(&study, &tables).unwrap();
    let ssq = questionnaire(&analysis, "ssq");
    assert_eq!(
        ssq.pages.iter().map(|page| &*page.part).collect::<Vec<_>>(),
        ["sickness-before", "sickness-after"]
    );
    assert_eq!((ssq.pages[0].people, ssq.pages[1].people, ssq.pages[1].incomplete), (8, 7, 1));
    let total = &ssq.pages[1].scores[3];
    assert_eq!(total.score, "total");
    // 21 symptoms counted, times 3.74; six people with 1, one with 3
    let values = total.values.unwrap();
    near(values.mean, 21.0 * 3.74 * 9.0 / 7.0);
    near(values.quartiles[1], 78.54);
    near(values.greatest, 235.62);
    // all symptoms alike: they go together perfectly
    near(ssq.pages[1].scores[0].alpha.unwrap().alpha, 1.0);
    let changes = &ssq.changes;
    assert_eq!(changes.len(), 4);
    let test = changes[3].test.as_ref().unwrap();
    assert_eq!(
        (changes[3].people, &*changes[3].before, &*changes[3].after),
        (7, "sickness-before", "sickness-after")
    );
    near(test.difference.mean, 78.54 * 8.0 / 7.0);
    // seven differences of one sign: p = 2 / 2^7, times four by Holm
    near(test.wilcoxon.p, 2.0 / 128.0);
    near(test.p_holm, 4.0 * 2.0 / 128.0);
    near(test.shift.estimate, 78.54);
    // FMS after each block, in the order of the blocks
    let pages: Vec<(&str, f64)> = questionnaire(&analysis, "fms")
        .pages
        .iter()
        .map(|page| (&*page.page, page.scores[0].values.unwrap().mean))
        .collect();
    assert_eq!(pages, [("scenes/after/1", 2.0), ("scenes/after/2", 4.0), ("scenes/after/10", 9.0)]);
    assert!(questionnaire(&analysis, "fms").changes.is_empty());
    let rows = scores(&study, &tables).unwrap();
    assert_eq!(rows.len(), (8 + 7) * 4 + 8 * 3);
    let page = markdown(&analysis);
    assert!(page.contains("| total | sickness-before to sickness-after | 7 | 89.76 |"), "{page}");
    // the other way of scoring leaves nausea out of D
    let variants = vec!["d_without_nausea".to_owned()];
    study.analysis.scoring.insert("ssq".to_owned(), Scoring { variants });
    let other = analyse(&study, &tables).unwrap();
    near(questionnaire(&other, "ssq").pages[0].scores[2].values.unwrap().mean, 6.0 * 13.92 / 8.0);
}

#[test]
fn ratings_have_the_labels_of_gait_ratings_and_say_how_far_they_hold() {
    let (study, tables) = rated(0.3);
    let analysis = analyse(&study.file, &tables).unwrap();
    assert!(analysis.exclusions.excluded.len() > 3);
    let sides = analysis.ratings.as_ref().unwrap();
    let sheet = rating_sheet(&study.file, &tables).unwrap().unwrap();
    let options = rule::Options::default();
    let responses = rule::parse(&sheet, "", &options).unwrap().responses;
    let known = rule::analyse(&responses, 3.5);
    let found = sides.kept.analysis.as_ref().unwrap();
    assert_eq!((&found.videos, found.responses), (&known.videos, known.responses));
    // the excluded are in the other table alone
    let with = sides.everyone.as_ref().unwrap().analysis.as_ref().unwrap();
    assert!(with.responses > found.responses && found.agreement[0].icc_single > with.agreement[0].icc_single);
    let excluded = &analysis.exclusions.excluded[0].participant;
    assert!(!sheet.lines().any(|line| line.starts_with(&format!("{excluded},"))));
    assert!(kept(&study.file, &tables).answers.iter().all(|row| row.participant != *excluded));
    let repeats = sides.kept.repeats.as_ref().unwrap();
    assert!(repeats[0].pairs > 20 && repeats[0].kappa.unwrap().kappa > 0.5, "{repeats:?}");
    assert!(sides.kept.complete.is_none());
    let stability = sides.kept.stability.as_ref().unwrap();
    assert_eq!((stability.draws, stability.gaits.len()), (2000, 40));
    assert!(stability.mean > 0.8 && stability.mean < 1.0, "{}", stability.mean);
    // labels with a great margin hold better than those with a small one
    let mean = |is_clear: bool| {
        let own = found
            .videos
            .iter()
            .filter(|video| video.label.is_some_and(|label| (video.margin(label) > 1.5) == is_clear));
        let shares: Vec<f64> = own.map(|video| stability.gaits[&video.name]).collect();
        shares.iter().sum::<f64>() / shares.len() as f64
    };
    assert!(mean(true) > mean(false), "{} {}", mean(true), mean(false));
    // the item counts are those of the answers
    let happy = analysis.answers.iter().find(|item| item.item == "emotions.happy").unwrap();
    assert_eq!((happy.least, happy.greatest, happy.groups.len()), (1, 5, 1));
    let counts = &happy.groups[0].counts;
    assert_eq!(counts.iter().sum::<usize>(), found.responses);
    let of_five = responses.iter().filter(|one| one.scores[Emotion::Happy.index()] == 5).count();
    assert_eq!(counts[4], of_five);
}

#[test]
fn raters_that_rate_every_gait_have_all_six_intraclass_correlations() {
    let study = Study::builtin("eva-gaits").unwrap();
    let mut tables = Tables::default();
    for (rater, shift) in [0, 1, 0].into_iter().enumerate() {
        let name = format!("r{rater}");
        tables.participants.push(person(&name, Front::Web));
        for gait in 0..4_i64 {
            for (item, value) in
                [("happy", 1 + gait), ("angry", 1 + (gait + shift) % 4), ("sad", 2), ("neutral", 3)]
            {
                let page = format!("walks/{}", gait + 1);
                let mut one = answer(&name, &page, Role::Ordinary, &format!("emotions.{item}"), value);
                one.shown.gait = Some(format!("g{gait}"));
                tables.answers.push(one);
            }
        }
    }
    let analysis = analyse(&study.file, &tables).unwrap();
    let complete = analysis.ratings.as_ref().unwrap().kept.complete.as_ref().unwrap();
    near(complete[0].as_ref().unwrap().agreement.single, 1.0);
    assert!(complete[1].as_ref().unwrap().agreement.single < 0.9 && complete[2].is_none());
    assert!(markdown(&analysis).contains("| ICC(2,1) | ICC(2,k) | Cronbach's alpha |"));
}

#[test]
fn answers_of_conditions_have_means_with_intervals_over_people() {
    let rows: Vec<[i64; 3]> = (0..12).map(|number| [1 + number % 3, 4, 5 + number % 3]).collect();
    let analysis =
        analyse(&Study::builtin("eva-agents").unwrap().file, &people(&rows, &["garden", "scifi"], &["q1"]))
            .unwrap();
    let item = analysis.answers.iter().find(|item| item.item == "presence.q1").unwrap();
    assert_eq!(item.groups.len(), 12);
    let of = |scene: &str, condition: &str| {
        let is_it = |group: &&gaitway::study::analyse::Group| {
            group.scene.as_deref() == Some(scene) && group.condition.as_deref() == Some(condition)
        };
        item.groups.iter().find(is_it).unwrap()
    };
    let low = of("garden", "baseline");
    assert_eq!((low.people, &low.counts[..]), (12, &[4, 4, 4, 0, 0, 0, 0][..]));
    near(low.mean.unwrap(), 2.0);
    let [a, b] = low.interval.unwrap();
    assert!(a > 1.4 && a < 2.0 && b > 2.0 && b < 2.6, "{a} {b}");
    assert_eq!(of("scifi", "eva-o").interval, Some([4.0, 4.0]));
    assert!(of("crossing", "eva-g").mean.is_none());
}

/// Tags of a page that are opened and not closed, or closed and not opened.
fn unbalanced(html: &str) -> Vec<String> {
    let void = ["meta", "rect", "line", "circle", "!doctype", "path"];
    let mut open: Vec<String> = Vec::new();
    let mut wrong = Vec::new();
    for tag in html.split('<').skip(1) {
        let inside = tag.split('>').next().unwrap();
        let name = inside.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap().to_owned();
        if void.contains(&name.as_str()) {
            continue;
        }
        if inside.starts_with('/') {
            if open.pop().as_ref() != Some(&name) {
                wrong.push(name);
            }
        } else {
            open.push(name);
        }
    }
    wrong.extend(open);
    wrong
}

#[test]
fn the_report_is_one_file_with_figures_that_asks_nothing_of_the_network() {
    let (study, tables) = rated(0.1);
    let walks = analyse(&study.file, &tables).unwrap();
    let rows: Vec<[i64; 3]> = (0..12).map(|number| [1 + number % 3, 4, 5 + number % 3]).collect();
    let mut tables = people(&rows, &["garden", "crossing"], &["q1", "q2"]);
    identify(&mut tables, [[5, 1, 0, 2], [1, 4, 1, 2], [0, 0, 8, 0], [1, 0, 1, 6]]);
    tables.participants[3].state = State::Lapsed;
    tables.participants[4].state = State::Ended(Ending::Excluded);
    let mut file = Study::builtin("eva-agents").unwrap().file;
    file.study.title = "<b>& 'walking' | \"among\" people</b> `x`".into();
    let agents = analyse(&file, &tables).unwrap();
    for (page, figures) in [(html(&[&walks]), 5), (html(&[&agents]), 6), (html(&[&walks, &agents]), 11)] {
        assert_eq!(unbalanced(&page), Vec::<String>::new());
        for part in ["<script", "http://", "https://", "@import", "url(", "<img", "<link", " src="] {
            let allowed = page.replace("http://www.w3.org/2000/svg", "");
            assert!(!allowed.contains(part), "{part}");
        }
        assert_eq!(page.matches("<figure>").count(), figures, "{page}");
        assert_eq!(page.matches("<figcaption>").count(), figures);
        assert_eq!(page.matches("role=\"img\">\n<title>").count(), figures, "screen readers read each title");
        assert_eq!(page.matches("<h1 ").count() + page.matches("<h1>").count(), 1);
        assert!(page.starts_with("<!doctype html>\n<html lang=\"en\">"));
        for part in ["prefers-color-scheme:dark", "@media print", "name=\"viewport\"", "<th scope=\"col\""] {
            assert!(page.contains(part), "{part}");
        }
        // every link of the contents leads to a heading
        for link in page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
            assert!(page.contains(&format!(" id=\"{link}\"")), "{link}");
        }
        let is_legible = |text: &str| !text.contains("NaN") && !text.contains("inf");
        assert!(
            page.split("<figure>").skip(1).map(|rest| rest.split("</svg>").next().unwrap()).all(is_legible)
        );
    }
    let page = html(&[&agents]);
    assert!(
        page.contains("<title>&lt;b&gt;&amp; 'walking' | &quot;among&quot; people&lt;/b&gt; `x`</title>"),
        "{}",
        &page[..900]
    );
    assert!(page.contains(">less 1 lapsed, 1 excluded<"), "{page}");
}

#[test]
fn the_papers_studies_stand_beside_the_papers_tables() {
    let rows: Vec<[i64; 3]> = (0..12).map(|number| [1 + number % 3, 4, 5 + number % 3]).collect();
    let mut tables = people(&rows, &["garden", "crossing"], &["q1", "q2"]);
    identify(&mut tables, [[5, 1, 0, 2], [1, 4, 1, 2], [0, 0, 8, 0], [1, 0, 1, 6]]);
    let mut file = Study::builtin("eva-agents").unwrap().file;
    let page = markdown(&analyse(&file, &tables).unwrap());
    for line in [
        "| presence.q1 | garden | eva-o | 12 | 12 | 4.00 | 4.00 to 4.00 |",
        "| presence.q1 | garden | eva-o | 12 | 12 | 4.00 | 4.00 to 4.00 |",
        // 12 people, all in one order: Q = 24; the paper has 4.67 and p 0.10 there
        "| q1 | Garden | 24.00 | 4.67 | < 0.001 | 0.10 | no |",
        "| q1 | Crossing | 24.00 | 9.75 | < 0.001 | 0.01 | yes |",
        "3 of 4 tests lie on the same side of .05 as the paper's.",
        "| q1 | Crossing | baseline and eva-o | < 0.001 | 0.018 |",
        "| q1 | Garden | baseline and eva-o | < 0.001 | - |",
        "| happy | 62.5 / 60.4 | 12.5 / 4.2 | 0.0 / 4.2 | 25.0 / 31.2 |",
        "Right: 23 of 32 (71.9 %), in the paper 136 of 192 (70.8 %).",
    ] {
        assert!(page.lines().any(|found| found == line), "{line}\n{page}");
    }
    file.study.id = "another".to_owned();
    assert!(!markdown(&analyse(&file, &tables).unwrap()).contains("paper"));
}
