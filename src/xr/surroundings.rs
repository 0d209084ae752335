//! What the headset shows of a scene, and where its user may go.

use super::rig::Stand;
use super::world::next_number;
use crate::kernels::Store;
use crate::render::{Quality, Settings};
use crate::scenario::{Clearance, EnvironmentMesh, Floors, Gaze};
use crate::scene::{Scene, atmosphere};
use crate::sim::bodies::MeshBuffers;
use crate::sim::snapshots::make_room;
use glam::Vec2;

/// Texels a side of the shadow map: a headset draws twice.
const SHADOW_SIZE: u32 = 1024;

/// What the headset shows, and where its user may go.
pub(super) struct Surroundings {
    /// Names it among all of this program.
    pub(super) number: u64,
    /// The crowd at its start, with bodies filled in.
    pub(super) store: Store,
    /// The bodies' meshes.
    pub(super) meshes: MeshBuffers,
    /// The scenery.
    pub(super) scenery: EnvironmentMesh,
    /// Light and quality; size and number of eyes follow the headset.
    pub(super) settings: Settings,
    /// How agents gaze.
    pub(super) gaze: Gaze,
    /// Levels of detail end here, and the crowd, m.
    pub(super) level_distances: [f32; 3],
    /// Where the user begins.
    pub(super) start: Stand,
    /// What the user may stand on.
    pub(super) floors: Floors,
    /// Where the user may be moved to by stick or teleport.
    free: Clearance,
    /// Radius of the user, m.
    radius: f32,
}

impl std::fmt::Debug for Surroundings {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Surroundings").field("number", &self.number).finish_non_exhaustive()
    }
}

impl Surroundings {
    pub(super) fn of(scene: &Scene, mut store: Store, meshes: MeshBuffers, quality: Quality) -> Self {
        let geometry = &scene.geometry;
        let user = scene.scenario.user.unwrap_or_default();
        let [near, middle, far, ..] = store.frame.level_distance;
        make_room(&mut store);
        Self {
            number: next_number(),
            store,
            meshes,
            scenery: geometry.scenery_of(quality.finish()),
            settings: Settings {
                atmosphere: atmosphere(scene.scenario.layout),
                shadow_size: SHADOW_SIZE,
                quality,
                ..Settings::default()
            },
            gaze: scene.scenario.gaze,
            level_distances: [near, middle, far],
            start: Stand {
                position: geometry.user.unwrap_or_default(),
                elevation: geometry.user_elevation,
                heading: user.heading_deg.to_radians(),
            },
            floors: geometry.floors.clone(),
            free: Clearance::new(&geometry.bounds, &geometry.obstacles),
            radius: user.radius,
        }
    }

    /// Whether the user may be moved to a place, on a floor of some height, m.
    pub(super) fn is_free(&self, place: Vec2, height: f32) -> bool {
        self.free.admits(place, self.radius) && self.floors.admits(place, self.radius, height)
    }
}
