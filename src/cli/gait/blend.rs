//! `gaitway gait blend`: one gait that shows a mixture of the four emotions, by weights or by valence and arousal.

use crate::Error;
use crate::cli::output::say;
use crate::cli::scene::library;
use crate::cli::usage;
use crate::emotion::Emotion;
use crate::library::GaitLibrary;
use crate::library::blend::{affect_from_weights, blend, weights_from_affect};
use crate::library::choose::{Chooser, SPEED_TOLERANCE, Wish};
use crate::scenario::random::{Purpose, bits};
use crate::spelling::UnknownName;
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait blend --weights happy=0.7,angry=0.3 --out eager.glb\n  gaitway gait blend \
                  --affect -0.3,0.5 --sex female --out tense.csv\n\nValence is unpleasant to pleasant, arousal calm to \
                  excited, -1 to 1 each; happy is at 0.81,0.51, angry at -0.51,0.59, sad at -0.63,-0.27 and neutral at \
                  0,0 (Russell and Mehrabian 1977)."
)]
pub(super) struct BlendArguments {
    /// Weight of each emotion, any scale
    #[arg(long, value_name = "EMOTION=W,...", value_parser = weights, required_unless_present = "affect")]
    weights: Option<[f32; 4]>,
    /// Where on the circumplex instead
    #[arg(long, value_name = "VALENCE,AROUSAL", value_parser = affect, allow_hyphen_values = true, conflicts_with = "weights")]
    affect: Option<[f64; 2]>,
    /// Gaits to blend [default: the built-in library]
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Take gaits of this sex only [default: both]
    #[arg(long, value_enum)]
    sex: Option<super::SexName>,
    /// Seed of the choice among the gaits of each emotion
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// .csv (joint positions of three strides over the ground) or .glb (library of one gait)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &BlendArguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let weights = match (arguments.weights, arguments.affect) {
        (Some(weights), _) => weights,
        (None, Some([valence, arousal])) => weights_from_affect(valence, arousal),
        (None, None) => Emotion::Neutral.weights(),
    };
    let library = library(arguments.library.as_deref())?;
    let chooser = Chooser::new(&library, SPEED_TOLERANCE, None)?;
    let wish = Wish { sex: arguments.sex.map(super::SexName::sex), speed: None };
    let mut parts = Vec::new();
    for emotion in Emotion::ALL.into_iter().filter(|emotion| weights[emotion.index()] > 0.0) {
        let draw = u32::try_from(emotion.index()).unwrap_or(0);
        let id = chooser.choose(emotion, wish, bits(arguments.seed, 0, Purpose::Gait, draw))?;
        parts.extend(library.gaits().get(id as usize).map(|gait| (gait, weights[emotion.index()])));
    }
    let name = arguments.out.file_stem().map_or("blend".into(), |stem| stem.to_string_lossy());
    let gait = blend(&name, &parts)?;
    match arguments.out.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => super::write_csv(&gait, &arguments.out)?,
        Some("glb") => GaitLibrary::from_gaits(vec![gait.clone()])?.save_glb(&arguments.out)?,
        _ => {
            let out = arguments.out.display();
            return Err(usage(format!("--out {out}: neither .csv nor .glb"), "such as --out mixed.glb"));
        }
    }
    let total: f32 = weights.iter().sum();
    let shares = weights.map(|weight| weight / total);
    let [valence, arousal] = affect_from_weights(shares);
    let words = Emotion::ALL.map(|emotion| format!("{emotion} {:.3}", shares[emotion.index()]));
    say(&format!("weights    {}", words.join(", ")));
    say(&format!("at         valence {valence:.2}, arousal {arousal:.2}"));
    super::list(&[gait], vec![arguments.out.clone()], begin, false)?;
    Ok(true)
}

fn weights(text: &str) -> Result<[f32; 4], String> {
    let mut weights = [0.0; 4];
    for part in text.split(',') {
        let (name, value) = part.split_once('=').ok_or("use EMOTION=WEIGHT, such as happy=0.7,angry=0.3")?;
        let emotion: Emotion = name.trim().parse().map_err(|error: UnknownName| error.to_string())?;
        weights[emotion.index()] = match value.trim().parse::<f32>() {
            Ok(weight) if (0.0..=1e6).contains(&weight) => weight,
            _ => {
                return Err(format!(
                    "the weight of {emotion} is {value:?}; it must be a number of 0 or more"
                ));
            }
        };
    }
    if weights.iter().all(|&weight| weight <= 0.0) {
        return Err("all weights are 0; one must be above".to_owned());
    }
    Ok(weights)
}

fn affect(text: &str) -> Result<[f64; 2], String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [valence, arousal] if valence.abs() <= 1.0 && arousal.abs() <= 1.0 => Ok([valence, arousal]),
        _ => Err("use VALENCE,AROUSAL, -1 to 1 each, such as -0.5,0.6".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_and_places_are_read_or_refused_with_the_reason() {
        assert_eq!(weights("sad=1, happy=0.5"), Ok([0.5, 0.0, 1.0, 0.0]));
        for (text, part) in
            [("sad", "EMOTION=WEIGHT"), ("glad=1", "glad"), ("sad=-1", "-1"), ("sad=0", "all weights")]
        {
            assert!(weights(text).unwrap_err().contains(part), "{text}");
        }
        assert_eq!(affect("-0.5, 1"), Ok([-0.5, 1.0]));
        assert!(affect("0.5").is_err() && affect("2,0").is_err() && affect("nan,0").is_err());
    }
}
