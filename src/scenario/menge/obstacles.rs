//! Obstacles as solid polygons: closed ones as they are, open ones and enclosures as thin walls, the outline of a
//! navigation mesh as the bounds.

use super::super::error::Error;
use super::super::polygon;
use super::Report;
use super::nav::NavMesh;
use super::xml::{Source, children, kind, need, place, tag, wrong};
use glam::Vec2;
use roxmltree::Document;

/// Thickness of a wall that Menge has as a line, m.
const THICKNESS: f32 = 0.04;
/// Most corners of an obstacle.
const MAX_CORNERS: usize = 1000;

/// What stands in the way, in Menge's plane, m.
#[derive(Debug, Default)]
pub(super) struct Solids {
    pub(super) polygons: Vec<Vec<Vec2>>,
    /// The outline of a navigation mesh.
    pub(super) bounds: Option<Vec<Vec2>>,
}

/// Reads the obstacle sets of a scene; `starts` tells enclosures from solids.
pub(super) fn read(
    source: &Source,
    document: &Document<'_>,
    starts: &[Vec2],
    report: &mut Report,
) -> Result<Solids, Error> {
    let mut solids = Solids::default();
    for set in children(&document.root_element()).filter(|node| tag(node) == "ObstacleSet") {
        match kind(&set) {
            "explicit" => {
                for node in children(&set) {
                    if tag(&node) != "Obstacle" {
                        report.unsupported(
                            &place(source, &node),
                            &format!("<{}> of an obstacle set", tag(&node)),
                        );
                        continue;
                    }
                    let vertices = children(&node).filter(|part| tag(part) == "Vertex");
                    let corner =
                        |part| Ok(Vec2::new(need(source, &part, "p_x")?, need(source, &part, "p_y")?));
                    let corners = vertices.map(corner).collect::<Result<Vec<_>, Error>>()?;
                    let is_closed = matches!(node.attribute("closed"), Some("1" | "true"));
                    if corners.len() < if is_closed { 3 } else { 2 } || corners.len() > MAX_CORNERS {
                        let message =
                            format!("an obstacle of {} corners; 3 (open: 2) to {MAX_CORNERS}", corners.len());
                        return Err(wrong(source, &node, message));
                    }
                    let is_enclosure =
                        is_closed && starts.iter().any(|start| polygon::contains(&corners, *start));
                    if is_closed && !is_enclosure {
                        solids.polygons.push(corners);
                        continue;
                    }
                    let at = place(source, &node);
                    let why = if is_closed { "people start inside" } else { "it is open" };
                    report.note(format!("{at}: obstacle became walls {THICKNESS} m thick, since {why}"));
                    solids.polygons.extend(walls(&corners, is_closed));
                }
            }
            "nav_mesh" => {
                let mesh = NavMesh::read(source, &set)?;
                let mut loops = mesh.outlines();
                // The outline with the largest area is the outside; the others are holes.
                let area = |outline: &Vec<Vec2>| polygon::signed_area(outline).abs();
                loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
                let mut loops = loops.into_iter();
                solids.bounds = loops.next();
                solids.polygons.extend(loops);
            }
            other => report.unsupported(&place(source, &set), &format!("<ObstacleSet type={other:?}>")),
        }
    }
    Ok(solids)
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
}
