//! Some three hundred malformed or odd inputs, to every command that reads a file: one message, no panic, and never more
//! than 512 MiB.

use super::{good, program};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Address space of a run, KiB.
const MEMORY: u32 = 512 << 10;

/// What reads a file: the ending of its name, and the command line about it (`FILE`).
const READERS: [(&str, &str); 23] = [
    ("toml", "simulate FILE --seconds 0.1 --backend cpu"),
    ("scene", "scene import FILE --out OUT.toml"),
    ("glb", "simulate garden --library FILE --seconds 0.1 --backend cpu"),
    ("glb", "gait show FILE"),
    ("vrm", "simulate AVATAR --seconds 0 --backend cpu"),
    ("gltf", "simulate AVATAR --seconds 0 --backend cpu"),
    ("csv", "replay FILE --seconds 0.1 --fps 10 --backend cpu"),
    ("txt", "replay FILE --seconds 0.1 --fps 10 --backend cpu"),
    ("vsp", "replay FILE --seconds 0.1 --fps 10 --backend cpu"),
    ("sqlite", "replay FILE --seconds 0.1 --backend cpu"),
    ("bvh", "gait import FILE"),
    ("amc", "gait import FILE"),
    ("bvh", "gait measure FILE"),
    ("glb", "gait measure WALK --avatar FILE"),
    ("c3d", "gait predict FILE"),
    ("npz", "gait import FILE"),
    ("csv", "gait predict FILE"),
    ("toml", "gait import WALK --joint-map FILE"),
    ("csv", "gait ratings FILE"),
    ("json", "gait fit FILE"),
    ("gwh", "gait fit FILE"),
    ("json", "gait predict WALK --model FILE"),
    ("csv", "xr garden --replay FILE --backend cpu"),
];

/// Command lines that are odd by themselves.
const LINES: [&str; 26] = [
    "simulate",
    "simulate crossing --agents 1e9",
    "simulate crossing --agents 99999999999999999999",
    "simulate crossing --seconds inf",
    "simulate crossing --seconds 0 --fps nan --out OUT.csv",
    "simulate crossing --seconds 0 --fps 1e300 --out OUT.csv",
    "simulate crossing --seed 18446744073709551616",
    "simulate crossing --backend gpu",
    "simulate crossing --affect nan,nan --backend cpu",
    "simulate crossing --gait-speed 9..1 --backend cpu",
    "simulate crossing --gait-margin -inf --backend cpu",
    "simulate crossing --out /dev/full/x.csv --backend cpu",
    "simulate crossing --out OUT.xyz --backend cpu",
    "simulate crossing/ --backend cpu",
    "simulate .toml --backend cpu",
    "simulate crossing crossing",
    "scene import",
    "gait walk --emotion bored --out OUT.csv",
    "gait walk --emotion sad --set bounce=nan --out OUT.csv",
    "gait walk --emotion sad --set =1 --out OUT.csv",
    "gait walk --emotion sad --speed inf --out OUT.csv",
    "gait walk --emotion sad --out OUT",
    "gait import /nowhere",
    "bench --agents , --backend cpu",
    "validate nosuch --backend cpu",
    "completions tcsh",
];

/// Bytes that look random.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 0x9e37_79b9_u32;
    let mut byte = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state.to_le_bytes()[1]
    };
    (0..count).map(|_| byte()).collect()
}

/// A text with every number replaced.
fn with_numbers(bytes: &[u8], number: &str) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    let (mut out, mut is_inside) = (String::new(), false);
    for c in text.chars() {
        let is_number = c.is_ascii_digit() || (is_inside && ".eE+-".contains(c));
        if is_number && !is_inside {
            out += number;
        } else if !is_number {
            out.push(c);
        }
        is_inside = is_number;
    }
    out.into_bytes()
}

/// What may be found under a name, besides what should be there (`whole`).
fn contents(whole: &[u8]) -> Vec<Vec<u8>> {
    let flipped = whole.iter().enumerate().map(|(at, byte)| if at % 97 == 13 { byte ^ 0x55 } else { *byte });
    vec![
        Vec::new(),
        b"\n".to_vec(),
        noise(3000),
        vec![0; 1 << 16],
        [b"\x89PNG\r\n\x1a\n", noise(500).as_slice()].concat(),
        whole[..whole.len() / 3].to_vec(),
        whole[..whole.len().saturating_sub(1)].to_vec(),
        flipped.collect(),
        with_numbers(whole, "1e999"),
        with_numbers(whole, "nan"),
        with_numbers(whole, "-99999999999999999999"),
        b"[".repeat(100_000),
        b"<a>{\"a\":".repeat(30_000),
        b"7 ".repeat(500_000),
    ]
}

/// What a reader should find, where the program can write it or it is short.
fn sample(folder: &Path, ending: &str, line: &str) -> Vec<u8> {
    let path = folder.join(format!("sample.{ending}"));
    let file = path.to_str().unwrap();
    let walked = "ROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n End Site\n {\n OFFSET 0 1 0\n }\n}\n";
    let text = match (ending, line.split(' ').nth(1).unwrap()) {
        ("scene", _) => {
            "<Project scene=\"s.xml\" behavior=\"b.xml\" view=\"v.xml\" duration=\"5\"/>".to_owned()
        }
        ("toml", "import") => "like = \"gaitway\"\nhead = \"head\"\nunit = 1.0\n".to_owned(),
        ("toml", _) => {
            std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes/garden.toml"))
                .unwrap_or_else(|_| "layout = \"garden\"\nseed = 1\n[population]\nagents = 4\n".to_owned())
        }
        ("bvh", _) => format!("HIERARCHY\n{walked}MOTION\nFrames: 2\nFrame Time: 0.1\n0 1 0\n0 1 0.1\n"),
        ("amc", _) => ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\n2\nroot 0 1 0.1 0 0 0\n".to_owned(),
        ("csv", "ratings") => {
            "worker,video,happy,angry,sad,neutral\na,v.mp4,1,2,3,4\nb,v.mp4,2,2,3,5\n".to_owned()
        }
        ("csv", "garden") => "# gaitway xr recording 1\nstep,x,z,vx,vz\n1,0,0,0,0\n".to_owned(),
        ("vsp", _) => "1 - the number of splines\n2\n0 0 1 90\n10 10 2 90\n".to_owned(),
        ("gltf", _) => {
            "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":7,\"children\":[0]}],\"accessors\":[\
                        {\"count\":4000000000,\"componentType\":5126,\"type\":\"MAT4\"}]}"
                .to_owned()
        }
        ("c3d", _) => return [b"\x02\x50\x36\x00\xff\xff\x01\x00\xff\xff".as_slice(), &noise(2000)].concat(),
        ("npz", _) => return [b"PK\x03\x04\x14\0\0\0\x08\0", noise(2000).as_slice()].concat(),
        _ => {
            match (ending, line.split(' ').next().unwrap()) {
                (_, "replay") => {
                    good(&[
                        "simulate",
                        "garden",
                        "--seconds",
                        "0.5",
                        "--backend",
                        "cpu",
                        "--force",
                        "--out",
                        file,
                    ]);
                }
                ("json" | "gwh", _) => {
                    let walk = folder.join("walk.glb");
                    good(&["gait", "fit", walk.to_str().unwrap(), "--force", "--out", file]);
                }
                ("vrm", _) => return std::fs::read(folder.join("walk.glb")).unwrap(),
                _ => {
                    good(&["gait", "walk", "--emotion", "sad", "--force", "--out", file]);
                }
            }
            return std::fs::read(&path).unwrap();
        }
    };
    text.into_bytes()
}

/// Runs with little memory; threads that wait for nothing take some of it, so there are two.
fn run(arguments: &[String]) -> Output {
    let program = program();
    let mut words = vec![program.get_program().to_owned()];
    words.extend(program.get_args().map(ToOwned::to_owned));
    let line = format!("ulimit -v {MEMORY}; exec \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &line, "sh"]).args(words).args(arguments).env("RAYON_NUM_THREADS", "2");
    command.output().unwrap()
}

/// What is wrong with how the program took an input, if anything.
fn fault(arguments: &[String]) -> Option<String> {
    let output = run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    let errors =
        error.lines().filter(|line| line.starts_with("error: ") || line.starts_with("left out: ")).count();
    let is_wrong = match output.status.code() {
        Some(0) => error.contains("error: "),
        Some(1 | 2) => errors != 1,
        _ => true, // a signal, or an abort
    };
    let is_wrong = is_wrong || error.contains("panicked") || error.contains("not enough memory");
    let told: String = error.chars().take(600).collect();
    is_wrong.then(|| format!("{}: {:?}\n{told}", arguments.join(" "), output.status))
}

/// All command lines, their files written into a folder.
fn cases(folder: &Path) -> Vec<Vec<String>> {
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    good(&["gait", "walk", "--emotion", "sad", "--out", &at("walk.csv")]);
    good(&["gait", "walk", "--emotion", "sad", "--out", &at("walk.glb")]);
    assert!(Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
    drop(std::os::unix::net::UnixListener::bind(folder.join("socket")).unwrap());
    let mut cases: Vec<Vec<String>> = Vec::new();
    let mut add = |line: &str, file: &str| {
        let number = cases.len();
        let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        for word in &mut words {
            *word = match word.as_str() {
                "FILE" => file.to_owned(),
                "WALK" => at("walk.csv"),
                "AVATAR" => {
                    let mut text = "layout = \"garden\"\n[population]\nagents = 1\n".to_owned();
                    let _ = writeln!(text, "avatars = [{file:?}]");
                    let scenario = at(&format!("avatar-{number}.toml"));
                    std::fs::write(&scenario, text).unwrap();
                    scenario
                }
                other => other.replace("OUT", &at(&format!("out-{number}"))),
            };
        }
        cases.push(words);
    };
    for (reader, (ending, line)) in READERS.into_iter().enumerate() {
        if line.starts_with("xr") && !cfg!(feature = "xr") {
            continue;
        }
        let name = |what: &str| folder.join(format!("{reader}-{what}.{ending}"));
        for (number, bytes) in contents(&sample(folder, ending, line)).into_iter().enumerate() {
            let path = name(&number.to_string());
            std::fs::write(&path, bytes).unwrap();
            add(line, path.to_str().unwrap());
        }
        add(line, name("missing").to_str().unwrap());
        let link = |target: PathBuf, what: &str| {
            std::os::unix::fs::symlink(target, name(what)).unwrap();
            name(what)
        };
        let odd =
            [("pipe", folder.join("pipe")), ("socket", folder.join("socket")), ("zero", "/dev/zero".into())];
        for (what, target) in odd {
            add(line, link(target, what).to_str().unwrap());
        }
        std::fs::create_dir(name("folder")).unwrap();
        add(line, name("folder").to_str().unwrap());
    }
    for line in LINES {
        add(line, "");
    }
    cases
}

#[test]
fn whatever_is_read_ends_with_one_message_and_within_bounds() {
    let folder = tempfile::tempdir().unwrap();
    let cases = cases(folder.path());
    assert!(cases.len() >= 300, "{}", cases.len());
    let (next, faults) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Some(fault) = fault(case) {
                        faults.lock().unwrap().push(fault);
                    }
                }
            });
        }
    });
    let faults = faults.into_inner().unwrap();
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), cases.len(), faults.join("\n"));
}
