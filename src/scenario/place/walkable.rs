//! The walkable area from files of others: well-known text as JuPedSim and PedPy write it, or the floor of a glTF model.
//!
//! Well-known text has x to the right and y up the page; on the ground that is x and z = -y, as in trajectories. A
//! scenario may say that its text has z instead ([`Plane`]).

use super::solid;
use crate::scenario::file::{MAX_COORDINATE, Plane};
use crate::scenario::polygon::{self, UnionError};
use crate::{avatar, file, wkt};
use glam::{DVec2, Vec2, Vec3};
use std::path::Path;

/// Most corners of an area.
const MOST_CORNERS: usize = 200_000;
/// Most corners of a ring that is searched for crossings of its own edges (which takes the square of it).
const MOST_CHECKED: usize = 4096;
/// Largest file read, bytes.
const MOST_BYTES: u64 = 256 << 20;
/// A floor is no steeper than this: the least upward part of a triangle's unit normal (45 degrees).
const STEEPEST: f32 = 0.7;
/// How far a floor may lie above or below the ground, m.
const NEAR_GROUND: f32 = 0.5;
/// Smallest ring kept, m².
const SMALLEST: f64 = 1e-3;

/// Text or a model without a walkable area.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AreaError {
    /// The text is not well-known text of polygons.
    #[error(transparent)]
    Text(#[from] wkt::Error),
    /// There is too much of it.
    #[error("has {count} {of}; at most {most} are read")]
    Large {
        /// How many there are.
        count: usize,
        /// Of what.
        of: &'static str,
        /// How many may be.
        most: usize,
    },
    /// The text has no polygon.
    #[error("holds no polygon")]
    NoPolygon,
    /// A ring crosses itself.
    #[error("ring {ring} (by size) crosses itself at its edges {} and {}", .edges[0], .edges[1])]
    Crossed {
        /// Number of the ring, the largest first.
        ring: usize,
        /// Numbers of its edges.
        edges: [usize; 2],
    },
    /// The model has no floor near the ground.
    #[error("has no floor: no triangle faces up within {NEAR_GROUND} m of y = 0 (units are metres, y is up)")]
    NoFloor,
    /// All rings are empty.
    #[error("has no area")]
    NoArea,
    /// The area does not hang together.
    #[error("is in {parts} parts that do not touch; make them one area, or one scenario each")]
    Apart {
        /// How many parts there are.
        parts: usize,
    },
    /// Its polygons cannot be united.
    #[error(transparent)]
    Union(#[from] UnionError),
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] avatar::Error),
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] std::io::Error),
}

/// A walkable area: an outline with holes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Area {
    /// Outline on (x, z), m.
    pub bounds: Vec<Vec2>,
    /// What is not walkable inside it, m.
    pub holes: Vec<Vec<Vec2>>,
}

impl Area {
    /// As [`Self::from_wkt`], with the second coordinate read as `plane` says.
    ///
    /// # Errors
    /// As [`Self::from_wkt`].
    pub fn from_wkt_in(plane: Plane, text: &str) -> Result<Self, AreaError> {
        let mut area = Self::from_wkt(text)?;
        if plane == Plane::Xz {
            let corners = area.bounds.iter_mut().chain(area.holes.iter_mut().flatten());
            corners.for_each(|corner| corner.y = 0.0 - corner.y);
        }
        Ok(area)
    }

    /// Reads POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION (of these); several polygons are united where they overlap or
    /// come within a millimetre of each other.
    ///
    /// # Errors
    /// What is wrong with the text and where, or how many parts there are that do not hang together.
    pub fn from_wkt(text: &str) -> Result<Self, AreaError> {
        let faces = wkt::polygons(text, f64::from(MAX_COORDINATE))?;
        let corners: usize = faces.iter().flatten().map(Vec::len).sum();
        if corners > MOST_CORNERS {
            return Err(AreaError::Large { count: corners, of: "corners", most: MOST_CORNERS });
        }
        match faces.as_slice() {
            [] => Err(AreaError::NoPolygon),
            [one] => {
                let area = Self::of_rings(one.clone())?;
                let crossed = std::iter::once(&area.bounds).chain(&area.holes).enumerate().find_map(
                    |(number, ring)| {
                        let few = ring.len() <= MOST_CHECKED;
                        few.then(|| polygon::self_intersection(ring)).flatten().map(|edges| (number, edges))
                    },
                );
                match crossed {
                    None => Ok(area),
                    Some((ring, (i, j))) => Err(AreaError::Crossed { ring, edges: [i, j] }),
                }
            }
            _ => Self::of_rings(polygon::union(&faces)?),
        }
    }

    /// The floor that triangles make: those that face up by more than 45 degrees from the vertical's side and lie within half a metre of
    /// the ground (y = 0), seen from above, united where their edges come within a millimetre of each other. Metres, y up.
    ///
    /// # Errors
    /// When there is no floor, or it does not hang together.
    pub fn from_triangles(triangles: &[[Vec3; 3]]) -> Result<Self, AreaError> {
        Self::of_rings(floor(triangles)?)
    }

    /// Reads a `.wkt` or `.txt` in a plane, or the floor of a `.glb` or `.gltf` (of the nodes with that name and those below them, or all).
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(path: &Path, node: Option<&str>, plane: Plane) -> Result<Self, AreaError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if extension == "glb" || extension == "gltf" {
            let triangles = avatar::triangles(path, node)?;
            return Self::from_triangles(&triangles);
        }
        Self::from_wkt_in(plane, &file::read_text(path, MOST_BYTES)?)
    }

    /// Where people can walk in a model: on its floor (of the nodes with that name and those below them, or of all of it), but not
    /// where anything of the model is between 0.3 and 1.8 m above the ground. Of parts that walls cut off the largest counts.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(crate) fn of_place(path: &Path, node: Option<&str>) -> Result<Self, AreaError> {
        // with cut-outs whole: one does not walk through a fence
        let all = avatar::place(path)?.triangles();
        let floor = match node {
            Some(_) => floor(&avatar::triangles(path, node)?)?,
            None => floor(&all)?,
        };
        let solid = solid::faces(&all);
        if solid.len() > MOST_CORNERS {
            let of = "triangles that stand in people's way";
            return Err(AreaError::Large { count: solid.len(), of, most: MOST_CORNERS });
        }
        Self::of_rings(polygon::largest_without(&floor, &solid))
    }

    /// The area as POLYGON.
    pub fn to_wkt(&self) -> String {
        let rings = std::iter::once(&self.bounds).chain(&self.holes);
        let page = |ring: &Vec<Vec2>| ring.iter().map(|at| [at.x, 0.0 - at.y]).collect();
        wkt::text(&[rings.map(page).collect()])
    }

    /// Whether a point is walkable.
    pub(crate) fn contains(&self, at: Vec2) -> bool {
        polygon::contains(&self.bounds, at) && !self.holes.iter().any(|hole| polygon::contains(hole, at))
    }

    pub(crate) fn edges(&self) -> impl Iterator<Item = (Vec2, Vec2)> {
        polygon::edges(&self.bounds).chain(self.holes.iter().flat_map(|hole| polygon::edges(hole)))
    }

    /// Distance of a point to the nearest edge, m.
    pub(crate) fn distance(&self, at: Vec2) -> f32 {
        self.edges().map(|(a, b)| polygon::point_segment_distance(at, a, b)).fold(f32::INFINITY, f32::min)
    }

    /// Whether some of a region is walkable, or touches what is.
    pub(crate) fn meets(&self, region: &[Vec2]) -> bool {
        region.iter().any(|corner| self.contains(*corner))
            || self.edges().any(|(a, b)| {
                polygon::contains(region, a)
                    || polygon::edges(region).any(|(c, d)| polygon::segments_meet(a, b, c, d))
            })
    }

    /// The largest ring is the outline, all others must be holes in it.
    fn of_rings(rings: Vec<Vec<DVec2>>) -> Result<Self, AreaError> {
        let mut found: Vec<(f64, Vec<Vec2>)> = Vec::new();
        for ring in rings {
            let ring: Vec<Vec2> = ring.iter().map(|at| DVec2::new(at.x, -at.y).as_vec2()).collect();
            let area = polygon::signed_area(&ring).abs();
            if area > SMALLEST {
                found.push((area, ring));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut rings = found.into_iter().map(|(_, ring)| ring);
        let bounds = rings.next().ok_or(AreaError::NoArea)?;
        let holes: Vec<Vec<Vec2>> = rings.collect();
        let apart =
            holes.iter().filter(|hole| !hole.iter().any(|at| polygon::contains(&bounds, *at))).count();
        if apart > 0 {
            return Err(AreaError::Apart { parts: apart + 1 });
        }
        Ok(Self { bounds, holes })
    }
}

/// The rings of the floor that triangles make, on (x, -z), m.
fn floor(triangles: &[[Vec3; 3]]) -> Result<Vec<Vec<DVec2>>, AreaError> {
    let is_floor = |t: &&[Vec3; 3]| {
        let normal = (t[1] - t[0]).cross(t[2] - t[0]);
        t.iter().all(|corner| corner.y.abs() <= NEAR_GROUND) && normal.y > STEEPEST * normal.length()
    };
    // x, z as the page's x, y upside down: what comes out is turned back with the rest
    let flat = |corner: Vec3| DVec2::new(f64::from(corner.x), -f64::from(corner.z));
    let faces: Vec<Vec<Vec<DVec2>>> =
        triangles.iter().filter(is_floor).map(|t| vec![t.map(flat).to_vec()]).collect();
    if faces.len() > MOST_CORNERS {
        return Err(AreaError::Large { count: faces.len(), of: "triangles of floor", most: MOST_CORNERS });
    }
    if faces.is_empty() {
        return Err(AreaError::NoFloor);
    }
    Ok(polygon::union(&faces)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(text: &str) -> f64 {
        let area = Area::from_wkt(text).unwrap();
        let holes: f64 = area.holes.iter().map(|hole| polygon::signed_area(hole).abs()).sum();
        polygon::signed_area(&area.bounds).abs() - holes
    }

    #[test]
    fn a_polygon_with_a_hole_lies_on_the_ground_with_z_against_y() {
        let area = Area::from_wkt("POLYGON ((0 0, 4 0, 4 3, 0 3, 0 0), (1 1, 2 1, 2 2, 1 2, 1 1))").unwrap();
        assert!(area.bounds.contains(&Vec2::new(4.0, -3.0)) && area.holes[0].contains(&Vec2::new(1.0, -1.0)));
        assert_eq!(Area::from_wkt(&area.to_wkt()).unwrap(), area);
    }

    #[test]
    fn polygons_that_overlap_touch_or_share_part_of_an_edge_are_one_area() {
        let square = |x: f64, y: f64, s: f64| {
            let (u, v) = (x + s, y + s);
            format!("(({x} {y}, {u} {y}, {u} {v}, {x} {v}, {x} {y}))")
        };
        let many = |list: &[String]| format!("MULTIPOLYGON ({})", list.join(", "));
        assert!((area(&many(&[square(0., 0., 2.), square(1., 1., 2.)])) - 7.0).abs() < 1e-6, "overlap");
        assert!(
            (area(&many(&[square(0., 0., 2.), square(2., 0.5, 1.)])) - 5.0).abs() < 1e-6,
            "part of an edge"
        );
        assert!((area(&many(&[square(0., 0., 2.), square(2.0004, 0.0, 2.)])) - 8.0).abs() < 4e-3, "almost");
        let collection =
            format!("GEOMETRYCOLLECTION (POLYGON {}, POLYGON {})", square(0., 0., 4.), square(1., 1., 1.));
        assert!((area(&collection) - 16.0).abs() < 1e-6, "one inside another");
        // a frame of four bars has a hole
        let bars = "MULTIPOLYGON (((0 0, 5 0, 5 1, 0 1, 0 0)), ((0 4, 5 4, 5 5, 0 5, 0 4)), ((0 0, 1 0, 1 5, 0 5, 0 0)), ((4 0, 5 0, 5 5, 4 5, 4 0)))";
        assert!((area(bars) - 16.0).abs() < 1e-6);
        assert_eq!(Area::from_wkt(bars).unwrap().holes.len(), 1);
        let error = Area::from_wkt(&many(&[square(0., 0., 1.), square(3., 0., 1.)])).unwrap_err().to_string();
        assert!(error.contains("2 parts"), "{error}");
    }

    #[test]
    fn a_floor_of_triangles_is_its_outline_whatever_else_the_model_holds() {
        let quad = |x: [f32; 2], z: [f32; 2], y: f32| {
            let p = |i: usize, j: usize| Vec3::new(x[i], y, z[j]);
            [[p(0, 0), p(0, 1), p(1, 1)], [p(0, 0), p(1, 1), p(1, 0)]]
        };
        let mut model = Vec::new();
        for i in 0..3_u8 {
            for j in (0..3_u8).filter(|j| (i, *j) != (1, 1)) {
                let at = |n: u8| [f32::from(n) * 2.0, f32::from(n) * 2.0 + 2.0];
                model.extend(quad(at(i), at(j), 0.01 * f32::from(i)));
            }
        }
        model.extend(quad([-20.0, 20.0], [-20.0, 20.0], 3.0)); // a ceiling, or another storey
        model.extend(quad([-9.0, 9.0], [-9.0, 9.0], 0.0).map(|[a, b, c]| [a, c, b])); // seen from below
        let area = Area::from_triangles(&model).unwrap();
        assert!((polygon::signed_area(&area.bounds).abs() - 36.0).abs() < 1e-3);
        assert_eq!((area.bounds.len(), area.holes.len()), (4, 1), "{area:?}");
        assert!(area.bounds.contains(&Vec2::new(6.0, 6.0)));
        assert!(Area::from_triangles(&[]).unwrap_err().to_string().contains("no floor"));
    }
}
