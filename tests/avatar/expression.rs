//! Claims about faces: what each emotion does to them, and when they are at rest.

use crate::paper_gaze::{run, standing};
use gaitway::Emotion;
use gaitway::kernels::Store;
use gaitway::kernels::layout::Expression;
use gaitway::verify::cases::animation::animation;
use glam::Vec3;

const NATURAL: u32 = 0;
const PAPER: u32 = 1;

/// One agent of an emotion whose face is that of no one but the emotion.
fn plain(emotion: Emotion, mode: u32) -> Store {
    let mut store = standing(emotion, mode, Vec3::new(0.0, 1.6, 3.0));
    store.frame.individuals = 0.0;
    store.frame.expression = 1.0;
    store
}

fn face(mut store: Store) -> Expression {
    run(&mut store);
    // when it blinks is another question
    Expression { blink: 0.0, ..store.expressions[0] }
}

#[test]
fn each_emotion_has_the_face_of_its_action_units() {
    let of = |emotion| face(plain(emotion, NATURAL));
    let happy = of(Emotion::Happy);
    assert!(happy.mouth_corner > 0.9 && happy.mouth_open > 0.2, "12 and 25: {happy:?}");
    let angry = of(Emotion::Angry);
    assert!(angry.inner_brow < -0.9 && angry.inner_brow < angry.outer_brow - 0.5, "4: {angry:?}");
    assert!(angry.upper_lid > 0.1 && angry.mouth_open < -0.5, "5 and 23: {angry:?}");
    assert!(angry.fist > 0.9 && happy.fist < 0.1, "fists: {angry:?}");
    let sad = of(Emotion::Sad);
    assert!(sad.inner_brow > 0.9 && sad.inner_brow > sad.outer_brow + 0.5, "1 and 4: {sad:?}");
    assert!(sad.mouth_corner < -0.9 && sad.upper_lid < -0.2, "15: {sad:?}");
    assert_eq!(of(Emotion::Neutral), Expression::default());
}

#[test]
fn a_face_follows_the_shares_of_its_emotions_and_the_strength_of_expression() {
    let mut mixed = plain(Emotion::Happy, NATURAL);
    mixed.gait_weights[0] = [0.25, 0.0, 0.75, 0.0];
    let [happy, sad] = [Emotion::Happy, Emotion::Sad].map(|emotion| face(plain(emotion, NATURAL)));
    let corner = 0.25 * happy.mouth_corner + 0.75 * sad.mouth_corner;
    assert!((face(mixed).mouth_corner - corner).abs() < 1e-6);
    let mut faint = plain(Emotion::Sad, NATURAL);
    faint.frame.expression = 0.5;
    assert!((face(faint).inner_brow - 0.5 * sad.inner_brow).abs() < 1e-6);
}

#[test]
fn without_expression_and_in_paper_mode_faces_are_at_rest() {
    for emotion in Emotion::ALL {
        let mut none = plain(emotion, NATURAL);
        none.frame.expression = 0.0;
        assert_eq!(face(none), Expression::default());
        let mut paper = plain(emotion, PAPER);
        paper.frame.individuals = 1.0;
        assert_eq!(face(paper), Expression::default());
    }
}

#[test]
fn faces_are_individual_and_no_number_goes_farther_than_faces_are_made_for() {
    let mut store = animation(900, 4);
    store.frame.expression = 9.0;
    store.frame.individuals = 1.0;
    run(&mut store);
    let faces: Vec<&Expression> = store.expressions.iter().filter(|face| !face.blink.is_nan()).collect();
    assert!(faces.len() > 100, "{} faces", faces.len());
    for face in &faces {
        let Expression { inner_brow, outer_brow, upper_lid, mouth_corner, mouth_open, blink, fist, .. } =
            **face;
        for number in [inner_brow, outer_brow, upper_lid, mouth_corner, mouth_open] {
            assert!(number.abs() <= 1.5, "{face:?}");
        }
        assert!((0.0..=1.0).contains(&blink) && (0.0..=1.0).contains(&fist), "{face:?}");
    }
    let brows: std::collections::BTreeSet<u32> = faces.iter().map(|face| face.inner_brow.to_bits()).collect();
    assert!(brows.len() > 20, "{} kinds of brows", brows.len());
}
