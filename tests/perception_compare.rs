//! The perceivers on E-Gait, side by side: what people see in 232 gaits of 92 people.
use gaitway::emotion::Emotion;
use gaitway::gait::{Gait, import, stride};
use gaitway::perception::Method;
use gaitway::perception::evaluate::{Grouping, Plan, evaluate};
use std::path::PathBuf;

/// E-Gait, if it is there.
fn egait() -> Option<(Vec<Gait>, Vec<Emotion>)> {
    let data = std::env::var_os("GAITWAY_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let folder = data.join("egait");
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return None;
    }
    let mut gaits = Vec::new();
    for name in ["bml", "cmu", "ewalk", "ict", "sig"] {
        let path = folder.join(format!("{name}.csv"));
        for recording in import::import_file_with(&path, &import::Options::default()).unwrap() {
            gaits.push(stride::best(&recording).unwrap());
        }
    }
    let emotions = gaits.iter().map(|gait| gait.label.unwrap()).collect();
    Some((gaits, emotions))
}

fn show(method: &dyn Method, grouping: Grouping, repeats: u64) -> f64 {
    let Some((gaits, emotions)) = egait() else { return f64::NAN };
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let plan = Plan { grouping, seeds: (0..repeats).collect() };
    let result = evaluate(method, &gaits, &emotions, &plan).unwrap();
    println!(
        "{} {}: {:.3} {:.3}",
        result.method,
        grouping.describe(),
        result.accuracy_mean,
        result.accuracy_sd
    );
    println!("  {:?} {:?}", result.recall, result.by_dataset);
    result.accuracy_mean
}

#[test]
fn perceiver_beats() {
    use gaitway::perception::affective_svm::AffectiveSvm;
    use gaitway::perception::perceiver::PhasePerceiver;
    for grouping in [Grouping::Stratified { folds: 10 }, Grouping::Subject { folds: 10 }, Grouping::Dataset] {
        show(&PhasePerceiver::default(), grouping, 10);
        for (name, svm) in AffectiveSvm::presets() {
            println!("{name}");
            show(&svm, grouping, 10);
        }
    }
}
