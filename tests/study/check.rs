//! Study files: what is read, what is refused, and what is said about it.

use gaitway::study::check::{Note, Report, Severity};
use gaitway::study::{BUILTIN, Error, Materials, Study, check};

fn text(name: &str) -> &'static str {
    BUILTIN.iter().find(|study| study.name == name).unwrap().toml
}

/// All that the built-in studies need beside their file.
fn materials() -> Materials {
    let with_walks = Materials::default().with_gaits("library.glb", super::walks(342));
    BUILTIN.iter().fold(with_walks, |all, study| all.with_text(study.consent_name, study.consent))
}

/// What is said about a built-in study in whose text `old` stands once and becomes `new`.
fn changed(name: &str, old: &str, new: &str) -> Report {
    assert_eq!(text(name).matches(old).count(), 1, "{old:?}");
    check(&Study::parse(&text(name).replace(old, new), "study.toml").unwrap(), &materials())
}

fn syntax(name: &str, old: &str, new: &str) -> String {
    assert_eq!(text(name).matches(old).count(), 1, "{old:?}");
    let error = Study::parse(&text(name).replace(old, new), "study.toml").unwrap_err();
    assert!(matches!(error, Error::Syntax { .. }), "{error}");
    error.to_string()
}

fn of(report: &Report, severity: Severity) -> Vec<String> {
    report.notes.iter().filter(|note| note.severity == severity).map(Note::to_string).collect()
}

/// The line of the text that begins so, from 1.
fn line(name: &str, start: &str) -> usize {
    1 + text(name).lines().position(|line| line.starts_with(start)).unwrap()
}

#[test]
fn the_built_in_studies_are_valid_and_say_what_the_lab_must_fill_in() {
    for (name, blanks) in [("eva-gaits", "consent.en.md"), ("eva-agents", "consent-vr.en.md")] {
        let report = check(&Study::builtin(name).unwrap(), &materials());
        assert_eq!(of(&report, Severity::Error), Vec::<String>::new());
        assert_eq!(of(&report, Severity::Warning), Vec::<String>::new());
        let missing = of(&report, Severity::Missing);
        assert_eq!(missing.len(), 2, "{missing:?}");
        assert!(missing[0].contains("study.contact") && missing[1].contains(blanks), "{missing:?}");
        assert!(report.is_valid() && !report.is_ready());
    }
}

#[test]
fn a_filled_in_study_is_ready() {
    let filled = text("eva-gaits").replace("TO FILL IN: name and address of the lab", "Lab, Street 1, Town");
    let consent = BUILTIN[0].consent.replace("TO FILL IN", "filled in");
    let report = check(
        &Study::parse(&filled, "study.toml").unwrap(),
        &materials().with_text("consent.en.md", &consent),
    );
    assert!(report.is_ready(), "{report}");
}

#[test]
fn the_summary_counts_trials_minutes_and_participants() {
    let summary = |name| check(&Study::builtin(name).unwrap(), &materials()).summary.unwrap();
    let walks = summary("eva-gaits");
    assert_eq!((walks.trials, walks.least, walks.multiple, walks.with_drop_outs), (12, 342, 1, 403));
    assert!((6.0..9.0).contains(&walks.minutes), "{}", walks.minutes);
    let agents = summary("eva-agents");
    assert_eq!((agents.trials, agents.least, agents.multiple), (20, 24, 24));
    assert!((15.0..25.0).contains(&agents.minutes), "{}", agents.minutes);
    assert!(
        agents
            .to_string()
            .contains("scenes: 12 trials of 12 stimuli; 24 participants or more, in multiples of 24")
    );
}

#[test]
fn thirty_participants_cannot_be_balanced_over_blocks() {
    let report = changed("eva-agents", "most_participants = 48 ", "most_participants = 30 ");
    let warnings = of(&report, Severity::Warning);
    assert_eq!(warnings.len(), 1);
    let at = line("eva-agents", "most_participants");
    let wanted =
        format!("study.toml:{at}: recruit.most_participants = 30: should be 24 or 48; 30 participants");
    assert!(warnings[0].contains(&wanted), "{warnings:?}");
    let report = changed("eva-gaits", "most_participants = 500", "most_participants = 341");
    assert!(of(&report, Severity::Error)[0].contains("= 341: must be 342 or more"));
    let report = changed("eva-gaits", "most_participants = 500", "most_participants = 342");
    assert!(of(&report, Severity::Warning)[0].contains("about 403 if 3 in 10 leave"));
}

#[test]
fn misspelt_keys_are_named_with_line_and_the_nearest_one() {
    let cases = [
        ("minutes = 8", "minuets = 8", "study.minuets: unknown field `minuets`", "did you mean `minutes`?"),
        (
            "attempts = 2",
            "atempts = 2",
            "part.check.atempts: unknown field `atempts`",
            "did you mean `attempts`?",
        ),
        (
            "kind = \"comprehension\"",
            "kind = \"comprehention\"",
            "part.check.kind",
            "did you mean `comprehension`?",
        ),
        (
            "kind = \"fill\", each = 10",
            "kind = \"fill\", eech = 10",
            "part.walks.design.eech",
            "did you mean `each`?",
        ),
        ("plays = 1,", "playes = 1,", "part.walks.show.playes", "did you mean `plays`?"),
        (
            "on_withdrawal = \"delete\"",
            "on_withdrawal = \"delet\"",
            "consent.on_withdrawal",
            "did you mean `delete`?",
        ),
        ("seed = 20190919", "seed = -1", "study.seed", ""),
        ("title = \"How do", "title = 7 #", "study.title", "a text, or a table of texts by language"),
        ("order = \"per-participant\"", "order = \"per-person\"", "questions.emotions.order", ""),
    ];
    for (old, new, key, hint) in cases {
        let message = syntax("eva-gaits", old, new);
        let at = 1 + text("eva-gaits").lines().position(|line| line.contains(old)).unwrap();
        assert!(message.starts_with(&format!("study.toml:{at}: {key}")), "{message}");
        assert!(message.contains(hint), "{message}");
    }
}

#[test]
fn wrong_values_are_named_with_line_key_value_range_and_way_out() {
    let cases = [
        (
            "eva-gaits",
            "seconds = 4.0, plays",
            "seconds = 0.1, plays",
            "part.walks.show.seconds = 0.1: must be 0.5 to 600;",
        ),
        ("eva-gaits", "each = 10, at", "each = 343, at", "part.walks.design.each = 343: must be 1 to 342;"),
        (
            "eva-gaits",
            "lease_minutes = 30",
            "lease_minutes = 0",
            "recruit.lease_minutes = 0: must be 1 to 10080;",
        ),
        ("eva-gaits", "\"check\", \"practice\"", "\"chekc\", \"practice\"", "did you mean \"check\"?"),
        (
            "eva-gaits",
            "flow = [\"consent\", ",
            "flow = [",
            "study.flow = \"about-you\" first: must be \"consent\" first;",
        ),
        (
            "eva-gaits",
            "\"check\", \"practice\", \"walks\"",
            "\"practice\", \"walks\", \"check\"",
            "must be before all counted trials;",
        ),
        (
            "eva-gaits",
            "gaits = \"library.glb\"",
            "gaits = \"libary.glb\"",
            "part.walks.show.gaits = \"libary.glb\"",
        ),
        ("eva-gaits", "right = 1", "right = 2", "part.check.questions[1].right = 2: must be 0 to 1;"),
        ("eva-gaits", "repeat = 1 ", "repeat = 6 ", "part.walks.repeat = 6: must be 0 to 5;"),
        (
            "eva-gaits",
            "{ id = \"angry\"",
            "{ id = \"happy\"",
            "questions.emotions.items[1].id = \"happy\": must be another id",
        ),
        (
            "eva-gaits",
            "same_answer_share = 0.95",
            "same_answer_share = 95",
            "exclude.same_answer_share = 95: must be 0 to 1;",
        ),
        ("eva-gaits", "part = \"walks\"", "part = \"practice\"", "analysis.ratings.part = \"practice\""),
        ("eva-gaits", "“{answer}”", "it", "part.walks.instruction = no {answer}"),
        ("eva-gaits", "ask = \"remarks\"", "ask = \"remark\"", "did you mean \"remarks\"?"),
        (
            "eva-gaits",
            "ask = [\"gender\", \"age\"]",
            "ask = [\"gender\", \"agee\"]",
            "part.about-you.ask[1] = \"agee\"",
        ),
        (
            "eva-agents",
            "\"eva-o\", \"eva-g\"], seconds",
            "\"eva-0\", \"eva-g\"], seconds",
            "part.scenes.show.conditions[1] = \"eva-0\": must be a condition;",
        ),
        ("eva-agents", "after_block = [\"fms\"]", "after_block = [\"fmss\"]", "did you mean \"fms\"?"),
        ("eva-agents", "stop_at = { fms", "stop_at = { fmz", "headset.stop_at.fmz"),
        (
            "eva-agents",
            "\"sad\", \"neutral\"], bodies",
            "\"sat\", \"neutral\"], bodies",
            "did you mean \"sad\"?",
        ),
        ("eva-agents", "of = \"identify.which\"", "of = \"identify.witch\"", "did you mean \"which\"?"),
        ("eva-agents", "of = \"scenes.presence.*\"", "of = \"scenes.presence.q6\"", "analysis.test[0].of"),
        ("eva-agents", "within = \"scene\"", "within = \"condition\"", "analysis.test[0].within"),
        ("eva-agents", "design = { kind = \"square\" }", "repeat = 1", "part.identify = repeat or catch"),
        (
            "eva-agents",
            "scenes = [\"garden\"], seconds = 20, condition = \"baseline\"",
            "seconds = 20",
            "part.practice.show = 0 of them",
        ),
        ("eva-agents", "[crowd]\nlibrary = \"rated.glb\"", "[crowd]\nlibrary = \" \"", "crowd.library"),
    ];
    for (name, old, new, wanted) in cases {
        let report = changed(name, old, new);
        let errors = of(&report, Severity::Error);
        assert!(errors.iter().any(|error| error.contains(wanted)), "{new}: {errors:?}");
        assert!(errors.iter().all(|error| error.starts_with("error: study.toml:")), "{errors:?}");
        assert!(report.summary.is_none());
    }
}

#[test]
fn every_error_is_on_the_line_of_its_key() {
    let report = changed("eva-gaits", "lease_minutes = 30", "lease_minutes = 0");
    let at = line("eva-gaits", "lease_minutes");
    assert_eq!(
        report.notes.iter().find(|note| note.key == "recruit.lease_minutes").unwrap().place,
        format!("study.toml:{at}")
    );
}

#[test]
fn wording_without_a_licence_has_to_be_written_in() {
    let asks = |wording: &str| {
        let text = text("eva-agents").replace(
            "[part.comments]\nkind = \"form\"\nask = \"remarks\"",
            "[part.comments]\nkind = \"form\"\nask = [\"remarks\", \"sus\"]",
        );
        check(&Study::parse(&format!("{text}\n{wording}"), "study.toml").unwrap(), &materials())
    };
    let missing = of(&asks(""), Severity::Missing);
    assert!(
        missing.iter().any(|note| note.contains("wording.sus = 6 of 6 items without wording")),
        "{missing:?}"
    );
    let all: String = (1..=6).map(|item| format!("{item} = \"a text\"\n")).collect();
    let missing = of(&asks(&format!("[wording.sus]\n{all}")), Severity::Missing);
    assert!(!missing.iter().any(|note| note.contains("sus")), "{missing:?}");
    let errors = of(&asks("[wording.sus]\n7 = \"a text\"\n"), Severity::Error);
    assert!(errors[0].contains("wording.sus.7"), "{errors:?}");
    let errors = of(&asks("[wording.ipx]\n"), Severity::Error);
    assert!(errors[0].contains("did you mean \"ipq\"?"), "{errors:?}");
}

#[test]
fn texts_that_lack_a_language_are_warned_of() {
    let report = changed("eva-gaits", "languages = [\"en\"]", "languages = [\"en\", \"de\"]");
    assert_eq!(of(&report, Severity::Warning), Vec::<String>::new(), "texts for all languages lack none");
    let text = text("eva-gaits")
        .replace("languages = [\"en\"]", "languages = [\"en\", \"de\"]")
        .replace("title = \"How do these people feel?\"", "title = { en = \"How do these people feel?\" }");
    let warnings = of(&check(&Study::parse(&text, "study.toml").unwrap(), &materials()), Severity::Warning);
    assert!(
        warnings[0].contains("study.title") && warnings[0].contains("participants of de"),
        "{warnings:?}"
    );
}

#[test]
fn studies_are_loaded_from_folders_and_unknown_ones_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("study.toml"), text("eva-gaits")).unwrap();
    let study = Study::load(folder.path()).unwrap();
    assert_eq!(study.file, Study::builtin("eva-gaits").unwrap().file);
    assert_eq!(study.folder.as_deref(), Some(folder.path()));
    assert!(matches!(Study::load(&folder.path().join("none.toml")), Err(Error::Read { .. })));
    let error = Study::builtin("eva-gait").unwrap_err();
    assert!(error.to_string().contains("did you mean \"eva-gaits\"?"), "{error}");
}

#[test]
fn a_study_survives_being_written_and_read_again() {
    for study in BUILTIN {
        let file = Study::builtin(study.name).unwrap().file;
        let written = toml::to_string(&file).unwrap();
        assert_eq!(Study::parse(&written, "written").unwrap().file, file);
    }
}

/// Numbers of a generator that is the same on every machine.
fn draws(mut state: u64) -> impl FnMut(usize) -> usize {
    move |end| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % end.max(1)
    }
}

/// Reads, checks, plans and gives places to a file in which pieces are changed at random; what it is must never be a panic.
fn torn(from: u64, count: u64) -> (usize, usize) {
    let pieces = [
        "-1",
        "0",
        "9223372036854775807",
        "\"\"",
        "[]",
        "{}",
        "1e400",
        "nan",
        "true",
        "\"walks\"",
        "[\"a\"]",
        "4",
        "=",
    ];
    let (mut read, mut valid) = (0, 0);
    for seed in from..from + count {
        let mut below = draws(seed);
        let mut words: Vec<String> = Vec::new();
        for line in text(BUILTIN[below(2)].name).lines() {
            words.extend(line.split_inclusive(' ').map(str::to_owned));
            words.push("\n".to_owned());
        }
        for _ in 0..1 + below(3) {
            let (at, other) = (below(words.len()), below(words.len()));
            match below(4) {
                0 => words[at] = format!("{} ", pieces[below(pieces.len())]),
                1 => words.swap(at, other),
                2 => drop(words.remove(at)),
                _ => words.insert(at, words[other].clone()),
            }
        }
        let Ok(study) = Study::parse(&words.concat(), "torn") else { continue };
        read += 1;
        let report = check(&study, &materials());
        let _ = report.to_string();
        if report.is_valid() {
            valid += 1;
            let plan = gaitway::study::plan::Plan::of(&study.file, &materials()).unwrap();
            let mut ledger = gaitway::study::plan::Ledger::new(&plan);
            (0..3).for_each(|person| drop(ledger.place(&plan, person)));
            gaitway::study::protocol::page(&plan, &[]);
        }
    }
    (read, valid)
}

#[test]
fn torn_files_are_refused_and_never_a_panic() {
    let (read, valid) = torn(0, 1500);
    assert!(read > 200 && valid > 50, "{read} read, {valid} valid");
}

#[test]
#[ignore = "long: a hundred thousand torn files"]
fn a_hundred_thousand_torn_files_are_refused_and_never_a_panic() {
    println!("{:?}", torn(1_000_000, 100_000));
}

#[test]
fn only_origins_may_show_the_study_in_a_frame() {
    let with = |list: &str| {
        changed("eva-gaits", "lease_minutes = 30", &format!("embed_in = {list}\nlease_minutes = 30"))
    };
    let right = with("[\"https://survey.example.org\", \"https://a.org:8443\", \"http://localhost:8000\"]");
    assert_eq!(of(&right, Severity::Error), Vec::<String>::new());
    for wrong in [
        "https://survey.example.org/page",
        "http://survey.example.org",
        "*",
        "https://*.example.org",
        "'self'",
    ] {
        let errors = of(&with(&format!("[\"https://a.org\", \"{wrong}\"]")), Severity::Error);
        assert!(errors.len() == 1 && errors[0].contains("recruit.embed_in[1]"), "{wrong}: {errors:?}");
    }
}

#[test]
fn ratings_that_no_analysis_takes_are_an_error_before_the_first_participant() {
    let report = changed("eva-gaits", "id = \"neutral\"", "id = \"calm\"");
    let errors = of(&report, Severity::Error);
    assert!(errors.len() == 1 && errors[0].contains("analysis.ratings.part"), "{errors:?}");
    assert!(errors[0].contains("four items is missing"), "{errors:?}");
}

#[test]
fn an_address_of_credit_is_sonas_and_names_the_participant() {
    let address = "https://school.sona-systems.com/webstudy_credit.aspx?experiment_id=1&credit_token=2&survey_code=XXXX";
    let codes = "codes = { complete = \"C1ABCDEF\", screened-out = \"C2ABCDEF\", withdrawn = \"C3ABCDEF\" }";
    let with = |platform: &str, credit: &str| {
        let file =
            text("eva-gaits").replace("platform = \"prolific\"", &format!("platform = \"{platform}\""));
        let credit = if credit.is_empty() { String::new() } else { format!("credit = \"{credit}\"") };
        check(&Study::parse(&file.replace(codes, &credit), "study.toml").unwrap(), &materials())
    };
    assert_eq!(of(&with("sona", address), Severity::Error), Vec::<String>::new());
    let missing =
        |report: &Report| of(report, Severity::Missing).iter().any(|note| note.contains("recruit.credit"));
    assert!(missing(&with("sona", "")) && !missing(&with("sona", address)));
    for (credit, allowed) in [
        (address.replace("https", "http"), "must be https:// with a host"),
        (address.replace("survey_code", "code"), "must be an address with survey_code= once"),
        (address.replace("XXXX", "X X"), "must be an address without spaces, quotes and #"),
    ] {
        let errors = of(&with("sona", &credit), Severity::Error);
        assert!(errors.len() == 1 && errors[0].contains(allowed), "{errors:?}");
    }
    let errors = of(&with("prolific", address), Severity::Error);
    assert!(errors[0].contains("platform = \"sona\" alone"), "{errors:?}");
}
