//! How each prop is drawn. Flat things lie in layers, see [`EnvironmentMesh::layers`]: none flickers through another.
//!
//! [`EnvironmentMesh::layers`]: super::EnvironmentMesh::layers

mod facade;
mod ground;
mod letters;
mod look;
mod outpost;
mod plants;
mod shops;
mod street;
mod vehicles;

use super::material::SurfaceMaterial as Material;
use super::mesh::{Builder, EnvironmentMesh, srgb};
use crate::scenario::file::{Prop, PropKind};
use glam::Vec3;
use look::v;

pub(crate) use ground::GROUND;
pub(crate) use look::{Detail, Look};
pub(crate) use plants::trunk_radius;

/// Draws a prop.
pub(crate) fn draw(mesh: &mut EnvironmentMesh, prop: &Prop, look: &Look) {
    let [x, z] = prop.position;
    let b = &mut Builder::new(mesh, v(x, 0.0, z), prop.heading_deg.to_radians());
    let size = Vec3::from(prop.size);
    match prop.kind {
        PropKind::Pavement => ground::pavement(b, size, look),
        PropKind::Zebra => ground::zebra(b, size, look),
        PropKind::Line => ground::line(b, size),
        PropKind::Lawn => ground::lawn(b, size, look),
        PropKind::Strip => ground::strip(b, size),
        PropKind::LandingPad => outpost::landing_pad(b, size),
        _ if look.detail == Detail::Box => far(b, prop.kind, size, look),
        PropKind::Building => facade::building(b, size, look),
        PropKind::Store => shops::store(b, size, look),
        PropKind::Lamp => street::lamp(b, size),
        PropKind::TrafficLight => street::traffic_light(b, size, look),
        PropKind::Tree => plants::tree(b, size, look),
        PropKind::Hedge => plants::hedge(b, Vec3::ZERO, size, look),
        PropKind::Bed => plants::bed(b, size, look),
        PropKind::Bench => street::bench(b, size),
        PropKind::Fountain => street::fountain(b, size, look),
        PropKind::Car => vehicles::car(b, size, look),
        PropKind::Pod => outpost::pod(b, size, look),
        PropKind::Column => outpost::column(b, size),
        PropKind::Wall => outpost::wall(b, size),
        PropKind::Box => b.block(Vec3::ZERO, size, srgb(0x9a9a98)),
    }
}

/// A plain box in the thing's main colour, for the distance.
fn far(b: &mut Builder<'_>, kind: PropKind, size: Vec3, look: &Look) {
    let color = match kind {
        PropKind::Building => look.pick(0, &facade::WALLS),
        PropKind::Store => srgb(shops::WALL),
        PropKind::Tree | PropKind::Hedge => srgb(0x3f7038),
        PropKind::Bed => srgb(0x5d8a45),
        PropKind::Car => look.pick(0, &vehicles::PAINTS),
        PropKind::Pod => srgb(0xe6ebf0),
        PropKind::Wall => srgb(0x566074),
        _ => srgb(0x8a8f98),
    };
    b.of(match kind {
        PropKind::Building | PropKind::Store => Material::Plaster,
        PropKind::Tree | PropKind::Hedge | PropKind::Bed => Material::Foliage,
        PropKind::Car | PropKind::Pod => Material::Lacquer,
        _ => Material::Plain,
    });
    match kind {
        PropKind::Tree => b.block(v(0.0, size.y * 0.3, 0.0), size * v(0.8, 0.7, 0.8), color),
        PropKind::Lamp | PropKind::TrafficLight => b.block(Vec3::ZERO, v(0.12, size.y, 0.12), color),
        PropKind::Pod => b.turned(Vec3::ZERO, &[(size.x * 0.5, 0.0), (size.x * 0.3, size.y)], 6, color),
        _ => b.block(Vec3::ZERO, size, color),
    }
}
