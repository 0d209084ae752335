//! Other emotions as mixtures of the four (paper, section 3.2; S-32): from valence and arousal to weights, and gaits blended
//! phase by phase.
//!
//! Valence (unpleasant to pleasant) and arousal (calm to excited) are the axes of the circumplex model (Russell 1980, "A
//! circumplex model of affect", Journal of Personality and Social Psychology 39). The four emotions stand where Russell and
//! Mehrabian 1977 ("Evidence for a three-factor theory of emotions", Journal of Research in Personality 11) measured the
//! terms happy, angry and sad; neutral is the origin. Between them the map is ours ([`weights_from_affect`]): the direction
//! says which emotions, the distance from the origin how much of them against neutral.

use super::Error;
use crate::emotion::Emotion;
use crate::gait::{Gait, JOINT_COUNT, Joint, JointSet, Pose, Provenance};
use glam::{DVec2, Vec3};

/// Valence and arousal of the four emotions, in the order of [`Emotion::ALL`]: pleasure and arousal of Russell and
/// Mehrabian 1977; neutral is the origin.
pub const AFFECT: [[f64; 2]; 4] = [[0.81, 0.51], [-0.51, 0.59], [-0.63, -0.27], [0.0, 0.0]];

/// Frames of a blended gait.
pub const FRAMES: usize = 64;

/// Weights of the four emotions, sum 1, in the order of [`Emotion::ALL`], at `valence` and `arousal`, both -1 to 1.
///
/// Between happy and angry, and between angry and sad, the point is the weighted mean of those two and neutral; beyond the
/// line between the two, neutral is 0 and the direction alone decides. In the remaining sector (calm: from sad over low
/// arousal to happy) no emotion of the four stands, so the point is projected on the nearer of the rays of sad and happy,
/// and is neutral where it is on neither side. The map is continuous; NaN gives neutral.
pub fn weights_from_affect(valence: f64, arousal: f64) -> [f32; 4] {
    if valence.is_nan() || arousal.is_nan() {
        return Emotion::Neutral.weights();
    }
    let point = DVec2::new(valence, arousal).clamp(DVec2::NEG_ONE, DVec2::ONE);
    let [happy, angry, sad, _] = AFFECT.map(DVec2::from);
    let mut weights = [0.0; 4];
    for (a, b, first, second) in
        [(happy, angry, Emotion::Happy, Emotion::Angry), (angry, sad, Emotion::Angry, Emotion::Sad)]
    {
        // point = u a + v b; both are positive inside the sector.
        let area = a.perp_dot(b);
        let (u, v) = (point.perp_dot(b) / area, a.perp_dot(point) / area);
        if u >= 0.0 && v >= 0.0 {
            let beyond = (u + v).max(1.0);
            weights[first.index()] = u / beyond;
            weights[second.index()] = v / beyond;
            return rest(weights);
        }
    }
    for (direction, emotion) in [(happy, Emotion::Happy), (sad, Emotion::Sad)] {
        weights[emotion.index()] = (point.dot(direction) / direction.length_squared()).clamp(0.0, 1.0);
    }
    rest(weights)
}

/// The rest is neutral.
fn rest(weights: [f64; 4]) -> [f32; 4] {
    #[allow(clippy::cast_possible_truncation, reason = "a weight of 0 to 1, rounded to f32")]
    let mut weights = weights.map(|weight| weight as f32);
    weights[Emotion::Neutral.index()] = (1.0 - weights.iter().sum::<f32>()).max(0.0);
    weights
}

/// Valence and arousal of a mixture: the weighted mean of the four emotions' places.
pub fn affect_from_weights(weights: [f32; 4]) -> [f64; 2] {
    let places = AFFECT.map(DVec2::from).into_iter().zip(weights);
    places.map(|(place, weight)| place * f64::from(weight)).sum::<DVec2>().to_array()
}

/// One gait out of several, phase by phase: the poses' weighted mean, at the weighted mean of their speeds and stride
/// travels, as the engine walks a mixture. Weights need not sum to 1.
///
/// # Errors
/// [`Error::Gait`] named `name` if no weight is positive, a weight is negative or not finite, or a gait has no frames.
pub fn blend(name: &str, gaits: &[(&Gait, f32)]) -> Result<Gait, Error> {
    let wrong = |message: String| Error::Gait { name: name.to_owned(), message };
    if let Some((gait, weight)) = gaits.iter().find(|(_, weight)| !(*weight >= 0.0 && weight.is_finite())) {
        return Err(wrong(format!("the weight of {:?} is {weight}; it must be 0 or more", gait.name)));
    }
    if let Some((gait, _)) = gaits.iter().find(|(gait, _)| gait.poses.is_empty()) {
        return Err(wrong(format!("{:?} has no frames to blend", gait.name)));
    }
    let total: f32 = gaits.iter().map(|(_, weight)| weight).sum();
    if total <= 0.0 || total.is_nan() {
        return Err(wrong("all weights are 0; one must be above".to_owned()));
    }
    let mean =
        |of: &dyn Fn(&Gait) -> f32| gaits.iter().map(|(gait, weight)| of(gait) * weight / total).sum::<f32>();
    let (speed, travel) = (mean(&|gait| gait.speed), mean(&Gait::stride_travel));
    let cycle_time = if speed > 0.0 && travel > 0.0 { travel / speed } else { mean(&Gait::cycle_time) };
    let mut poses = vec![[Vec3::ZERO; JOINT_COUNT]; FRAMES];
    for (frame, pose) in poses.iter_mut().enumerate() {
        for (gait, weight) in gaits {
            let sample = at_phase(gait, frame);
            for (point, sample) in pose.iter_mut().zip(sample) {
                *point += sample * (weight / total);
            }
        }
    }
    let foot = |pose: &Pose| pose[Joint::LeftFoot as usize].y.min(pose[Joint::RightFoot as usize].y);
    let ground = poses.iter().map(foot).fold(f32::MAX, f32::min);
    for point in poses.iter_mut().flatten() {
        point.y -= ground;
    }
    let parts = gaits.iter().filter(|(_, weight)| *weight > 0.0);
    let parts: Vec<String> =
        parts.map(|(gait, weight)| format!("{:.3} {}", weight / total, gait.name)).collect();
    #[allow(clippy::cast_precision_loss, reason = "64")]
    let frame_rate = FRAMES as f32 / cycle_time;
    Ok(Gait {
        name: name.to_owned(),
        poses,
        frame_rate,
        speed,
        provenance: Provenance {
            format: "gaitway blend".to_owned(),
            take: name.to_owned(),
            notes: vec![parts.join(", ")],
            ..Provenance::default()
        },
        acted: None,
        ratings: None,
        label: None,
        missing: gaits.iter().fold(JointSet::default(), |all, (gait, _)| all.union(gait.missing)),
    })
}

/// The pose of a gait at frame `frame` of [`FRAMES`], between its own frames by periodic Catmull-Rom splines.
fn at_phase(gait: &Gait, frame: usize) -> Pose {
    let count = gait.poses.len();
    let (whole, part) = (frame * count / FRAMES, frame * count % FRAMES);
    #[allow(clippy::cast_precision_loss, reason = "below 64")]
    let t = part as f32 / FRAMES as f32;
    let [a, b, c, d] = [count - 1, 0, 1, 2].map(|shift| &gait.poses[(whole + shift) % count]);
    std::array::from_fn(|j| {
        let (a, b, c, d) = (a[j], b[j], c[j], d[j]);
        b + (c - a + (a * 2.0 - b * 5.0 + c * 4.0 - d + (b * 3.0 - c * 3.0 + d - a) * t) * t) * (t * 0.5)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::walker::{Sex, person};

    fn near(found: [f32; 4], wanted: [f32; 4]) {
        assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}, not {wanted:?}");
    }

    #[test]
    fn each_emotion_stands_at_its_own_place_and_the_middle_of_two_is_half_of_each() {
        for (emotion, [valence, arousal]) in Emotion::ALL.into_iter().zip(AFFECT) {
            near(weights_from_affect(valence, arousal), emotion.weights());
        }
        let middle = |a: usize, b: usize| [0, 1].map(|axis| 0.5 * (AFFECT[a][axis] + AFFECT[b][axis]));
        let [valence, arousal] = middle(0, 1);
        near(weights_from_affect(valence, arousal), [0.5, 0.5, 0.0, 0.0]);
        let [valence, arousal] = middle(1, 2);
        near(weights_from_affect(valence, arousal), [0.0, 0.5, 0.5, 0.0]);
        let [valence, arousal] = middle(2, 3);
        near(weights_from_affect(valence, arousal), [0.0, 0.0, 0.5, 0.5]);
        near(weights_from_affect(f64::NAN, 0.3), Emotion::Neutral.weights());
        near(weights_from_affect(0.0, -1.0), {
            let sad = 0.27 / (0.63 * 0.63 + 0.27 * 0.27);
            [0.0, 0.0, sad, 1.0 - sad]
        });
    }

    #[test]
    fn weights_are_a_continuous_partition_of_one_and_give_the_place_back_where_they_can() {
        let step = 0.01;
        for v in -100..=100 {
            for a in -100..=100 {
                let (v, a) = (f64::from(v) * step, f64::from(a) * step);
                let weights = weights_from_affect(v, a);
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{v} {a}: {weights:?}");
                assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
                for next in [weights_from_affect(v + step, a), weights_from_affect(v, a + step)] {
                    let jump = next.iter().zip(weights).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                    assert!(jump < 0.06, "{v} {a}: {weights:?} to {next:?}");
                }
                // Inside the two sectors (some neutral left, angry present) nothing is lost.
                if weights[1] > 0.01 && weights[3] > 0.01 {
                    let [back_v, back_a] = affect_from_weights(weights);
                    assert!((back_v - v).abs() < 1e-5 && (back_a - a).abs() < 1e-5, "{v} {a}");
                }
            }
        }
    }

    #[test]
    fn a_blend_stands_between_its_gaits_and_one_gait_alone_stays_itself() {
        let [happy, sad] =
            [Emotion::Happy, Emotion::Sad].map(|emotion| person(emotion, Sex::Female, 1, 0).unwrap());
        let alone = blend("alone", &[(&happy, 2.0), (&sad, 0.0)]).unwrap();
        for (pose, wanted) in alone.poses.iter().zip(&happy.poses) {
            assert!(pose.iter().zip(wanted).all(|(a, b)| a.distance(*b) < 1e-5));
        }
        assert!((alone.cycle_time() - happy.cycle_time()).abs() < 1e-5);
        let half = blend("half", &[(&happy, 1.0), (&sad, 1.0)]).unwrap();
        assert!((half.speed - 0.5 * (happy.speed + sad.speed)).abs() < 1e-5);
        assert!((half.stride_travel() - 0.5 * (happy.stride_travel() + sad.stride_travel())).abs() < 1e-4);
        let head = |gait: &Gait| gait.poses[0][Joint::Head as usize].z;
        assert!(head(&happy) < head(&half) && head(&half) < head(&sad));
        assert!(half.provenance.notes[0].contains("0.500 happy-female-0") && half.label.is_none());
        assert!(blend("none", &[(&happy, 0.0)]).is_err() && blend("none", &[]).is_err());
        assert!(blend("bad", &[(&happy, -1.0)]).unwrap_err().to_string().contains("-1"));
    }
}
