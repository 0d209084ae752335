//! What an agent is like: how it feels, which gait it walks with, how it looks.
//!
//! All draws are counter-based: they depend on the seed and the agent's number alone.

use super::crowd::{AgentStart, Entry};
use super::people::person;
use super::places::Place;
use super::shares::{cumulate, weighted};
use crate::avatar::anthropometry::Build;
use crate::emotion::Emotion;
use crate::gait::walker::Sex;
use crate::ground::{ABSENT, heading_from_ground};
use crate::library::GaitLibrary;
use crate::library::blend::weights_from_affect;
use crate::library::choose::{Chooser, Clarity, Wish, margins};
use crate::perception::Perceiver;
use crate::scenario::error::Error;
use crate::scenario::file::{Affect, Condition, EmotionMode, GaitChoice, GenderChoice, Scenario};
use crate::scenario::random::{Purpose, bits, index, range, unit};
use glam::Vec2;

/// Speed at the start, m/s: an ordinary walk; the simulation goes on from there.
const START_SPEED: f32 = 1.2;

/// Emotion weights, gaits and their weights, as in [`AgentStart`].
type Feeling = ([f32; 4], [u32; 4], [f32; 4]);

/// What chooses the gaits of a scenario out of a library.
pub(super) fn chooser(
    scenario: &Scenario,
    library: &GaitLibrary,
    perceiver: Option<&dyn Perceiver>,
) -> Result<Chooser, Error> {
    let prefer = &scenario.population.prefer;
    let clarity = prefer
        .margin_temperature
        .map(|temperature| Clarity { margins: margins(library, perceiver), temperature });
    Chooser::new(library, prefer.speed_tolerance, clarity.as_ref()).map_err(|error| {
        let hint = "or leave population.prefer.margin_temperature out".to_owned();
        Error::Populate { name: scenario.name.clone(), message: error.to_string(), hint }
    })
}

/// Draws what an agent is like: emotion, gait, body, clothes.
pub(super) struct TraitSampler<'a> {
    scenario: &'a Scenario,
    chooser: &'a Chooser,
    shares: [f32; 4],
    cumulative: Vec<f32>,
}

impl<'a> TraitSampler<'a> {
    pub(super) fn new(scenario: &'a Scenario, chooser: &'a Chooser) -> Result<Self, Error> {
        let baseline = scenario.condition == Condition::Baseline;
        let shares = match scenario.population.emotion_mode {
            _ if baseline => Emotion::Neutral.weights(),
            // Who feels what is drawn agent by agent, and so is whether there is a gait for it.
            EmotionMode::Affect => [0.0; 4],
            EmotionMode::Draw | EmotionMode::Blend => scenario.population.emotions.normalised(),
        };
        let lacks = |e: &Emotion| !baseline && shares[e.index()] > 0.0 && chooser.gaits_for(*e).is_empty();
        let missing: Vec<Emotion> = Emotion::ALL.into_iter().filter(lacks).collect();
        if !missing.is_empty() {
            let why = if missing.len() == 1 { "its share is above 0" } else { "their shares are above 0" };
            return Err(no_gait(scenario, chooser, &missing, why));
        }
        Ok(Self { scenario, chooser, shares, cumulative: cumulate(shares) })
    }

    /// One gait out of GEA(e).
    fn gait(&self, agent: u32, emotion: Emotion) -> Result<u32, Error> {
        let is_baseline = self.scenario.condition == Condition::Baseline;
        // The baseline is one gait for all (S-26), so all draw as agent 0 does, and none has wishes.
        let who = if is_baseline { 0 } else { agent };
        let looks = self.chooser.gaits_for(emotion);
        let takes_any = is_baseline && looks.is_empty();
        let gaits = if takes_any { self.chooser.baseline() } else { looks };
        let chosen = match self.scenario.population.gaits {
            GaitChoice::Random => {
                let draw = u32::try_from(emotion.index()).unwrap_or(0);
                let random = bits(self.scenario.seed, who, Purpose::Gait, draw);
                let wish = if is_baseline { Wish::default() } else { self.wish(agent) };
                match takes_any {
                    true => self.chooser.choose_baseline(random).ok(),
                    false => self.chooser.choose(emotion, wish, random).ok(),
                }
            }
            GaitChoice::Cycle => gaits.get(who as usize % gaits.len().max(1)).copied(),
            GaitChoice::First => gaits.first().copied(),
        };
        chosen.ok_or_else(|| {
            no_gait(self.scenario, self.chooser, &[emotion], &format!("agent {agent} feels so"))
        })
    }

    /// What the agent asks of its gait.
    fn wish(&self, agent: u32) -> Wish {
        let (population, seed) = (&self.scenario.population, self.scenario.seed);
        let avatar = || population.gender_of(self.avatar(agent) as usize);
        let sex = match population.prefer.gender {
            GenderChoice::Any => None,
            GenderChoice::Female => Some(Sex::Female),
            GenderChoice::Male => Some(Sex::Male),
            GenderChoice::Match => avatar(),
            GenderChoice::Counter => avatar().map(|sex| match sex {
                Sex::Female => Sex::Male,
                Sex::Male => Sex::Female,
            }),
        };
        let speed = population.prefer.speed;
        Wish { sex, speed: speed.map(|[low, high]| range(seed, agent, Purpose::Speed, 0, low, high)) }
    }

    /// One gait for each emotion, for feelings that change; where the library has none, that of the strongest feeling.
    fn of_every_emotion(&self, agent: u32, weights: [f32; 4]) -> Result<Feeling, Error> {
        let by_weight = |a: &&Emotion, b: &&Emotion| weights[a.index()].total_cmp(&weights[b.index()]);
        let spare = Emotion::ALL.iter().rev().max_by(by_weight).copied().unwrap_or(Emotion::Neutral);
        let mut gaits = [self.gait(agent, spare)?; 4];
        let is_baseline = self.scenario.condition == Condition::Baseline;
        for emotion in Emotion::ALL {
            if !is_baseline && !self.chooser.gaits_for(emotion).is_empty() {
                gaits[emotion.index()] = self.gait(agent, emotion)?;
            }
        }
        Ok((weights, gaits, weights))
    }

    /// Emotion weights, gaits and their weights.
    fn feeling(&self, agent: u32) -> Result<Feeling, Error> {
        let population = &self.scenario.population;
        let is_baseline = self.scenario.condition == Condition::Baseline;
        match (population.emotion_mode, population.affect) {
            (EmotionMode::Blend, _) if !is_baseline => self.mixture(agent, self.shares),
            (EmotionMode::Affect, Some(affect)) if !is_baseline => {
                self.mixture(agent, self.drawn_affect(agent, affect))
            }
            _ => {
                let share = unit(self.scenario.seed, agent, Purpose::Emotion, 0);
                let drawn = Emotion::ALL[weighted(&self.cumulative, share).min(3)];
                if self.scenario.emotion_dynamics.is_some() {
                    return self.of_every_emotion(agent, drawn.weights());
                }
                let gait = self.gait(agent, drawn)?;
                Ok((drawn.weights(), [gait; 4], [1.0, 0.0, 0.0, 0.0]))
            }
        }
    }

    fn drawn_affect(&self, agent: u32, affect: Affect) -> [f32; 4] {
        let draw = |count: u32, [low, high]: [f32; 2]| {
            f64::from(range(self.scenario.seed, agent, Purpose::Affect, count, low, high))
        };
        weights_from_affect(draw(0, affect.valence), draw(1, affect.arousal))
    }

    /// One gait for each emotion of the mixture; where the weight is 0, one that is there anyway.
    fn mixture(&self, agent: u32, weights: [f32; 4]) -> Result<Feeling, Error> {
        if self.scenario.emotion_dynamics.is_some() {
            return self.of_every_emotion(agent, weights);
        }
        let spare = Emotion::ALL.into_iter().find(|e| weights[e.index()] > 0.0).unwrap_or(Emotion::Neutral);
        let mut gaits = [self.gait(agent, spare)?; 4];
        for emotion in Emotion::ALL {
            if weights[emotion.index()] > 0.0 {
                gaits[emotion.index()] = self.gait(agent, emotion)?;
            }
        }
        Ok((weights, gaits, weights))
    }

    fn scale(&self, agent: u32) -> f32 {
        let [low, high] = self.scenario.population.scale;
        range(self.scenario.seed, agent, Purpose::Scale, 0, low, high)
    }

    /// Every run of as many agents as there are avatars has each of them once: as many women as men.
    fn avatar(&self, agent: u32) -> u32 {
        if let Some(avatar) = person(self.scenario, agent).avatar(self.scenario, agent) {
            return avatar;
        }
        let avatars = u32::try_from(self.scenario.population.avatars.len()).unwrap_or(1).max(1);
        let shift = bits(self.scenario.seed, agent / avatars, Purpose::Avatar, 0) % avatars;
        (agent % avatars + shift) % avatars
    }

    /// A body that stands somewhere and does not gaze: of an external agent. Only one that `walks` needs a gait of the emotion.
    pub(super) fn body(&self, agent: u32, emotion: Emotion, walks: bool) -> Result<AgentStart, Error> {
        let gait = if walks { self.gait(agent, emotion)? } else { 0 };
        let avatar = self.avatar(agent);
        let (scale, build) = match walks {
            true => self.scenario.build_of(agent, avatar, self.scale(agent)),
            false => (1.0, Build::default()),
        };
        Ok(AgentStart {
            radius: self.scenario.navigation.radius,
            emotion: emotion.weights(),
            gaits: [gait; 4],
            avatar,
            scale,
            build,
            colors: colors(self.scenario.seed, agent),
            phase: bits(self.scenario.seed, agent, Purpose::Phase, 0),
            ..AgentStart::at(Vec2::ZERO)
        })
    }

    pub(super) fn agent(&self, agent: u32, place: Place, entry: Entry) -> Result<AgentStart, Error> {
        let (seed, avatar) = (self.scenario.seed, self.avatar(agent));
        let (scale, build) = self.scenario.build_of(agent, avatar, self.scale(agent));
        let (emotion, gaits, gait_weights) = self.feeling(agent)?;
        let person = person(self.scenario, agent);
        let is_there = entry == Entry::Start;
        let walks = is_there && person.reaction <= 0.0;
        let speed = if walks { START_SPEED.min(self.scenario.navigation.max_speed) } else { 0.0 };
        Ok(AgentStart {
            entry,
            elevation: place.elevation,
            velocity: place.direction * speed,
            heading: heading_from_ground(place.direction),
            radius: person.radius(&self.scenario.navigation, scale),
            emotion,
            gaits,
            gait_weights,
            gazes: self.scenario.condition == Condition::EvaG,
            avatar,
            scale,
            build,
            colors: colors(seed, agent),
            phase: bits(seed, agent, Purpose::Phase, 0),
            route_start: place.route_start,
            route_length: place.route_length,
            waypoint: place.waypoint,
            loops: place.loops,
            avoidance: Some(person.avoidance),
            speed: person.speed,
            speed_factor: person.speed_factor,
            reaction: person.reaction,
            ..AgentStart::at(if is_there { place.position } else { Vec2::splat(ABSENT) })
        })
    }
}

/// No gait looks like some of the emotions in use.
fn no_gait(scenario: &Scenario, chooser: &Chooser, missing: &[Emotion], why: &str) -> Error {
    let list = |word: &str, between: &str| {
        let words: Vec<String> = missing.iter().map(|emotion| format!("{word}{emotion}")).collect();
        words.join(between)
    };
    let [all, unlabelled] = chooser.gait_counts();
    let counted = match unlabelled {
        0 => String::new(),
        count => format!(" ({count} of its {all} gaits have no label)"),
    };
    let shares = match scenario.population.emotion_mode {
        EmotionMode::Affect => "narrow population.affect".to_owned(),
        _ => format!("give no share to {}", list("", ", ")),
    };
    Error::Populate {
        name: scenario.name.clone(),
        message: format!("the gait library has no {} gait{counted}, and {why}", list("", ", no ")),
        hint: format!(
            "label gaits (gaitway gait label LIB.glb --out LABELLED.glb, or gaitway gait import with a labels.csv beside \
             the captures: columns file, label), walk with --condition baseline, or {shares} (--emotions)"
        ),
    }
}

/// Skin, hair, top and bottom, drawn apart from the emotion, which must show in gait and gaze alone.
fn colors(seed: u64, agent: u32) -> [u32; 4] {
    const SKIN: [u32; 7] = [0xf3d3bc, 0xe6b899, 0xd29f7b, 0xb47d57, 0x8d5a3b, 0x6b4128, 0x4a2c1b];
    const HAIR: [u32; 7] = [0x1c1714, 0x33241b, 0x5a3b24, 0x8a5f35, 0xc49a58, 0x8f8b86, 0x7a2f1d];
    /// Which of them grow on each skin.
    const HAIR_OF: [&[usize]; 7] = [
        &[0, 1, 2, 3, 4, 5, 6],
        &[0, 1, 2, 3, 4, 5, 6],
        &[0, 1, 2, 3, 5],
        &[0, 1, 2, 5],
        &[0, 0, 1, 5],
        &[0, 0, 1, 5],
        &[0, 0, 0, 5],
    ];
    const TOP: [u32; 14] = [
        0x2f4b6e, 0x9a3b3b, 0x4d6b46, 0xd9d4c7, 0x33363c, 0xc78b3c, 0x6a4c7d, 0x3f8a8c, 0xb9b2a7, 0x7d5a43,
        0xcf6a57, 0x8aa5bf, 0xe3c565, 0x56606b,
    ];
    const BOTTOM: [u32; 8] = [0x2a3b55, 0x1f2226, 0x5b5348, 0x7c7465, 0x3c4a3c, 0x474c57, 0x8d8675, 0x5a3a33];
    let pick = |draw: u32, list: &[u32]| list[index(seed, agent, Purpose::Colors, draw, list.len())];
    let skin = index(seed, agent, Purpose::Colors, 0, SKIN.len());
    let hair = HAIR_OF[skin][index(seed, agent, Purpose::Colors, 1, HAIR_OF[skin].len())];
    [SKIN[skin], HAIR[hair], pick(2, &TOP), pick(3, &BOTTOM)]
}
