//! The operators' pages beside a headset: what its user sees, and orders.

use crate::admin::{mark_of, owner, sign_in_at};
use crate::lab::{Lab, begin};
use gaitway::study::lab::{Lab as Table, Order};
use gaitway::study::serve::{Error, Server};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The operators' pages of a headset, served until it is dropped.
struct Beside {
    console: SocketAddr,
    table: Arc<Table>,
    stop: Arc<AtomicBool>,
    server: Option<std::thread::JoinHandle<()>>,
}

impl Beside {
    fn new(lab: &Lab, code: &str) -> Self {
        let table = Arc::new(Table::new(code));
        let free = SocketAddr::from(([127, 0, 0, 1], 0));
        let server = Server::beside(&lab.store, free, Arc::clone(&table)).unwrap();
        assert_eq!((server.address(), server.entrance(), server.first_link()), (None, "", None));
        let console = server.console_address().unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let server = std::thread::spawn(move || server.run(move || asked.load(Ordering::Relaxed)).unwrap());
        Self { console, table, stop, server: Some(server) }
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.server.take().unwrap().join().unwrap();
    }
}

#[test]
fn an_operator_sees_what_the_user_sees_and_gives_orders() {
    let lab = Lab::plain();
    let mut own = owner(&lab);
    begin(&mut lab.browser());
    let code = || gaitway::study::store::wait(|then| lab.store.people(then)).unwrap().remove(0);
    let beside = Beside::new(&lab, &code().code);
    let (mut operator, page) = sign_in_at(beside.console, "ann");
    assert!(
        page.body.contains("The headset has shown nothing yet.")
            && !page.body.contains("Participants begin at")
    );
    assert_eq!(operator.open("/admin/headset/eye").status, 404);
    beside.table.note("scenes/3: presence.q1 = <4>");
    beside.table.show(b"\x89PNG".to_vec());
    let page = operator.open("/admin/live");
    assert!(page.body.contains("scenes/3: presence.q1 = &lt;4&gt;"), "{}", page.body);
    assert!(page.body.contains(r#"src="/admin/headset/eye?1""#), "{}", page.body);
    let eye = operator.open("/admin/headset/eye?1");
    assert_eq!(
        (eye.status, eye.header("content-type"), eye.header("cache-control")),
        (200, "image/png", "no-store")
    );
    assert!(eye.body.ends_with("PNG"));
    let mark = mark_of(&page);
    for (act, order, state) in [
        ("repeat", Some(Order::Repeat), "arrived"),
        ("skip", Some(Order::Skip), "arrived"),
        ("pause", Some(Order::Look), "paused"),
        ("resume", None, "arrived"),
        ("end", Some(Order::End), "arrived"),
    ] {
        let reply = operator.post("/admin/headset", &[("mark", &mark), ("act", act)]);
        assert_eq!(reply.status, 303, "{act}: {reply:?}");
        assert_eq!((beside.table.next_order(), code().state.name()), (order, state), "{act}");
    }
    let audit = rusqlite::Connection::open(lab.store.folder().join("study.sqlite")).unwrap();
    let noted: Vec<String> = audit
        .prepare("SELECT what FROM audit WHERE operator = 'ann' ORDER BY rowid DESC LIMIT 5")
        .and_then(|mut rows| rows.query_map([], |row| row.get(0))?.collect())
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(noted, ["end the session", "resume", "pause", "skip a trial", "repeat a trial"]);
    // a form of another session, one that is none, and one who only watches
    assert_eq!(operator.post("/admin/headset", &[("mark", "x"), ("act", "end")]).status, 403);
    assert_eq!(operator.post("/admin/headset", &[("mark", &mark), ("act", "dance")]).status, 400);
    assert_eq!(beside.table.next_order(), None);
    // without a headset there is no such page
    assert_eq!(own.open("/admin/headset/eye").status, 404);
    assert!(!own.open("/admin/live").body.contains("In the headset"));
}

#[test]
fn orders_are_for_operators_who_run_and_pages_stay_on_this_machine() {
    let lab = Lab::plain();
    crate::admin::with_role(&lab, "watch");
    let beside = Beside::new(&lab, "K7");
    let (mut bob, page) = crate::admin::sign_in_with(beside.console, "bob", "another password");
    assert!(page.body.contains("In the headset") && !page.body.contains("Repeat trial"));
    assert_eq!(bob.post("/admin/headset", &[("mark", &mark_of(&page)), ("act", "end")]).status, 403);
    assert_eq!(beside.table.next_order(), None);
    let far: SocketAddr = "192.0.2.1:1".parse().unwrap();
    let refused = Server::beside(&lab.store, far, Arc::new(Table::new("K7")));
    assert!(matches!(refused, Err(Error::Console { address }) if address == far));
}
