//! Where everything is: the walkable area, floors, what is solid, how far away it is, and the mesh of the scenery.

mod clearance;
mod environment;
mod external;
mod floors;
mod geometry;
mod material;
mod mesh;
mod props;
mod shapes;
mod solid;
mod stages;
mod walkable;
mod walls;

pub use clearance::Clearance;
pub(crate) use environment::place_model;
pub use external::{ExternalBodies, external_bodies};
pub(crate) use floors::MAX_FLOOR_CORNERS;
pub use floors::{Floors, RAILING, Raised};
pub use geometry::Geometry;
pub use material::SurfaceMaterial;
pub use mesh::{Distant, EnvironmentMesh, Finish};
pub use walkable::{Area, AreaError};
