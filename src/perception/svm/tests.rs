use super::*;

/// Points of `count` clouds in the plane, from a small generator.
fn clouds(count: usize, each: usize) -> (Vec<Vec<f64>>, Vec<usize>) {
    let mut state = 12_345_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        count_f64(usize::try_from(state >> 40).unwrap()) / f64::from(1 << 24)
    };
    let mut points = Vec::new();
    let mut classes = Vec::new();
    for i in 0..count * each {
        let class = i % count;
        let angle = count_f64(class) / count_f64(count) * std::f64::consts::TAU;
        points.push(vec![angle.cos() + 1.4 * unit() - 0.7, angle.sin() + 1.4 * unit() - 0.7]);
        classes.push(class * 10);
    }
    (points, classes)
}

#[test]
fn two_points_are_parted_half_way_with_the_known_dual() {
    // RBF, points at distance 2: K = exp(-4 gamma); a = 2 / (2 - 2K) below C, bias 0
    let points = vec![vec![-1.0], vec![1.0]];
    let settings = Settings { c: 10.0, kernel: Kernel::Rbf(Gamma::Value(0.5)), ..Settings::default() };
    let machine = Svm::train(&points, &[0, 1], &settings).unwrap();
    let a = 1.0 / (1.0 - (-2.0_f64).exp());
    assert!((machine.machines[0].terms[0].1 - a).abs() < 1e-12);
    assert!(machine.decisions(&[0.0])[0].abs() < 1e-12);
    assert!((machine.decisions(&[-1.0])[0] - 1.0).abs() < 1e-12);
}

#[test]
fn both_schemes_learn_four_clouds_and_answer_with_their_class_numbers() {
    let (points, classes) = clouds(4, 30);
    for scheme in [Scheme::OneVersusOne, Scheme::OneVersusRest] {
        let settings = Settings { scheme, has_probabilities: true, ..Settings::default() };
        let machine = Svm::train(&points, &classes, &settings).unwrap();
        machine.validate().unwrap();
        let right = points.iter().zip(&classes).filter(|(p, c)| machine.predict(p) == **c).count();
        assert!(right > 110, "{scheme:?}: {right} of 120");
        for (point, class) in points.iter().zip(&classes) {
            let p = machine.probabilities(point).unwrap();
            assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12 && p.iter().all(|p| (0.0..=1.0).contains(p)));
            let verdict = machine.verdict(point);
            if verdict.margin > 1.0 {
                let best = machine.classes().iter().position(|c| *c == verdict.class).unwrap();
                assert!(p.iter().all(|other| *other <= p[best]), "{p:?} {verdict:?} {class}");
            }
        }
    }
}

#[test]
fn the_solution_satisfies_the_optimality_conditions() {
    let (points, classes) = clouds(2, 40);
    for kernel in [Kernel::Linear, Kernel::Rbf(Gamma::Value(2.0))] {
        let settings = Settings { c: 0.7, kernel, tolerance: 1e-9, ..Settings::default() };
        let machine = Svm::train(&points, &classes, &settings).unwrap();
        let terms = &machine.machines[0].terms;
        assert!(terms.iter().map(|t| t.1).sum::<f64>().abs() < 1e-9);
        for (i, (point, class)) in points.iter().zip(&classes).enumerate() {
            let y = if *class == 0 { 1.0 } else { -1.0 };
            let weight = terms.iter().find(|t| machine.vectors[t.0] == points[i]).map_or(0.0, |t| t.1 * y);
            let edge = y * machine.decisions(point)[0] - 1.0;
            let is_optimal = match weight {
                w if w <= 0.0 => edge > -1e-8,
                w if w >= 0.7 => edge < 1e-8,
                _ => edge.abs() < 1e-8,
            };
            assert!(is_optimal, "{kernel:?} point {i}: weight {weight}, edge {edge}");
        }
    }
}

#[test]
fn coupling_recovers_consistent_pairwise_probabilities() {
    let p = [0.1, 0.2, 0.3, 0.4];
    let pairwise: Vec<f64> = pairs(4).map(|(a, b)| p[a] / (p[a] + p[b])).collect();
    for (found, p) in platt::couple(4, &pairwise).iter().zip(p) {
        assert!((found - p).abs() < 1e-12, "{found} {p}");
    }
}

#[test]
fn the_sigmoid_is_the_most_likely_one() {
    let decisions: Vec<f64> = (-20..=20).map(|i| f64::from(i) * 0.1).collect();
    let sides: Vec<bool> = (-20..=20).map(|i| i > 3 || i % 4 == 0).collect();
    let [a, b] = platt::fit(&decisions, &sides);
    assert!(a < 0.0, "larger decisions are more probable: {a} {b}");
    let positive = count_f64(sides.iter().filter(|s| **s).count());
    let targets = [1.0 / (41.0 - positive + 2.0), (positive + 1.0) / (positive + 2.0)];
    // at the optimum the residuals are orthogonal to 1 and to the decisions
    let residual = |i: usize| targets[usize::from(sides[i])] - platt::probability([a, b], decisions[i]);
    assert!((0..41).map(residual).sum::<f64>().abs() < 1e-8);
    assert!((0..41).map(|i| residual(i) * decisions[i]).sum::<f64>().abs() < 1e-8);
}

#[test]
fn a_cache_of_two_rows_gives_the_same_solution() {
    let (points, classes) = clouds(2, 30);
    let task = smo::Task {
        points: points.iter().map(Vec::as_slice).collect(),
        sides: classes.iter().map(|&class| class == 0).collect(),
        bounds: vec![5.0; 60],
        gamma: Some(0.5),
    };
    let (large, small) = (smo::solve(&task, 1e-6), smo::solve_within(&task, 1e-6, 0));
    assert_eq!(large.terms, small.terms);
    assert_eq!(large.bias.to_bits(), small.bias.to_bits());
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let (points, classes) = clouds(4, 25);
    let settings = Settings { has_probabilities: true, ..Settings::default() };
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Svm::train(&points, &classes, &settings).unwrap())
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn search_prefers_what_the_held_out_points_prefer() {
    let (points, classes) = clouds(3, 40);
    let folds: Vec<usize> = (0..points.len()).map(|i| i / 3 % 5).collect();
    let grid = Grid { c: vec![1.0], gamma: vec![Gamma::Value(1e6), Gamma::Value(0.5)] };
    let found = search(&points, &classes, &folds, &Settings::default(), &grid).unwrap();
    assert_eq!((found.settings.c, found.settings.kernel), (1.0, Kernel::Rbf(Gamma::Value(0.5))));
    assert!(found.accuracy > 0.8);
}

#[test]
fn what_cannot_be_learned_is_refused_with_the_reason() {
    let settings = Settings::default();
    let train = |points: &[Vec<f64>], classes: &[usize], settings: &Settings| {
        Svm::train(points, classes, settings).unwrap_err().to_string()
    };
    assert!(train(&[vec![1.0]], &[0, 1], &settings).contains("2 classes"));
    assert!(train(&[vec![1.0], vec![2.0]], &[3, 3], &settings).contains("two classes"));
    assert!(train(&[vec![1.0], vec![1.0, 2.0]], &[0, 1], &settings).contains("point 1"));
    assert!(train(&[vec![1.0], vec![f64::NAN]], &[0, 1], &settings).contains("point 1"));
    let wrong = Settings { c: 0.0, ..settings };
    assert!(train(&[vec![1.0], vec![2.0]], &[0, 1], &wrong).contains("C is 0"));
}
