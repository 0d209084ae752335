//! Chromium without a screen, and its driver: started, set up, closed, killed.

use fantoccini::error::CmdError;
use fantoccini::wd::WebDriverCompatibleCommand;
use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use tokio::runtime::{Builder, Runtime};

/// Longest wait for anything: only a guard against hanging, on machines with other work to do.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// Of every session. No flag opens a connection: whatever a page loads, it loads from the address that a test gave.
const FLAGS: [&str; 10] = [
    "--headless",
    "--no-sandbox", // Chromium refuses to start as root with one
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--force-color-profile=srgb",
    "--font-render-hinting=none",
];

/// The folder that `scripts/setup --browser` filled. Where there is none, a line says so.
pub(crate) fn folder() -> Option<PathBuf> {
    let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = || {
        let home = || variable("HOME").unwrap_or_default().join(".cache");
        variable("XDG_CACHE_HOME").unwrap_or_else(home).join("gaitway/browser")
    };
    let folder = variable("GAITWAY_BROWSER_ROOT").unwrap_or_else(cache);
    if folder.join(".complete").exists() {
        return Some(folder);
    }
    let is_demanded = crate::common::gpu::is_demanded("GAITWAY_REQUIRE_BROWSER");
    assert!(!is_demanded, "there is no browser in {}: run scripts/setup --browser", folder.display());
    println!("skipped: no browser in {} (scripts/setup --browser)", folder.display());
    None
}

/// What a browser remembers when it is closed: cookies, local storage. Removed with this.
#[derive(Debug)]
pub(crate) struct Profile(TempDir);

impl Profile {
    pub(crate) fn new() -> Self {
        Self(tempfile::Builder::new().prefix("gaitway-browser-").tempdir().unwrap())
    }
}

/// How the browser reaches the server.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Network {
    Full,
    Offline,
    /// Mbit/s, both ways.
    Slow(f64),
}

/// How a participant comes.
#[derive(Debug)]
pub(crate) struct Options {
    /// Width and height of the page (pixels).
    pub(crate) size: [u32; 2],
    pub(crate) dark: bool,
    /// Whether pages may run scripts.
    pub(crate) scripts: bool,
    pub(crate) network: Network,
    /// Of an earlier visit; none: empty.
    pub(crate) profile: Option<Profile>,
    /// Whether `network_events` has something to tell.
    pub(crate) listens: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size: [1024, 768],
            dark: false,
            scripts: true,
            network: Network::Full,
            profile: None,
            listens: false,
        }
    }
}

/// The program `chromedriver`; it ends with this, and Chromium with it.
struct Driver {
    process: Child,
    port: u16,
    /// Held: a closed pipe would end the driver.
    says: BufReader<ChildStdout>,
}

/// How often a driver may start. It wants one port for IPv4 and IPv6, takes a free one of the first, and ends
/// where another program has that port of the second.
const STARTS: usize = 5;

impl Driver {
    fn start(folder: &Path, home: &Path) -> Self {
        let mut said = String::new();
        (0..STARTS)
            .find_map(|_| Self::try_start(folder, home, &mut said))
            .unwrap_or_else(|| panic!("chromedriver ended {STARTS} times without naming its port:\n{said}"))
    }

    /// A driver that names its port; none if it ends before. What it says comes to `said`.
    fn try_start(folder: &Path, home: &Path, said: &mut String) -> Option<Self> {
        let mut command = Command::new(folder.join("chromedriver"));
        // Chromium puts certificates and crash reports into the home folder.
        command.arg("--port=0").env("HOME", home).env_remove("XDG_CONFIG_HOME").env_remove("XDG_CACHE_HOME");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut process = command.spawn().unwrap();
        let says = BufReader::new(process.stdout.take().unwrap());
        // it ends with this wherever this function does
        let mut driver = Self { process, port: 0, says };
        loop {
            let start = said.len();
            if driver.says.read_line(said).unwrap() == 0 {
                return None;
            }
            if let Some((_, port)) = said[start..].split_once("successfully on port ") {
                driver.port = port.trim().trim_end_matches('.').parse().unwrap();
                return Some(driver);
            }
        }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A command of chromedriver's own, beside the standard ones.
#[derive(Debug)]
struct Extra {
    path: &'static str,
    body: Value,
}

impl WebDriverCompatibleCommand for Extra {
    fn endpoint(&self, base: &url::Url, session: Option<&str>) -> Result<url::Url, url::ParseError> {
        base.join(&format!("session/{}/{}", session.unwrap_or_default(), self.path))
    }

    fn method_and_body(&self, _: &url::Url) -> (axum::http::Method, Option<String>) {
        (axum::http::Method::POST, Some(self.body.to_string()))
    }
}

/// A browser with its own profile. What to do on a page is in `page.rs`.
pub(crate) struct Browser {
    runtime: Runtime,
    client: Client,
    is_open: bool,
    /// How its tabs are now.
    pub(super) options: Options,
    /// The folder of axe-core.
    pub(super) folder: PathBuf,
    _driver: Driver,
    profile: Option<Profile>,
}

impl Browser {
    /// A browser with one empty tab; none where there is no browser on this machine, and a line says so.
    pub(crate) fn open(mut options: Options) -> Option<Self> {
        let folder = folder()?;
        let profile = options.profile.take().unwrap_or_else(Profile::new);
        let driver = Driver::start(&folder, profile.0.path());
        let runtime = Builder::new_current_thread().enable_all().build().unwrap();
        let mut arguments: Vec<String> = FLAGS.iter().map(|&flag| flag.to_owned()).collect();
        arguments.push(format!("--window-size={},{}", options.size[0], options.size[1]));
        arguments.push(format!("--user-data-dir={}", profile.0.path().join("profile").display()));
        let capabilities = json!({
            "browserName": "chrome-headless-shell",
            "goog:chromeOptions": { "binary": folder.join("chromium"), "args": arguments },
            "goog:loggingPrefs": { "browser": "ALL", "performance": if options.listens { "ALL" } else { "OFF" } },
            "timeouts": { "script": PATIENCE.as_millis(), "pageLoad": PATIENCE.as_millis() },
        });
        let mut builder = ClientBuilder::new(HttpConnector::new());
        builder.capabilities(capabilities.as_object().unwrap().clone());
        let address = format!("http://127.0.0.1:{}", driver.port);
        let client = runtime.block_on(builder.connect(&address)).unwrap();
        let browser =
            Self { runtime, client, is_open: true, options, folder, _driver: driver, profile: Some(profile) };
        browser.set_up_tab();
        Some(browser)
    }

    /// Waits for what the driver is asked.
    pub(super) fn wait<T, F: Future<Output = T>>(&self, asked: impl FnOnce(Client) -> F) -> T {
        self.runtime.block_on(asked(self.client.clone()))
    }

    /// A command of Chromium's own protocol (`Domain.command`) to the tab of now, and its answer.
    pub(crate) fn devtools(&self, command: &str, parameters: &Value) -> Value {
        self.extra("goog/cdp/execute", json!({ "cmd": command, "params": parameters }))
    }

    /// The same; none where Chromium refuses.
    pub(crate) fn try_devtools(&self, command: &str, parameters: &Value) -> Option<Value> {
        self.try_extra("goog/cdp/execute", json!({ "cmd": command, "params": parameters })).ok()
    }

    fn try_extra(&self, path: &'static str, body: Value) -> Result<Value, CmdError> {
        self.wait(|client| async move { client.issue_cmd(Extra { path, body }).await })
    }

    fn extra(&self, path: &'static str, body: Value) -> Value {
        self.try_extra(path, body).unwrap_or_else(|error| panic!("{path}: {error}"))
    }

    /// What the browser has complained of since the last call: exceptions of scripts, what the policy of contents forbids,
    /// what could not be loaded.
    pub(crate) fn complaints(&self) -> Vec<String> {
        let entries = self.extra("se/log", json!({ "type": "browser" }));
        let severe = entries.as_array().unwrap().iter().filter(|entry| entry["level"] == "SEVERE");
        severe.map(|entry| entry["message"].as_str().unwrap().to_owned()).collect()
    }

    /// What the network brought since the last call, as events of Chromium's own protocol: `method` and `params`.
    pub(crate) fn network_events(&self) -> Vec<Value> {
        assert!(self.options.listens, "a browser that does not listen");
        let entries = self.extra("se/log", json!({ "type": "performance" }));
        let event =
            |entry: &Value| -> Value { serde_json::from_str(entry["message"].as_str().unwrap()).unwrap() };
        entries.as_array().unwrap().iter().map(|entry| event(entry)["message"].take()).collect()
    }

    /// What is set belongs to one tab, so each new one gets all of it.
    pub(super) fn set_up_tab(&self) {
        self.apply_dark();
        self.let_scripts_run(self.options.scripts);
        self.apply_network();
        self.apply_size();
    }

    pub(crate) fn set_dark(&mut self, dark: bool) {
        self.options.dark = dark;
        self.apply_dark();
    }

    /// Counts from the next page on.
    pub(crate) fn set_scripts(&mut self, scripts: bool) {
        self.options.scripts = scripts;
        self.let_scripts_run(self.options.scripts);
    }

    /// Of the tab of now, and of those that are opened later; the others keep theirs.
    pub(crate) fn set_network(&mut self, network: Network) {
        self.options.network = network;
        self.apply_network();
    }

    /// Width and height of the page (pixels).
    pub(crate) fn set_size(&mut self, size: [u32; 2]) {
        self.options.size = size;
        self.apply_size();
    }

    fn apply_dark(&self) {
        let scheme = if self.options.dark { "dark" } else { "light" };
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.devtools("Emulation.setEmulatedMedia", &json!({ "features": [feature] }));
    }

    pub(super) fn let_scripts_run(&self, run: bool) {
        self.devtools("Emulation.setScriptExecutionDisabled", &json!({ "value": !run }));
    }

    fn apply_network(&self) {
        let bytes = match self.options.network {
            Network::Slow(rate) => rate * 1e6 / 8.0,
            Network::Full | Network::Offline => -1.0,
        };
        self.devtools("Network.enable", &json!({}));
        let conditions = json!({
            "offline": self.options.network == Network::Offline,
            "latency": 0,
            "downloadThroughput": bytes,
            "uploadThroughput": bytes,
        });
        self.devtools("Network.emulateNetworkConditions", &conditions);
    }

    fn apply_size(&self) {
        let [width, height] = self.options.size;
        self.wait(|client| async move { client.set_window_size(width, height).await }).unwrap();
    }

    /// Minimizes the window: the page is hidden, and gets no frames. Another tab in front does not hide it here, as Chromium
    /// without a screen has no front.
    pub(crate) fn hide(&self) {
        self.wait(|client| async move { client.minimize_window().await }).unwrap();
    }

    /// Shows the window again.
    pub(crate) fn show(&self) {
        self.apply_size();
    }

    /// Closes the browser as a participant does, and gives back what it remembers.
    pub(crate) fn close(mut self) -> Profile {
        self.end();
        self.profile.take().unwrap()
    }

    /// Kills the browser at once, as a crash does, and gives back what is on disk. Chromium writes local storage up to five
    /// seconds later: what a page stored just before is lost.
    pub(crate) fn kill(mut self) -> Profile {
        let process = self.client.capabilities().unwrap()["goog:processID"].as_u64().unwrap();
        let killed = Command::new("kill").args(["-KILL", &process.to_string()]).status().unwrap();
        assert!(killed.success());
        self.is_open = false;
        self.profile.take().unwrap()
    }

    fn end(&mut self) {
        if std::mem::take(&mut self.is_open) {
            let _ = self.wait(Client::close);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if self.is_open && std::thread::panicking() {
            self.keep_last_sight();
        }
        self.end();
    }
}
