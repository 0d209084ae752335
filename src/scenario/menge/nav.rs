//! Navigation meshes: convex nodes, the edges (doors) between them, and the edges that cannot be crossed.
//!
//! ```text
//! vertices: N, then x y
//! doors:    N, then vertex vertex node node
//! walls:    N, then vertex vertex node next-wall, -1 where none follows
//! groups:   name, N, then for each node its centre, its vertices (count first), its plane, its doors, its walls
//! ```

use super::xml::{Source, wrong};
use crate::scenario::error::Error;
use crate::scenario::polygon;
use glam::Vec2;
use roxmltree::Node;
use std::collections::BTreeSet;

/// Most elements of each kind.
const MOST: usize = 1_000_000;

/// In place of the number of the next wall: none follows.
const NONE: usize = usize::MAX;

/// The walls of a mesh, one joined to the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Outlines {
    /// Outlines that close.
    pub(super) closed: Vec<Vec<Vec2>>,
    /// Rows of walls that end somewhere.
    pub(super) open: Vec<Vec<Vec2>>,
}

/// A mesh in Menge's plane, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct NavMesh {
    vertices: Vec<Vec2>,
    /// Two vertices, two nodes.
    doors: Vec<[usize; 4]>,
    /// Two vertices, node, next wall or [`NONE`].
    walls: Vec<[usize; 4]>,
    /// Corners of the nodes.
    nodes: Vec<Vec<usize>>,
}

/// Words of a text with their lines.
struct Words<'a> {
    source: &'a Source,
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let (line, word) = self.words.next()?;
        self.line = line;
        Some(word)
    }

    fn number(&mut self, what: &str) -> Result<f32, Error> {
        let word =
            self.next().ok_or_else(|| self.source.wrong_line(self.line, format!("ends before {what}")))?;
        match word.parse::<f32>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => {
                let word: String = word.chars().take(40).collect();
                Err(self.source.wrong_line(self.line, format!("{what} is {word:?}, not a number")))
            }
        }
    }

    /// The number of the wall that follows one, of `count`.
    fn next_wall(&mut self, count: usize) -> Result<usize, Error> {
        let what = "the next wall of a wall";
        let word =
            self.next().ok_or_else(|| self.source.wrong_line(self.line, format!("ends before {what}")))?;
        match word.parse::<i64>() {
            Ok(..0) => Ok(NONE),
            Ok(value) if usize::try_from(value).is_ok_and(|value| value < count) => {
                Ok(usize::try_from(value).unwrap_or(NONE))
            }
            _ => {
                let word: String = word.chars().take(40).collect();
                let last = count.saturating_sub(1);
                let message = format!("{what} is {word:?}, not 0 to {last}, or -1 where none follows");
                Err(self.source.wrong_line(self.line, message))
            }
        }
    }

    fn index(&mut self, what: &str, below: usize) -> Result<usize, Error> {
        let word =
            self.next().ok_or_else(|| self.source.wrong_line(self.line, format!("ends before {what}")))?;
        match word.parse::<usize>() {
            Ok(value) if value < below => Ok(value),
            _ => {
                let word: String = word.chars().take(40).collect();
                Err(self.source.wrong_line(
                    self.line,
                    format!("{what} is {word:?}, not 0 to {}", below.saturating_sub(1)),
                ))
            }
        }
    }
}

impl NavMesh {
    /// The mesh that an element names by `file_name`, beside its own file.
    pub(super) fn read(source: &Source, node: &Node<'_, '_>) -> Result<Self, Error> {
        let Some(name) = node.attribute("file_name") else {
            return Err(wrong(source, node, "a navigation mesh without file_name"));
        };
        Self::parse(&Source::read(&source.path.with_file_name(name))?)
    }

    pub(super) fn parse(source: &Source) -> Result<Self, Error> {
        let words = (1..).zip(source.text.lines());
        let words = words.flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)));
        let mut words = Words { source, words: Box::new(words), line: 1 };
        let mut mesh = Self::default();
        for _ in 0..words.index("the number of vertices", MOST)? {
            mesh.vertices.push(Vec2::new(words.number("x")?, words.number("y")?));
        }
        let vertices = mesh.vertices.len();
        for _ in 0..words.index("the number of doors", MOST)? {
            mesh.doors.push([
                words.index("a vertex of a door", vertices)?,
                words.index("a vertex of a door", vertices)?,
                words.index("a node of a door", MOST)?,
                words.index("the other node of a door", MOST)?,
            ]);
        }
        let walls = words.index("the number of walls", MOST)?;
        for _ in 0..walls {
            mesh.walls.push([
                words.index("a vertex of a wall", vertices)?,
                words.index("a vertex of a wall", vertices)?,
                words.index("a node of a wall", MOST)?,
                words.next_wall(walls)?,
            ]);
        }
        while words.next().is_some() {
            for _ in 0..words.index("the number of nodes", MOST)? {
                mesh.read_node(&mut words)?;
            }
        }
        let nodes = mesh.nodes.len();
        if let Some(door) = mesh.doors.iter().find(|door| door[2] >= nodes || door[3] >= nodes) {
            let message = format!("a door between nodes {} and {}; there are {nodes}", door[2], door[3]);
            return Err(source.wrong_line(words.line, message));
        }
        Ok(mesh)
    }

    fn read_node(&mut self, words: &mut Words<'_>) -> Result<(), Error> {
        words.number("x of a node")?;
        words.number("y of a node")?;
        let mut corners = Vec::new();
        for _ in 0..words.index("the number of corners", MOST)? {
            corners.push(words.index("a corner", self.vertices.len())?);
        }
        for _ in 0..3 {
            words.number("the plane of a node")?;
        }
        for _ in 0..words.index("the number of doors", MOST)? {
            words.index("a door", self.doors.len())?;
        }
        for _ in 0..words.index("the number of walls", MOST)? {
            words.index("a wall", self.walls.len())?;
        }
        self.nodes.push(corners);
        Ok(())
    }

    /// The outlines of the walls: each wall's end is the beginning of the next, as far as there is one.
    pub(super) fn outlines(&self) -> Outlines {
        let count = self.walls.len();
        let follow = |first: usize, used: &mut [bool]| {
            let (mut at, mut outline) = (first, Vec::new());
            while let Some(used) = used.get_mut(at).filter(|used| !**used) {
                *used = true;
                outline.push(at);
                at = self.walls[at][3];
            }
            (outline, at)
        };
        let begin = |wall: &usize| self.vertices[self.walls[*wall][0]];
        let mut outlines = Outlines::default();
        let (mut seen, mut used) = (vec![false; count], vec![false; count]);
        for first in 0..count {
            let (walls, end) = follow(first, &mut seen);
            if walls.contains(&end) {
                let mut outline: Vec<Vec2> = follow(end, &mut used).0.iter().map(begin).collect();
                outline.dedup_by(|a, b| a.distance(*b) < 0.002);
                if outline.len() >= 3 {
                    outlines.closed.push(outline);
                }
            }
        }
        let follows: BTreeSet<usize> = (0..count).filter(|w| !used[*w]).map(|w| self.walls[w][3]).collect();
        let firsts: Vec<usize> = (0..count).filter(|wall| !used[*wall] && !follows.contains(wall)).collect();
        for first in firsts {
            let walls = follow(first, &mut used).0;
            let end = walls.last().map(|wall| self.vertices[self.walls[*wall][1]]);
            let mut row: Vec<Vec2> = walls.iter().map(begin).chain(end).collect();
            row.dedup_by(|a, b| a.distance(*b) < 0.002);
            if row.len() >= 2 {
                outlines.open.push(row);
            }
        }
        outlines
    }

    fn corners(&self, node: usize) -> Vec<Vec2> {
        self.nodes.get(node).into_iter().flatten().map(|corner| self.vertices[*corner]).collect()
    }

    /// The node that a point is in, or the nearest.
    fn node_of(&self, point: Vec2) -> Option<usize> {
        let distance = |node: usize| {
            let corners = self.corners(node);
            if corners.len() > 2 && polygon::contains(&corners, point) {
                return 0.0;
            }
            polygon::edges(&corners)
                .map(|(a, b)| polygon::point_segment_distance(point, a, b))
                .fold(f32::INFINITY, f32::min)
        };
        (0..self.nodes.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    }

    /// Places on the shortest way from one point to another, without the first, with the last: from node to node by the
    /// lengths between the middles of the doors, then pulled straight through doors narrowed by `radius`.
    pub(super) fn way(&self, from: Vec2, to: Vec2, radius: f32) -> Option<Vec<Vec2>> {
        let (start, end) = (self.node_of(from)?, self.node_of(to)?);
        let middle =
            |door: usize| (self.vertices[self.doors[door][0]] + self.vertices[self.doors[door][1]]) * 0.5;
        // Dijkstra over nodes; where one is entered is the middle of the door that led there.
        let count = self.nodes.len();
        let mut best = vec![(f32::INFINITY, from, usize::MAX); count];
        best[start] = (0.0, from, usize::MAX);
        let mut done = vec![false; count];
        loop {
            let open = (0..count).filter(|&node| !done[node] && best[node].0.is_finite());
            let Some(node) = open.min_by(|a, b| best[*a].0.total_cmp(&best[*b].0)) else { break };
            done[node] = true;
            for door in 0..self.doors.len() {
                let [_, _, a, b] = self.doors[door];
                let other = if a == node { b } else { a };
                if (a == node || b == node) && !done[other] {
                    let length = best[node].0 + best[node].1.distance(middle(door));
                    if length < best[other].0 {
                        best[other] = (length, middle(door), door);
                    }
                }
            }
        }
        if !done[end] {
            return None;
        }
        let (mut doors, mut node) = (Vec::new(), end);
        while best[node].2 != usize::MAX {
            let door = best[node].2;
            doors.push(door);
            let [_, _, a, b] = self.doors[door];
            node = if a == node { b } else { a };
        }
        doors.reverse();
        let portals: Vec<(Vec2, Vec2)> = doors.iter().map(|door| self.portal(*door, radius)).collect();
        Some(pulled(from, to, &portals))
    }

    /// The two ends of a door, each moved in by the radius as far as the door is wide enough.
    fn portal(&self, door: usize, radius: f32) -> (Vec2, Vec2) {
        let (a, b) = (self.vertices[self.doors[door][0]], self.vertices[self.doors[door][1]]);
        let inset = (b - a) * (radius / a.distance(b).max(1e-3)).min(0.45);
        (a + inset, b - inset)
    }
}

/// A short way through a row of portals: each place is moved to the point of its portal that is nearest to the straight line
/// between the places before and after, over and over; the length falls each time.
fn pulled(from: Vec2, to: Vec2, portals: &[(Vec2, Vec2)]) -> Vec<Vec2> {
    const ROUNDS: usize = 60;
    let mut places: Vec<Vec2> = portals.iter().map(|(a, b)| (*a + *b) * 0.5).collect();
    for _ in 0..ROUNDS {
        for i in 0..places.len() {
            let before = if i == 0 { from } else { places[i - 1] };
            let after = places.get(i + 1).copied().unwrap_or(to);
            let (a, b) = portals[i];
            let (along, door) = (after - before, b - a);
            let cross = door.perp_dot(along);
            let share = if cross.abs() > 1e-6 { (before - a).perp_dot(along) / cross } else { 0.5 };
            places[i] = a + door * share.clamp(0.0, 1.0);
        }
    }
    places.push(to);
    // Places on the straight line between their neighbours say nothing.
    let mut way: Vec<Vec2> = Vec::new();
    let mut last = from;
    for i in 0..places.len() {
        let is_last = i + 1 == places.len();
        if is_last || polygon::point_segment_distance(places[i], last, places[i + 1]) > 0.02 {
            way.push(places[i]);
            last = places[i];
        }
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// Two rooms side by side, a door of 2 m between them.
    const MESH: &str = "8\n 0 0\n 4 0\n 4 1\n 4 3\n 4 4\n 0 4\n 8 0\n 8 4\n
1\n 2 3 0 1\n
8\n 0 1 0 1\n 1 6 1 2\n 6 7 1 3\n 7 4 1 4\n 4 5 0 5\n 5 0 0 0\n 1 2 0 0\n 3 4 0 0\n
rooms\n2\n 2 2\n 6 0 1 2 3 4 5\n 0 0 0\n 1 0\n 1 0\n 6 2\n 6 1 6 7 4 3 2\n 0 0 0\n 1 0\n 1 1\n";

    fn mesh(text: &str) -> Result<NavMesh, Error> {
        NavMesh::parse(&Source { path: PathBuf::from("a.nav"), text: text.to_owned() })
    }

    #[test]
    fn the_way_goes_through_the_door_as_straight_as_it_can() {
        let mesh = mesh(MESH).unwrap();
        let way = mesh.way(Vec2::new(1.0, 2.0), Vec2::new(7.0, 2.2), 0.3).unwrap();
        assert_eq!(way, [Vec2::new(7.0, 2.2)], "in sight");
        let way = mesh.way(Vec2::new(3.9, 0.1), Vec2::new(4.1, 0.1), 0.3).unwrap();
        assert_eq!(way.len(), 2);
        assert!(way[0].distance(Vec2::new(4.0, 1.3)) < 0.01, "round the edge of the door: {}", way[0]);
        let outlines = mesh.outlines();
        assert_eq!(outlines.closed[0].len(), 6);
    }

    #[test]
    fn a_wall_after_which_none_follows_ends_a_row_of_walls() {
        // the last wall of the outline is left open, and two walls stand alone
        let cut = [" 5 0 0 0\n", " 1 2 0 0\n", " 3 4 0 0\n"]
            .iter()
            .fold(MESH.to_owned(), |mesh, wall| mesh.replace(wall, &wall.replace(" 0\n", " -1\n")));
        let outlines = mesh(&cut).unwrap().outlines();
        assert_eq!(outlines.closed, Vec::<Vec<Vec2>>::new());
        let lengths: Vec<usize> = outlines.open.iter().map(Vec::len).collect();
        assert_eq!(lengths, [7, 2, 2], "{outlines:?}");
        assert_eq!(outlines.open[1], [Vec2::new(4.0, 0.0), Vec2::new(4.0, 1.0)], "{outlines:?}");
    }

    #[test]
    fn a_broken_mesh_says_where() {
        for (text, why) in [
            ("2\n 0 0\n", "ends before"),
            ("1\n x 0\n", "not a number"),
            ("1\n 0 0\n 1\n 0 5 0 0\n", "not 0 to 0"),
            ("9999999999\n", "not 0 to"),
            ("1\n 0 0\n 1\n 0 0 3 3\n 0\n", "there are 0"),
            ("1\n 0 0\n 0\n 1\n 0 0 0 7\n", "not 0 to 0, or -1"),
        ] {
            let said = mesh(text).unwrap_err().to_string();
            assert!(said.contains(why) && said.contains("a.nav:"), "{text:?}: {said}");
        }
        for end in 0..MESH.len() {
            let _ = mesh(&MESH[..end]); // an answer, whichever, and no panic
        }
    }
}
