//! A report about a GPU, for `scripts/gpu-report`: whether it gives the bits of the CPU, how fast every kernel is, how near
//! this project's goals it comes, and pictures. `report.md` is the page, `report.json` holds the same as numbers.
#![allow(clippy::print_stdout, missing_docs, reason = "a benchmark says what it does")]

use gaitway::Scene;
use gaitway::bench::{Report as Times, Workload, bench};
use gaitway::export::image::write_png;
use gaitway::gpu::{Device, Validation};
use gaitway::render::Settings;
use gaitway::scenario::Condition;
use gaitway::scene::{CameraChoice, Stage};
use gaitway::sim::{Backend, measure::state_hash};
use gaitway::verify::{Options, Report as Verification, verify};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// What is asked for on the command line.
struct Arguments {
    out: PathBuf,
    device: Option<String>,
    /// Small crowds, to try it.
    is_quick: bool,
}

/// All that was found so far.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    machine: Vec<String>,
    device: String,
    driver: String,
    api: String,
    verification: Verification,
    /// State hash of 2,000 people in the crossing after 10 s, by backend.
    hashes: Vec<(&'static str, String)>,
    goals: Option<Times>,
    kernels: Option<Times>,
    stereo: Option<Times>,
    pictures: Vec<String>,
}

fn main() -> Result<()> {
    let arguments = arguments()?;
    let Some(arguments) = arguments else { return Ok(()) };
    std::fs::create_dir_all(&arguments.out)?;
    let report = measure(&arguments)?;
    println!("{}", arguments.out.join("report.md").display());
    if report.verification.pass {
        Ok(())
    } else {
        Err("this device does not give the bits of the CPU".into())
    }
}

impl Report {
    /// Writes what there is by now, so that a device that is lost, or a run that is ended, loses one part alone.
    fn write(&self, folder: &Path) -> Result<()> {
        let text = [("report.json", serde_json::to_string_pretty(self)?), ("report.md", page(self))];
        for (name, text) in text {
            let part = folder.join(name).with_extension("part");
            std::fs::write(&part, text)?;
            std::fs::rename(part, folder.join(name))?;
        }
        Ok(())
    }
}

/// None where cargo runs all benchmarks once, to see that they start: this one would take minutes.
fn arguments() -> Result<Option<Arguments>> {
    let mut found = Arguments { out: PathBuf::from("out/gpu-report"), device: None, is_quick: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--out" => found.out = value()?.into(),
            "--device" => found.device = Some(value()?),
            "--quick" => found.is_quick = true,
            "--test" => return Ok(None),
            "--bench" => {}
            _ => return Err(format!("unknown option {word}: --out FOLDER, --device NAME, --quick").into()),
        }
    }
    Ok(Some(found))
}

fn measure(arguments: &Arguments) -> Result<Report> {
    let named = arguments.device.as_deref();
    let (sizes, people): (&[usize], &[u32]) = if arguments.is_quick {
        (&[1_000, 10_000], &[300])
    } else {
        (&[10_000, 100_000, 1_000_000], &[1_000, 5_000, 20_000])
    };
    let options = if arguments.is_quick { Options::quick() } else { Options::full() };
    let device = Device::open(named, Validation::Off)?;
    let info = device.info().clone();
    println!("verifying on {}", device.describe());
    let verification = verify(Some(&device), &options, &mut |_, _| ())?;
    let description = device.describe();
    drop(device);
    println!("two crowds");
    let hashes = [("vulkan", Backend::Vulkan), ("cpu", Backend::Cpu), ("reference", Backend::Reference)]
        .into_iter()
        .map(|(name, backend)| Ok((name, hash(backend, named)?)))
        .collect::<Result<_>>()?;
    let time = |workload: Workload, sizes: &[usize]| {
        bench(workload, sizes, Backend::Vulkan, named, &mut |what, _| println!("{what}"))
    };
    let mut report = Report {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        device: description,
        driver: info.driver,
        api: info.api,
        verification,
        hashes,
        goals: None,
        kernels: None,
        stereo: None,
        pictures: Vec::new(),
    };
    report.write(&arguments.out)?;
    report.goals = Some(time(Workload::Goals, sizes)?);
    report.write(&arguments.out)?;
    report.kernels = Some(time(Workload::All, sizes)?);
    report.write(&arguments.out)?;
    let crowds: Vec<usize> = people.iter().map(|count| *count as usize).collect();
    report.stereo = Some(time(Workload::Stereo, &crowds)?);
    for &count in people {
        println!("picture, {count} people");
        report.pictures.push(picture(&arguments.out, count, named)?);
        report.write(&arguments.out)?;
    }
    Ok(report)
}

fn hash(backend: Backend, device: Option<&str>) -> Result<String> {
    let device = device.filter(|_| backend == Backend::Vulkan);
    let scene = Scene::load("crossing")?.agents(2_000).condition(Condition::EvaG);
    let mut crowd = scene.backend(backend).device(device).start()?;
    crowd.step(300)?;
    Ok(format!("{:016x}", state_hash(crowd.state()?)))
}

/// What a person in the crossing sees; the name of the file.
fn picture(folder: &Path, people: u32, device: Option<&str>) -> Result<String> {
    let scene = Scene::load("crossing")?.agents(people).backend(Backend::Vulkan).device(device).build()?;
    let mut stage = Stage::new(scene, Settings::sized(1680, 1760))?;
    stage.step(150)?;
    let camera = stage.camera(CameraChoice::Eyes, stage.simulation.time())?;
    let name = format!("{people}.png");
    write_png(&folder.join(&name), &stage.picture(&camera)?)?;
    Ok(name)
}

/// What the machine says of itself and of its clocks; a program that is not there says nothing.
fn machine() -> Vec<String> {
    let smi = "--query-gpu=name,driver_version,clocks.sm,clocks.mem,clocks.max.sm,clocks.max.mem,power.limit";
    let commands: [(&str, &[&str]); 3] = [
        ("uname", &["-srm"]),
        ("sh", &["-c", "grep -m 1 'model name' /proc/cpuinfo; cat /sys/class/drm/card*/device/pp_dpm_sclk"]),
        ("nvidia-smi", &[smi, "--format=csv"]),
    ];
    let said = commands.into_iter().filter_map(|(name, arguments)| {
        let output = Command::new(name).args(arguments).output().ok()?;
        Some(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect::<Vec<_>>())
    });
    said.flatten().collect()
}

fn page(report: &Report) -> String {
    let mut page = format!("# {}\n\ngaitway {}, Vulkan {}", report.device, report.version, report.api);
    let _ = write!(page, ", driver {}\n\n", report.driver);
    report.machine.iter().for_each(|line| _ = writeln!(page, "    {line}"));
    let verification = &report.verification;
    page.push_str("\n## The same bits\n\n");
    if let Some(arithmetic) = &verification.arithmetic {
        let _ =
            writeln!(page, "Arithmetic: {}; the device's own: {}.\n", arithmetic.taken, arithmetic.native);
    }
    let exact = verification.kernels.iter().filter(|kernel| kernel.pass).count();
    let _ = writeln!(
        page,
        "- {exact} of {} kernels give the bits of their twins, on the device and by lanes",
        verification.kernels.len()
    );
    for kernel in verification.kernels.iter().filter(|kernel| !kernel.pass) {
        let _ = writeln!(page, "- {}: wrong is {}", kernel.name, kernel.differs.join(", or "));
    }
    let crowd = &verification.crowd;
    let outcome =
        crowd.differs_by_step.map_or("equal".to_owned(), |step| format!("different by step {step}"));
    let _ = writeln!(page, "- {} people for {} steps: {outcome}", crowd.agents, crowd.steps);
    for (backend, hash) in &report.hashes {
        let _ = writeln!(page, "- 2000 people in the crossing after 10 s, {backend}: {hash}");
    }
    page.push_str("\n## Goals\n\n| | what | median | goal | |\n| --- | --- | --- | --- | --- |\n");
    for goal in report.goals.iter().flat_map(|times| &times.goals) {
        let bound = if goal.unit == "ms" { "at most" } else { "at least" };
        let met = if goal.is_met { "met" } else { "missed" };
        let (name, what, value, unit) = (goal.name, &goal.what, goal.value, goal.unit);
        let _ = writeln!(page, "| {name} | {what} | {value:.3} {unit} | {bound} {} | {met} |", goal.goal);
    }
    page.push_str("\n## The crowds that were timed\n\n| agents | steps | overlaps a person | deep | nearest, m | progress, m/s | bytes a person |\n| --- | --- | --- | --- | --- | --- | --- |\n");
    for seen in report.goals.iter().flat_map(|times| &times.quality) {
        let _ = writeln!(
            page,
            "| {} | {} | {:.4} | {:.4} | {:.3} | {:.3} | {:.0} |",
            seen.agents,
            seen.steps,
            seen.overlapping,
            seen.deep,
            seen.min_distance,
            seen.progress,
            seen.bytes_per_agent
        );
    }
    for (title, times) in [("Every kernel", &report.kernels), ("Pictures for both eyes", &report.stereo)] {
        let _ = write!(
            page,
            "\n## {title}\n\n| name | agents | median, ms | least | most |\n| --- | --- | --- | --- | --- |\n"
        );
        for row in times.iter().flat_map(|times| &times.rows) {
            let (median, least, most) = (row.ms_median, row.ms_min, row.ms_max);
            let _ =
                writeln!(page, "| {} | {} | {median:.4} | {least:.4} | {most:.4} |", row.name, row.agents);
        }
    }
    page.push_str("\n## Pictures\n");
    report.pictures.iter().for_each(|name| _ = write!(page, "\n![{name}]({name})\n"));
    page
}
