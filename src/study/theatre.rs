//! What a trial shows, as a scene.

use super::plan::{Stimulus, Trial};
use crate::library::GaitLibrary;
use crate::scenario::{Clothes, Condition, RouteMode, Scenario, Shares, User, Walker};
use crate::scene::{Scene, SceneBuilder};
use crate::study::error::Error;
use crate::study::file::Crowd;
use std::path::Path;

/// Side of the square in which a single agent walks, m.
const SQUARE: f32 = 20.0;
/// How far before the user it begins and turns, m.
const BEGINS: f32 = 7.0;
const TURNS: f32 = 2.0;

/// A trial and what it shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Showing {
    /// The trial.
    pub trial: Trial,
    /// What it shows; none for an instructed one.
    pub stimulus: Option<Stimulus>,
}

/// Makes scenes of what trials show. All of a study walk with the same gaits and bodies.
#[derive(Debug, Clone)]
pub struct Theatre {
    /// The gaits.
    pub library: GaitLibrary,
    /// Whether the library is a file of the study's rather than the built-in one.
    pub is_own: bool,
    /// Names or files of the bodies; none: each scene's own.
    pub avatars: Vec<String>,
    /// The people of a scene, where it is not to have its own number.
    pub agents: Option<u32>,
}

impl Theatre {
    /// The people of a study; its library lies in a folder. Without a crowd they are those of each scene.
    ///
    /// # Errors
    /// When the library cannot be read.
    pub fn load(crowd: Option<&Crowd>, folder: &Path) -> Result<Self, crate::Error> {
        let Some(Crowd { library, avatars, agents }) = crowd else {
            let library = GaitLibrary::built_in()?;
            return Ok(Self { library, is_own: false, avatars: Vec::new(), agents: None });
        };
        let library = GaitLibrary::load_glb(folder.join(library))?;
        Ok(Self { library, is_own: true, avatars: avatars.clone(), agents: *agents })
    }

    /// The scene of a trial, with a user in it.
    ///
    /// # Errors
    /// When the trial shows nothing, its scene, condition or emotion is unknown, or the scene does not fit the library.
    pub fn scene(&self, showing: &Showing) -> Result<Scene, crate::Error> {
        let seed = showing.trial.seed;
        let builder = match &showing.stimulus {
            Some(Stimulus::Scene { scene, condition }) => {
                let builder = Scene::load(scene)?.condition(condition_of(condition)?);
                let builder = self.agents.into_iter().fold(builder, SceneBuilder::agents);
                builder.change(|scenario| self.set_bodies(scenario))
            }
            Some(Stimulus::Agent { emotion, body, condition }) => {
                Scene::of(single(emotion, body)?).condition(condition_of(condition)?)
            }
            Some(Stimulus::Gait { gait }) => {
                let hint = "gaits are shown in a browser; a study in a headset shows scenes and agents";
                return Err(wrong("show", gait, "scenes or agents", hint));
            }
            None => {
                let hint = "an instructed trial asks at once; no scene is needed";
                return Err(wrong("show", "nothing", "scenes or agents", hint));
            }
        };
        let builder = builder.seed(seed).gives_way().change(|scenario| {
            scenario.put_in(User::default());
            scenario.population.faces.get_or_insert(false); // what is studied are gait and gaze
        });
        if self.is_own { builder.library(self.library.clone()).build() } else { builder.build() }
    }

    fn set_bodies(&self, scenario: &mut Scenario) {
        if !self.avatars.is_empty() {
            scenario.population.avatars.clone_from(&self.avatars);
        }
    }
}

fn wrong(key: &str, value: &str, allowed: &str, hint: &str) -> crate::Error {
    Error::value(key.to_owned(), value.to_owned(), allowed.to_owned(), hint).into()
}

fn condition_of(name: &str) -> Result<Condition, crate::Error> {
    match name {
        "baseline" => Ok(Condition::Baseline),
        "eva-o" => Ok(Condition::EvaO),
        "eva-g" => Ok(Condition::EvaG),
        other => {
            Err(wrong("condition", other, "baseline, eva-o, eva-g", "name one of the paper's conditions"))
        }
    }
}

/// One agent who walks to the user and back, in an empty square.
fn single(emotion: &str, body: &str) -> Result<Scenario, crate::Error> {
    let mut emotions = Shares { happy: 0.0, angry: 0.0, sad: 0.0, neutral: 0.0 };
    let share = match emotion {
        "happy" => &mut emotions.happy,
        "angry" => &mut emotions.angry,
        "sad" => &mut emotions.sad,
        "neutral" => &mut emotions.neutral,
        other => {
            let hint = "an agent has one of the four emotions";
            return Err(wrong("each_of", other, "happy, angry, sad, neutral", hint));
        }
    };
    *share = 1.0;
    let half = 0.5 * SQUARE;
    let mut scenario = Scenario {
        name: "agent".to_owned(),
        bounds: vec![[-half, -half], [half, -half], [half, half], [-half, half]],
        user: Some(User { position: Some([0.0; 2]), ..User::default() }),
        walkers: vec![Walker {
            position: [0.0, -BEGINS],
            waypoints: vec![[0.0, -TURNS], [0.0, -BEGINS]],
            mode: RouteMode::Loop,
            ..Walker::default()
        }],
        ..Scenario::default()
    };
    scenario.population.agents = 0;
    scenario.population.emotions = emotions;
    scenario.population.avatars = vec![body.to_owned()];
    scenario.population.clothes = Clothes::Plain; // every walker looks alike but for the walk
    Ok(scenario)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::study::plan::Role;

    fn showing(stimulus: Option<Stimulus>, seed: u64) -> Showing {
        let (part, item, block, row) = ("scenes".to_owned(), None, None, None);
        let trial = Trial { part, position: 1, item, block, row, seed, role: Role::Ordinary };
        Showing { trial, stimulus }
    }

    fn theatre() -> Theatre {
        let library = GaitLibrary::built_in().unwrap();
        Theatre { library, is_own: false, avatars: Vec::new(), agents: Some(20) }
    }

    #[test]
    fn a_scene_has_the_trials_seed_and_condition_and_a_user() {
        let crossing =
            |condition: &str| Stimulus::Scene { scene: "crossing".into(), condition: condition.into() };
        let scene = |condition, seed| theatre().scene(&showing(Some(crossing(condition)), seed)).unwrap();
        let (one, other) = (scene("eva-o", 7), scene("eva-g", 7));
        assert_eq!((one.scenario.condition, other.scenario.condition), (Condition::EvaO, Condition::EvaG));
        assert!(one.scenario.user.is_some() && one.agents() == 20 && one.gives_way);
        assert_eq!(one.scenario.population.faces, Some(false));
        // two conditions of one seed have the same people in the same places
        let places =
            |scene: &Scene| scene.crowd.agents.iter().map(|agent| agent.position).collect::<Vec<_>>();
        assert_eq!(places(&one), places(&other));
        assert_ne!(places(&one), places(&scene("eva-o", 8)));
        let bad = theatre().scene(&showing(Some(crossing("eva-x")), 7)).unwrap_err().to_string();
        assert!(bad.contains("eva-x") && bad.contains("baseline, eva-o, eva-g"), "{bad}");
    }

    #[test]
    fn an_agent_alone_has_the_emotion_and_the_body_that_are_wanted() {
        for (emotion, wanted) in [
            ("happy", Emotion::Happy),
            ("angry", Emotion::Angry),
            ("sad", Emotion::Sad),
            ("neutral", Emotion::Neutral),
        ] {
            for body in ["female", "male"] {
                let (emotion, body, condition) = (emotion.to_owned(), body.to_owned(), "eva-g".to_owned());
                let agent = Stimulus::Agent { emotion, body: body.clone(), condition };
                let scene = theatre().scene(&showing(Some(agent), 3)).unwrap();
                assert_eq!(scene.crowd.agents.len(), 1);
                assert!(scene.crowd.agents[0].emotion[wanted as usize] > 0.99);
                assert_eq!(scene.scenario.population.faces, Some(false));
                assert_eq!(scene.cast.avatars().len(), 1);
                assert_eq!(scene.cast.avatars()[0].name, body);
            }
        }
        let bad = Stimulus::Agent { emotion: "bored".into(), body: "male".into(), condition: "eva-g".into() };
        assert!(theatre().scene(&showing(Some(bad), 3)).unwrap_err().to_string().contains("bored"));
    }

    #[test]
    fn what_a_headset_does_not_show_is_refused_with_the_way_out() {
        let gait = Stimulus::Gait { gait: "walk 7".into() };
        let text = theatre().scene(&showing(Some(gait), 1)).unwrap_err().to_string();
        assert!(text.contains("walk 7"), "{text}");
        assert!(theatre().scene(&showing(None, 1)).is_err());
    }
}
