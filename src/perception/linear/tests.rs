use super::*;
use crate::perception::evaluate::Random;

/// A symmetric matrix of numbers in (-1, 1).
fn symmetric(size: usize, seed: u64) -> Matrix {
    let mut random = Random::new(seed);
    let mut matrix = Matrix::zeros(size, size);
    for i in 0..size {
        for j in 0..=i {
            matrix[(i, j)] = random.unit() * 2.0 - 1.0;
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
    matrix
}

fn difference(a: &Matrix, b: &Matrix) -> f64 {
    a.plus(-1.0, b).norm()
}

#[test]
fn eigenvectors_rebuild_the_matrix_and_are_orthonormal() {
    for size in [1, 2, 3, 7, 20, 48] {
        let matrix = symmetric(size, 5);
        let eigen = Eigen::of(&matrix).unwrap();
        assert!(difference(&eigen.apply(|v| v), &matrix) < 1e-12 * number(size), "size {size}");
        let product = eigen.vectors.times(&eigen.vectors.transposed());
        assert!(difference(&product, &Matrix::identity(size)) < 1e-12 * number(size), "size {size}");
        assert!(eigen.values.windows(2).all(|pair| pair[0] >= pair[1]));
        let mut alone = eigenvalues(&matrix).unwrap();
        alone.sort_by(|a, b| b.total_cmp(a));
        let apart = distance_squared(&alone, &eigen.values).sqrt();
        assert!(apart < 1e-12 * number(size), "size {size}: {apart}");
    }
}

#[test]
fn eigenvalues_of_the_second_difference_are_those_of_the_textbook() {
    // 2 on the diagonal, -1 beside it: 2 - 2 cos(pi k / (n + 1))
    let size = 12;
    let mut matrix = Matrix::diagonal(&vec![2.0; size]);
    for i in 1..size {
        matrix[(i, i - 1)] = -1.0;
        matrix[(i - 1, i)] = -1.0;
    }
    let eigen = Eigen::of(&matrix).unwrap();
    for (k, value) in eigen.values.iter().rev().enumerate() {
        let angle = std::f64::consts::PI * number(k + 1) / number(size + 1);
        assert!((value - (2.0 - 2.0 * angle.cos())).abs() < 1e-13);
    }
}

#[test]
fn repeated_and_zero_eigenvalues_are_found() {
    let eigen = Eigen::of(&Matrix::diagonal(&[3.0, 0.0, 3.0, 0.0])).unwrap();
    assert_eq!(eigen.values, [3.0, 3.0, 0.0, 0.0]);
    let ones = Matrix { rows: 5, columns: 5, values: vec![1.0; 25] };
    let eigen = Eigen::of(&ones).unwrap();
    assert!((eigen.values[0] - 5.0).abs() < 1e-13 && eigen.values[1..].iter().all(|v| v.abs() < 1e-13));
    assert!(eigenvalues(&Matrix::zeros(0, 0)).unwrap().is_empty());
    assert!(eigenvalues(&Matrix::diagonal(&[1.0, f64::NAN])).is_none());
}

#[test]
fn cholesky_solves_and_refuses_what_is_not_positive_definite() {
    let half = symmetric(9, 3);
    let matrix = half.times(&half.transposed()).plus(0.1, &Matrix::identity(9));
    let right: Vec<f64> = (0..9).map(number).collect();
    let factor = Cholesky::of(&matrix).unwrap();
    let x = factor.solve(&right);
    for (i, wanted) in right.iter().enumerate() {
        assert!((dot(matrix.row(i), &x) - wanted).abs() < 1e-11);
    }
    assert!(difference(&factor.whiten(&matrix), &Matrix::identity(9)) < 1e-11);
    assert!(Cholesky::of(&Matrix::diagonal(&[1.0, -1.0])).is_none());
}

#[test]
fn principal_components_of_an_ellipsoid_are_its_axes() {
    // corners of a box with half sides 1, 2, 3 along axes turned by 30 degrees about z
    let (sine, cosine) = 30_f64.to_radians().sin_cos();
    let mut points = Vec::new();
    for (a, b, c) in [(1.0, 2.0, 3.0), (1.0, 2.0, -3.0), (1.0, -2.0, 3.0), (1.0, -2.0, -3.0)] {
        for sign in [1.0, -1.0] {
            let (x, y): (f64, f64) = (sign * a, b);
            points.push(vec![cosine * x - sine * y + 5.0, sine * x + cosine * y, c - 1.0]);
        }
    }
    let pca = Pca::of(&points, 3, 1.0).unwrap();
    for (found, wanted) in pca.variances.iter().zip([9.0, 4.0, 1.0]) {
        assert!((found - wanted).abs() < 1e-12);
    }
    assert!((pca.mean[0] - 5.0).abs() < 1e-12 && (pca.mean[2] + 1.0).abs() < 1e-12);
    assert!((pca.directions[(1, 0)] * cosine + pca.directions[(1, 1)] * sine).abs() < 1e-12);
    let restored = pca.restore(&pca.project(&points[3]));
    assert!(distance_squared(&restored, &points[3]) < 1e-24);
    // 9 of 14 is 64 %, 13 of 14 is 93 %
    assert_eq!(Pca::of(&points, 3, 0.9).unwrap().variances.len(), 2);
    assert_eq!(Pca::of(&points, 1, 1.0).unwrap().variances.len(), 1);
}

#[test]
fn components_of_few_long_points_are_those_of_their_covariance() {
    let mut random = Random::new(8);
    let points: Vec<Vec<f64>> = (0..5).map(|_| (0..12).map(|_| random.unit()).collect()).collect();
    let few = Pca::of(&points, 4, 1.0).unwrap();
    let whole = Eigen::of(&covariance(&points, &mean(&points))).unwrap();
    assert_eq!(few.variances.len(), 4);
    for k in 0..4 {
        assert!((few.variances[k] - whole.values[k]).abs() < 1e-12);
        assert!((dot(few.directions.row(k), whole.vectors.row(k)).abs() - 1.0).abs() < 1e-10);
    }
    let restored = few.restore(&few.project(&points[2]));
    assert!(distance_squared(&restored, &points[2]) < 1e-20);
}
