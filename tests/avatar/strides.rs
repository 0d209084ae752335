//! People who go at other speeds than their gaits: what the kernels `integrate`, `pose` and `feet` make of them.

use super::stroll::{PICTURES, Seen, Walker, watch};
use gaitway::Emotion;
use gaitway::avatar::{Sex, generated};
use gaitway::gait::{JOINT_COUNT, walker};
use gaitway::kernels::layout::Stance;
use glam::Quat;

/// Shares of the gait's speed.
const SHARES: [f32; 7] = [0.25, 0.4, 0.5, 0.65, 0.8, 1.0, 1.2];

fn women() -> impl Iterator<Item = (Emotion, f32, Seen)> {
    let all = Emotion::ALL.into_iter().flat_map(|emotion| SHARES.map(|share| (emotion, share)));
    all.map(|(emotion, share)| {
        let mut walker = Walker::person(emotion, walker::Sex::Female, share);
        let speed = share * walker.speed;
        (emotion, share, watch(&mut walker, speed, 6.0 / share.sqrt()))
    })
}

#[test]
fn length_and_rate_of_strides_go_with_the_root_of_the_speed() {
    for emotion in Emotion::ALL {
        let mut own = Walker::person(emotion, walker::Sex::Male, 1.0);
        let gait = own.speed;
        let usual_length = watch(&mut own, gait, 4.0).length;
        for share in SHARES {
            let mut walker = Walker::person(emotion, walker::Sex::Male, share);
            let speed = share * walker.speed;
            let seen = watch(&mut walker, speed, 10.0);
            assert!((seen.length / usual_length - share.sqrt()).abs() < 0.001, "{emotion} {share}: {seen:?}");
            assert!((seen.strides * seen.length - 10.0 * speed).abs() < 0.01, "{emotion} {share}: {seen:?}");
        }
    }
}

#[test]
fn planted_feet_stay_on_the_ground_and_where_they_are_at_every_speed() {
    for (emotion, share, seen) in women() {
        let (mean, most) = seen.moves;
        println!(
            "{emotion} {share}: {mean} m a picture, {most} at most; {} m in all; low {}",
            seen.slide, seen.lowest
        );
        assert!(
            mean < 0.0001 && seen.slide < 0.02,
            "{emotion} at {share}: {mean} m a picture, {} in all",
            seen.slide
        );
        assert!(seen.lowest > -0.001, "{emotion} at {share}: {} m below the ground", -seen.lowest);
    }
}

#[test]
fn who_goes_slower_swings_and_bobs_less() {
    for emotion in Emotion::ALL {
        let all: Vec<Seen> = women().filter(|(own, ..)| *own == emotion).map(|(.., seen)| seen).collect();
        for (slower, faster) in all.iter().zip(&all[1..]) {
            let [bob, swing] = [slower.bob / faster.bob, slower.swing / faster.swing];
            assert!(bob < 1.0 && swing < 1.01, "{emotion}: {bob} of the bob, {swing} of the swing");
        }
        let [slowest, .., usual, _] = &all[..] else { unreachable!("there are more shares") };
        assert!(slowest.bob < 0.4 * usual.bob && slowest.swing < 0.6 * usual.swing, "{emotion}");
    }
}

/// Schwartz et al. 2008, slow, free and fast: flexion of the knee under load and in swing, degrees.
#[test]
fn knees_give_and_bend_by_speed_as_measured() {
    for (speed, load, swing) in [(0.8, 12.0, 54.0), (1.25, 19.0, 58.0), (1.7, 23.0, 60.0)] {
        let body = Walker::person(Emotion::Neutral, walker::Sex::Female, 1.0);
        let mut walker = Walker::person(Emotion::Neutral, walker::Sex::Female, speed / body.speed);
        let seen = watch(&mut walker, speed, 8.0);
        let most = |range: std::ops::Range<usize>| seen.knee[range].iter().fold(0.0, |a: f32, b| a.max(*b));
        let found = [most(5..25), most(55..90)];
        println!("{speed} m/s: {found:.1?} degrees");
        assert!((found[0] - load).abs() < 5.0 && (found[1] - swing).abs() < 10.0, "{speed} m/s: {found:?}");
    }
}

/// The largest turn of a joint from one picture to the next while a person sets off, hurries and stops, degrees.
fn largest_turn(mut walker: Walker) -> f32 {
    let own = walker.speed;
    walker.store.heading[0] = 0.0;
    walker.store.stance[0] = Stance { phase: walker.store.stance[0].phase, ..Stance::default() };
    let mut before: Option<[Quat; JOINT_COUNT]> = None;
    let mut worst = 0.0_f32;
    for picture in 0..1200u16 {
        let time = f32::from(picture) / PICTURES;
        let speed = match time {
            ..2.0 => 0.0,
            ..5.0 => own * (0.5 * (time - 2.0)).min(1.0),
            ..7.0 => 1.3 * own,
            _ => (1.3 * own - 1.5 * (time - 7.0)).max(0.0),
        };
        walker.go([0.0, speed]);
        let joints = walker.joints().map(|joint| joint.to_scale_rotation_translation().1);
        if let Some(before) = before {
            let turned = before.iter().zip(&joints).map(|(a, b)| a.angle_between(*b));
            worst = worst.max(turned.fold(0.0, f32::max));
        }
        before = Some(joints);
    }
    worst.to_degrees()
}

#[test]
fn nothing_jumps_while_somebody_sets_off_hurries_and_stops() {
    for emotion in Emotion::ALL {
        let worst = largest_turn(Walker::person(emotion, walker::Sex::Male, 1.0));
        println!("{emotion}: {worst:.1} degrees in a picture");
        assert!(worst < 7.0, "{emotion}: {worst} degrees");
    }
}

/// Knees that snap straight turn shanks by 7 degrees and more: with them the mean of all was 5.7.
#[test]
fn few_of_a_crowd_jump_when_they_hurry() {
    let mut all = Vec::new();
    for emotion in Emotion::ALL {
        for (sex, body) in walker::Sex::ALL.into_iter().zip(Sex::ALL) {
            for index in 0..6 {
                let gait = walker::person(emotion, sex, 1, index).unwrap();
                all.push(largest_turn(Walker::new(gait, generated(body), 0.0)));
            }
        }
    }
    let mean = all.iter().sum::<f32>() / all.len() as f32;
    let most = all.iter().copied().fold(0.0, f32::max);
    println!("{mean:.2} degrees in a picture in the mean, {most:.1} at most");
    assert!(mean < 5.5 && most < 9.0, "{mean} {most}");
}
