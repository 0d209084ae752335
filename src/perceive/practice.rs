//! Gaits as our avatars show them: each walked alone and straight on each avatar, and recorded as a crowd is.

use super::{Recorder, Seen, record};
use crate::avatar::Avatar;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::scenario::{AgentStart, Condition, Crowd, Geometry, Scenario, Waypoint};
use crate::sim::{Backend, Cast, Simulation, bodies, setup};
use glam::{Vec2, Vec3};

/// Between the tracks, to the side, m: farther than avoidance looks.
const APART: f32 = 6.0;
/// Room along a track, m.
const ROOM: f32 = 14.0;
/// Of a walk before and while it is recorded, s.
const WARM_UP: f32 = 1.0;
const SECONDS: f32 = 4.5;
/// Where nobody looks, m.
const NOWHERE: Vec3 = Vec3::new(-1e5, 1.6, -1e5);

/// What is seen of every labelled gait of `gaits` on every avatar, walked alone and straight in an empty place, with the
/// gaze of the scenario's condition and nobody to look at: labelled strides of the 16 joints as drawn. Bodies have sizes
/// within the scenario's range. A gait that shows no whole stride in four seconds is left out.
///
/// # Errors
/// When a gait cannot drive an avatar, or the device fails.
pub fn practice(
    gaits: &[Gait],
    avatars: Vec<Avatar>,
    scenario: &Scenario,
    (backend, device): (Backend, Option<&str>),
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Gait>, crate::Error> {
    let labelled: Vec<(u32, Emotion)> =
        (0..).zip(gaits).filter_map(|(id, gait)| Some((id, gait.label?))).collect();
    let avatar_count = u32::try_from(avatars.len()).unwrap_or(u32::MAX);
    let cast = Cast::new(gaits, avatars)?;
    let walks: Vec<(u32, u32, Emotion)> = labelled
        .iter()
        .flat_map(|&(gait, emotion)| (0..avatar_count).map(move |avatar| (gait, avatar, emotion)))
        .collect();
    let (crowd, side) = crowd(&walks, scenario);
    let mut alone = scenario.clone();
    alone.user.avoided = false;
    alone.navigation.perturbation = 0.0;
    let geometry = Geometry {
        bounds: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
            .map(|corner| (Vec2::from(corner) * 2.0 - 1.0) * (side + 3.0 * ROOM))
            .to_vec(),
        obstacles: Vec::new(),
        spawns: Vec::new(),
        routes: Vec::new(),
        ..scenario.geometry()
    };
    let mut store = setup::store(&alone, &geometry, &crowd, &cast);
    store.step.neighbour_cap = 0;
    bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    let mut simulation = Simulation::from_store(store, backend, device)?;
    let steps = |seconds: f32| {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few seconds")]
        let steps = (seconds / scenario.navigation.time_step).round() as u32;
        steps
    };
    let how = Recorder {
        warm_up: steps(WARM_UP),
        steps: steps(SECONDS),
        user_eyes: NOWHERE,
        paper_gaze: scenario.gaze.mode == crate::scenario::GazeMode::Paper,
    };
    let tracks = record(&mut simulation, &cast, &how, progress)?;
    let seen = tracks.iter().zip(&walks).filter_map(|(track, &(gait, avatar, emotion))| {
        let Seen::Walk(seen) = track.stride() else { return None };
        let played = gaits.get(gait as usize)?;
        Some(Gait {
            name: format!("{} on {}", played.name, cast.avatars().get(avatar as usize)?.name),
            source: played.source.clone(),
            subject: played.subject.clone(),
            label: Some(emotion),
            ..*seen
        })
    });
    Ok(seen.collect())
}

/// Walkers on a square of tracks about the origin, each towards +z; and half its side, m.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few thousand walkers"
)]
fn crowd(walks: &[(u32, u32, Emotion)], scenario: &Scenario) -> (Crowd, f32) {
    let side = 0.5 * (walks.len() as f32 * APART * ROOM).sqrt().max(ROOM);
    let columns = ((2.0 * side / APART).ceil() as usize).max(1);
    let [low, high] = scenario.population.scale;
    let mut crowd = Crowd::default();
    for (index, &(gait, avatar, emotion)) in walks.iter().enumerate() {
        let position = Vec2::new((index % columns) as f32 * APART, (index / columns) as f32 * ROOM) - side;
        // sizes in turn over the range, in an order that has nothing to do with gait or avatar
        let size = (index as u32).wrapping_mul(0x9e37_79b9) >> 8;
        let scale = low + (high - low) * (size as f32 / (1 << 24) as f32);
        crowd.agents.push(AgentStart {
            position,
            velocity: Vec2::ZERO,
            heading: 0.0,
            radius: scenario.navigation.radius * scale,
            emotion: emotion.weights(),
            gaits: [gait; 4],
            gait_weights: [1.0, 0.0, 0.0, 0.0],
            gazes: scenario.condition == Condition::EvaG,
            avatar,
            scale,
            colors: [0; 4],
            phase: size << 8,
            route_start: index as u32,
            route_length: 1,
            waypoint: 0,
            loops: false,
        });
        crowd.waypoints.push(Waypoint { position: position + Vec2::new(0.0, 1000.0), radius: 0.5 });
    }
    (crowd, side)
}
