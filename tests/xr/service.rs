//! A Monado service without a display, one per test, and its scripted head.

use serde_json::Value;
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Longest wait for anything: only a guard against hanging, on machines with other work to do.
pub(super) const PATIENCE: Duration = Duration::from_secs(240);

/// Waits for something: looks until it is there. `look` says what is missing still.
pub(super) fn until<T>(mut look: impl FnMut() -> Result<T, String>) -> T {
    let begin = Instant::now();
    loop {
        match look() {
            Ok(found) => return found,
            Err(missing) => assert!(begin.elapsed() < PATIENCE, "after {PATIENCE:?}: {missing}"),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The script that runs programs on the unpacked drivers and runtime.
pub(super) const GPU_ENV: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/gpu-env");

/// Whether the runtime is there; a machine that must have it fails without.
pub(super) fn is_there() -> bool {
    if std::env::var_os("GAITWAY_DRIVER").is_some_and(|driver| driver != "lavapipe") {
        println!("skipped: Monado's service runs on lavapipe alone");
        return false;
    }
    let root = std::env::var_os("GAITWAY_VULKAN_ROOT").map_or_else(
        || PathBuf::from(std::env::var_os("HOME").unwrap_or_default()).join(".cache/gaitway/vulkan-trixie"),
        PathBuf::from,
    );
    if root.join("xr/.complete").exists() {
        return true;
    }
    assert!(
        !crate::common::gpu::is_demanded("GAITWAY_REQUIRE_XR"),
        "there is no Monado in {}: run scripts/setup --xr",
        root.display()
    );
    println!("skipped: no Monado in {} (scripts/setup --xr)", root.display());
    false
}

/// A running service.
pub(super) struct Service {
    child: Child,
    /// Its sockets and its log; short, since a socket's path has 108 bytes at most.
    pub(super) folder: PathBuf,
    port: u16,
    environment: Vec<(&'static str, String)>,
}

/// A port that nothing listens on, and that no other service of this process was given.
fn free_port() -> u16 {
    static GIVEN: Mutex<BTreeSet<u16>> = Mutex::new(BTreeSet::new());
    loop {
        let port = TcpListener::bind(("127.0.0.1", 0)).unwrap().local_addr().unwrap().port();
        if GIVEN.lock().unwrap().insert(port) {
            return port;
        }
    }
}

impl Service {
    /// Starts a service with a folder and a port of its own, so that tests run side by side.
    pub(super) fn start(name: &str) -> Self {
        Self::start_with(name, &[])
    }

    /// The same with Monado's own compositor, in a window on this display.
    pub(super) fn start_on(name: &str, display: &str) -> Self {
        let window = [
            ("XRT_COMPOSITOR_NULL", "0"),
            ("XRT_COMPOSITOR_FORCE_XCB", "1"),
            ("DISPLAY", display),
            ("XRT_COMPOSITOR_DEFAULT_FRAMERATE", "30"),
            ("XRT_COMPOSITOR_SCALE_PERCENTAGE", "50"),
        ];
        Self::start_with(name, &window)
    }

    /// The same with variables of its own.
    pub(super) fn start_with(name: &str, environment: &[(&'static str, &str)]) -> Self {
        let folder = std::env::temp_dir().join(format!("gaitway-xr-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("monado")).unwrap();
        let port = free_port();
        let config =
            format!(r#"{{"active":"remote","remote":{{"version":0,"port":{port},"view_count":2}}}}"#);
        std::fs::write(folder.join("monado/config_v0.json"), config).unwrap();
        let environment: Vec<_> =
            environment.iter().map(|(name, value)| (*name, (*value).to_owned())).collect();
        let child = spawn(&folder, &environment);
        let service = Self { child, folder, port, environment };
        service.wait_until_started();
        service
    }

    /// A program of ours that talks to this service.
    pub(super) fn gaitway(&self, arguments: &[&str]) -> Command {
        // pictures go into the folder that the scene stands in
        let mut command = self.program(env!("CARGO_BIN_EXE_gaitway"), &["--force"]);
        command.args(arguments);
        command
    }

    /// Any program, on the drivers, that talks to this service.
    pub(super) fn program(&self, path: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(GPU_ENV);
        command.arg(path).args(arguments);
        command.env("XDG_RUNTIME_DIR", &self.folder).env("XDG_CONFIG_HOME", &self.folder);
        command.env("GAITWAY_VALIDATION", "sync").env("OXR_NO_PRINTING", "1").stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Kills it, as a crash would.
    pub(super) fn kill(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Starts it again in the same folder.
    pub(super) fn restart(&mut self) {
        self.kill();
        let _ = std::fs::remove_file(self.folder.join("service.log"));
        self.child = spawn(&self.folder, &self.environment);
        self.wait_until_started();
    }

    /// A program whose OpenXR calls go through the layer that plants a fault.
    pub(super) fn faulty(&self, fault: &str, arguments: &[&str]) -> Command {
        let mut command = self.gaitway(arguments);
        command.env("XR_API_LAYER_PATH", layer()).env("XR_ENABLE_API_LAYERS", "XR_APILAYER_gaitway_faults");
        command.env("GAITWAY_FAULT", fault);
        command
    }

    /// Lets it hang, or go on.
    pub(super) fn signal(&self, name: &str) {
        signal(&self.child, name);
    }

    /// Its head.
    pub(super) fn head(&self) -> Head {
        Head::connect(self.port)
    }

    // A trial connection would count as a client, so the log it is.
    fn wait_until_started(&self) {
        let log = self.folder.join("service.log");
        until(|| {
            let said = std::fs::read_to_string(&log).unwrap_or_default();
            if said.contains("service has started") {
                Ok(())
            } else {
                Err(format!("the service did not start: {said}"))
            }
        });
    }
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").arg(format!("-{name}")).arg(child.id().to_string()).status();
    assert!(status.unwrap().success());
}

/// The folder of the layer that plants faults, compiled on first use.
fn layer() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder =
            PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("xr-layer-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let library = folder.join("libgaitway_faults.so");
        // `nodelete`: the loader unloads layers with each instance, and the count of calls with them
        let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let built = Command::new(rustc)
            .args(["--edition", "2024", "--crate-type", "cdylib", "--crate-name", "gaitway_faults", "-o"])
            .arg(&library)
            .args(["-C", "link-arg=-Wl,-z,nodelete"])
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/xr/layer.rs"))
            .status();
        assert!(built.unwrap().success(), "the layer does not compile");
        let manifest = serde_json::json!({
            "file_format_version": "1.0.0",
            "api_layer": {
                "name": "XR_APILAYER_gaitway_faults",
                "library_path": library,
                "api_version": "1.0",
                "implementation_version": "1",
                "description": "plants faults"
            }
        });
        std::fs::write(folder.join("faults.json"), manifest.to_string()).unwrap();
        folder
    })
}

/// A program that is being listened to.
pub(super) struct Live {
    child: Child,
    notes: Receiver<String>,
    heard: Vec<String>,
}

impl Live {
    pub(super) fn start(mut command: Command) -> Self {
        let mut child = command.spawn().unwrap();
        let (tell, notes) = mpsc::channel();
        let said = BufReader::new(child.stderr.take().unwrap());
        std::thread::spawn(move || said.lines().map_while(Result::ok).try_for_each(|line| tell.send(line)));
        Self { child, notes, heard: Vec::new() }
    }

    /// Waits until it says something; the time that took.
    pub(super) fn hear(&mut self, words: &str) -> Duration {
        let begin = Instant::now();
        self.hear_line(words);
        begin.elapsed()
    }

    /// Types a line.
    pub(super) fn type_line(&mut self, line: &str) {
        writeln!(self.child.stdin.as_mut().unwrap(), "{line}").unwrap();
    }

    /// Waits until it says something; the line.
    pub(super) fn hear_line(&mut self, words: &str) -> String {
        let begin = Instant::now();
        loop {
            match self.notes.recv_timeout(PATIENCE.saturating_sub(begin.elapsed())) {
                Ok(line) => {
                    self.heard.push(line.clone());
                    if line.contains(words) {
                        return line;
                    }
                }
                Err(_) => {
                    let _ = self.child.kill();
                    panic!("no {words:?} within {PATIENCE:?}; heard: {:#?}", self.heard);
                }
            }
        }
    }

    /// Waits until it has said something so many times from now on; what it says before is kept as heard.
    pub(super) fn hear_anew(&mut self, words: &str, times: u32) {
        self.heard.extend(self.notes.try_iter());
        for _ in 0..times {
            self.hear_line(words);
        }
    }

    /// Memory in use, MiB.
    pub(super) fn memory(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        line.split_whitespace().next().unwrap().parse::<f64>().unwrap() / 1024.0
    }

    /// Kills it, as a crash would.
    pub(super) fn kill(mut self) {
        // the script that starts it has become the program itself
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Ends it as Ctrl-C would: the JSON object of a run that must end well, and what it noted on the way.
    pub(super) fn end(self) -> (Value, Vec<String>) {
        signal(&self.child, "INT");
        self.ended(130)
    }

    /// The same of one that ends by itself.
    pub(super) fn wait(self) -> (Value, Vec<String>) {
        self.ended(0)
    }

    /// One that ends by itself and need not write JSON: what it wrote, and what it noted on the way.
    pub(super) fn over(mut self) -> (String, Vec<String>) {
        let begin = Instant::now();
        while self.child.try_wait().unwrap().is_none() {
            if begin.elapsed() > 2 * PATIENCE {
                let _ = self.child.kill();
                let heard: Vec<String> = self.heard.into_iter().chain(self.notes.iter()).collect();
                panic!("it does not end; heard: {heard:#?}");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let output = self.child.wait_with_output().unwrap();
        let heard: Vec<String> = self.heard.into_iter().chain(self.notes.iter()).collect();
        let out = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{:?}\n{out}\n{heard:#?}", output.status);
        assert!(!heard.iter().any(|line| line.contains("validation:")), "{heard:#?}");
        (out, heard)
    }

    fn ended(self, code: i32) -> (Value, Vec<String>) {
        let output = self.child.wait_with_output().unwrap();
        let heard: Vec<String> = self.heard.into_iter().chain(self.notes.iter()).collect();
        let out = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(code), "{:?}\n{out}\n{heard:#?}", output.status);
        assert!(!heard.iter().any(|line| line.contains("validation:")), "{heard:#?}");
        (serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}\n{heard:#?}")), heard)
    }
}

fn spawn(folder: &Path, environment: &[(&'static str, String)]) -> Child {
    let log = std::fs::File::create(folder.join("service.log")).unwrap();
    Command::new(GPU_ENV)
        .arg("monado-service")
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_CONFIG_HOME", folder)
        .env_remove("GAITWAY_VALIDATION")
        .envs(environment.iter().map(|(name, value)| (name, value)))
        .stdin(Stdio::null())
        .stdout(log.try_clone().unwrap())
        .stderr(log)
        .spawn()
        .unwrap()
}

impl Drop for Service {
    fn drop(&mut self) {
        self.kill();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The head of Monado's driver "remote": whole states of 376 bytes, little-endian.
pub(super) struct Head {
    stream: TcpStream,
    state: [u8; 376],
}

/// What a thumb does on a controller.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stick {
    pub(super) stick: [f32; 2],
    /// The stick pressed.
    pub(super) click: bool,
    /// The button A.
    pub(super) a: bool,
    /// The trigger, pulled.
    pub(super) trigger: bool,
}

/// Where the controllers stand in a state, and in a controller its stick and its 13 flags (from "active" on).
const HANDS: [usize; 2] = [136, 256];
const TRIGGER: usize = 72;
const STICK: usize = 84;
const FLAGS: usize = 104;

/// Where the head's pose stands in a state: after the header and the poses of two views.
const POSE: usize = 104;

impl Head {
    fn connect(port: u16) -> Self {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_nodelay(true).unwrap();
        let mut state = [0; 376];
        // its state after a reset, then the latest one
        stream.read_exact(&mut state).unwrap();
        stream.read_exact(&mut state).unwrap();
        Self { stream, state }
    }

    /// Holds a controller (0 the left one) at a place of the room, m, level or pitched upwards; goes with the next
    /// [`Head::set`].
    pub(super) fn set_hand(&mut self, hand: usize, position: [f32; 3], pitch_deg: f32, thumb: Stick) {
        let turn = glam::Quat::from_rotation_x(pitch_deg.to_radians());
        let at = HANDS[hand];
        for (place, value) in turn.to_array().into_iter().chain(position).enumerate() {
            self.state[at + 4 * place..][..4].copy_from_slice(&value.to_le_bytes());
        }
        for (place, value) in thumb.stick.into_iter().enumerate() {
            self.state[at + STICK + 4 * place..][..4].copy_from_slice(&value.to_le_bytes());
        }
        let pulled = f32::from(u8::from(thumb.trigger));
        self.state[at + TRIGGER..][..4].copy_from_slice(&pulled.to_le_bytes());
        let flags = &mut self.state[at + FLAGS..][..13];
        flags.fill(0);
        (flags[1], flags[4], flags[10]) = (1, u8::from(thumb.a), u8::from(thumb.click));
        flags[8] = u8::from(thumb.trigger);
    }

    /// Shows a hand without a controller (0 the left one) at a place of the room, m, its fingers straight; goes with the
    /// next [`Head::set`]. No place, no hand.
    pub(super) fn show_hand(&mut self, hand: usize, position: Option<[f32; 3]>) {
        self.set_hand(hand, position.unwrap_or_default(), 0.0, Stick::default());
        let flags = &mut self.state[HANDS[hand] + FLAGS..][..13];
        (flags[0], flags[1]) = (u8::from(position.is_some()), 0);
    }

    /// Turns and moves the head: turn to the left and upwards in degrees, position above the room's floor in m.
    pub(super) fn set(&mut self, yaw_deg: f32, pitch_deg: f32, position: [f32; 3]) {
        let turn = glam::Quat::from_rotation_y(yaw_deg.to_radians())
            * glam::Quat::from_rotation_x(pitch_deg.to_radians());
        self.state[..8].copy_from_slice(b"mndrmt3\0");
        for (place, value) in turn.to_array().into_iter().chain(position).enumerate() {
            self.state[POSE + 4 * place..][..4].copy_from_slice(&value.to_le_bytes());
        }
        self.stream.write_all(&self.state).unwrap();
    }
}
