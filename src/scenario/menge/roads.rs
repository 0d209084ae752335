//! Road maps: vertices that people walk along. `N`, then `degree x y` for each, then `M` and the two ends of each edge.

use super::xml::Source;
use crate::scenario::error::Error;
use crate::scenario::polygon;
use glam::Vec2;

/// Most vertices.
const MAX_VERTICES: usize = 20_000;

/// A graph in Menge's plane, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Roads {
    vertices: Vec<Vec2>,
    edges: Vec<Vec<usize>>,
}

impl Roads {
    pub(super) fn parse(source: &Source) -> Result<Self, Error> {
        let mut words = (1..)
            .zip(source.text.lines())
            .flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)));
        let last_line = source.text.lines().count().max(1);
        let mut next = |what: &str| -> Result<(usize, f32), Error> {
            let Some((line, word)) = words.next() else {
                return Err(source.wrong_line(last_line, format!("the road map ends before {what}")));
            };
            let value: f32 = word.parse().unwrap_or(f32::NAN);
            if value.is_finite() {
                return Ok((line, value));
            }
            let word: String = word.chars().take(40).collect();
            Err(source.wrong_line(line, format!("{what} is {word:?}, not a number")))
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked to be whole and small"
        )]
        let whole = |(line, value): (usize, f32), most: usize| {
            #[allow(clippy::cast_precision_loss, reason = "a small bound")]
            let is_good = value >= 0.0 && value.fract() == 0.0 && value <= most as f32;
            if is_good {
                Ok(value as usize)
            } else {
                Err(source.wrong_line(line, format!("{value} is not 0 to {most}")))
            }
        };
        let count = whole(next("the number of vertices")?, MAX_VERTICES)?;
        let mut roads = Self::default();
        for _ in 0..count {
            next("the degree of a vertex")?;
            roads.vertices.push(Vec2::new(next("x of a vertex")?.1, next("y of a vertex")?.1));
        }
        roads.edges = vec![Vec::new(); count];
        let edges = whole(next("the number of edges")?, 64 * MAX_VERTICES)?;
        for _ in 0..edges {
            let a = whole(next("the end of an edge")?, count.saturating_sub(1))?;
            let b = whole(next("the end of an edge")?, count.saturating_sub(1))?;
            if a < count && b < count {
                roads.edges[a].push(b);
                roads.edges[b].push(a);
            }
        }
        Ok(roads)
    }

    /// Places on the shortest way from one point to another, without the first, with the last: along the edges, entered
    /// and left at vertices to which nothing solid stands between for a disc of `radius`.
    pub(super) fn way(&self, from: Vec2, to: Vec2, walls: &[Vec<Vec2>], radius: f32) -> Option<Vec<Vec2>> {
        // From generous to none at all: a road map may lead closer to a wall than an agent is wide.
        for clearance in [radius, 0.5 * radius, 0.0] {
            let sees = |a: Vec2, b: Vec2| {
                walls.iter().all(|wall| {
                    !polygon::contains(wall, a)
                        && polygon::edges(wall).all(|(c, d)| {
                            if clearance > 0.0 {
                                polygon::segment_distance(a, b, c, d) >= clearance
                            } else {
                                !polygon::segments_meet(a, b, c, d)
                            }
                        })
                })
            };
            if let Some(way) = self.shortest(from, to, sees) {
                return Some(way);
            }
        }
        None
    }

    /// Dijkstra over the vertices, with the two points joined to all that they see.
    fn shortest(&self, from: Vec2, to: Vec2, sees: impl Fn(Vec2, Vec2) -> bool) -> Option<Vec<Vec2>> {
        if sees(from, to) {
            return Some(vec![to]);
        }
        let count = self.vertices.len();
        let mut best: Vec<f32> = self
            .vertices
            .iter()
            .map(|v| if sees(from, *v) { from.distance(*v) } else { f32::INFINITY })
            .collect();
        let mut before = vec![usize::MAX; count];
        let mut done = vec![false; count];
        loop {
            let open = (0..count).filter(|&v| !done[v] && best[v].is_finite());
            let Some(v) = open.min_by(|a, b| best[*a].total_cmp(&best[*b])) else { break };
            done[v] = true;
            for &w in &self.edges[v] {
                let length = best[v] + self.vertices[v].distance(self.vertices[w]);
                if length < best[w] {
                    (best[w], before[w]) = (length, v);
                }
            }
        }
        let exits = (0..count).filter(|&v| done[v] && sees(self.vertices[v], to));
        let total = |v: usize| best[v] + self.vertices[v].distance(to);
        let mut at = exits.min_by(|a, b| total(*a).total_cmp(&total(*b)))?;
        let mut way = vec![to];
        while at != usize::MAX {
            way.push(self.vertices[at]);
            at = before[at];
        }
        way.reverse();
        Some(way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn roads(text: &str) -> Result<Roads, Error> {
        Roads::parse(&Source { path: PathBuf::from("map.txt"), text: text.to_owned() })
    }

    #[test]
    fn the_way_goes_round_a_wall_along_the_roads() {
        let map = roads("3\n1 -2 2\n2 0 2\n1 2 2\n2\n0 1\n1 2\n").unwrap();
        let wall = vec![vec![
            Vec2::new(-0.1, -5.0),
            Vec2::new(0.1, -5.0),
            Vec2::new(0.1, 1.5),
            Vec2::new(-0.1, 1.5),
        ]];
        let (from, to) = (Vec2::new(-2.0, 0.0), Vec2::new(2.0, 0.0));
        let way = map.way(from, to, &wall, 0.2).unwrap();
        // straight to the first road that is seen past the wall
        assert_eq!(way, [Vec2::new(0.0, 2.0), to]);
        assert_eq!(map.way(from, to, &[], 0.2).unwrap(), [to], "and straight on where nothing stands");
    }

    #[test]
    fn a_broken_map_says_where() {
        for (text, why) in
            [("2\n0 0 0\n", "ends before"), ("x", "not a number"), ("1\n0 0 0\n1\n0 7\n", "not 0 to 0")]
        {
            let said = roads(text).unwrap_err().to_string();
            assert!(said.contains(why) && said.contains("map.txt:"), "{text:?}: {said}");
        }
    }
}
