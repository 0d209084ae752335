//! The linear algebra of perception: small dense symmetric matrices in f64.
//!
//! A few hundred lines instead of a library, because all that is needed is solving, eigenvalues and principal
//! components of matrices of some tens of rows, with the same bits everywhere.

/// A matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The numbers, row by row.
    pub values: Vec<f64>,
}

impl Matrix {
    /// All zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// Ones on the diagonal.
    pub fn identity(size: usize) -> Self {
        Self::diagonal(&vec![1.0; size])
    }

    /// A square matrix with this diagonal.
    pub fn diagonal(values: &[f64]) -> Self {
        let mut matrix = Self::zeros(values.len(), values.len());
        for (i, &value) in values.iter().enumerate() {
            matrix[(i, i)] = value;
        }
        matrix
    }

    /// Row `row`.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// Row `row`, to be changed.
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.values[row * self.columns..(row + 1) * self.columns]
    }

    /// Rows for columns.
    pub fn transposed(&self) -> Self {
        let mut result = Self::zeros(self.columns, self.rows);
        for i in 0..self.rows {
            for j in 0..self.columns {
                result[(j, i)] = self[(i, j)];
            }
        }
        result
    }

    /// `self * other`; `other` has as many rows as `self` columns.
    pub fn times(&self, other: &Self) -> Self {
        let mut result = Self::zeros(self.rows, other.columns);
        for i in 0..self.rows {
            for k in 0..self.columns.min(other.rows) {
                let factor = self[(i, k)];
                for (to, from) in result.row_mut(i).iter_mut().zip(other.row(k)) {
                    *to += factor * from;
                }
            }
        }
        result
    }

    /// `self + factor * other`, of one size.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut result = self.clone();
        for (to, from) in result.values.iter_mut().zip(&other.values) {
            *to += factor * from;
        }
        result
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.rows.min(self.columns)).map(|i| self[(i, i)]).sum()
    }

    /// Root of the sum of squares of all numbers (Frobenius).
    pub fn norm(&self) -> f64 {
        self.values.iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

impl std::ops::Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.values[row * self.columns + column]
    }
}

impl std::ops::IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.values[row * self.columns + column]
    }
}

/// Dot product, of the shorter length; in four sums, which need not wait for each other.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, a_rest) = a[..length].as_chunks::<4>();
    let (b, b_rest) = b[..length].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Squared distance, of the shorter length.
pub fn distance_squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// A count as a number.
#[allow(clippy::cast_precision_loss, reason = "counts of gaits, frames and features are far below 2^53")]
pub fn number(count: usize) -> f64 {
    count as f64
}

/// Mean of points of one length; empty of no points.
pub fn mean<P: AsRef<[f64]>>(points: &[P]) -> Vec<f64> {
    let mut sum = vec![0.0; points.first().map_or(0, |point| point.as_ref().len())];
    for point in points {
        for (to, from) in sum.iter_mut().zip(point.as_ref()) {
            *to += from;
        }
    }
    sum.iter().map(|s| s / number(points.len())).collect()
}

/// Covariance of points of one length about `centre`, divided by their number.
pub fn covariance<P: AsRef<[f64]>>(points: &[P], centre: &[f64]) -> Matrix {
    let size = centre.len();
    let mut result = Matrix::zeros(size, size);
    let mut away = vec![0.0; size];
    for point in points {
        for ((to, from), centre) in away.iter_mut().zip(point.as_ref()).zip(centre) {
            *to = from - centre;
        }
        for i in 0..size {
            let factor = away[i];
            for (to, from) in result.row_mut(i)[..=i].iter_mut().zip(&away) {
                *to += factor * from;
            }
        }
    }
    let count = number(points.len().max(1));
    for i in 0..size {
        for j in 0..=i {
            result[(i, j)] /= count;
            result[(j, i)] = result[(i, j)];
        }
    }
    result
}

/// The lower triangle `L` with `L L^T = matrix`.
#[derive(Debug, Clone, PartialEq)]
pub struct Cholesky(Matrix);

impl Cholesky {
    /// Factors a symmetric matrix (of which the lower triangle is read); none if it is not positive definite.
    pub fn of(matrix: &Matrix) -> Option<Self> {
        let size = matrix.rows;
        let mut lower = Matrix::zeros(size, size);
        for i in 0..size {
            for j in 0..=i {
                let rest = matrix[(i, j)] - dot(&lower.row(i)[..j], &lower.row(j)[..j]);
                if i != j {
                    lower[(i, j)] = rest / lower[(j, j)];
                } else if rest > 0.0 && rest.is_finite() {
                    lower[(i, i)] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        Some(Self(lower))
    }

    /// `x` of `matrix x = right`.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let lower = &self.0;
        let mut x = self.forward(right);
        for i in (0..lower.rows).rev() {
            x[i] /= lower[(i, i)];
            let known = x[i];
            for (to, from) in x[..i].iter_mut().zip(lower.row(i)) {
                *to -= known * from;
            }
        }
        x
    }

    /// `x` of `L x = right`.
    pub fn forward(&self, right: &[f64]) -> Vec<f64> {
        let lower = &self.0;
        let mut x: Vec<f64> = right.to_vec();
        for i in 0..lower.rows {
            x[i] = (x[i] - dot(&lower.row(i)[..i], &x[..i])) / lower[(i, i)];
        }
        x
    }

    /// `L^-1 matrix L^-T`, symmetric like `matrix`.
    pub fn whiten(&self, matrix: &Matrix) -> Matrix {
        let mut half = matrix.clone();
        for i in 0..half.rows {
            let solved = self.forward(matrix.row(i));
            half.row_mut(i).copy_from_slice(&solved);
        }
        let half = half.transposed();
        let mut whole = half.clone();
        for i in 0..half.rows {
            let solved = self.forward(half.row(i));
            whole.row_mut(i).copy_from_slice(&solved);
        }
        whole
    }
}

/// Eigenvalues of a symmetric matrix, from the largest, with their vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct Eigen {
    /// Eigenvalues, descending.
    pub values: Vec<f64>,
    /// The unit eigenvector of each value, as rows.
    pub vectors: Matrix,
}

impl Eigen {
    /// Of a symmetric matrix: Householder reflections to three diagonals, then QL with implicit shifts (Golub and
    /// Van Loan, sections 8.3.1 and 8.3.3). None if it is not finite.
    pub fn of(matrix: &Matrix) -> Option<Self> {
        let (mut diagonal, mut beside, mut vectors) = three_diagonals(matrix, true)?;
        diagonalise(&mut diagonal, &mut beside, Some(&mut vectors))?;
        let mut order: Vec<usize> = (0..diagonal.len()).collect();
        order.sort_by(|&a, &b| diagonal[b].total_cmp(&diagonal[a]));
        let mut sorted = Matrix::zeros(vectors.rows, vectors.columns);
        for (to, &from) in order.iter().enumerate() {
            sorted.row_mut(to).copy_from_slice(vectors.row(from));
        }
        Some(Self { values: order.iter().map(|&i| diagonal[i]).collect(), vectors: sorted })
    }

    /// `sum of function(value) vector vector^T`: the function of the matrix.
    pub fn apply(&self, function: impl Fn(f64) -> f64) -> Matrix {
        let mut scaled = self.vectors.clone();
        for (i, &value) in self.values.iter().enumerate() {
            let factor = function(value);
            scaled.row_mut(i).iter_mut().for_each(|v| *v *= factor);
        }
        self.vectors.transposed().times(&scaled)
    }
}

/// Eigenvalues alone of a symmetric matrix, in no order; several times faster than [`Eigen::of`]. None if it is not finite.
pub fn eigenvalues(matrix: &Matrix) -> Option<Vec<f64>> {
    let (mut diagonal, mut beside, _) = three_diagonals(matrix, false)?;
    diagonalise(&mut diagonal, &mut beside, None)?;
    Some(diagonal)
}

/// Diagonal, the numbers beside it (the last is 0) and the rows `Q^T` of `matrix = Q T Q^T`.
fn three_diagonals(matrix: &Matrix, with_vectors: bool) -> Option<(Vec<f64>, Vec<f64>, Matrix)> {
    let size = matrix.rows;
    if matrix.columns != size || matrix.values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let mut a = matrix.clone();
    let mut turned = if with_vectors { Matrix::identity(size) } else { Matrix::zeros(0, 0) };
    let mut beside = vec![0.0; size];
    for k in 0..size.saturating_sub(1) {
        // reflect the column below the diagonal onto its first number
        let mut mirror: Vec<f64> = (0..size).map(|i| if i > k { a[(i, k)] } else { 0.0 }).collect();
        let length = dot(&mirror, &mirror).sqrt();
        let image = if mirror[k + 1] > 0.0 { -length } else { length };
        beside[k] = image;
        mirror[k + 1] -= image;
        let square = dot(&mirror, &mirror);
        if square <= f64::MIN_POSITIVE {
            continue;
        }
        // A - v w^T - w v^T with p = 2 A v / v.v, w = p - (p.v / v.v) v
        let mut w: Vec<f64> =
            (0..size).map(|i| if i < k { 0.0 } else { 2.0 * dot(a.row(i), &mirror) / square }).collect();
        let overlap = dot(&w, &mirror) / square;
        w.iter_mut().zip(&mirror).for_each(|(w, v)| *w -= overlap * v);
        for i in k..size {
            let (vi, wi) = (mirror[i], w[i]);
            let row = &mut a.row_mut(i)[k..];
            for ((to, v), w) in row.iter_mut().zip(&mirror[k..]).zip(&w[k..]) {
                *to -= vi * w + wi * v;
            }
        }
        if with_vectors {
            // rows of Q^T: (I - 2 v v^T / v.v) Q^T
            let mut shadow = vec![0.0; size];
            for (i, across) in mirror.iter().enumerate().skip(k + 1) {
                let factor = 2.0 * across / square;
                shadow.iter_mut().zip(turned.row(i)).for_each(|(s, q)| *s += factor * q);
            }
            for (i, &factor) in mirror.iter().enumerate().skip(k + 1) {
                turned.row_mut(i).iter_mut().zip(&shadow).for_each(|(q, s)| *q -= factor * s);
            }
        }
    }
    Some(((0..size).map(|i| a[(i, i)]).collect(), beside, turned))
}

/// QL with implicit shifts: `diagonal` becomes the eigenvalues; `vectors` (rows) are turned along. None if a value
/// does not settle in 60 rounds, which does not happen to finite matrices.
fn diagonalise(diagonal: &mut [f64], beside: &mut [f64], mut vectors: Option<&mut Matrix>) -> Option<()> {
    let size = diagonal.len();
    let largest = diagonal.iter().chain(beside.iter()).fold(0.0_f64, |m, v| m.max(v.abs()));
    for l in 0..size {
        for round in 0..=60 {
            // the first place from l on where the matrix falls into two
            let falls = |m: &usize| {
                let scale = diagonal[*m].abs() + diagonal[m + 1].abs();
                beside[*m].abs() <= f64::EPSILON * scale.max(f64::EPSILON * largest)
            };
            let end = (l..size - 1).find(falls).unwrap_or(size - 1);
            if end == l {
                break;
            }
            if round == 60 {
                return None;
            }
            let half = (diagonal[l + 1] - diagonal[l]) / (2.0 * beside[l]);
            let root = half.hypot(1.0).copysign(half);
            let mut g = diagonal[end] - diagonal[l] + beside[l] / (half + root);
            let (mut sine, mut cosine, mut shift) = (1.0, 1.0, 0.0);
            let mut split = None;
            for i in (l..end).rev() {
                let (f, b) = (sine * beside[i], cosine * beside[i]);
                let length = f.hypot(g);
                beside[i + 1] = length;
                if length == 0.0 {
                    split = Some(i);
                    break;
                }
                sine = f / length;
                cosine = g / length;
                let apart = diagonal[i + 1] - shift;
                let turn = (diagonal[i] - apart) * sine + 2.0 * cosine * b;
                shift = sine * turn;
                diagonal[i + 1] = apart + shift;
                g = cosine * turn - b;
                if let Some(vectors) = vectors.as_deref_mut() {
                    turn_rows(vectors, i, cosine, sine);
                }
            }
            match split {
                Some(i) => {
                    diagonal[i + 1] -= shift;
                    beside[end] = 0.0;
                }
                None => {
                    diagonal[l] -= shift;
                    beside[l] = g;
                    beside[end] = 0.0;
                }
            }
        }
    }
    Some(())
}

/// Turns rows `i` and `i + 1` into each other.
fn turn_rows(matrix: &mut Matrix, i: usize, cosine: f64, sine: f64) {
    let columns = matrix.columns;
    let (upper, lower) = matrix.values[i * columns..(i + 2) * columns].split_at_mut(columns);
    for (a, b) in upper.iter_mut().zip(lower) {
        let (above, below) = (*a, *b);
        *b = sine * above + cosine * below;
        *a = cosine * above - sine * below;
    }
}

/// Principal components of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Pca {
    /// Mean of the points.
    pub mean: Vec<f64>,
    /// Unit directions of largest variance, as rows, descending.
    pub directions: Matrix,
    /// Variance along each direction (divided by the number of points).
    pub variances: Vec<f64>,
}

impl Pca {
    /// The first `most` components, or as many of them as hold `share` (0 to 1) of the variance. None of no points or
    /// if they are not finite.
    pub fn of<P: AsRef<[f64]>>(points: &[P], most: usize, share: f64) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let mean = mean(points);
        let eigen = if points.len() < mean.len() {
            by_points(points, &mean)?
        } else {
            Eigen::of(&covariance(points, &mean))?
        };
        let total: f64 = eigen.values.iter().map(|v| v.max(0.0)).sum();
        let mut held = 0.0;
        let mut count = 0;
        // at least one; none that holds nothing
        for &value in eigen.values.iter().take(most.max(1)) {
            if count > 0 && (held >= share * total || value <= 1e-12 * total) {
                break;
            }
            held += value;
            count += 1;
        }
        let mut directions = Matrix::zeros(count, mean.len());
        directions.values.copy_from_slice(&eigen.vectors.values[..count * mean.len()]);
        Some(Self { mean, directions, variances: eigen.values[..count].to_vec() })
    }

    /// Coordinates of a point along the directions.
    pub fn project(&self, point: &[f64]) -> Vec<f64> {
        let away: Vec<f64> = point.iter().zip(&self.mean).map(|(p, m)| p - m).collect();
        (0..self.directions.rows).map(|i| dot(self.directions.row(i), &away)).collect()
    }

    /// The point with these coordinates.
    pub fn restore(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut point = self.mean.clone();
        for (i, &along) in coordinates.iter().enumerate().take(self.directions.rows) {
            point.iter_mut().zip(self.directions.row(i)).for_each(|(p, d)| *p += along * d);
        }
        point
    }
}

/// Eigenvalues and vectors of the covariance of fewer points than they have numbers, from the products of the points
/// with each other: `X^T X u = l u` for `u = X^T w` where `X X^T w = l w`.
fn by_points<P: AsRef<[f64]>>(points: &[P], centre: &[f64]) -> Option<Eigen> {
    let away: Vec<Vec<f64>> =
        points.iter().map(|point| point.as_ref().iter().zip(centre).map(|(p, c)| p - c).collect()).collect();
    let count = points.len();
    let mut products = Matrix::zeros(count, count);
    for i in 0..count {
        for j in 0..=i {
            products[(i, j)] = dot(&away[i], &away[j]) / number(count);
            products[(j, i)] = products[(i, j)];
        }
    }
    let eigen = Eigen::of(&products)?;
    let mut vectors = Matrix::zeros(count, centre.len());
    for (k, value) in eigen.values.iter().enumerate() {
        // directions without variance stay zero; they are never read
        let scale = (value * number(count)).max(f64::MIN_POSITIVE).sqrt();
        for (point, share) in away.iter().zip(eigen.vectors.row(k)) {
            vectors.row_mut(k).iter_mut().zip(point).for_each(|(to, from)| *to += share / scale * from);
        }
    }
    Some(Eigen { values: eigen.values, vectors })
}

#[cfg(test)]
mod tests;
