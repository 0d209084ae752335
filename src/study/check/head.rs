//! The sections beside parts and questions.

use super::notes::Notes;
use crate::study::file::{Codes, CreditFault, Data, Exclude, Front, Platform, Recruit, credit};
use crate::study::instrument;
use crate::study::load::BLANK;
use crate::study::materials::Materials;

/// The longest that anything is kept, days: a century.
const MOST_DAYS: u32 = 36_500;
/// Most people of a scene.
const MOST_AGENTS: u32 = 100_000;

pub(super) fn check(notes: &mut Notes<'_>, materials: &Materials) {
    study(notes);
    consent(notes, materials);
    recruit(notes);
    crowd(notes);
    exclude(notes, &notes.file().exclude);
    data(notes, notes.file().data);
    headset(notes);
    registration(notes);
}

fn study(notes: &mut Notes<'_>) {
    let study = &notes.file().study;
    notes.id("study.id", &study.id);
    if study.id.chars().any(|c| c.is_ascii_uppercase()) {
        notes.error("study.id", format!("{:?}", study.id), "lower-case", "it stands in addresses");
    }
    notes.within("study.version", study.version, [1, 1_000_000], "count changes of the file from 1");
    notes.within("study.seed", study.seed, [0, i64::MAX.unsigned_abs()], "TOML knows no larger integer");
    notes.within("study.minutes", study.minutes, [1, 600], "the welcome page announces it");
    if study.languages.is_empty() {
        notes.error("study.languages", "[]", "one language or more", "try [\"en\"]");
    }
    let is_tag = |tag: &str| {
        (2..=35).contains(&tag.len()) && tag.chars().all(|c| c.is_ascii_alphanumeric() || c == '-')
    };
    for (index, tag) in study.languages.iter().enumerate() {
        let key = format!("study.languages[{index}]");
        if !is_tag(tag) {
            notes.error(&key, format!("{tag:?}"), "a tag of a language (BCP 47)", "try \"en\" or \"pt-BR\"");
        } else if study.languages[..index].contains(tag) {
            notes.error(&key, format!("{tag:?}"), "named once", "remove it");
        }
    }
    notes.words("study.title", &study.title);
    notes.words("study.contact", &study.contact);
    if study.contact.find("", &study.languages).contains(BLANK) {
        let hint = "participants have a right to it; it stands on every page";
        notes.missing("study.contact", "a blank", "the name and address of the lab", hint);
    }
    if study.fronts.is_empty() || study.fronts.contains(&Front::Simulated) {
        let hint = "simulated participants come by `gaitway study simulate`, not by the file";
        notes.error("study.where", format!("{:?}", study.fronts), "some of \"web\" and \"headset\"", hint);
    }
}

fn consent(notes: &mut Notes<'_>, materials: &Materials) {
    let file = notes.file();
    notes.within("consent.minimum_age", file.consent.minimum_age, [0, 120], "most ethics boards ask for 18");
    if file.consent.text.is_empty() {
        let hint = "no text, no participants";
        notes.error("consent.text", "\"\"", "a Markdown file beside the study file", hint);
        return;
    }
    let mut names: Vec<&str> =
        file.study.languages.iter().map(|language| file.consent.text.find(language, &[])).collect();
    names.dedup();
    for name in names {
        let blanks = materials.texts.get(name).map(|text| text.matches(BLANK).count());
        match blanks {
            None => {
                let hint = "put it beside the study file; `gaitway study new` writes a template";
                notes.missing("consent.text", format!("{name:?}"), "a file that is there", hint);
            }
            Some(0) => {}
            Some(count) => {
                let s = if count == 1 { "" } else { "s" };
                let found = format!("{name:?} with {count} blank{s}");
                let hint = format!("replace every {BLANK:?}, and have the ethics board approve the text");
                notes.missing("consent.text", found, "filled in", hint);
            }
        }
    }
}

fn recruit(notes: &mut Notes<'_>) {
    let recruit = &notes.file().recruit;
    notes.within("recruit.most_participants", recruit.most_participants, [1, 1_000_000], "what you can pay");
    notes.within("recruit.lease_minutes", recruit.lease_minutes, [1, 10_080], "30 suits studies of minutes");
    for (index, origin) in recruit.embed_in.iter().enumerate() {
        if !Recruit::is_origin(origin) {
            let hint = "scheme, host and port alone, in lower case; * is no host";
            let key = format!("recruit.embed_in[{index}]");
            notes.error(&key, format!("{origin:?}"), "https:// and a host, without a path", hint);
        }
    }
    let Codes { complete, screened_out, withdrawn } = &recruit.codes;
    let platform = recruit.platform;
    if matches!(platform, Platform::Prolific | Platform::Mturk) && complete.is_none() {
        let hint = "the platform pays by it; copy it from there";
        notes.missing("recruit.codes", "no `complete`", "a code of completion", hint);
    }
    if platform == Platform::Sona && complete.is_none() && recruit.credit.is_none() {
        let hint = "copy the client-side completion URL from the study's page at Sona; its study URL has ?survey_code=%SURVEY_CODE%";
        notes.missing("recruit.credit", "nothing", "the address that grants credit", hint);
    }
    if let Some(address) = &recruit.credit {
        credit_address(notes, platform, address);
    }
    let codes: Vec<&String> = [complete, screened_out, withdrawn].into_iter().flatten().collect();
    if codes.iter().enumerate().any(|(at, code)| codes[..at].contains(code)) {
        let hint = "or else the platform pays all of them alike";
        notes.warn("recruit.codes", "equal codes", "different from one another", hint);
    }
}

/// The address that grants credit.
fn credit_address(notes: &mut Notes<'_>, platform: Platform, address: &str) {
    let key = "recruit.credit";
    if platform != Platform::Sona {
        let hint = "remove it; the other platforms take codes";
        notes.error(key, format!("{address:?}"), "there with platform = \"sona\" alone", hint);
    }
    let allowed = match credit(address) {
        Ok(_) => return,
        Err(CreditFault::NoHttps) => "https:// with a host".to_owned(),
        Err(CreditFault::Characters) => "an address without spaces, quotes and #".to_owned(),
        Err(CreditFault::Field(field)) => format!("an address with {field}= once"),
    };
    let hint = "it looks like https://SCHOOL.sona-systems.com/webstudy_credit.aspx?experiment_id=1&credit_token=2&survey_code=XXXX";
    notes.error(key, format!("{address:?}"), allowed, hint);
}

fn crowd(notes: &mut Notes<'_>) {
    let file = notes.file();
    let is_crowded = |part: &crate::study::file::Part| {
        part.trials().is_some_and(|trials| trials.show.scenes.is_some() || trials.show.agents.is_some())
    };
    match &file.crowd {
        None if file.parts.values().any(is_crowded) => {
            let hint = "add [crowd] with `library = \"rated.glb\"` and `avatars = [\"female\", \"male\"]`";
            notes.error("crowd", "nothing", "there, since scenes or agents are shown", hint);
        }
        Some(crowd) => {
            if crowd.library.trim().is_empty() {
                notes.error("crowd.library", "\"\"", "a library of rated gaits", "study 1 makes one");
            }
            if crowd.avatars.is_empty() {
                notes.error("crowd.avatars", "[]", "one name or more", "try [\"female\", \"male\"]");
            }
            if let Some(agents) = crowd.agents {
                let hint = "without it each scene has its own number of people";
                notes.within("crowd.agents", agents, [1, MOST_AGENTS], hint);
            }
        }
        None => {}
    }
}

fn exclude(notes: &mut Notes<'_>, exclude: &Exclude) {
    if let Some(failed) = exclude.failed_catch {
        notes.within(
            "exclude.failed_catch",
            failed,
            [1, 100],
            "1 excludes after one wrong instructed answer",
        );
    }
    if let Some(median) = exclude.median_ms_below {
        notes.within("exclude.median_ms_below", median, [1, 600_000], "milliseconds for an answer");
    }
    let shares = [
        ("exclude.same_answer_share", exclude.same_answer_share),
        ("exclude.late_frames_share", exclude.late_frames_share),
    ];
    for (key, share) in shares {
        share.into_iter().for_each(|share| notes.within(key, share, [0.0, 1.0], "a share of all"));
    }
    let catches = |part: &crate::study::file::Part| part.trials().is_some_and(|trials| trials.catches > 0);
    if exclude.failed_catch.is_some() && !notes.file().parts.values().any(catches) {
        let hint = "add `catch = 1` to a part with trials, or remove the rule";
        notes.warn("exclude.failed_catch", "set", "set only where some part has instructed trials", hint);
    }
}

fn data(notes: &mut Notes<'_>, data: Data) {
    let Data { keep_links_days, keep_answers_days } = data;
    notes.within("data.keep_links_days", keep_links_days, [0, MOST_DAYS], "30 leaves time to pay");
    notes.within(
        "data.keep_answers_days",
        keep_answers_days,
        [0, MOST_DAYS],
        "many funders ask for ten years",
    );
    if keep_links_days > keep_answers_days {
        let hint = "a platform's id without answers has no use";
        notes.warn("data.keep_links_days", keep_links_days, format!("at most {keep_answers_days}"), hint);
    }
}

fn headset(notes: &mut Notes<'_>) {
    let file = notes.file();
    let wants_one = file.study.fronts.contains(&Front::Headset);
    let Some(headset) = &file.headset else {
        if wants_one {
            let hint = "add [headset] with `answer = [\"laser\", \"stick\", \"gaze\"]`";
            notes.error("headset", "nothing", "there, since study.where has \"headset\"", hint);
        }
        return;
    };
    if headset.answer.is_empty() {
        let hint = "try [\"laser\", \"stick\", \"gaze\"]";
        notes.error("headset.answer", "[]", "one way to answer or more", hint);
    }
    let own = file.questions.keys().map(String::as_str);
    let known: Vec<&str> = own.chain(instrument::names()).collect();
    for name in headset.stop_at.keys() {
        notes.known(&format!("headset.stop_at.{name}"), name, &known, "a question or questionnaire");
    }
}

fn registration(notes: &mut Notes<'_>) {
    let registration = &notes.file().registration;
    if let Some(w) = registration.smallest_w
        && !(w > 0.0 && w < 1.0)
    {
        let hint = "0.1 is a small effect, 0.3 a medium one, 0.5 a large one (Cohen 1988)";
        notes.error("registration.smallest_w", w, "above 0 and below 1", hint);
    }
    let texts = [("authors", &registration.authors), ("hypotheses", &registration.hypotheses)];
    for (key, texts) in texts {
        for (index, _) in texts.iter().enumerate().filter(|(_, text)| text.trim().is_empty()) {
            let key = format!("registration.{key}[{index}]");
            notes.error(&key, "\"\"", "a text", "or leave it out: the page of registration then has a blank");
        }
    }
}
