//! The study in a frame of another page: of none unless the study file names its origin.

use super::driver::{Browser, Options};
use super::visit::{Hands, Visit, small};
use serde_json::json;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};

/// Serves a page with the study in a frame until the process ends.
fn host(listener: TcpListener, study: &str) {
    let page = format!(
        "<!doctype html><html lang=\"en\"><title>Host</title><iframe title=\"study\" src=\"{study}\" \
         width=\"1000\" height=\"700\"></iframe></html>"
    );
    std::thread::spawn(move || listener.incoming().flatten().for_each(|stream| answer(stream, &page)));
}

fn answer(mut stream: TcpStream, page: &str) {
    let lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
    lines.take_while(|line| !line.is_empty()).for_each(drop);
    let head = "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nCache-Control: no-store\r\nConnection: close";
    // a browser that goes away in between is no failure
    let _ = write!(stream, "{head}\r\nContent-Length: {}\r\n\r\n{page}", page.len());
}

fn listen() -> (TcpListener, u16) {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    (listener, port)
}

/// Whether the frame of a page shows the study; commands go to the page again.
fn shows(browser: &Browser, address: &str) -> bool {
    browser.go(address);
    browser.enter_frame();
    let place = browser.run("return location.protocol", &[]);
    let is_shown = place == json!("http:") && browser.count("main[data-study]") == 1;
    browser.leave_frame();
    let complaints = browser.complaints();
    let is_refused = complaints.iter().any(|one| one.contains("frame-ancestors"));
    assert!(is_shown != is_refused, "{address}: {place}, {complaints:?}");
    is_shown
}

#[test]
fn no_page_may_show_the_study_in_a_frame() {
    let Some(visit) = Visit::new(Options::default(), Hands::Mouse) else { return };
    let (listener, port) = listen();
    host(listener, &visit.lab.address());
    for name in ["localhost", "127.0.0.1"] {
        assert!(!shows(&visit.browser, &format!("http://{name}:{port}/")), "{name} frames the study");
    }
}

#[test]
fn only_the_origin_that_the_study_file_names_may_and_people_take_part_there() {
    let Some(browser) = Browser::open(Options::default()) else { return };
    let ((named, port), (other, another)) = (listen(), listen());
    let origin = format!("http://localhost:{port}");
    let named_in_file = format!("[recruit]\nembed_in = [\"{origin}\"]");
    let lab = small(&[("[recruit]", &named_in_file)]);
    let visit = Visit::of(browser, lab, Hands::Mouse);
    host(named, &visit.lab.address());
    host(other, &visit.lab.address());
    for wrong in [format!("http://127.0.0.1:{port}/"), format!("http://localhost:{another}/")] {
        assert!(!shows(&visit.browser, &wrong), "{wrong} frames the study");
    }
    assert!(shows(&visit.browser, &format!("{origin}/")), "the origin of the file does not");
    visit.browser.enter_frame();
    let given = visit.go_on("");
    assert!(visit.browser.text("main").contains("C1ABCDEF"));
    visit.assert_stored(&given);
    assert_eq!(visit.stored("SELECT count(*) FROM participant WHERE state = 'finished'"), 1);
    visit.assert_quiet();
    // and as a page of its own it is as before
    visit.browser.leave_frame();
    visit.open();
    visit.go_on("about-you");
    assert_eq!(visit.stored("SELECT count(*) FROM participant"), 2);
}
