//! How a place without props looks: its obstacles as low walls, so that the crowd behind them is seen, and a kerb along its
//! bounds.

use super::material::SurfaceMaterial;
use super::mesh::{Builder, EnvironmentMesh, Finish, srgb};
use crate::scenario::polygon;
use glam::{Vec2, Vec3};

/// Height of an obstacle that says none, m: one looks over it.
const HEIGHT: f32 = 1.1;
/// Most triangles of a place with its walls.
const MOST: usize = Finish::Plain.most_triangles();
/// Height and width of the kerb, m.
const KERB: [f32; 2] = [0.12, 0.2];

/// Something solid, as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wall {
    /// Corners, either way round, m.
    pub(crate) outline: Vec<Vec2>,
    /// Its lowest and highest point, m, as far as the file says.
    pub(crate) heights: [Option<f32>; 2],
}

/// Adds walls to a mesh, and a kerb around `bounds`, as far as its greatest size allows.
pub(crate) fn draw(mesh: &mut EnvironmentMesh, walls: &[Wall], bounds: &[Vec2]) {
    let (stone, edge) = (srgb(0x00a7_9c8c), srgb(0x008d_8a83));
    for wall in walls {
        if mesh.triangle_count() + 4 * wall.outline.len() > MOST {
            return;
        }
        let low = wall.heights[0].unwrap_or(0.0).max(0.0);
        let high = wall.heights[1].unwrap_or(low + HEIGHT).max(low);
        prism(mesh, &polygon::oriented(wall.outline.clone(), true), [low, high], stone);
    }
    let kerb: Vec<[Vec2; 2]> = polygon::edges(bounds).map(|(a, b)| [a, b]).collect();
    if mesh.triangle_count() + 12 * kerb.len() > MOST {
        return;
    }
    for [a, b] in kerb {
        // outside is to the left of the bounds' edges; corners overlap
        let along = (b - a).normalize_or_zero() * KERB[1];
        let (a, b, out) = (a - along, b + along, -along.perp());
        prism(mesh, &polygon::oriented(vec![a, b, b + out, a + out], true), [0.0, KERB[0]], edge);
    }
}

/// An upright body over a polygon that runs counter-clockwise on (x, z).
fn prism(mesh: &mut EnvironmentMesh, outline: &[Vec2], [low, high]: [f32; 2], color: Vec3) {
    let mut builder = Builder::new(mesh, Vec3::ZERO, 0.0);
    builder.of(SurfaceMaterial::Plaster);
    let at = |p: Vec2, y: f32| Vec3::new(p.x, y, p.y);
    for (a, b) in polygon::edges(outline) {
        builder.quad([at(a, high), at(b, high), at(b, low), at(a, low)], color * 0.9);
    }
    for [a, b, c] in ears(outline) {
        // seen from above, (x, z) is left-handed: counter-clockwise there is clockwise from above
        builder.triangle([c, b, a].map(|p| at(p, high)), color);
        if low > 0.0 {
            builder.triangle([a, b, c].map(|p| at(p, low)), color * 0.6);
        }
    }
}

/// Triangles of a polygon without holes that runs counter-clockwise and does not cross itself, by cutting off ears.
fn ears(outline: &[Vec2]) -> Vec<[Vec2; 3]> {
    let mut left = outline.to_vec();
    let mut triangles = Vec::with_capacity(left.len().saturating_sub(2));
    while left.len() > 2 {
        let count = left.len();
        let corners = |i: usize| [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
        let is_ear = |i: &usize| {
            let [a, b, c] = corners(*i);
            let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p);
            let within = |p: &&Vec2| {
                **p != a
                    && **p != b
                    && **p != c
                    && side(a, b, **p) >= 0.0
                    && side(b, c, **p) >= 0.0
                    && side(c, a, **p) >= 0.0
            };
            side(a, b, c) > 0.0 && !left.iter().any(|p| within(&p))
        };
        // where rounding leaves no ear, the flattest corner goes
        let ear = (0..count).find(is_ear).unwrap_or(0);
        triangles.push(corners(ear));
        left.remove(ear);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area([a, b, c]: [Vec2; 3]) -> f32 {
        (b - a).perp_dot(c - a) * 0.5
    }

    #[test]
    #[allow(clippy::cast_possible_truncation, reason = "a few square metres")]
    fn ears_cover_the_polygon_and_nothing_else() {
        let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]].map(Vec2::from);
        let star: Vec<Vec2> = (0..10)
            .map(|i| Vec2::from_angle(i as f32 * 0.628) * if i % 2 == 0 { 3.0 } else { 1.0 })
            .collect();
        for polygon in [l.to_vec(), star] {
            let triangles = ears(&polygon);
            assert_eq!(triangles.len(), polygon.len() - 2);
            assert!(triangles.iter().all(|t| area(*t) > 0.0));
            let whole: f32 = triangles.iter().map(|t| area(*t)).sum();
            assert!((whole - polygon::signed_area(&polygon).abs() as f32).abs() < 1e-4, "{whole}");
            for [a, b, c] in triangles {
                assert!(polygon::contains(&polygon, (a + b + c) / 3.0));
            }
        }
    }

    #[test]
    fn a_wall_is_closed_faces_outwards_and_has_its_height() {
        let square = [[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]].map(Vec2::from).to_vec();
        let mut mesh = EnvironmentMesh::default();
        let wall = |low, high| Wall { outline: square.clone(), heights: [low, high] };
        draw(&mut mesh, &[wall(None, None), wall(Some(3.0), Some(5.0))], &[]);
        let tops: Vec<f32> = mesh.positions.iter().map(|p| p.y).collect();
        assert!(tops.contains(&HEIGHT) && tops.contains(&3.0) && tops.contains(&5.0));
        assert!(tops.iter().all(|y| (0.0..=5.0).contains(y)));
        for (corner, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let middle = Vec3::new(1.0, if corner.y < 2.0 { 0.5 } else { 4.0 }, 1.0);
            assert!((*corner - middle).dot(*normal) > 0.0, "{corner} {normal}");
        }
        // the kerb lies outside of the bounds
        let mut kerb = EnvironmentMesh::default();
        draw(&mut kerb, &[], &polygon::oriented(square, false));
        let inside = |p: &&Vec3| (0.01..1.99).contains(&p.x) && (0.01..1.99).contains(&p.z);
        assert!(!kerb.positions.is_empty() && !kerb.positions.iter().any(|p| inside(&p)));
    }
}
