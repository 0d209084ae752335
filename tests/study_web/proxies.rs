//! The settings of reverse proxies in `docs/studies.md`, read by the proxies themselves where they are installed.

use std::path::Path;
use std::process::Command;

const DOCUMENT: &str = include_str!("../../docs/studies.md");
/// Where the document's certificate lies.
const CERTIFICATES: &str = "/etc/letsencrypt/live/study.example.org";

/// The one block of this language in the document.
fn block(language: &str) -> &'static str {
    let fence = format!("```{language}\n");
    let mut blocks = DOCUMENT.split(&fence).skip(1);
    let block = blocks.next().unwrap_or_else(|| panic!("no block of {language}"));
    assert!(blocks.next().is_none(), "two blocks of {language}");
    block.split("\n```").next().unwrap()
}

/// Whether a program runs; where it does not, a line says so.
fn is_there(program: &str, argument: &str) -> bool {
    let runs = Command::new(program).arg(argument).output().is_ok_and(|ended| ended.status.success());
    if !runs {
        println!("skipped: no {program}");
    }
    runs
}

/// What a program says of a file of settings; whether it accepts them.
fn asked(command: &mut Command, home: &Path) -> (bool, String) {
    let ended =
        command.env("HOME", home).env("XDG_DATA_HOME", home).env("XDG_CONFIG_HOME", home).output().unwrap();
    (ended.status.success(), String::from_utf8_lossy(&ended.stderr).into_owned())
}

#[test]
fn caddy_reads_the_documents_settings() {
    if !is_there("caddy", "version") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Caddyfile");
    let validate = |text: &str| {
        std::fs::write(&path, text).unwrap();
        let mut caddy = Command::new("caddy");
        asked(caddy.args(["validate", "--adapter", "caddyfile", "--config"]).arg(&path), folder.path())
    };
    let (is_valid, said) = validate(block("caddy"));
    assert!(is_valid, "{said}");
    assert!(!validate(&block("caddy").replace("reverse_proxy", "reverse_prox")).0, "anything is valid");
}

#[test]
fn nginx_reads_the_documents_settings() {
    if !is_there("nginx", "-v") || !is_there("openssl", "version") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path().display().to_string();
    let made = Command::new("openssl")
        .args([
            "req",
            "-x509",
            "-newkey",
            "ec",
            "-pkeyopt",
            "ec_paramgen_curve:prime256v1",
            "-nodes",
            "-days",
            "1",
        ])
        .args(["-subj", "/CN=study.example.org", "-keyout"])
        .arg(folder.path().join("privkey.pem"))
        .arg("-out")
        .arg(folder.path().join("fullchain.pem"))
        .output()
        .unwrap();
    assert!(made.status.success(), "{made:?}");
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let path = folder.path().join("nginx.conf");
    let test = |server: &str| {
        // only its root may listen at 443
        let server =
            server.replace(CERTIFICATES, &here).replace("listen 443", &format!("listen 127.0.0.1:{port}"));
        let around = format!("pid {here}/pid;\nevents {{}}\nhttp {{\naccess_log off;\n{server}\n}}\n");
        std::fs::write(&path, around).unwrap();
        let mut nginx = Command::new("nginx");
        asked(nginx.args(["-t", "-e"]).arg(folder.path().join("errors")).arg("-c").arg(&path), folder.path())
    };
    let (is_valid, said) = test(block("nginx"));
    assert!(is_valid, "{said}");
    assert!(!test(&block("nginx").replace("proxy_pass", "proxy_pas")).0, "anything is valid");
}
