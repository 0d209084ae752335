//! What the runtime's compositor shows: Monado's own, in a window on a virtual display.

use super::service::{Live, Service, is_there};
use super::{POST, after, folder, post, shows};
use gaitway::picture::Image;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Pixels of one eye in the compositor's window: half of Monado's remote headset.
pub(super) const EYE: [u32; 2] = [480, 540];

/// Xvfb, which keeps its screen in a file.
pub(super) struct Screen {
    server: Child,
    pub(super) display: String,
    file: PathBuf,
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

pub(super) fn screen(folder: &Path) -> Option<Screen> {
    let started = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1280x720x24", "-nolisten", "tcp", "-noreset", "-fbdir"])
        .arg(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let mut server = match started {
        Ok(server) => server,
        Err(error) => {
            println!("skipped: no Xvfb ({error}); scripts/setup --view brings it");
            return None;
        }
    };
    let mut line = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(!line.trim().is_empty(), "Xvfb does not start");
    Some(Screen { server, display: format!(":{}", line.trim()), file: folder.join("Xvfb_screen0") })
}

impl Screen {
    /// The server's process.
    #[cfg(feature = "view")]
    pub(super) fn server_id(&self) -> u32 {
        self.server.id()
    }

    /// What is in the screen's upper left corner. The file is an XWD image: big-endian words of a header, then pixels of
    /// blue, green, red.
    pub(super) fn shows(&self, [width, height]: [u32; 2]) -> Image {
        let bytes = std::fs::read(&self.file).unwrap();
        let word = |at: usize| u32::from_be_bytes(bytes[4 * at..4 * at + 4].try_into().unwrap()) as usize;
        let (first, stride) = (word(0) + 12 * word(19), word(12));
        let row = |y: u32| &bytes[first + y as usize * stride..][..width as usize * 4];
        let pixels = (0..height)
            .flat_map(row)
            .collect::<Vec<_>>()
            .chunks_exact(4)
            .flat_map(|p| [*p[2], *p[1], *p[0], 255])
            .collect();
        Image { width, height, pixels }
    }
}

/// The share of pixels of each eye's half that differ by more than so many levels.
pub(super) fn differs(a: &Image, b: &Image, levels: u8) -> [f32; 2] {
    assert_eq!([a.width, a.height], [b.width, b.height]);
    [0, 1].map(|eye| {
        let half = (0..a.height).flat_map(|y| (eye * EYE[0]..(eye + 1) * EYE[0]).map(move |x| (x, y)));
        let off = half.filter(|(x, y)| {
            let (a, b) = (a.pixel(*x, *y).unwrap(), b.pixel(*x, *y).unwrap());
            (0..3).any(|c| a[c].abs_diff(b[c]) > levels)
        });
        off.count() as f32 / (EYE[0] * EYE[1]) as f32
    })
}

#[test]
fn the_compositor_presents_our_pictures_to_both_eyes() {
    if !is_there() {
        return;
    }
    let folder = folder("presented");
    let Some(screen) = screen(&folder) else { return };
    let service = Service::start_on("presented", &screen.display);
    let file = folder.join("post.toml");
    std::fs::write(&file, POST).unwrap();
    let (scene, shots) = (file.to_str().unwrap(), folder.to_str().unwrap());
    let size = format!("{}x{}", EYE[0], EYE[1]);
    let run = ["xr", scene, "--eye-size", &size, "--shots", shots, "--every", "5", "--json"];
    let mut head = service.head();
    head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    let mut columns = Vec::new();
    for turn in [0.0, 14.0] {
        head.set(turn, 0.0, [0.0, 1.6, 0.0]);
        after(&folder, 2);
        // a sky of many tones, a ground, a post: all where and as we drew them
        let (_, (shown, off)) = shows(&folder, |ours| {
            let shown = screen.shows([2 * EYE[0], EYE[1]]);
            let off = differs(&shown, ours, 6);
            if off.iter().all(|share| *share < 0.01) {
                Ok((shown, off))
            } else {
                Err(format!("{off:?} differ"))
            }
        });
        gaitway::export::image::write_png(&folder.join(format!("presented-{turn}.png")), &shown).unwrap();
        println!("turned by {turn}: {off:.4?} of the pixels differ in each eye");
        columns.push([0, 1].map(|eye| post(&shown, eye).unwrap()));
    }
    // the post is in the middle of both halves, then right of it; a swapped pair of eyes would have the parallax reversed
    println!("the post in columns {columns:.1?}");
    let [straight, turned] = columns[..] else { panic!() };
    let focal = 0.5 * EYE[0] as f32 / 0.7418_f32.tan();
    for eye in 0..2 {
        let (from, to) = (straight[eye] - 0.5 * EYE[0] as f32, turned[eye] - 0.5 * EYE[0] as f32);
        let moved = ((to / focal).atan() - (from / focal).atan()).to_degrees();
        assert!((moved - 14.0).abs() < 0.6, "{moved} degrees, eye {eye}");
    }
    assert!(straight[0] > straight[1] + 0.8, "{straight:?}");
    live.end();
}
