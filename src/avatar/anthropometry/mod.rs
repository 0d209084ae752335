//! People's measures, and the build of a body that has them.
//!
//! A person is a sex, a stature, a weight, and how it differs from others of the same. Each measure follows from these by
//! regressions (`ansur`), corrected by age where there are figures (`by_age`). [`Build::of`] then makes a generated body as
//! long, broad and deep as that.

mod ansur;
mod build;
mod by_age;

pub use build::{Build, Size};

use super::Sex;
use ansur::{LINES, Line, RESIDUALS, WHOLE};
use std::sync::OnceLock;

/// Number of measures.
const MEASURES: usize = 19;

/// A measure of a person; girths unless another word says so.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the variants say it")]
pub enum Measure {
    CrotchHeight,
    UpperArmLength,
    HandLength,
    Head,
    ShoulderBreadth,
    Neck,
    Chest,
    ChestBreadth,
    ChestDepth,
    Waist,
    WaistBreadth,
    WaistDepth,
    Hips,
    HipBreadth,
    HipDepth,
    Biceps,
    Forearm,
    Thigh,
    Calf,
}

impl Measure {
    /// All, in the order of the tables.
    pub const ALL: [Self; MEASURES] = [
        Self::CrotchHeight,
        Self::UpperArmLength,
        Self::HandLength,
        Self::Head,
        Self::ShoulderBreadth,
        Self::Neck,
        Self::Chest,
        Self::ChestBreadth,
        Self::ChestDepth,
        Self::Waist,
        Self::WaistBreadth,
        Self::WaistDepth,
        Self::Hips,
        Self::HipBreadth,
        Self::HipDepth,
        Self::Biceps,
        Self::Forearm,
        Self::Thigh,
        Self::Calf,
    ];

    /// Girth at the height of a breadth or depth of the trunk.
    const fn of_trunk(self) -> Option<Self> {
        match self {
            Self::Chest | Self::ChestBreadth | Self::ChestDepth => Some(Self::Chest),
            Self::Waist | Self::WaistBreadth | Self::WaistDepth => Some(Self::Waist),
            Self::Hips | Self::HipBreadth | Self::HipDepth => Some(Self::Hips),
            _ => None,
        }
    }
}

/// Normal numbers of one person, one for each of [`Measure::ALL`]: how far it is from others of its stature and weight.
pub type Residuals = [f32; MEASURES];

/// Someone, of any age.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Person {
    /// Sex.
    pub sex: Sex,
    /// Age, years; none: an adult as in ANSUR II.
    pub age: Option<f32>,
    /// Stature, m.
    pub stature: f32,
    /// Weight, kg.
    pub weight: f32,
    /// How it differs from others of that stature and weight.
    pub residuals: Residuals,
}

impl Person {
    /// Someone of a stature, of the weight that is usual among adults (ANSUR II), and like most.
    pub fn average(sex: Sex, stature: f32) -> Self {
        let [body_mass_index, _] = WHOLE[sex as usize].body_mass_index;
        let weight = body_mass_index * stature * stature;
        Self { sex, age: None, stature, weight, residuals: [0.0; MEASURES] }
    }

    /// A measure, m.
    pub fn measure(&self, measure: Measure) -> f32 {
        let line = &LINES[self.sex as usize][measure as usize];
        self.by_age(measure) * line.at(self.logarithms(), self.residuals[measure as usize])
    }

    /// All of them, m.
    fn measures(&self) -> [f32; MEASURES] {
        let logarithms = self.logarithms();
        let lines = &LINES[self.sex as usize];
        let measure = |measure: Measure| {
            let number = measure as usize;
            self.by_age(measure) * lines[number].at(logarithms, self.residuals[number])
        };
        Measure::ALL.map(measure)
    }

    /// Of stature, m, and weight, kg.
    fn logarithms(&self) -> [f32; 2] {
        [self.stature, self.weight].map(libm::logf)
    }

    /// By how much more a measure is than in adults of that stature and weight.
    fn by_age(&self, measure: Measure) -> f32 {
        let line = &LINES[self.sex as usize][measure.of_trunk().unwrap_or(measure) as usize];
        self.age.map_or(1.0, |age| {
            by_age::factor(self.sex, age, measure, |stature, weight| {
                line.at([stature, weight].map(libm::logf), 0.0)
            })
        })
    }
}

impl Line {
    /// The measure for logarithms of stature, m, and weight, kg, and a residual in deviations, m.
    fn at(&self, [stature, weight]: [f32; 2], residual: f32) -> f32 {
        let log = self.intercept + self.stature * stature + self.weight * weight + self.residual * residual;
        0.001 * libm::expf(log)
    }
}

/// Stature, m, and weight, kg, of an adult, for two independent normal numbers (ANSUR II).
pub fn adult(sex: Sex, [tall, heavy]: [f32; 2]) -> [f32; 2] {
    let own = &WHOLE[sex as usize];
    let ([mean, deviation], [log_mean, log_deviation]) = (own.stature, own.log_weight);
    [mean + deviation * tall, libm::expf(log_mean + log_deviation * together(sex, [tall, heavy]))]
}

/// Stature, m, and weight, kg, of an age in years, likewise (NCHS and CDC). Stature and weight go together as they do in adults of
/// ANSUR II: the tables do not tell.
pub fn of_age(sex: Sex, age: f32, [tall, heavy]: [f32; 2]) -> [f32; 2] {
    by_age::size_at(sex, age.max(by_age::YOUNGEST), [tall, together(sex, [tall, heavy])])
}

/// A normal number that goes together with the first one as weight does with stature.
fn together(sex: Sex, [tall, heavy]: [f32; 2]) -> f32 {
    let share = WHOLE[sex as usize].correlation;
    share * tall + (1.0 - share * share).sqrt() * heavy
}

/// Body-mass index of an adult, kg/m², for a normal number (ANSUR II). It is as skewed as weights are.
pub fn body_mass_index(sex: Sex, heavy: f32) -> f32 {
    let [mean, deviation] = WHOLE[sex as usize].body_mass_index;
    let spread = libm::logf(1.0 + (deviation / mean) * (deviation / mean));
    mean * libm::expf(spread.sqrt() * heavy - 0.5 * spread)
}

/// Residuals that go together as people's do, from independent normal numbers.
pub fn correlated(sex: Sex, independent: &Residuals) -> Residuals {
    static FACTORS: OnceLock<[[Residuals; MEASURES]; 2]> = OnceLock::new();
    let factor = &FACTORS.get_or_init(|| RESIDUALS.map(|below| cholesky(&below)))[sex as usize];
    std::array::from_fn(|row| {
        let pairs = factor[row].iter().zip(independent).take(row + 1);
        pairs.map(|(share, number)| share * number).sum()
    })
}

/// The lower factor of a matrix of correlations, given below its diagonal in hundredths.
fn cholesky(below: &[i8]) -> [Residuals; MEASURES] {
    let mut factor = [[0.0_f32; MEASURES]; MEASURES];
    let mut next = below.iter();
    for row in 0..MEASURES {
        for column in 0..row {
            let correlation = 0.01 * f32::from(next.next().copied().unwrap_or(0));
            let known: f32 = (0..column).map(|k| factor[row][k] * factor[column][k]).sum();
            factor[row][column] = (correlation - known) / factor[column][column];
        }
        let rest: f32 = factor[row][..row].iter().map(|share| share * share).sum();
        factor[row][row] = (1.0 - rest).max(0.01).sqrt();
    }
    factor
}

#[cfg(test)]
mod tests;
