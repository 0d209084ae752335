//! The operators' page beside a headset.

use super::admin::{PASSWORD, wait_for};
use super::driver::{Browser, Options};
use super::looks::assert_clean;
use fantoccini::key::Key;
use gaitway::study::file::Front;
use gaitway::study::lab::{Lab, Order};
use gaitway::study::serve::Server;
use gaitway::study::store::{Arrival, Opening, Store, wait};
use gaitway::study::{Materials, Study};
use std::collections::BTreeMap;
use std::io::BufReader;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the left eye sees: half of the documents' picture, which the headset's study made.
fn eye() -> Vec<u8> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/pictures/study-panel.png");
    let mut reader =
        png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let (row, half) = (info.line_size, info.line_size / 2);
    let left: Vec<u8> =
        pixels[..info.buffer_size()].chunks(row).flat_map(|row| &row[..half]).copied().collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, info.width / 2, info.height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    encoder.write_header().unwrap().write_image_data(&left).unwrap();
    png
}

/// A participant's store whose operators' pages are served until `is_over` is set.
fn serve(
    folder: &std::path::Path,
    is_over: &Arc<AtomicBool>,
) -> (Arc<Lab>, String, std::thread::JoinHandle<()>) {
    let study = Study::builtin("eva-agents").unwrap();
    let materials = Materials::default().with_text("consent-vr.en.md", "# Consent");
    let opening = Opening { study, materials, libraries: BTreeMap::new(), rows: None };
    let store = Store::open(folder, &opening).unwrap();
    let arrival = Arrival { front: Front::Headset, language: "en".to_owned(), platform: None };
    let code = wait(|then| store.arrive(arrival, then)).unwrap().turn.code;
    let lab = Arc::new(Lab::new(&code));
    let server = Server::beside(&store, SocketAddr::from(([127, 0, 0, 1], 0)), Arc::clone(&lab)).unwrap();
    let link = server.first_link().unwrap().to_owned();
    let is_over = Arc::clone(is_over);
    let served = std::thread::spawn(move || server.run(move || is_over.load(Ordering::Relaxed)).unwrap());
    (lab, link, served)
}

/// `GAITWAY_SHOTS=assets/pictures` makes the documents' picture again.
#[test]
fn an_operator_sees_the_headset_live_and_orders_by_buttons() {
    let Some(mut operator) = Browser::open(Options { size: [960, 800], ..Options::default() }) else {
        return;
    };
    let (folder, is_over) = (tempfile::tempdir().unwrap(), Arc::new(AtomicBool::new(false)));
    let (lab, link, served) = serve(folder.path(), &is_over);
    operator.go(&link);
    operator.click("#name");
    operator.type_text("ann");
    operator.press(Key::Tab);
    operator.type_text(PASSWORD);
    operator.press(Key::Enter);
    operator.wait_for_text("h1", "Live");
    wait_for(&operator, "The headset has shown nothing yet.");
    for line in [
        "scenes/3: presence.q5 = 6",
        "scenes/4: seen for 45.0 s, 90 frames/s, 2 late, longest 22 ms",
        "scenes/4: presence.q1 = 5",
        "scenes/4: presence.q2 = 5",
    ] {
        lab.note(line);
    }
    lab.show(eye());
    // by itself, without a reload, and the picture is drawn
    wait_for(&operator, "scenes/4: presence.q2 = 5");
    let drawn = "const eye = document.querySelector('.headset img'); return !!eye && eye.complete && eye.naturalWidth === 640";
    operator.until("no picture of the eye", |operator| {
        (operator.run(drawn, &[]) == serde_json::json!(true)).then_some(())
    });
    operator.shot("study-headset");
    assert_clean(&mut operator, "headset");
    operator.set_size([320, 568]);
    let wide = "return document.documentElement.scrollWidth <= document.documentElement.clientWidth";
    assert_eq!(operator.run(wide, &[]), serde_json::json!(true));
    for (act, order) in [("repeat", Order::Repeat), ("skip", Order::Skip), ("end", Order::End)] {
        operator.click(&format!("button[value={act}]"));
        operator.until("no order", |_| lab.next_order().map(|given| assert_eq!(given, order)));
        operator.wait_for_text("h1", "Live");
    }
    assert_eq!(operator.complaints(), Vec::<String>::new());
    drop(operator);
    is_over.store(true, Ordering::Relaxed);
    served.join().unwrap();
}
