//! From a person's measures to what a body is multiplied by.

use super::{LINES, MEASURES, Measure, Person};
use crate::avatar::Sex;
use crate::avatar::body::figure::{Across, Figure, Section};
use crate::kernels::layout::Physique;
use glam::Vec2;
use std::sync::OnceLock;

/// How often the three girths of a trunk are brought to what they are to be: each moves its neighbours a little.
const ROUNDS: usize = 3;
/// Least and greatest ratio of a part of the trunk.
const LEAST: f32 = 0.5;
const MOST: f32 = 2.2;

/// How a body is built beside its avatar's at the agent's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Build {
    /// Ratio of statures.
    pub stature: f32,
    /// Ratio of breadths, for bodies far away.
    pub breadth: f32,
    /// Ratios of its parts.
    pub physique: Physique,
    /// Whose it is; none: the avatar's own.
    pub size: Option<Size>,
}

/// How tall and heavy someone is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// m.
    pub stature: f32,
    /// kg.
    pub weight: f32,
    /// Years, if that counted.
    pub age: Option<f32>,
}

impl Default for Build {
    /// As the avatar.
    fn default() -> Self {
        Self { stature: 1.0, breadth: 1.0, physique: Physique::default(), size: None }
    }
}

/// What a generated body counts as: an average person of its stature.
struct Reference {
    figure: &'static Figure,
    measures: [f32; MEASURES],
}

impl Reference {
    fn of(sex: Sex) -> &'static Self {
        static REFERENCES: OnceLock<[Reference; 2]> = OnceLock::new();
        let made = REFERENCES.get_or_init(|| {
            Sex::ALL.map(|sex| {
                let figure = Figure::of(sex);
                Self { figure, measures: Person::average(sex, figure.stature).measures() }
            })
        });
        &made[sex as usize]
    }
}

impl Build {
    /// The scale at which the generated body of this sex has the legs of a person.
    pub fn scale(person: &Person) -> f32 {
        let legs = Measure::CrotchHeight;
        person.measure(legs) / Reference::of(person.sex).measures[legs as usize]
    }

    /// The stature of a person whose legs are those of the generated body at a scale, m; `legs`: their residual. Legs grow faster
    /// than statures, but a scale is to be the size of the whole.
    pub fn stature_at(sex: Sex, scale: f32, legs: f32) -> f32 {
        let spread = LINES[sex as usize][Measure::CrotchHeight as usize].residual;
        Figure::of(sex).stature * scale * libm::expf(-spread * legs)
    }

    /// That of a person on the generated body of its sex at a scale.
    pub fn of(person: &Person, scale: f32) -> Self {
        let Reference { figure, measures: average } = Reference::of(person.sex);
        let measures = person.measures();
        // over the avatar's at this scale
        let over_average =
            |measure: Measure| measures[measure as usize] / (average[measure as usize] * scale);
        let over = |measure: Measure, own: f32| measures[measure as usize] / (own * scale);
        let head = over_average(Measure::Head);
        let above = person.stature / scale - figure.root - (figure.stature - figure.head) * head;
        let trunk = above / (figure.head - figure.root);
        let across = across(&measures, figure, scale);
        let word = Physique::word;
        let physique = Physique {
            trunk_and_arms: word([trunk, over_average(Measure::UpperArmLength)]),
            head_and_shoulders: word([head, over_average(Measure::ShoulderBreadth)]),
            chest: word(across.chest.to_array()),
            waist: word(across.waist.to_array()),
            hips: word(across.hips.to_array()),
            neck_and_hands: word([over_average(Measure::Neck), over_average(Measure::HandLength)]),
            arms: word([over(Measure::Biceps, figure.upper_arm), over(Measure::Forearm, figure.forearm)]),
            legs: word([across.thigh, over(Measure::Calf, figure.calf)]),
        };
        let size = Size { stature: person.stature, weight: person.weight, age: person.age };
        Self {
            stature: size.stature / (figure.stature * scale),
            breadth: across.chest.x,
            physique,
            size: Some(size),
        }
    }
}

/// Ratios that give a trunk a person's girths, each with the person's depth over breadth.
fn across(measures: &[f32; MEASURES], figure: &Figure, scale: f32) -> Across {
    let measure = |measure: Measure| measures[measure as usize] / scale;
    let start =
        |section: &Section, breadth, depth| Vec2::new(measure(breadth), measure(depth)) / section.size;
    let mut across = Across {
        chest: start(&figure.chest, Measure::ChestBreadth, Measure::ChestDepth),
        waist: start(&figure.waist, Measure::WaistBreadth, Measure::WaistDepth),
        hips: start(&figure.hips, Measure::HipBreadth, Measure::HipDepth),
        thigh: measure(Measure::Thigh) / figure.thigh,
    };
    let limited = |ratios: Vec2| ratios.clamp(Vec2::splat(LEAST), Vec2::splat(MOST));
    let [chest, waist, hips] = [Measure::Chest, Measure::Waist, Measure::Hips].map(measure);
    for _ in 0..ROUNDS {
        across.chest = limited(across.chest * (chest / figure.chest.girth(&across)));
        across.hips = limited(across.hips * (hips / figure.hips.girth(&across)));
        across.waist = limited(across.waist * (waist / figure.waist.girth(&across)));
    }
    across
}
