//! Which gaits a crowd prefers and where on the circumplex it feels, from the command line.

use crate::scenario::{Affect, EmotionMode, GaitChoice, GenderChoice, Scenario, Shares};
use clap::{Args, ValueEnum};
use std::str::FromStr;

/// Preferences among the gaits that look like an emotion; the scenario's own where left out.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct PreferenceArguments {
    /// Gaits of people of the avatar's gender (match), of the other (counter), of women, of men
    #[arg(long, value_enum, value_name = "GENDER", help_heading = "Choice of gaits")]
    gait_gender: Option<GenderName>,
    /// Gaits near a preferred speed, m/s, or near one that each agent draws from a range
    #[arg(long, value_name = "SPEED|LOW..HIGH", value_parser = range, help_heading = "Choice of gaits")]
    gait_speed: Option<[f32; 2]>,
    /// Gaits that show their emotion clearly: one that leads by POINTS more is 2.7 times as likely; needs ratings
    #[arg(long, value_name = "POINTS", help_heading = "Choice of gaits")]
    gait_margin: Option<f32>,
    /// Everyone feels a mixture by valence and arousal, -1 to 1 each; a range is drawn from
    #[arg(
        long,
        value_name = "VALENCE,AROUSAL",
        value_parser = affect,
        allow_hyphen_values = true,
        help_heading = "Choice of gaits"
    )]
    affect: Option<[[f32; 2]; 2]>,
    /// Shares of the emotions, those left out 0 [default: the scene's]
    #[arg(
        long,
        value_name = "EMOTION=SHARE,..",
        value_parser = Shares::from_str,
        conflicts_with = "affect",
        help_heading = "Choice of gaits"
    )]
    emotions: Option<Shares>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum GenderName {
    Any,
    Match,
    Counter,
    Female,
    Male,
}

impl PreferenceArguments {
    /// Puts what is given in the place of what the scenario says. Values are checked with the scenario's.
    pub(super) fn apply(&self, scenario: &mut Scenario) {
        let population = &mut scenario.population;
        if let Some(gender) = self.gait_gender {
            population.prefer.gender = match gender {
                GenderName::Any => GenderChoice::Any,
                GenderName::Match => GenderChoice::Match,
                GenderName::Counter => GenderChoice::Counter,
                GenderName::Female => GenderChoice::Female,
                GenderName::Male => GenderChoice::Male,
            };
        }
        population.prefer.speed = self.gait_speed.or(population.prefer.speed);
        population.prefer.margin_temperature = self.gait_margin.or(population.prefer.margin_temperature);
        if self.gait_gender.is_some() || self.gait_speed.is_some() || self.gait_margin.is_some() {
            population.gaits = GaitChoice::Random;
        }
        if let Some([valence, arousal]) = self.affect {
            population.emotion_mode = EmotionMode::Affect;
            population.affect = Some(Affect { valence, arousal });
        }
        if let Some(emotions) = self.emotions {
            population.emotions = emotions;
            if population.affect.take().is_some() {
                population.emotion_mode = EmotionMode::Draw;
            }
        }
    }
}

/// A number, or two with `..` between them.
fn range(text: &str) -> Result<[f32; 2], String> {
    let number = |text: &str| text.trim().parse::<f32>().map_err(|error| format!("{text:?}: {error}"));
    match text.split_once("..") {
        Some((low, high)) => Ok([number(low)?, number(high)?]),
        None => Ok([number(text)?; 2]),
    }
}

fn affect(text: &str) -> Result<[[f32; 2]; 2], String> {
    let (valence, arousal) =
        text.split_once(',').ok_or("use VALENCE,AROUSAL, such as -0.5,0.6 or -1..1,0.2")?;
    Ok([range(valence)?, range(arousal)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_ranges_are_read_and_put_into_the_scenario() {
        assert_eq!(range("1.2"), Ok([1.2, 1.2]));
        assert_eq!(range("-0.5..1"), Ok([-0.5, 1.0]));
        assert!(range("1..x").is_err() && affect("0.5").is_err());
        let mut scenario = Scenario::builtin("garden").unwrap();
        let before = scenario.clone();
        PreferenceArguments::default().apply(&mut scenario);
        assert_eq!(scenario, before);
        let arguments = PreferenceArguments {
            gait_gender: Some(GenderName::Counter),
            affect: Some(affect("-1..0, 0.25").unwrap()),
            ..PreferenceArguments::default()
        };
        arguments.apply(&mut scenario);
        assert_eq!(scenario.population.prefer.gender, GenderChoice::Counter);
        assert_eq!(scenario.population.affect, Some(Affect { valence: [-1.0, 0.0], arousal: [0.25; 2] }));
        assert!(scenario.validate().is_ok());
        let sad = Shares { sad: 1.0, ..Shares::default() };
        PreferenceArguments { emotions: Some(sad), ..PreferenceArguments::default() }.apply(&mut scenario);
        assert_eq!((scenario.population.emotions, scenario.population.affect), (sad, None));
        assert!(scenario.validate().is_ok());
    }
}
