//! Williams squares: orders in which every item stands in every place, and follows every other item, equally often.
//!
//! E. J. Williams (1949), Experimental designs balanced for the estimation of residual effects of treatments, Australian Journal
//! of Scientific Research A 2. The first row is 0, 1, n-1, 2, n-2, ...; row r adds r to it, modulo n. For n even that is enough:
//! n rows. For n odd every row is used backwards, too: 2n rows.

/// Fewest and most items of a square.
pub const SIZES: std::ops::RangeInclusive<usize> = 2..=12;

/// The rows for `n` items: n of them for n even, 2n for n odd. Each is an order of 0..n; none for n = 0.
///
/// Over all rows, every item stands in every place equally often (once, or twice for n odd), and every ordered pair of items
/// is adjacent equally often (once, or twice).
pub fn rows(n: usize) -> Vec<Vec<usize>> {
    let first: Vec<usize> =
        (0..n).map(|place| if place % 2 == 1 { place.div_ceil(2) } else { (n - place / 2) % n }).collect();
    let turned = |by: usize| first.iter().map(move |item| (item + by) % n).collect::<Vec<_>>();
    let mut rows: Vec<Vec<usize>> = (0..n).map(turned).collect();
    if n % 2 == 1 {
        let backwards: Vec<_> = rows.iter().map(|row| row.iter().rev().copied().collect()).collect();
        rows.extend::<Vec<Vec<usize>>>(backwards);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_of_four_is_the_designs() {
        assert_eq!(rows(4), [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]);
        assert!(rows(0).is_empty());
    }

    #[test]
    fn every_item_stands_everywhere_and_follows_every_other_equally_often() {
        for n in SIZES {
            let rows = rows(n);
            let times = if n % 2 == 0 { 1 } else { 2 };
            assert_eq!(rows.len(), n * times);
            let (mut places, mut pairs) = (vec![vec![0; n]; n], vec![vec![0; n]; n]);
            for row in &rows {
                row.iter().enumerate().for_each(|(place, &item)| places[place][item] += 1);
                row.windows(2).for_each(|pair| pairs[pair[0]][pair[1]] += 1);
            }
            for a in 0..n {
                for b in 0..n {
                    assert_eq!(places[a][b], times, "{n}: item {b} at {a}");
                    assert_eq!(pairs[a][b], if a == b { 0 } else { times }, "{n}: {b} after {a}");
                }
            }
        }
    }
}
