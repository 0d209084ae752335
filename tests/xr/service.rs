//! A Monado service without a display, one per test, and its scripted head.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The script that runs programs on the unpacked drivers and runtime.
pub(super) const GPU_ENV: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/gpu-env");

/// Whether the runtime is there; a machine that must have it fails without.
pub(super) fn is_there() -> bool {
    let root = std::env::var_os("GAITWAY_VULKAN_ROOT").map_or_else(
        || PathBuf::from(std::env::var_os("HOME").unwrap_or_default()).join(".cache/gaitway/vulkan-trixie"),
        PathBuf::from,
    );
    if root.join("xr/.complete").exists() {
        return true;
    }
    assert!(
        std::env::var_os("GAITWAY_REQUIRE_XR").is_none(),
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
}

impl Service {
    /// Starts a service with a folder and a port of its own, so that tests run side by side.
    pub(super) fn start(name: &str, port: u16) -> Self {
        let folder = std::env::temp_dir().join(format!("gaitway-xr-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("monado")).unwrap();
        let config =
            format!(r#"{{"active":"remote","remote":{{"version":0,"port":{port},"view_count":2}}}}"#);
        std::fs::write(folder.join("monado/config_v0.json"), config).unwrap();
        let child = spawn(&folder);
        let service = Self { child, folder, port };
        service.wait_until_started();
        service
    }

    /// A program of ours that talks to this service.
    pub(super) fn gaitway(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(GPU_ENV);
        command.arg(env!("CARGO_BIN_EXE_gaitway")).args(arguments);
        command.env("XDG_RUNTIME_DIR", &self.folder).env("XDG_CONFIG_HOME", &self.folder);
        command.env("GAITWAY_VALIDATION", "sync").stdin(Stdio::null());
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
        self.child = spawn(&self.folder);
        self.wait_until_started();
    }

    /// Lets it hang, or go on.
    pub(super) fn signal(&self, name: &str) {
        let status = Command::new("kill").arg(format!("-{name}")).arg(self.child.id().to_string()).status();
        assert!(status.unwrap().success());
    }

    /// Its head.
    pub(super) fn head(&self) -> Head {
        Head::connect(self.port)
    }

    // A trial connection would count as a client, so the log it is.
    fn wait_until_started(&self) {
        let begin = Instant::now();
        let log = self.folder.join("service.log");
        while !std::fs::read_to_string(&log).unwrap_or_default().contains("service has started") {
            assert!(
                begin.elapsed() < Duration::from_secs(30),
                "the service did not start: {}",
                log.display()
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

fn spawn(folder: &Path) -> Child {
    let log = std::fs::File::create(folder.join("service.log")).unwrap();
    Command::new(GPU_ENV)
        .arg("monado-service")
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_CONFIG_HOME", folder)
        .env_remove("GAITWAY_VALIDATION")
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
