//! Gaits as our avatars show them: each walked alone and straight on each avatar, or in a crowd of a scene. The recording
//! is that of the judged crowd.

use super::{Recorder, Seen, Track, record};
use crate::avatar::Avatar;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::library::GaitLibrary;
use crate::scenario::{
    AgentStart, Avoidance, Condition, Crowd, EmotionMode, Prefer, Scenario, Shares, Stop, Way, populate_from,
};
use crate::scene::Scene;
use crate::sim::{AvatarSet, Backend};
use glam::Vec2;

/// Between the tracks, to the side, m: farther than avoidance looks.
const APART: f32 = 6.0;
/// Room along a track, m.
const ROOM: f32 = 14.0;
/// Length of a walk before and during the recording, s.
const WARM_UP: f32 = 1.0;
const SECONDS: f32 = 4.5;
/// Seconds before a crowd is recorded: it has then met.
const CROWD_WARM_UP: f32 = 5.0;
/// Fewest and most agents of a crowd: enough of each emotion and avatar, and fast.
const CROWD: [u32; 2] = [200, 1000];
/// Added to the scenario's seed: other people on other ways.
const OTHER: u64 = 0x005e_ed0f_07e5;

/// Labelled strides of the 16 joints as drawn: every labelled gait of `gaits` on every avatar, walked alone and straight in an
/// empty place. The gaze is that of the scenario's condition, without a user. Body sizes lie within the scenario's range. A
/// gait that shows no whole stride in four seconds is left out.
///
/// # Errors
/// When a gait cannot drive an avatar, or the device fails.
pub fn practice_alone(
    gaits: &[Gait],
    avatars: Vec<Avatar>,
    scenario: &Scenario,
    (backend, device): (Backend, Option<&str>),
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Gait>, crate::Error> {
    let labelled: Vec<(u32, Emotion)> =
        (0..).zip(gaits).filter_map(|(id, gait)| Some((id, gait.label?))).collect();
    let avatar_count = u32::try_from(avatars.len()).unwrap_or(u32::MAX);
    let cast = AvatarSet::new(gaits, avatars)?;
    let walks: Vec<(u32, u32, Emotion)> = labelled
        .iter()
        .flat_map(|&(gait, emotion)| (0..avatar_count).map(move |avatar| (gait, avatar, emotion)))
        .collect();
    let (crowd, side) = crowd(&walks, scenario);
    let mut alone = scenario.clone();
    alone.user = None;
    // each gait as it is
    alone.population.individuals = None;
    alone.navigation.perturbation = 0.0;
    alone.way_finding.way = Way::Straight;
    let mut scene = Scene::of_crowd(alone, crowd, cast).on(backend, device);
    let geometry = &mut scene.geometry;
    geometry.bounds = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
        .map(|corner| (Vec2::from(corner) * 2.0 - 1.0) * (side + 3.0 * ROOM))
        .to_vec();
    geometry.obstacles.clear();
    geometry.spawns.clear();
    geometry.routes.clear();
    // no agent avoids another
    let own = Avoidance { neighbour_cap: 0, ..Avoidance::of(&scene.scenario.navigation) };
    scene.crowd.agents.iter_mut().for_each(|agent| agent.avoidance = Some(own));
    let (mut simulation, _) = scene.start_with_bodies()?;
    let how = Recorder {
        user_eyes: None,
        ..Recorder::of(scenario, steps(scenario, WARM_UP), steps(scenario, SECONDS))
    };
    let tracks = record(&mut simulation, &scene.cast, &how, progress)?;
    let played = walks.iter().map(|&(gait, avatar, _)| [gait, avatar]);
    Ok(labelled_strides(&tracks, played, gaits, &scene.cast))
}

/// Labelled strides of a crowd that walks with these gaits in the place of the scenario, under its condition (`eva-o` instead
/// of `baseline`, which has one gait for all). The people are others than the scenario's own, by another seed. Emotions are
/// equally frequent, and each agent shows the emotion of one gait. One stride of each walking agent, up to 1,000.
///
/// # Errors
/// When an emotion has no gait, a gait cannot drive an avatar, or the device fails.
pub fn practice_in_crowd(
    gaits: &[Gait],
    avatars: Vec<Avatar>,
    scenario: &Scenario,
    (backend, device): (Backend, Option<&str>),
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Gait>, crate::Error> {
    let mut others = scenario.clone();
    others.seed = others.seed.wrapping_add(OTHER);
    let population = &mut others.population;
    population.agents = population.agents.clamp(CROWD[0], CROWD[1]);
    population.emotions = Shares { happy: 1.0, angry: 1.0, sad: 1.0, neutral: 1.0 };
    population.emotion_mode = EmotionMode::Draw;
    population.affect = None;
    population.prefer = Prefer::default();
    if others.condition == Condition::Baseline {
        others.condition = Condition::EvaO;
    }
    let library = GaitLibrary::from_gaits(gaits.to_vec())?;
    let crowd = populate_from(&others, &library)?;
    let cast = AvatarSet::new(gaits, avatars)?;
    let scene = Scene::of_crowd(others, crowd, cast).on(backend, device);
    let (mut simulation, _) = scene.start_with_bodies()?;
    let others = &scene.scenario;
    let how = Recorder::of(others, steps(others, CROWD_WARM_UP), steps(others, SECONDS));
    let tracks = record(&mut simulation, &scene.cast, &how, progress)?;
    let played = scene.crowd.agents.iter().map(|agent| [agent.gaits[0], agent.avatar]);
    Ok(labelled_strides(&tracks, played, gaits, &scene.cast))
}

/// The first walking stride of each track, under the name and label of the gait that was played on an avatar.
fn labelled_strides(
    tracks: &[Track],
    played: impl Iterator<Item = [u32; 2]>,
    gaits: &[Gait],
    cast: &AvatarSet,
) -> Vec<Gait> {
    let stride = |(track, [gait, avatar]): (&Track, [u32; 2])| {
        let Seen::Walk(seen) = track.stride() else { return None };
        let played = gaits.get(gait as usize)?;
        Some(Gait {
            name: format!("{} on {}", played.name, cast.avatars().get(avatar as usize)?.name),
            provenance: played.provenance.clone(),
            label: Some(track.wanted),
            ..*seen
        })
    };
    tracks.iter().zip(played).filter_map(stride).collect()
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few seconds")]
fn steps(scenario: &Scenario, seconds: f32) -> u32 {
    (seconds / scenario.navigation.time_step).round() as u32
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
        // They are drawn from the same population, with other numbers than the crowd: no person is in both.
        let (scale, build) = scenario.build_of(u32::MAX - index as u32, avatar, scale);
        crowd.agents.push(AgentStart {
            radius: scenario.navigation.radius * scale,
            emotion: emotion.weights(),
            gaits: [gait; 4],
            gazes: scenario.condition == Condition::EvaG,
            avatar,
            scale,
            build,
            phase: size << 8,
            route_start: index as u32,
            waypoint: 0,
            ..AgentStart::at(position)
        });
        crowd.stages.push(Stop::waypoint(position + Vec2::new(0.0, 1000.0), 0.5));
    }
    (crowd, side)
}
