//! Obstacle polygons as the segments that `velocity_orca` reads, and which segments matter in which cell.

use crate::kernels::layout::{Segment, StepUniforms};
use crate::kernels::shared::orca::RAISED;
use crate::reference::exact::{det2, dot2};
use crate::reference::orca::unit_or;

/// The segments of closed polygons.
///
/// A polygon whose corners run counter-clockwise in the (x, z) plane is solid inside; clockwise, solid outside (the
/// outline of a walkable area). Two corners make a wall that is solid from both sides. Repeated corners are dropped.
pub fn segments(polygons: &[Vec<[f32; 2]>]) -> Vec<Segment> {
    let mut all = Vec::new();
    for polygon in polygons {
        let mut corners: Vec<[f32; 2]> = Vec::with_capacity(polygon.len());
        for &corner in polygon {
            if corners.last() != Some(&corner) {
                corners.push(corner);
            }
        }
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let count = corners.len();
        if count < 2 {
            continue;
        }
        let corner = |i: usize| corners[i % count];
        let along = |i: usize| {
            let (a, b) = (corner(i), corner(i + 1));
            unit_or([b[0] - a[0], b[1] - a[1]], [1.0, 0.0])
        };
        // the next corner lies left of, or on, the line through the last two
        let convex = |i: usize| {
            let (a, b, c) = (corner(i + count - 1), corner(i), corner(i + 1));
            count == 2 || det2([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]) >= 0.0
        };
        for i in 0..count {
            let (a, b) = (corner(i), corner(i + 1));
            all.push(Segment {
                a,
                b,
                along: along(i),
                before: along(i + count - 1),
                after: along(i + 1),
                corners: [convex(i), convex(i + 1)].map(|is_convex| f32::from(u8::from(is_convex))),
            });
        }
    }
    all
}

/// The segment where it stands between two heights, m, only (see `reference::orca::stands_at`).
pub fn at_heights(mut segment: Segment, low: f32, high: f32) -> Segment {
    let coded = |convex: f32, height: f32| {
        let size = height.clamp(-1000.0, 1000.0) + RAISED;
        if convex > 0.0 { size } else { -size }
    };
    let [first, second] = segment.corners;
    segment.corners = [coded(first, low), coded(second, high)];
    segment
}

/// For each cell the segments that an agent in it may have to avoid: those within `reach` metres of the cell.
///
/// Shape: `cell_count + 1` starts (indices into this same array), then the lists, each rising.
pub fn cell_lists(segments: &[Segment], step: &StepUniforms, reach: f32) -> Vec<u32> {
    let (columns, rows) = (step.grid_columns as i32, step.grid_rows as i32);
    if columns == 0 || rows == 0 {
        return vec![1]; // no grid, so no agent looks it up
    }
    let mut lists = vec![Vec::new(); (columns * rows) as usize];
    let half = step.cell_size * 0.5;
    for (number, segment) in segments.iter().enumerate() {
        let ([ax, az], [bx, bz]) = (segment.a, segment.b);
        // border cells also hold agents from outside, so they take whatever lies beyond them
        let column = |x: f32| {
            (((x - step.grid_origin[0]) * step.inverse_cell_size).floor() as i32).clamp(0, columns - 1)
        };
        let row =
            |z: f32| (((z - step.grid_origin[1]) * step.inverse_cell_size).floor() as i32).clamp(0, rows - 1);
        for r in row(az.min(bz) - reach)..=row(az.max(bz) + reach) {
            for c in column(ax.min(bx) - reach)..=column(ax.max(bx) + reach) {
                let centre = [
                    step.grid_origin[0] + c as f32 * step.cell_size + half,
                    step.grid_origin[1] + r as f32 * step.cell_size + half,
                ];
                let border = r == 0 || c == 0 || r == rows - 1 || c == columns - 1;
                let (ab, ap) = ([bx - ax, bz - az], [centre[0] - ax, centre[1] - az]);
                let t = (dot2(ap, ab) / dot2(ab, ab)).clamp(0.0, 1.0);
                let off = [ap[0] - ab[0] * t, ap[1] - ab[1] * t];
                let near = reach + half * std::f32::consts::SQRT_2;
                if border || dot2(off, off) <= near * near {
                    lists[(r * columns + c) as usize].push(number as u32);
                }
            }
        }
    }
    let mut start = step.cell_count + 1;
    let mut out = Vec::with_capacity(lists.iter().map(Vec::len).sum::<usize>() + lists.len() + 1);
    for list in &lists {
        out.push(start);
        start += list.len() as u32;
    }
    out.push(start);
    out.extend(lists.into_iter().flatten());
    out
}

/// In how many solids the middle of each cell lies. Outside of the bounds counts as one; what stands at some heights only
/// bounds no area. A middle on an outline lies outside of the solid.
pub fn cell_depth(segments: &[Segment], step: &StepUniforms) -> Vec<i32> {
    let size = step.cell_size;
    let middle = |axis: usize, cell: u32| f64::from(step.grid_origin[axis] + (cell as f32 + 0.5) * size);
    let bounding = segments.iter().filter(|segment| segment.corners[0].abs() < 0.5 * RAISED);
    let edges: Vec<([f64; 2], [f64; 2])> =
        bounding.map(|segment| (segment.a.map(f64::from), segment.b.map(f64::from))).collect();
    let mut depths = Vec::with_capacity(step.cell_count as usize);
    for row in 0..step.grid_rows {
        let z = middle(1, row);
        // where outlines cross the row of middles, and whether upwards
        let crossing = edges.iter().filter(|(a, b)| (a[1] <= z) != (b[1] <= z));
        let crossing = crossing.map(|([ax, az], [bx, bz])| (ax + (z - az) / (bz - az) * (bx - ax), bz > az));
        let crossing: Vec<(f64, bool)> = crossing.collect();
        depths.extend((0..step.grid_columns).map(|column| {
            let x = middle(0, column);
            let turns =
                |(at, is_up): &(f64, bool)| if *is_up { i32::from(*at > x) } else { -i32::from(*at >= x) };
            crossing.iter().map(turns).sum::<i32>()
        }));
    }
    // far away it is solid once for every outline that runs clockwise
    let far_away = clockwise(&edges);
    depths.iter_mut().for_each(|depth| *depth += far_away);
    depths
}

/// How many outlines run clockwise, of edges that follow one another.
#[allow(clippy::float_cmp, reason = "an outline ends at the very corner where it began")]
fn clockwise(edges: &[([f64; 2], [f64; 2])]) -> i32 {
    let (mut count, mut begin, mut area) = (0, None, 0.0);
    for (a, b) in edges {
        let first = *begin.get_or_insert(*a);
        area += a[0] * b[1] - a[1] * b[0];
        if *b == first {
            count += i32::from(area < 0.0);
            (begin, area) = (None, 0.0);
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cells_depth_counts_the_solids_around_its_middle() {
        let step = StepUniforms {
            grid_columns: 8,
            grid_rows: 6,
            cell_count: 48,
            cell_size: 1.0,
            ..StepUniforms::default()
        };
        let bounds = vec![[1.0, 1.0], [1.0, 5.0], [7.0, 5.0], [7.0, 1.0]];
        let boxes = |x: f32, z: f32| vec![[x, z], [x + 2.0, z], [x + 2.0, z + 2.0], [x, z + 2.0]];
        let wall = vec![[1.25, 1.5], [1.25, 4.0]];
        // the left side of the second runs through middles
        let outlines = [bounds, boxes(2.0, 2.0), boxes(3.5, 2.0), wall];
        let depths = cell_depth(&segments(&outlines), &step);
        let row = |row: usize| &depths[8 * row..][..8];
        assert_eq!(row(0), [1; 8]);
        assert_eq!(row(1), [1, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!(row(2), [1, 0, 1, 1, 1, 0, 0, 1]);
        let without = cell_depth(&segments(&outlines[1..2]), &step);
        assert_eq!(&without[16..24], [0, 0, 1, 1, 0, 0, 0, 0]);
    }

    #[test]
    fn a_counter_clockwise_box_is_open_on_the_outside_with_convex_corners() {
        let found = segments(&[vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]]]);
        assert_eq!(found.len(), 4);
        for segment in &found {
            assert!(segment.corners.iter().all(|corner| *corner > 0.0));
            assert!(crate::reference::orca::segment_distance2(segment, [1.0, 0.5]) > 1e30, "inside");
        }
        let from_below = crate::reference::orca::segment_distance2(&found[0], [1.0, -3.0]);
        assert!((from_below - 9.0).abs() < 1e-6);
    }

    #[test]
    fn the_inner_corner_of_an_l_is_concave() {
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let found = segments(&[l.to_vec()]);
        let convex: Vec<f32> = found.iter().map(|s| s.corners[0]).collect();
        assert_eq!(convex, [1.0, 1.0, 1.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn every_cell_lists_every_segment_in_reach() {
        let step = StepUniforms {
            cell_count: 100,
            grid_columns: 10,
            grid_rows: 10,
            cell_size: 2.0,
            inverse_cell_size: 0.5,
            ..StepUniforms::default()
        };
        let found = segments(&[vec![[5.0, 5.0], [9.0, 6.0], [6.0, 9.0]]]);
        let lists = cell_lists(&found, &step, 3.0);
        for cell in 0..100_usize {
            let list = &lists[lists[cell] as usize..lists[cell + 1] as usize];
            assert!(list.is_sorted());
            for i in 0..25_usize {
                let at = [
                    (cell % 10) as f32 * 2.0 + (i % 5) as f32 * 0.5,
                    (cell / 10) as f32 * 2.0 + (i / 5) as f32 * 0.5,
                ];
                for (number, segment) in found.iter().enumerate() {
                    if crate::reference::orca::segment_distance2(segment, at) < 9.0 {
                        assert!(list.contains(&(number as u32)), "cell {cell} lacks segment {number}");
                    }
                }
            }
        }
    }
}
