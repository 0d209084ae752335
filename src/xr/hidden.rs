//! What the lenses hide of each eye's image (`XR_KHR_visibility_mask`), as triangles in clip space.

use openxr as xr;

/// A mask as the runtime gives it: corners on the plane one metre before the eye, and triangles of them.
pub(super) type Mask = xr::VisibilityMask;

/// The masks of both eyes, and the fields of view that their triangles were made for.
#[derive(Default)]
pub(super) struct Hidden {
    masks: [Mask; 2],
    made_for: Option<[xr::Fovf; 2]>,
}

impl Hidden {
    /// Takes other masks.
    pub(super) fn set(&mut self, masks: [Mask; 2]) {
        *self = Self { masks, made_for: None };
    }

    /// Gives the corners again: what draws has changed.
    pub(super) fn renew(&mut self) {
        self.made_for = None;
    }

    /// Triangles that are hidden to each eye.
    pub(super) fn triangles(&self) -> [usize; 2] {
        [0, 1].map(|eye| self.masks[eye].indices.len() / 3)
    }

    /// The corners for these fields of view if they have changed since the last call: the left eye's, then as many of
    /// the right one's.
    pub(super) fn corners(&mut self, fovs: [xr::Fovf; 2]) -> Option<Vec<[f32; 4]>> {
        if self.made_for == Some(fovs) {
            return None;
        }
        self.made_for = Some(fovs);
        let mut eyes = [0, 1].map(|eye| corners(&self.masks[eye], fovs[eye]));
        let most = eyes[0].len().max(eyes[1].len());
        eyes.iter_mut().for_each(|eye| eye.resize(most, [0.0, 0.0, 1.0, 1.0])); // triangles without an area
        Some(eyes.concat())
    }
}

/// One eye's corners. Triangles that lead nowhere are left out.
fn corners(mask: &Mask, fov: xr::Fovf) -> Vec<[f32; 4]> {
    let (left, right) = (fov.angle_left.tan(), fov.angle_right.tan());
    let (up, down) = (fov.angle_up.tan(), fov.angle_down.tan());
    let corner = |index: &u32| {
        let at = mask.vertices.get(*index as usize)?;
        // as `views::projection` has it: x to the right, y down
        let x = (2.0 * at.x - right - left) / (right - left);
        let y = (up + down - 2.0 * at.y) / (up - down);
        (x.is_finite() && y.is_finite()).then_some([x, y, 1.0, 1.0])
    };
    let triangle = |indices: &[u32]| Some([corner(&indices[0])?, corner(&indices[1])?, corner(&indices[2])?]);
    mask.indices.chunks_exact(3).filter_map(triangle).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::super::views::projection;
    use super::*;
    use glam::Vec3;

    fn fov(right: f32) -> xr::Fovf {
        xr::Fovf { angle_left: -0.9, angle_right: right, angle_up: 0.8, angle_down: -0.95 }
    }

    #[test]
    fn corners_lie_where_the_image_shows_them_and_follow_the_view() {
        let vertices = [(-1.2, 1.0), (0.5, -0.3), (0.1, 0.9), (f32::NAN, 0.0)];
        let vertices = vertices.map(|(x, y)| xr::Vector2f { x, y }).to_vec();
        let one = Mask { vertices: vertices.clone(), indices: vec![0, 1, 2, 0, 1, 9, 0, 1, 3] };
        let two = Mask { vertices, indices: vec![0, 1, 2, 2, 1, 0] };
        let mut hidden = Hidden::default();
        hidden.set([one, two]);
        assert_eq!(hidden.triangles(), [3, 2]);
        let made = hidden.corners([fov(0.7), fov(0.6)]).unwrap_or_default();
        assert_eq!(made.len(), 12, "as many of one eye as of the other");
        for (place, at) in [(0, Vec3::new(-1.2, 1.0, -1.0)), (1, Vec3::new(0.5, -0.3, -1.0))] {
            let seen = projection(fov(0.7)).project_point3(at);
            assert!((seen.x - made[place][0]).abs() < 1e-5 && (seen.y - made[place][1]).abs() < 1e-5);
        }
        assert_eq!(made[3..6], [[0.0, 0.0, 1.0, 1.0]; 3]);
        assert!(hidden.corners([fov(0.7), fov(0.6)]).is_none());
        assert!(hidden.corners([fov(0.7), fov(0.5)]).is_some());
    }
}
