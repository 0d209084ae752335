//! Choice out of GEA(e): at random, by gender, by speed, by margin.

use gaitway::Emotion;
use gaitway::gait::Gait;
use gaitway::gait::walker::Sex;
use gaitway::library::GaitLibrary;
use gaitway::library::choose::{Chooser, Clarity, Wish, margins};
use gaitway::perception::Perceiver;

/// Evenly spread draws.
fn draws(count: u32) -> impl Iterator<Item = u32> {
    (0..count).map(move |i| (u64::from(i) * (1 << 32) / u64::from(count)) as u32)
}

/// How often each gait of the library is chosen.
fn tally(library: &GaitLibrary, chooser: &Chooser, emotion: Emotion, wish: Wish) -> Vec<u32> {
    let mut counts = vec![0; library.gaits().len()];
    for random in draws(6000) {
        counts[chooser.choose(emotion, wish, random).unwrap() as usize] += 1;
    }
    counts
}

/// The built-in library with ratings: gait k of its class leads the second emotion by k / 4 points.
fn rated() -> GaitLibrary {
    let library = GaitLibrary::built_in().unwrap();
    let mut gaits = library.gaits().to_vec();
    for emotion in Emotion::ALL {
        for (k, &id) in library.gaits_for(emotion).iter().enumerate() {
            let mut ratings = [1.5; 4];
            ratings[(emotion.index() + 1) % 4] = 2.0;
            ratings[emotion.index()] = 2.0 + k as f32 * 0.25;
            gaits[id as usize].ratings = Some(ratings);
        }
    }
    GaitLibrary::from_gaits(gaits).unwrap()
}

#[test]
fn without_wishes_every_gait_is_equally_likely_and_as_the_library_chooses() {
    let library = GaitLibrary::built_in().unwrap();
    let chooser = Chooser::new(&library, 0.1, None).unwrap();
    let ids_only = Chooser::of_ids(|emotion| library.gaits_for(emotion));
    for emotion in Emotion::ALL {
        let counts = tally(&library, &chooser, emotion, Wish::default());
        for (id, gait) in library.gaits().iter().enumerate() {
            let want = if gait.label == Some(emotion) { 6000 / 12 } else { 0 };
            assert!(counts[id].abs_diff(want) <= 1, "{}: {}", gait.name, counts[id]);
        }
        for random in draws(97) {
            let id = chooser.choose(emotion, Wish::default(), random).unwrap();
            assert_eq!(id, library.choose(emotion, None, random).unwrap());
            assert_eq!(id, ids_only.choose(emotion, Wish::default(), random).unwrap());
        }
    }
}

#[test]
fn a_wish_for_a_sex_is_heeded_where_it_can_be() {
    let library = GaitLibrary::built_in().unwrap();
    let chooser = Chooser::new(&library, 0.1, None).unwrap();
    for sex in Sex::ALL {
        let wish = Wish { sex: Some(sex), speed: None };
        let counts = tally(&library, &chooser, Emotion::Sad, wish);
        for (gait, count) in library.gaits().iter().zip(counts) {
            let wanted = gait.label == Some(Emotion::Sad) && gait.provenance.sex == Some(sex);
            assert_eq!(count > 0, wanted, "{}", gait.name);
        }
    }
    let men: Vec<Gait> =
        library.gaits().iter().filter(|gait| gait.provenance.sex == Some(Sex::Male)).cloned().collect();
    let men = GaitLibrary::from_gaits(men).unwrap();
    let wish = Wish { sex: Some(Sex::Female), speed: Some(1.0) };
    assert!(Chooser::new(&men, 0.1, None).unwrap().choose(Emotion::Happy, wish, 5).is_ok());
}

#[test]
fn a_preferred_speed_takes_gaits_near_it() {
    let library = GaitLibrary::built_in().unwrap();
    let mean_speed = |chooser: &Chooser, speed: f32| {
        let wish = Wish { sex: None, speed: Some(speed) };
        let counts = tally(&library, chooser, Emotion::Neutral, wish);
        let sum: f32 =
            library.gaits().iter().zip(&counts).map(|(gait, &count)| gait.speed * count as f32).sum();
        sum / 6000.0
    };
    let speeds: Vec<f32> =
        library.gaits_for(Emotion::Neutral).iter().map(|&id| library.gaits()[id as usize].speed).collect();
    let (slow, fast) =
        (speeds.iter().copied().fold(9.0, f32::min), speeds.iter().copied().fold(0.0, f32::max));
    let nearest = Chooser::new(&library, 0.0, None).unwrap();
    assert!((mean_speed(&nearest, 0.1) - slow).abs() < 1e-4, "beyond the slowest it is the slowest");
    assert!((mean_speed(&nearest, 5.0) - fast).abs() < 1e-4);
    let near = Chooser::new(&library, 0.03, None).unwrap();
    let wide = Chooser::new(&library, 9.0, None).unwrap();
    let all = speeds.iter().sum::<f32>() / speeds.len() as f32;
    assert!(mean_speed(&near, slow) < mean_speed(&near, fast) - 0.1);
    assert!((mean_speed(&wide, slow) - all).abs() < 0.01, "a wide tolerance is no wish");
}

#[test]
fn margins_strengthen_clear_gaits_as_the_temperature_says() {
    let library = rated();
    let clarity = |temperature| Clarity { margins: margins(&library, None), temperature };
    let counts = |temperature| {
        let chooser = Chooser::new(&library, 0.1, Some(&clarity(temperature))).unwrap();
        let counts = tally(&library, &chooser, Emotion::Angry, Wish::default());
        library.gaits_for(Emotion::Angry).iter().map(|&id| counts[id as usize]).collect::<Vec<_>>()
    };
    let chosen = counts(0.5);
    for pair in chosen.windows(2) {
        let ratio = f64::from(pair[1]) / f64::from(pair[0]);
        assert!((ratio - (0.25_f64 / 0.5).exp()).abs() < 0.2, "{chosen:?}");
    }
    let clearest = counts(0.0);
    assert_eq!((clearest[11], clearest.iter().sum::<u32>()), (6000, 6000));
    let even = counts(100.0);
    assert!(even.iter().all(|count| count.abs_diff(500) < 12), "{even:?}");
    // Speed and clarity multiply: at 0 degrees the clearest among women's gaits.
    let chooser = Chooser::new(&library, 0.1, Some(&clarity(0.0))).unwrap();
    let women = Wish { sex: Some(Sex::Female), speed: None };
    let id = chooser.choose(Emotion::Angry, women, 77).unwrap();
    assert_eq!(library.gaits()[id as usize].name, "angry-female-5");
}

/// Sees in every gait what its speed says.
struct BySpeed;

impl Perceiver for BySpeed {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let rest = (f64::from(gait.speed) / 3.0).clamp(0.0, 1.0);
        [rest / 3.0, rest / 3.0, 1.0 - rest, rest / 3.0]
    }
}

#[test]
fn a_perceiver_stands_in_for_raters_and_without_either_there_is_an_error() {
    let library = GaitLibrary::built_in().unwrap();
    let found = margins(&library, Some(&BySpeed));
    let clarity = Clarity { margins: found, temperature: 0.0 };
    let chooser = Chooser::new(&library, 0.1, Some(&clarity)).unwrap();
    let id = chooser.choose(Emotion::Sad, Wish::default(), 3).unwrap();
    let slowest = library.gaits_for(Emotion::Sad).iter().copied();
    let speed = |id: u32| library.gaits()[id as usize].speed;
    assert_eq!(Some(id), slowest.min_by(|&a, &b| speed(a).total_cmp(&speed(b))));
    let none = Clarity { margins: margins(&library, None), temperature: 0.5 };
    let message = Chooser::new(&library, 0.1, Some(&none)).unwrap_err().to_string();
    assert!(message.contains("48") && message.contains("happy-female-0"), "{message}");
    let empty = GaitLibrary::from_gaits(Vec::new()).unwrap();
    let chooser = Chooser::new(&empty, 0.1, None).unwrap();
    assert!(chooser.choose(Emotion::Sad, Wish { sex: None, speed: Some(1.0) }, 0).is_err());
}
