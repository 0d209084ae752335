//! The way back to Sona, which grants credit when its page opens.

use super::driver::Options;
use super::visit::{Hands, Visit};

/// Where nothing answers, and nothing has to.
const SONA: &str = "https://127.0.0.1:9/credit?experiment_id=1&credit_token=2&survey_code=";

#[test]
fn a_participant_who_finishes_is_taken_to_sona_once_and_may_come_back() {
    let sona = format!("platform = \"sona\"\ncredit = \"{SONA}XXXX\"");
    let changes = [("platform = \"prolific\"", sona.as_str())];
    let Some(visit) = Visit::to(Options::default(), Hands::Mouse, &changes) else { return };
    visit.browser.go(&format!("{}?survey_code=4711", visit.lab.address()));
    visit.go_on("debrief");
    visit.press("button.next");
    let at_sona = |browser: &super::driver::Browser| {
        Some(browser.address()).filter(|address| address.starts_with("https:"))
    };
    assert_eq!(visit.browser.until("never at Sona", at_sona), format!("{SONA}4711"));
    // back on the last page, which sends no participant away again
    visit.browser.back();
    visit.browser.until("no last page", |_| visit.is_over().then_some(()));
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(visit.is_over() && visit.browser.text("main").contains("Back to Sona"));
}
