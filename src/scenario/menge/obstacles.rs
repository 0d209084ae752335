//! Obstacles as solid polygons: closed ones as they are, in pieces where their edges cross; open ones and enclosures as
//! thin walls; the outline of a navigation mesh as the bounds.

use super::agents::Placed;
use super::nav::NavMesh;
use super::report::Report;
use super::xml::{Source, children, count, kind, need, place, tag, wrong};
use crate::scenario::error::Error;
use crate::scenario::polygon;
use glam::Vec2;
use roxmltree::{Document, Node};

/// Thickness of a wall that Menge has as a line, m.
const THICKNESS: f32 = 0.04;
/// Most corners of an obstacle.
const MAX_CORNERS: usize = 1000;
/// Corners nearer than this are one, m.
const SAME: f32 = 0.002;
/// Pieces of a crossing outline that are smaller are left out, m².
const SMALLEST: f64 = 1e-4;

/// What stands in the way, in Menge's plane, m.
#[derive(Debug, Default)]
pub(super) struct Solids {
    pub(super) polygons: Vec<Vec<Vec2>>,
    /// The outline of a navigation mesh.
    pub(super) bounds: Option<Vec<Vec2>>,
}

/// Reads the obstacle sets of a scene; where people start tells enclosures from solids, and which sets they heed.
pub(super) fn read(
    source: &Source,
    document: &Document<'_>,
    placed: &[Placed],
    report: &mut Report,
) -> Result<Solids, Error> {
    let starts: Vec<Vec2> = placed.iter().map(|agent| agent.position).collect();
    let mut solids = Solids::default();
    for set in children(&document.root_element()).filter(|node| tag(node) == "ObstacleSet") {
        if !is_heeded(source, &set, placed, report)? {
            continue;
        }
        match kind(&set) {
            "explicit" => {
                for node in children(&set) {
                    if tag(&node) == "Obstacle" {
                        solids.polygons.extend(obstacle(source, &node, &starts, report)?);
                    } else {
                        let what = format!("<{}> of an obstacle set", tag(&node));
                        report.unsupported(&place(source, &node), &what);
                    }
                }
            }
            "nav_mesh" => outline(source, &set, &starts, &mut solids, report)?,
            other => report.unsupported(&place(source, &set), &format!("<ObstacleSet type={other:?}>")),
        }
    }
    Ok(solids)
}

/// Whether any agent heeds the class of an obstacle set at the start.
fn is_heeded(
    source: &Source,
    set: &Node<'_, '_>,
    placed: &[Placed],
    report: &mut Report,
) -> Result<bool, Error> {
    if set.attribute("class").is_none() || placed.is_empty() {
        return Ok(true);
    }
    let class = count(source, set, "class", u32::MAX)?;
    let heeding = placed.iter().filter(|agent| agent.profile.obstacle_set & class != 0).count();
    if heeding == 0 && class != 0 {
        report.unsupported(
            &place(source, set),
            &format!("<ObstacleSet class=\"{class}\">: nobody heeds it at the start"),
        );
        return Ok(false);
    }
    if heeding < placed.len() {
        report.approximate(
            source,
            set,
            format!("everybody heeds it, not only {heeding} of {}", placed.len()),
        );
    }
    Ok(true)
}

/// The solid polygons of one obstacle.
fn obstacle(
    source: &Source,
    node: &Node<'_, '_>,
    starts: &[Vec2],
    report: &mut Report,
) -> Result<Vec<Vec<Vec2>>, Error> {
    let vertices = children(node).filter(|part| tag(part) == "Vertex");
    let corner = |part| Ok(Vec2::new(need(source, &part, "p_x")?, need(source, &part, "p_y")?));
    let mut corners = vertices.map(corner).collect::<Result<Vec<_>, Error>>()?;
    if corners.len() < 2 || corners.len() > MAX_CORNERS {
        let message = format!("an obstacle of {} corners; 3 (a wall: 2) to {MAX_CORNERS}", corners.len());
        return Err(wrong(source, node, message));
    }
    let is_closed = matches!(node.attribute("closed"), Some("1" | "true")) && corners.len() > 2;
    corners.dedup_by(|a, b| a.distance(*b) < SAME);
    if is_closed && corners.len() > 1 && corners[0].distance(corners[corners.len() - 1]) < SAME {
        corners.pop();
    }
    let is_enclosure = is_closed && starts.iter().any(|start| polygon::contains(&corners, *start));
    if is_closed && !is_enclosure && corners.len() > 2 {
        return Ok(solid(corners, starts, |what| report.approximate(source, node, what)));
    }
    let why = if is_closed { "people start inside" } else { "it is open" };
    report.approximate(source, node, format!("walls {THICKNESS} m thick, since {why}"));
    Ok(walls(&corners, is_closed))
}

/// A closed outline as solid polygons that do not cross themselves; says what it made of one that does.
fn solid(corners: Vec<Vec2>, starts: &[Vec2], mut say: impl FnMut(String)) -> Vec<Vec<Vec2>> {
    if polygon::self_intersection(&corners).is_none() {
        return vec![corners];
    }
    let pieces = polygon::pieces(&corners).unwrap_or_default();
    let (whole, holes): (Vec<_>, Vec<_>) =
        pieces.into_iter().partition(|piece| polygon::signed_area(piece) > 0.0);
    let whole: Vec<Vec<Vec2>> =
        whole.into_iter().filter(|piece| polygon::signed_area(piece) > SMALLEST).collect();
    let is_inhabited = starts.iter().any(|start| holes.iter().any(|hole| polygon::contains(hole, *start)));
    let is_simple = whole.iter().all(|piece| polygon::self_intersection(piece).is_none());
    if whole.is_empty() || is_inhabited || !is_simple {
        say(format!("its edges cross or touch: walls {THICKNESS} m thick"));
        return walls(&corners, true);
    }
    say(format!("its edges cross or touch: {} solid pieces", whole.len()));
    whole
}

/// The outline of a navigation mesh: the largest one with people in it is the bounds, the others are solid.
fn outline(
    source: &Source,
    set: &Node<'_, '_>,
    starts: &[Vec2],
    solids: &mut Solids,
    report: &mut Report,
) -> Result<(), Error> {
    let outlines = NavMesh::read(source, set)?.outlines();
    let mut loops = outlines.closed;
    let area = |outline: &Vec<Vec2>| polygon::signed_area(outline).abs();
    loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let is_around = |outline: &Vec<Vec2>| {
        let inside = starts.iter().filter(|start| polygon::contains(outline, **start)).count();
        2 * inside >= starts.len() && polygon::self_intersection(outline).is_none()
    };
    if solids.bounds.is_none() && loops.first().is_some_and(is_around) {
        solids.bounds = Some(loops.remove(0));
    }
    for outline in loops {
        if starts.iter().any(|start| polygon::contains(&outline, *start)) {
            report.approximate(
                source,
                set,
                format!("an outline with people in it: walls {THICKNESS} m thick"),
            );
            solids.polygons.extend(walls(&outline, true));
        } else {
            solids.polygons.extend(solid(outline, starts, |what| report.approximate(source, set, what)));
        }
    }
    if !outlines.open.is_empty() {
        let what = format!("{} rows of walls that do not close: {THICKNESS} m thick", outlines.open.len());
        report.approximate(source, set, what);
        solids.polygons.extend(outlines.open.iter().flat_map(|row| walls(row, false)));
    }
    Ok(())
}

/// A thin wall along each edge.
fn walls(corners: &[Vec2], is_closed: bool) -> Vec<Vec<Vec2>> {
    let edges = if is_closed { corners.len() } else { corners.len() - 1 };
    let wall = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let across = (b - a).normalize_or(Vec2::X).perp() * (0.5 * THICKNESS);
        vec![a - across, b - across, b + across, a + across]
    };
    (0..edges).filter(|&i| corners[i].distance(corners[(i + 1) % corners.len()]) > 0.001).map(wall).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_line_becomes_one_wall_an_edge() {
        let corners = [Vec2::ZERO, Vec2::new(2.0, 0.0), Vec2::new(2.0, 3.0)];
        let open = walls(&corners, false);
        assert_eq!(open.len(), 2);
        assert!(polygon::contains(&open[0], Vec2::new(1.0, 0.01)));
        assert!(!polygon::contains(&open[0], Vec2::new(1.0, 0.03)));
        assert_eq!(walls(&corners, true).len(), 3);
    }

    #[test]
    fn an_outline_that_crosses_itself_is_solid_where_it_was() {
        let bow = [[0.0, 0.0], [4.0, 2.0], [4.0, 0.0], [0.0, 2.0]].map(Vec2::from_array);
        let mut said = Vec::new();
        let pieces = solid(bow.to_vec(), &[], |what| said.push(what));
        assert_eq!((pieces.len(), said.len()), (2, 1), "{said:?}");
        let is_in = |at: Vec2| pieces.iter().any(|piece| polygon::contains(piece, at));
        assert!(is_in(Vec2::new(0.3, 1.0)) && is_in(Vec2::new(3.7, 1.0)) && !is_in(Vec2::new(2.0, 1.8)));
        // two squares joined by a corner, and one with a corner on its own edge
        let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]].map(Vec2::from_array);
        let pieces = solid(touching.to_vec(), &[], |_| {});
        assert_eq!(pieces.len(), 2, "{pieces:?}");
        assert!(pieces.iter().all(|piece| polygon::self_intersection(piece).is_none()));
        said.clear();
        assert_eq!(solid(bow[..3].to_vec(), &[], |what| said.push(what)).len(), 1);
        assert!(said.is_empty(), "{said:?}");
    }
}
