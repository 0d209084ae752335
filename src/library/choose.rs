//! Which gait out of GEA(e): at random as in the paper (section 4.2; S-18), or leaning towards those that fit a walker's
//! gender or preferred speed or that show the emotion most clearly, the criteria that the paper names for future work.
//!
//! Every criterion is a weight, and the weights of a gait are multiplied: gender is 1 or 0, speed is
//! `exp(-(v - wanted)^2 / (2 tolerance^2))`, clarity is `exp(margin / temperature)` where the margin is the mean rating of
//! the wanted emotion minus the best other ("strengthen the wanted, dampen the others"; spec 1.11). A draw is a uniform
//! u32 from outside, and all arithmetic is plain, so a seed gives the same gaits on every machine.

use super::{Error, GaitLibrary, scaled};
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::gait::walker::Sex;
use crate::perception::{Perceiver, ratings};

/// Default spread of speeds around the wanted one, m/s.
pub const SPEED_TOLERANCE: f32 = 0.1;

/// Rating points that a margin of 1 between two probabilities counts as: both then range over -4 to 4.
const POINTS: f64 = 4.0;

/// What one walker asks of a gait; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wish {
    /// Walked by this sex, if any gait of the emotion is.
    pub sex: Option<Sex>,
    /// Walked at about this speed, m/s.
    pub speed: Option<f32>,
}

/// How much clearer gaits are preferred.
#[derive(Debug, Clone, PartialEq)]
pub struct Clarity {
    /// Margin of each gait of the library for its own label ([`margins`]); gaits without a label do not matter.
    pub margins: Vec<Option<f64>>,
    /// A gait whose margin is this much larger, in rating points, is e = 2.7 times as likely; 0: the clearest always.
    pub temperature: f32,
}

/// How clearly each gait of a library shows its own label, in rating points, -4 to 4: from its ratings or, if it has
/// none, from what `perceiver` sees in it. None without a label, ratings and perceiver.
pub fn margins(library: &GaitLibrary, perceiver: Option<&dyn Perceiver>) -> Vec<Option<f64>> {
    let margin = |gait: &Gait| {
        let label = gait.label?;
        match gait.ratings {
            Some(rated) => Some(ratings::margin(rated.map(f64::from), label)),
            None => Some(POINTS * ratings::margin(perceiver?.probabilities(gait), label)),
        }
    };
    library.gaits().iter().map(margin).collect()
}

/// Chooses gaits out of GEA(e).
#[derive(Debug, Clone)]
pub struct Chooser {
    /// `[emotion][anyone, female, male]`.
    classes: [[Class; 3]; 4],
    /// Gaits that the baseline may walk with where none looks neutral: unlabelled ones, or else all.
    spare: Vec<u32>,
    /// How many gaits there are, and how many of them have no label.
    gaits: [usize; 2],
    tolerance: f64,
}

/// Gaits among which is chosen.
#[derive(Debug, Clone, Default)]
struct Class {
    ids: Vec<u32>,
    /// m/s, beside `ids`.
    speeds: Vec<f64>,
    /// Logarithm of the weight by clarity, at most 0, beside `ids`; empty if all weigh alike.
    logs: Vec<f64>,
    /// Sums of the weights up to and with each gait; empty if all weigh alike.
    ends: Vec<f64>,
}

impl Chooser {
    /// A chooser that knows the ids of each emotion only: it chooses at random and heeds no wish.
    pub fn of_ids<'a>(gaits_for: impl Fn(Emotion) -> &'a [u32]) -> Self {
        let class = |emotion| Class { ids: gaits_for(emotion).to_vec(), ..Class::default() };
        let classes = Emotion::ALL.map(|emotion| [class(emotion), Class::default(), Class::default()]);
        let spare: Vec<u32> = Emotion::ALL.into_iter().flat_map(gaits_for).copied().collect();
        Self { classes, gaits: [spare.len(), 0], spare, tolerance: 0.0 }
    }

    /// A chooser for the gaits of a library. `tolerance` is the spread of speeds around a wanted one, m/s; 0: the nearest.
    ///
    /// # Errors
    /// [`Error::NoMargin`] with `clarity` if a labelled gait has no margin.
    pub fn new(library: &GaitLibrary, tolerance: f32, clarity: Option<&Clarity>) -> Result<Self, Error> {
        if let Some(clarity) = clarity {
            check(library, clarity)?;
        }
        let class = |emotion: Emotion, sex: Option<Sex>| {
            let gait = |id: u32| library.gaits().get(id as usize);
            let of_sex = |id: &u32| sex.is_none() || gait(*id).and_then(|gait| gait.provenance.sex) == sex;
            let ids: Vec<u32> = library.gaits_for(emotion).iter().copied().filter(of_sex).collect();
            let speeds = ids.iter().map(|&id| gait(id).map_or(0.0, |gait| f64::from(gait.speed))).collect();
            let logs = clarity.map_or(Vec::new(), |clarity| logs(&ids, clarity));
            let add = |sum: &mut f64, log: &f64| {
                *sum += exp(*log);
                Some(*sum)
            };
            let ends = logs.iter().scan(0.0, add).collect();
            Class { ids, speeds, logs, ends }
        };
        let kinds = [None, Some(Sex::Female), Some(Sex::Male)];
        let classes = Emotion::ALL.map(|emotion| kinds.map(|sex| class(emotion, sex)));
        let all = library.gaits();
        let mut spare: Vec<u32> =
            (0..).zip(all).filter(|(_, g)| g.label.is_none()).map(|(id, _)| id).collect();
        let gaits = [all.len(), spare.len()];
        if spare.is_empty() {
            spare.extend((0..).zip(all).map(|(id, _)| id));
        }
        Ok(Self { classes, spare, gaits, tolerance: f64::from(tolerance.max(0.0)) })
    }

    /// Ids of the gaits of an emotion, ascending.
    pub fn gaits_for(&self, emotion: Emotion) -> &[u32] {
        &self.classes[emotion.index()][0].ids
    }

    /// Ids of the gaits out of which the baseline takes the one that all walk with: the neutral ones; where there is none,
    /// those without a label, or else all.
    pub fn baseline(&self) -> &[u32] {
        match self.gaits_for(Emotion::Neutral) {
            [] => &self.spare,
            neutral => neutral,
        }
    }

    /// One of [`Self::baseline`]; `random` is a uniform u32.
    ///
    /// # Errors
    /// [`Error::NoGait`] if there is no gait at all.
    pub fn choose_baseline(&self, random: u32) -> Result<u32, Error> {
        let spare = self.spare.get(scaled(random, self.spare.len()));
        self.choose(Emotion::Neutral, Wish::default(), random).or_else(|error| spare.copied().ok_or(error))
    }

    /// How many gaits there are, and how many of them have no label, as far as that is known.
    pub const fn gait_counts(&self) -> [usize; 2] {
        self.gaits
    }

    /// A gait that looks like `emotion`, as `wish` asks if it can be; `random` is a uniform u32.
    ///
    /// Without wishes and clarity every gait is equally likely, as in the paper. A wish for a sex that walked none of the
    /// emotion's gaits is not heeded.
    ///
    /// # Errors
    /// [`Error::NoGait`] if no gait looks like `emotion`.
    pub fn choose(&self, emotion: Emotion, wish: Wish, random: u32) -> Result<u32, Error> {
        let classes = &self.classes[emotion.index()];
        let wished = match wish.sex {
            None => &classes[0],
            Some(Sex::Female) => &classes[1],
            Some(Sex::Male) => &classes[2],
        };
        let class = if wished.ids.is_empty() { &classes[0] } else { wished };
        let place = match wish.speed {
            Some(speed) if !class.speeds.is_empty() => class.near(f64::from(speed), self.tolerance, random),
            _ if class.ends.is_empty() => scaled(random, class.ids.len()),
            _ => drawn(&class.ends, random),
        };
        let counts = Emotion::ALL.map(|emotion| self.gaits_for(emotion).len());
        class.ids.get(place).copied().ok_or(Error::NoGait { emotion, counts })
    }
}

impl Class {
    /// A draw among gaits near a speed.
    fn near(&self, speed: f64, tolerance: f64, random: u32) -> usize {
        let log = |place: usize, own: f64| {
            let clarity = self.logs.get(place).copied().unwrap_or(0.0);
            // A millimetre per second is the finest tolerance: it takes the nearest.
            clarity - 0.5 * ((own - speed) / tolerance.max(1e-3)).powi(2)
        };
        let logs: Vec<f64> = self.speeds.iter().enumerate().map(|(place, &own)| log(place, own)).collect();
        let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut sum = 0.0;
        let ends = logs.iter().map(|log| {
            sum += exp(log - highest);
            sum
        });
        drawn(&ends.collect::<Vec<f64>>(), random)
    }
}

/// Every labelled gait must have a margin.
fn check(library: &GaitLibrary, clarity: &Clarity) -> Result<(), Error> {
    let lacks = |(index, gait): &(usize, &Gait)| {
        gait.label.is_some() && clarity.margins.get(*index).copied().flatten().is_none_or(f64::is_nan)
    };
    let mut missing = library.gaits().iter().enumerate().filter(lacks);
    match missing.next() {
        None => Ok(()),
        Some((_, gait)) => Err(Error::NoMargin { name: gait.name.clone(), missing: 1 + missing.count() }),
    }
}

/// Logarithms of the weights by clarity, the highest 0.
fn logs(ids: &[u32], clarity: &Clarity) -> Vec<f64> {
    let margin = |id: &u32| clarity.margins.get(*id as usize).copied().flatten().unwrap_or(f64::NEG_INFINITY);
    let highest = ids.iter().map(margin).fold(f64::NEG_INFINITY, f64::max);
    let temperature = f64::from(clarity.temperature).max(0.0);
    let log = |id: &u32| {
        let behind = margin(id) - highest;
        if temperature > 0.0 {
            behind / temperature
        } else if behind < 0.0 {
            f64::NEG_INFINITY
        } else {
            0.0
        }
    };
    ids.iter().map(log).collect()
}

/// The place that a uniform u32 falls into when `ends` are running sums of weights.
fn drawn(ends: &[f64], random: u32) -> usize {
    let total = ends.last().copied().unwrap_or(0.0);
    let at = (f64::from(random) + 0.5) / 4_294_967_296.0 * total;
    ends.partition_point(|&end| end <= at).min(ends.len().saturating_sub(1))
}

/// The exponential function for numbers up to 0, from plain arithmetic: system libraries differ in the last bit, and then
/// a draw might too. Below -700 it is 0.
fn exp(x: f64) -> f64 {
    if x <= -700.0 || x.is_nan() {
        return 0.0;
    }
    // exp(x) = 2^n exp(rest) with |rest| <= ln 2 / 2, for which the series is exact to the last bits. ln 2 is split in two so
    // that nothing is lost in the subtraction.
    const LN_2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let power = (x * std::f64::consts::LOG2_E).round();
    let rest = (x - power * LN_2_HIGH) - power * LN_2_LOW;
    let mut sum = 1.0;
    for n in (1..=14).rev() {
        sum = 1.0 + sum * rest / f64::from(n);
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "1023 - 1010 to 1023: an exponent"
    )]
    let exponent = (1023.0 + power) as u64;
    sum * f64::from_bits(exponent << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_that_of_the_system_to_twelve_digits() {
        for step in 0..7000 {
            let x = -0.1 * f64::from(step);
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-12, "{x}");
        }
        assert!(
            exp(-1e9).abs() < 1e-300 && exp(f64::NEG_INFINITY).abs() < 1e-300 && exp(f64::NAN).abs() < 1e-300
        );
    }

    #[test]
    fn draws_fall_in_proportion_and_never_outside() {
        let ends = [1.0, 1.0, 4.0];
        assert_eq!(drawn(&ends, 0), 0);
        assert_eq!(drawn(&ends, (1 << 30) - 1), 0);
        assert_eq!(drawn(&ends, 1 << 30), 2);
        assert_eq!(drawn(&ends, u32::MAX), 2);
        assert_eq!(drawn(&[], 7), 0);
    }
}
