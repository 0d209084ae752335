//! Links of recruiting platforms: who comes, and whether it is a preview only.

use super::form::Fields;
use crate::study::file::{Platform, Recruit, credit};
use crate::study::store::PlatformId;

/// Longest id of a platform, bytes.
const LONGEST: usize = 128;
/// What Mechanical Turk sends in place of an assignment while a task is only looked at.
const PREVIEW: &str = "ASSIGNMENT_ID_NOT_AVAILABLE";
/// Where Prolific takes completion codes.
const PROLIFIC: &str = "https://app.prolific.com/submissions/complete?cc=";

/// The names by which a platform gives participant and submission.
fn names(platform: Platform) -> Option<[&'static str; 2]> {
    match platform {
        Platform::Prolific => Some(["PROLIFIC_PID", "SESSION_ID"]),
        Platform::Mturk => Some(["workerId", "assignmentId"]),
        Platform::Sona => Some(["survey_code", "survey_code"]),
        Platform::None | Platform::Links => None,
    }
}

/// The fields of a link that come along to the first form.
pub(super) fn carried(platform: Platform, query: &Fields) -> Vec<(&'static str, &str)> {
    let [participant, submission] = match names(platform) {
        Some(names) => names,
        None => return Vec::new(),
    };
    let mut fields = vec![participant, submission];
    fields.dedup();
    fields.into_iter().filter_map(|name| Some((name, query.get(name)?.as_str()))).collect()
}

/// The ids in a link, if it has usable ones.
pub(super) fn id(platform: Platform, query: &Fields) -> Option<PlatformId> {
    let usable = |name: &str| query.get(name).filter(|id| (1..=LONGEST).contains(&id.len())).cloned();
    let [participant, submission] = names(platform)?;
    Some(PlatformId { participant: usable(participant)?, submission: usable(submission).unwrap_or_default() })
}

/// Whether the platform only shows the study to a person who has not taken it.
pub(super) fn is_preview(platform: Platform, query: &Fields) -> bool {
    platform == Platform::Mturk && query.get("assignmentId").is_some_and(|id| id == PREVIEW)
}

/// The address that takes a participant with a completion code back to the platform.
pub(super) fn way_back(platform: Platform, code: &str) -> Option<String> {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    let is_usable = platform == Platform::Prolific && code.bytes().all(is_plain);
    is_usable.then(|| format!("{PROLIFIC}{code}"))
}

/// Whether a participant who finishes gets credit by an address of their own.
pub(super) const fn grants_credit(recruit: &Recruit) -> bool {
    matches!(recruit.platform, Platform::Sona) && recruit.credit.is_some()
}

/// The address that grants credit to the participant whom the platform knows by an id.
pub(super) fn credit_of(recruit: &Recruit, id: &str) -> Option<String> {
    let address = recruit.credit.as_ref().filter(|_| grants_credit(recruit))?;
    let (before, after) = credit(address).ok()?;
    Some(format!("{before}{}{after}", encoded(id)))
}

/// A text as it stands behind the question mark of an address.
pub(super) fn encoded(text: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
    let one = |byte: u8| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    text.bytes().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn query(pairs: &[(&str, &str)]) -> Fields {
        pairs.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect()
    }

    #[test]
    fn each_platform_has_its_own_names() {
        let prolific = query(&[("PROLIFIC_PID", "p1"), ("SESSION_ID", "s1"), ("STUDY_ID", "x")]);
        let found = id(Platform::Prolific, &prolific).unwrap();
        assert_eq!([found.participant, found.submission], ["p1", "s1"]);
        assert_eq!(carried(Platform::Prolific, &prolific), [("PROLIFIC_PID", "p1"), ("SESSION_ID", "s1")]);
        assert!(id(Platform::Mturk, &prolific).is_none() && id(Platform::None, &prolific).is_none());
        assert!(id(Platform::Prolific, &query(&[("PROLIFIC_PID", &"x".repeat(200))])).is_none());
        let sona = query(&[("survey_code", "77")]);
        assert_eq!(carried(Platform::Sona, &sona).len(), 1);
        assert_eq!(id(Platform::Sona, &sona).unwrap().submission, "77");
        let looks = query(&[("assignmentId", PREVIEW)]);
        assert!(is_preview(Platform::Mturk, &looks) && !is_preview(Platform::Prolific, &looks));
        assert_eq!(way_back(Platform::Prolific, "C1").unwrap(), format!("{PROLIFIC}C1"));
        assert!(way_back(Platform::Mturk, "C1").is_none() && way_back(Platform::Prolific, "a&b").is_none());
    }

    #[test]
    fn credit_is_granted_at_sona_to_the_code_that_the_participant_came_with() {
        let address = "https://school.sona-systems.com/webstudy_credit.aspx?experiment_id=1&credit_token=2&survey_code=XXXX";
        let recruit = |platform| Recruit { platform, credit: Some(address.to_owned()), ..Recruit::default() };
        assert_eq!(
            credit_of(&recruit(Platform::Sona), "7 7&x=1").unwrap(),
            address.replace("XXXX", "7%207%26x%3D1")
        );
        assert!(credit_of(&recruit(Platform::Prolific), "77").is_none());
        assert!(credit_of(&Recruit { platform: Platform::Sona, ..Recruit::default() }, "77").is_none());
    }
}
