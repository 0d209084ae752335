//! Streets that were filmed.

use super::super::files;
use super::super::judge::{Bench, Draws, Test};
use super::super::measure::{kolmogorov_smirnov, nearest_distances, quantile};
use super::super::rooms::{RADIUS, walker};
use super::super::scene::Experiment;
use super::super::tracks::Tracks;
use crate::Error;
use crate::export::chart::{Curve, Plot, Stroke};
use glam::Vec2;

pub(super) const UCY: Test = Test {
    name: "ucy",
    title: "Speeds and distances to the nearest other as in two streets that were filmed",
    source: "Recordings zara01 and students03 (Lerner et al. 2007)",
    about: "Every 8 s of the film are walked again. Each person present begins at their place and speed in the film, and walks at \
            their mean speed to their place 8 s later. Compared by Kolmogorov-Smirnov distances over the same seconds: speeds, and \
            distances to the nearest other. The values are shown and not judged: we know of no published bound, and the comparison \
            does not separate standing people from slow walkers. Walls and benches are left out.",
    run: ucy,
    draws: Draws::One,
    grows: false,
};

/// Length of a piece, s.
const PIECE: usize = 8;
/// Metres from one piece to the next: far beyond where neighbours matter.
const APART: f32 = 60.0;

/// People of one piece of the film.
struct Piece {
    /// Its first frame.
    first: usize,
    /// Id, first and last place of each person.
    people: Vec<(u32, Vec2, Vec2)>,
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "frames")]
fn pieces(film: &Tracks) -> Vec<Piece> {
    let length = (PIECE as f64 * film.rate) as usize;
    let firsts = (0..).map(|k| k * length).take_while(|first| first + length < film.frames.len());
    let piece = |first: usize| {
        let people = film.frames[first].iter().filter_map(|&(who, from)| {
            let last = (first..=first + length).rev().find_map(|frame| film.at(frame, who))?;
            Some((who, from, last))
        });
        Piece { first, people: people.collect() }
    };
    firsts.map(piece).filter(|piece| piece.people.len() >= 2).collect()
}

/// Speeds and nearest distances of the same people in the film, and walked again.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "frames"
)]
fn walk_again(bench: &Bench<'_>, film: &Tracks) -> Result<[[Vec<f64>; 2]; 2], Error> {
    let pieces = pieces(film);
    let columns = (pieces.len() as f32).sqrt().ceil().max(1.0) as usize;
    let origin = |k: usize| Vec2::new((k % columns) as f32, (k / columns) as f32) * APART;
    let side = APART * columns as f32;
    let outline = [[-40.0, -40.0], [side + 40.0, -40.0], [side + 40.0, side + 40.0], [-40.0, side + 40.0]];
    let mut scene = Experiment::new("street", &outline, PIECE as f32)?;
    for (k, piece) in pieces.iter().enumerate() {
        for &(who, from, to) in &piece.people {
            let frames = (piece.first..).take_while(|frame| film.at(*frame, who).is_some());
            let length = (PIECE as f64 * film.rate) as usize;
            let time = frames.count().min(length + 1).saturating_sub(1).max(1) as f32 / film.rate as f32;
            let speed = (from.distance(to) / time).clamp(0.02, 2.5);
            // on beyond the goal, so that people leaving the film do not stop at its edge
            let goal = to + (to - from).normalize_or_zero() * speed * 4.0;
            scene.walkers.push(walker(from + origin(k), speed, vec![(goal + origin(k), RADIUS)]));
        }
    }
    let run = bench.run(&scene)?;
    let mut found: [[Vec<f64>; 2]; 2] = Default::default();
    let mut number = 0_u32;
    for piece in &pieces {
        let own = number..number + u32::try_from(piece.people.len()).unwrap_or(0);
        number = own.end;
        // from 2 s on, once a second, the people in the film
        for second in 2..PIECE {
            let in_film = piece.first + (second as f64 * film.rate).round() as usize;
            let in_run = ((second as f64) * run.tracks.rate).round() as usize;
            let present: Vec<(u32, u32)> = own
                .clone()
                .zip(piece.people.iter().map(|person| person.0))
                .filter(|(_, who)| film.at(in_film, *who).is_some())
                .collect();
            let places = |tracks: &Tracks, frame: usize, film: bool| -> Vec<(u32, Vec2)> {
                let who = present.iter().map(|pair| if film { pair.1 } else { pair.0 });
                who.filter_map(|who| tracks.at(frame, who).map(|at| (who, at))).collect()
            };
            for (side, (tracks, frame)) in [(film, in_film), (&run.tracks, in_run)].into_iter().enumerate() {
                let people = places(tracks, frame, side == 0);
                let speeds = people.iter().filter_map(|p| tracks.velocity(frame, p.0, 0.4));
                found[side][0].extend(speeds.map(|v| f64::from(v.length())));
                found[side][1].extend(nearest_distances(&people));
            }
        }
    }
    Ok(found)
}

fn ucy(bench: &Bench<'_>) -> Result<(), Error> {
    for name in ["zara01", "students03"] {
        let Some(path) = bench.file(&format!("crowd-ucy/{name}/obsmat.txt")) else { continue };
        let film = files::ucy(&path).map_err(super::super::unusable)?;
        let [real, made] = walk_again(bench, &film)?;
        for (what, index) in [("speeds", 0), ("nearest", 1)] {
            let distance = kolmogorov_smirnov(&real[index], &made[index]);
            bench.report(&format!("{name}-{what}"), distance, "Kolmogorov-Smirnov distance");
            let axis = if index == 0 { "speed, m/s" } else { "distance to the nearest other, m" };
            bench
                .draw(&format!("ucy-{name}-{what}"), || distribution(name, axis, &real[index], &made[index]));
        }
    }
    Ok(())
}

fn distribution(name: &str, axis: &str, real: &[f64], made: &[f64]) -> Plot {
    let curve = |name: &str, sample: &[f64], stroke, color| Curve {
        name: name.into(),
        points: (0..=98_u8).map(|i| [quantile(sample, f64::from(i) / 100.0), f64::from(i) / 100.0]).collect(),
        stroke,
        color,
    };
    Plot {
        title: format!("UCY {name}"),
        axes: [axis.into(), "share of people below".into()],
        curves: vec![
            curve("film", real, Stroke::Dashed, [200, 66, 52]),
            curve("gaitway", made, Stroke::Line, [66, 118, 190]),
        ],
        note: "Data: Lerner, Chrysanthou, Lischinski 2007.".into(),
    }
}
