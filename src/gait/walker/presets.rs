//! The walks of the four emotions, as faint or as strong as the slider `expression` says.
//!
//! Two tables hold what each emotion changes. At an expression of 1 it is what perceived labels do in E-Gait (232 gaits of 92
//! people, each against the neutral mean of its own source; `gait fit --check-walker` sets both side by side). At 2 it is what
//! actors show (Bandai-Namco and `EWalk` bound it), which reads at a distance. Between them, and beyond, numbers lie on a line.

use super::style::{Body, STYLE_FIELDS, Sex, WalkerStyle};
use crate::emotion::Emotion;

/// Degrees to radians.
const DEG: f64 = std::f64::consts::PI / 180.0;

/// The expression of the gaits that crowds walk with: as actors show it.
pub const EXPRESSION: f64 = 2.0;

/// The strongest expression: a stage.
pub const MOST_EXPRESSION: f64 = 3.0;

impl WalkerStyle {
    /// The style of an emotion as a person of this sex walks it in crowds: [`WalkerStyle::expressed`] at [`EXPRESSION`].
    pub fn preset(emotion: Emotion, sex: Sex) -> Self {
        Self::expressed(emotion, sex, EXPRESSION)
    }

    /// The style of an emotion that is expressed as strongly as `expression` says: 0 is neutral, 1 as E-Gait's people are
    /// perceived, 2 as actors show it, 3 for a stage. What is outside 0 to 3 counts as the nearer end.
    pub fn expressed(emotion: Emotion, sex: Sex, expression: f64) -> Self {
        let [neutral, perceived, acted] = [Self::neutral(), Self::perceived(emotion), Self::acted(emotion)];
        let expression = expression.clamp(0.0, MOST_EXPRESSION);
        let (from, to, share) = if expression <= 1.0 {
            (neutral, perceived, expression)
        } else {
            (perceived, acted, expression - 1.0)
        };
        let mut style = neutral;
        for field in STYLE_FIELDS {
            let [low, high] = field.range;
            let value = (field.get)(&from) + ((field.get)(&to) - (field.get)(&from)) * share;
            (field.set)(&mut style, value.clamp(low, high));
        }
        style.of_sex(sex)
    }

    fn of_sex(mut self, sex: Sex) -> Self {
        self.body = Body::mean(sex);
        match sex {
            // Shorter legs take shorter, quicker steps; hips move more, shoulders less (Troje 2002).
            Sex::Female => {
                self.speed *= 0.965;
                self.cycle_time *= 0.965;
                self.step_width *= 0.82;
                self.foot_lift *= 0.92;
                self.sway *= 0.85;
                self.pelvis_turn *= 1.25;
                self.pelvis_drop *= 1.45;
                self.arm_abduction *= 0.8;
                self.bounce *= 0.92;
            }
            Sex::Male => {
                self.speed *= 1.02;
                self.shoulder_turn *= 1.2;
                self.toe_out += 0.05;
            }
        }
        self
    }

    fn neutral() -> Self {
        Self {
            body: Body::mean(Sex::Male),
            speed: 1.22,
            cycle_time: 1.14,
            duty: 0.60,
            step_width: 0.13,
            foot_lift: 0.15,
            stomp: 0.0,
            heel_rise: 62.0 * DEG,
            toe_out: 0.10,
            bounce: 0.027,
            crouch: 0.0,
            sway: 0.022,
            pelvis_turn: 5.0 * DEG,
            pelvis_drop: 3.5 * DEG,
            lean: 2.0 * DEG,
            slump: 2.0 * DEG,
            neck_flexion: 6.0 * DEG,
            nod: 1.5 * DEG,
            shoulder_turn: 4.7 * DEG,
            shoulder_lift: 0.0,
            shoulder_forward: 0.0,
            arm_swing: 13.0 * DEG,
            arm_forward: -17.0 * DEG,
            arm_abduction: 8.0 * DEG,
            elbow_flexion: 23.5 * DEG,
            elbow_swing: 25.0 * DEG,
            asymmetry: 0.0,
            knee_flexion: 0.0,
            side_lean: 0.0,
            trunk_turn: 0.0,
            arm_lag: 0.02,
            arm_cross: 0.0,
            swing_asymmetry: 0.0,
            forward_asymmetry: 0.0,
            abduction_asymmetry: 0.0,
            elbow_asymmetry: 0.0,
        }
    }

    /// As E-Gait's people are perceived.
    fn perceived(emotion: Emotion) -> Self {
        let neutral = Self::neutral();
        match emotion {
            Emotion::Happy => Self {
                speed: 1.335,
                cycle_time: 1.09,
                sway: 0.024,
                lean: 1.5 * DEG,
                slump: 1.0 * DEG,
                neck_flexion: 0.5 * DEG,
                nod: 1.7 * DEG,
                shoulder_turn: 8.0 * DEG,
                shoulder_forward: -0.006,
                arm_swing: 18.6 * DEG,
                elbow_flexion: 24.0 * DEG,
                elbow_swing: 39.0 * DEG,
                ..neutral
            },
            Emotion::Angry => Self {
                speed: 1.64,
                cycle_time: 0.96,
                duty: 0.59,
                step_width: 0.155,
                foot_lift: 0.16,
                stomp: 0.01,
                heel_rise: 70.0 * DEG,
                pelvis_turn: 6.0 * DEG,
                lean: 2.6 * DEG,
                slump: 2.2 * DEG,
                neck_flexion: 3.0 * DEG,
                nod: 1.7 * DEG,
                shoulder_turn: 7.0 * DEG,
                shoulder_lift: 0.008,
                arm_swing: 16.0 * DEG,
                arm_abduction: 11.0 * DEG,
                elbow_flexion: 24.2 * DEG,
                elbow_swing: 29.0 * DEG,
                ..neutral
            },
            Emotion::Sad => Self {
                speed: 1.0,
                cycle_time: 1.36,
                duty: 0.615,
                foot_lift: 0.135,
                bounce: 0.0258,
                sway: 0.025,
                pelvis_turn: 4.5 * DEG,
                lean: 3.0 * DEG,
                slump: 4.5 * DEG,
                neck_flexion: 8.7 * DEG,
                shoulder_lift: -0.004,
                shoulder_forward: 0.01,
                arm_swing: 9.8 * DEG,
                elbow_flexion: 27.4 * DEG,
                elbow_swing: 15.5 * DEG,
                ..neutral
            },
            Emotion::Neutral => neutral,
        }
    }

    /// As actors show it.
    fn acted(emotion: Emotion) -> Self {
        let neutral = Self::neutral();
        match emotion {
            Emotion::Happy => Self {
                speed: 1.4,
                cycle_time: 1.06,
                foot_lift: 0.16,
                heel_rise: 68.0 * DEG,
                bounce: 0.0275,
                sway: 0.026,
                pelvis_turn: 6.0 * DEG,
                pelvis_drop: 4.5 * DEG,
                lean: 1.0 * DEG,
                slump: -2.5 * DEG,
                neck_flexion: -0.5 * DEG,
                nod: 2.0 * DEG,
                shoulder_turn: 8.5 * DEG,
                shoulder_lift: 0.004,
                shoulder_forward: -0.016,
                arm_swing: 27.5 * DEG,
                arm_forward: -18.0 * DEG,
                arm_abduction: 9.5 * DEG,
                elbow_flexion: 22.0 * DEG,
                elbow_swing: 33.0 * DEG,
                ..neutral
            },
            Emotion::Angry => Self {
                speed: 1.83,
                cycle_time: 0.87,
                duty: 0.58,
                step_width: 0.165,
                foot_lift: 0.17,
                stomp: 0.008,
                heel_rise: 72.0 * DEG,
                pelvis_turn: 7.0 * DEG,
                lean: 5.5 * DEG,
                slump: 8.0 * DEG,
                neck_flexion: 1.0 * DEG,
                nod: 1.7 * DEG,
                shoulder_turn: 8.0 * DEG,
                shoulder_lift: 0.018,
                shoulder_forward: 0.012,
                arm_swing: 20.0 * DEG,
                arm_forward: -28.0 * DEG,
                arm_abduction: 14.0 * DEG,
                elbow_flexion: 34.0 * DEG,
                elbow_swing: 29.0 * DEG,
                ..neutral
            },
            Emotion::Sad => Self {
                speed: 0.79,
                cycle_time: 1.52,
                duty: 0.625,
                step_width: 0.14,
                foot_lift: 0.105,
                heel_rise: 68.0 * DEG,
                bounce: 0.016,
                sway: 0.03,
                pelvis_turn: 3.5 * DEG,
                pelvis_drop: 2.5 * DEG,
                lean: 3.0 * DEG,
                slump: 12.3 * DEG,
                neck_flexion: 11.0 * DEG,
                nod: 1.1 * DEG,
                shoulder_turn: 4.0 * DEG,
                shoulder_lift: -0.012,
                shoulder_forward: 0.028,
                arm_swing: 8.5 * DEG,
                arm_forward: -21.0 * DEG,
                arm_abduction: 6.0 * DEG,
                elbow_flexion: 20.0 * DEG,
                elbow_swing: 12.0 * DEG,
                ..neutral
            },
            Emotion::Neutral => neutral,
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "copies of the same numbers")]
mod tests {
    use super::*;

    #[test]
    fn expression_leads_from_neutral_over_people_to_actors_and_ends() {
        for (emotion, sex) in Emotion::ALL.into_iter().flat_map(|e| Sex::ALL.map(|sex| (e, sex))) {
            let at = |expression: f64| WalkerStyle::expressed(emotion, sex, expression);
            assert_eq!(at(0.0), WalkerStyle::preset(Emotion::Neutral, sex));
            assert_eq!(at(EXPRESSION), WalkerStyle::preset(emotion, sex));
            assert_eq!((at(-1.0), at(9.0)), (at(0.0), at(MOST_EXPRESSION)));
            assert_eq!(at(f64::INFINITY), at(MOST_EXPRESSION));
            let half = 0.5 * (at(1.0).neck_flexion + at(2.0).neck_flexion);
            assert!((at(1.5).neck_flexion - half).abs() < 1e-12, "{emotion}");
            for expression in [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0] {
                assert_eq!(at(expression).check(), Ok(()), "{emotion} {sex} at {expression}");
            }
        }
        let sad = |expression| WalkerStyle::expressed(Emotion::Sad, Sex::Male, expression);
        assert!(sad(1.0).speed < sad(0.0).speed && sad(2.0).speed < sad(1.0).speed);
    }

    #[test]
    fn everyone_of_every_expression_can_walk() {
        for emotion in Emotion::ALL {
            for (expression, index) in [(0.0, 1), (1.0, 2), (MOST_EXPRESSION, 3), (MOST_EXPRESSION, 4)] {
                for sex in Sex::ALL {
                    super::super::person_expressing(emotion, sex, expression, 9, index).unwrap();
                }
            }
        }
    }
}
