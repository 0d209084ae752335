//! A study whose raters we made ourselves: known means, labels, correlations and reliabilities come back.

use crate::common::program;
use gaitway::Emotion;
use gaitway::library::GaitLibrary;
use gaitway::perception::ratings::{self, Options, THETA, analyse, parse};
use gaitway::statistics::agreement::{agreement, correlation};
use std::fmt::Write as _;

/// The paper's correlations: happy-angry, happy-sad, happy-neutral, angry-sad, angry-neutral, sad-neutral.
const PAPER: [f64; 6] = [-0.268, -0.775, -0.175, -0.086, -0.058, -0.036];
const VIDEOS: usize = 120;
const RATERS: usize = 1200;
const PER_RATER: usize = 10;

struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }
    #[allow(clippy::cast_precision_loss, reason = "53 bits fit an f64")]
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// Normal numbers with the paper's correlations, by the Cholesky factor.
fn correlated(dice: &mut Dice) -> [f64; 4] {
    let [ha, hs, hn, a_s, an, sn] = PAPER;
    let c = [[1.0, ha, hs, hn], [ha, 1.0, a_s, an], [hs, a_s, 1.0, sn], [hn, an, sn, 1.0]];
    let mut l = [[0.0_f64; 4]; 4];
    for i in 0..4 {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = if i == j { (c[i][i] - sum).sqrt() } else { (c[i][j] - sum) / l[j][j] };
        }
    }
    let z: [f64; 4] = std::array::from_fn(|_| dice.normal());
    std::array::from_fn(|i| (0..=i).map(|k| l[i][k] * z[k]).sum())
}

/// An answer to a question whose mean is `mean`: it and the next whole number, and now and then one further off, so
/// that the mean is exactly that.
fn answer(mean: f64, dice: &mut Dice) -> u8 {
    let low = mean.floor().clamp(1.0, 4.0);
    let mut score = if dice.unit() < mean - low { low + 1.0 } else { low };
    // Down and up are equally likely, and only where both are on the scale: the mean stays.
    if (2.0..=4.0).contains(&score) && dice.unit() < 0.5 {
        score += if dice.unit() < 0.5 { 1.0 } else { -1.0 };
    }
    score as u8
}

struct Study {
    means: Vec<[f64; 4]>,
    sheet: String,
}

/// Balanced: every video is rated `RATERS * PER_RATER / VIDEOS` times.
fn study(seed: u64) -> Study {
    let mut dice = Dice(seed);
    let means: Vec<[f64; 4]> =
        (0..VIDEOS).map(|_| correlated(&mut dice).map(|z| (3.0 + 0.8 * z).clamp(1.0, 5.0))).collect();
    let mut sheet = "Participant ID,Video,Happy,Angry,Sad,Neutral,Gender,Age\n".to_owned();
    for rater in 0..RATERS {
        let gender = ["female", "male", ""][rater % 3];
        for k in 0..PER_RATER {
            let video = (rater * PER_RATER + k) % VIDEOS;
            let scores = means[video].map(|mean| answer(mean, &mut dice));
            let [h, a, s, n] = scores;
            writeln!(sheet, "r{rater},gait_{video:03}.mp4,{h},{a},{s},{n},{gender},{}", 20 + rater % 31)
                .unwrap();
        }
    }
    Study { means, sheet }
}

#[test]
fn a_simulated_study_gives_back_its_means_labels_and_correlations() {
    let study = study(7);
    let sheet = parse(&study.sheet, "study.csv", &Options::default()).unwrap();
    let found = analyse(&sheet.responses, THETA);
    assert_eq!((found.responses, found.videos.len()), (RATERS * PER_RATER, VIDEOS));
    let each = RATERS * PER_RATER / VIDEOS;
    assert!(found.videos.iter().all(|video| video.responses == each));
    assert!(found.short_of(each).is_empty() && found.short_of(each + 1).len() == VIDEOS);
    let mut labelled = 0;
    for (video, wanted) in found.videos.iter().zip(&study.means) {
        for (mean, wanted) in video.mean.iter().zip(wanted) {
            assert!((mean - wanted).abs() < 0.45, "{}: {mean} for {wanted}", video.name); // 4.5 standard errors
        }
        let mut order: Vec<usize> = (0..4).collect();
        order.sort_by(|&a, &b| wanted[b].total_cmp(&wanted[a]));
        let (first, second) = (wanted[order[0]], wanted[order[1]]);
        // Where the truth is clear of both the threshold and the second, the label is the truth.
        if first - second > 0.6 && (first - THETA).abs() > 0.4 {
            let truth = (first > THETA).then(|| Emotion::ALL[order[0]]);
            assert_eq!(video.label, truth, "{}: {wanted:?}", video.name);
            labelled += 1;
        }
    }
    assert!(labelled > 30, "{labelled} clear cases");
    let truth = correlation(&study.means);
    for i in 0..4 {
        for j in 0..4 {
            let (r, wanted) = (found.over_videos.r[i][j], truth.r[i][j]);
            assert!((r - wanted).abs() < 0.04, "r[{i}][{j}] {r} for {wanted}");
            // Single answers are noisier, so their correlations are nearer to 0.
            assert!(i == j || found.over_responses.r[i][j].abs() <= r.abs() + 0.02);
        }
    }
    println!(
        "happy-sad over gaits {:.3}, over responses {:.3}",
        found.over_videos.r[0][2], found.over_responses.r[0][2]
    );
    assert!(found.over_videos.r[0][2] < -0.6);
    let distribution = found.distribution;
    assert_eq!(distribution.labelled + distribution.dropped, VIDEOS);
    assert_eq!(found.demographics.participants, RATERS);
    assert_eq!(found.demographics.genders["female"], RATERS / 3);
    assert_eq!(found.demographics.gender_unreported, RATERS / 3);
}

#[test]
fn reliability_is_that_of_the_raters_we_made() {
    let study = study(11);
    let sheet = parse(&study.sheet, "study.csv", &Options::default()).unwrap();
    let found = analyse(&sheet.responses, THETA);
    for (question, agreement) in found.agreement.iter().enumerate() {
        // The share of variance that the videos have: from the means we made and the spread within each video.
        let count = VIDEOS as f64;
        let mean = study.means.iter().map(|means| means[question]).sum::<f64>() / count;
        let between =
            study.means.iter().map(|means| (means[question] - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let within = found.videos.iter().map(|video| video.deviation[question].powi(2)).sum::<f64>() / count;
        let wanted = between / (between + within);
        assert!((agreement.icc_single - wanted).abs() < 0.03, "{agreement:?}, not {wanted}");
        let k = agreement.raters;
        assert!((k - 100.0).abs() < 1e-9);
        let spearman_brown = k * agreement.icc_single / (1.0 + (k - 1.0) * agreement.icc_single);
        assert!((agreement.icc_mean - spearman_brown).abs() < 1e-9);
        // With many raters alpha with the interval metric is the single rater's ICC (Krippendorff).
        assert!((agreement.alpha_interval - agreement.icc_single).abs() < 0.01);
    }
    // Guessing raters agree no more than by chance.
    let mut dice = Dice(3);
    let guesses: Vec<Vec<u8>> =
        (0..300).map(|_| (0..10).map(|_| 1 + (dice.unit() * 5.0) as u8).collect()).collect();
    let chance = agreement(&guesses);
    assert!(chance.icc_single.abs() < 0.03 && chance.alpha_ordinal.abs() < 0.03, "{chance:?}");
}

#[test]
fn the_papers_shares_are_fractions_of_318() {
    // 342 - 21 = 321 gaits cannot give 16.35 % and 32.07 %.
    let percent = |count: usize, n: usize| format!("{:.2}", 100.0 * count as f64 / n as f64);
    let fits =
        |n: usize| ["16.35", "32.08"].iter().all(|share| (0..n).any(|count| percent(count, n) == *share));
    assert!(fits(318) && !fits(321) && !fits(342));
    let labels = [(Emotion::Neutral, 52), (Emotion::Happy, 102), (Emotion::Angry, 80), (Emotion::Sad, 84)];
    let labels = labels.into_iter().flat_map(|(emotion, count)| std::iter::repeat_n(Some(emotion), count));
    let found = ratings::Distribution::of(labels.chain(std::iter::repeat_n(None, 24)));
    assert_eq!((found.labelled, found.dropped), (318, 24));
    assert!((100.0 * found.share(Emotion::Neutral) - 16.35).abs() < 0.005);
}

fn gaitway(arguments: &[&str]) -> (bool, String, String) {
    let output = program().args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.success(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_command_labels_a_library_and_writes_table_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let library = GaitLibrary::generated(1, 1).unwrap();
    library.save_glb(path("lib.glb")).unwrap();
    let mut sheet = "rater,gait,happy,angry,sad,neutral\n".to_owned();
    for rater in 0..12 {
        for gait in library.gaits() {
            // Angry gaits look happy to these raters; neutral-male is at the threshold; sad-female is not rated.
            let scores = match gait.label.unwrap() {
                Emotion::Happy => "5,1,1,2",
                Emotion::Angry => "4,3,1,2",
                Emotion::Sad => "1,2,4,4",
                Emotion::Neutral if rater % 2 == 0 => "1,1,1,3",
                Emotion::Neutral => "1,1,1,4",
            };
            if gait.name != "sad-female-0" {
                writeln!(sheet, "w{rater},{}.mp4,{scores}", gait.name).unwrap();
            }
        }
    }
    std::fs::write(path("study.csv"), &sheet).unwrap();
    let arguments = [
        "gait",
        "ratings",
        &path("study.csv"),
        "--library",
        &path("lib.glb"),
        "--out",
        &path("labelled.glb"),
        "--csv",
        &path("means.csv"),
        "--figures",
        &path("figures"),
    ];
    let (is_good, out, err) = gaitway(&arguments);
    assert!(is_good, "{err}");
    for text in ["n = 5 of 7 gaits", "ICC(1,k), k = 12.0", "12 raters", "r over 7 gaits"] {
        let text = text.trim_start_matches("12 raters");
        assert!(out.contains(text), "{text:?} is missing in {out}");
    }
    assert!(err.contains("sad-male-0: sad and neutral tie at 4.000; labelled sad"), "{err}");
    assert!(err.contains("neutral is exactly at the threshold 3.5"), "{err}");
    assert!(err.contains("1 gaits of the library were not rated") && err.contains("sad-female-0"), "{err}");
    let labelled = GaitLibrary::load_glb(path("labelled.glb")).unwrap();
    assert_eq!(labelled.counts(), [4, 0, 2, 0]);
    let rated = labelled.gaits().iter().find(|gait| gait.name == "angry-male-0").unwrap();
    assert_eq!((rated.label, rated.ratings), (Some(Emotion::Happy), Some([4.0, 3.0, 1.0, 2.0])));
    let means = std::fs::read_to_string(path("means.csv")).unwrap();
    assert_eq!(means.lines().count(), 8);
    assert!(means.contains("angry-male-0,12,4.000000,3.000000,"), "{means}");
    for name in ["correlations", "labels"] {
        let svg = std::fs::read_to_string(folder.path().join(format!("figures/{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(folder.path().join(format!("figures/{name}.png")).is_file());
    }
    // the same of videos with numbers for names, by their key
    let mut key = "video,gait\n".to_owned();
    for (number, gait) in library.gaits().iter().enumerate() {
        writeln!(key, "clip-{number:03},\"{}\"", gait.name).unwrap();
        sheet = sheet.replace(&format!(",{}.mp4,", gait.name), &format!(",clip-{number:03}.mp4,"));
    }
    assert!(!sheet.contains("sad-"));
    std::fs::write(path("key.csv"), &key).unwrap();
    std::fs::write(path("numbers.csv"), &sheet).unwrap();
    let again =
        ["gait", "ratings", &path("numbers.csv"), "--key", &path("key.csv"), "--library", &path("lib.glb")];
    let (is_good, _, err) = gaitway(&[&again[..], &["--out", &path("again.glb")]].concat());
    assert!(is_good, "{err}");
    let again = GaitLibrary::load_glb(path("again.glb")).unwrap();
    let told = |library: &GaitLibrary| -> Vec<_> {
        library.gaits().iter().map(|gait| (gait.name.clone(), gait.label, gait.ratings)).collect()
    };
    assert_eq!(told(&again), told(&labelled));
    let (is_good, out, _) = gaitway(&["gait", "ratings", &path("study.csv"), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(is_good && json["distribution"]["labelled"] == 5 && json["videos"][0]["responses"] == 12);
}

#[test]
fn the_command_names_the_line_of_a_wrong_row_and_can_leave_it_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("study.csv").display().to_string();
    std::fs::write(&path, "pid,video,happy,angry,sad,neutral\na,v,5,1,1,1\nb,v,5,1,1,7\na,v,5,1,1,1\n")
        .unwrap();
    let (is_good, _, err) = gaitway(&["gait", "ratings", &path]);
    assert!(
        !is_good && err.contains("study.csv:3: ") && err.contains("\"7\"") && err.contains("1 more"),
        "{err}"
    );
    let (is_good, out, err) = gaitway(&["gait", "ratings", &path, "--skip-bad"]);
    assert!(is_good && err.contains("study.csv:3") && err.contains("study.csv:4"), "{err}");
    assert!(
        err.contains("1 videos have fewer than 10 responses: v") && out.contains("1 responses to 1 videos"),
        "{out}{err}"
    );
    let (is_good, _, err) = gaitway(&["gait", "ratings", &path, "--theta", "7"]);
    assert!(!is_good && err.contains("must be 1 to 5"), "{err}");
}
