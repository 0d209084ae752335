//! Ways to goals: distances against exact ones, traps, doors, crowds, and the same bits on both backends.

mod storeys;

use crate::common::{glb, gpu};
use gaitway::avatar::{Sex, generated};
use gaitway::kernels::flow::FAR;
use gaitway::kernels::shared::way::SOLID;
use gaitway::kernels::{BufferId, Store};
use gaitway::library::GaitLibrary;
use gaitway::reference::way::flow_direction;
use gaitway::scenario::{Scenario, populate};
use gaitway::sim::flow::{Goal, Raster, Settings, lay};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure};
use glam::Vec2;
use serde_json::json;

type Outlines = Vec<Vec<[f32; 2]>>;

/// A rectangle to walk in.
fn floor(width: f32, depth: f32) -> Vec<[f32; 2]> {
    vec![[0.0, 0.0], [0.0, depth], [width, depth], [width, 0.0]]
}

/// Something solid.
fn block(x: [f32; 2], z: [f32; 2]) -> Vec<[f32; 2]> {
    vec![[x[0], z[0]], [x[1], z[0]], [x[1], z[1]], [x[0], z[1]]]
}

fn goal(x: f32, z: f32) -> Goal {
    Goal { name: "there".into(), center: Vec2::new(x, z), radius: 0.5, ..Goal::default() }
}

fn solved(outlines: &Outlines, goals: &[Goal], settings: &Settings, backend: Backend) -> Store {
    let mut store = Store::default();
    gaitway::sim::setup::scratch(&mut store);
    lay(&mut store, outlines, goals, settings).unwrap();
    let mut simulation = Simulation::from_store(store, backend, None).unwrap();
    simulation.read(&[BufferId::FlowDistance, BufferId::FlowWay, BufferId::FlowArgs]).unwrap().clone()
}

/// Free cells of field 0: middle and distance, m.
fn cells(store: &Store) -> Vec<(Vec2, f32)> {
    let grid = &store.flow_grid;
    (0..grid.cell_count)
        .filter(|cell| store.flow_cells[*cell as usize] & SOLID == 0)
        .map(|cell| {
            let at = Vec2::new((cell % grid.columns) as f32 + 0.5, (cell / grid.columns) as f32 + 0.5);
            (Vec2::from_array(grid.origin) + at * grid.cell_size, store.flow_distance[cell as usize])
        })
        .collect()
}

/// Mean and largest of |found / wanted - 1| over cells farther than `from` m.
fn errors(store: &Store, from: f32, wanted: impl Fn(Vec2) -> f32) -> (f32, f32) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f32, 0);
    for (at, found) in cells(store) {
        let wanted = wanted(at);
        if wanted > from {
            let error = (found / wanted - 1.0).abs();
            (sum, worst, count) = (sum + error, worst.max(error), count + 1);
        }
    }
    (sum / count as f32, worst)
}

#[test]
fn distances_in_the_open_are_euclidean() {
    for cell in [0.25, 0.5] {
        let settings = Settings { cell: Some(cell), ..Settings::default() };
        let store = solved(&vec![floor(60.0, 40.0)], &[goal(23.1, 17.7)], &settings, Backend::Cpu);
        let (mean, worst) = errors(&store, 4.0 * cell, |at| at.distance(Vec2::new(23.1, 17.7)));
        println!("cells {cell}: mean {mean} worst {worst}");
        assert!(mean < 0.012 && worst < 0.025, "cells of {cell} m: mean {mean}, worst {worst}");
    }
}

#[test]
fn distances_round_a_block_are_those_over_its_corners() {
    let outlines = vec![floor(60.0, 40.0), block([20.0, 24.0], [10.0, 40.0])];
    let (target, r) = (Vec2::new(10.0, 30.0), 0.25);
    let corners = [Vec2::new(20.0 - r, 10.0 - r), Vec2::new(24.0 + r, 10.0 - r)];
    let store = solved(&outlines, &[goal(target.x, target.y)], &Settings::default(), Backend::Cpu);
    let wanted = |at: Vec2| {
        if at.x < 20.0 {
            return at.distance(target);
        }
        let first = target.distance(corners[0]);
        let round = first + corners[0].distance(corners[1]) + corners[1].distance(at);
        // seen past the first corner alone
        let line = (at - corners[0]).perp_dot(corners[1] - corners[0]);
        if (at.x < corners[1].x && at.y < 10.0) || line >= 0.0 {
            // or from the goal itself
            let sees = (corners[0] - target).perp_dot(at - target) <= 0.0;
            return if sees { at.distance(target) } else { first + corners[0].distance(at) };
        }
        round
    };
    let (mean, worst) = errors(&store, 2.0, wanted);
    println!("block: mean {mean} worst {worst}");
    assert!(mean < 0.015 && worst < 0.04, "mean {mean}, worst {worst}");
}

#[test]
fn following_the_field_leads_out_of_a_trap_and_never_through_a_wall() {
    // a cup open to the left, the goal behind it
    let outlines = vec![
        floor(40.0, 30.0),
        block([10.0, 25.0], [8.0, 9.0]),
        block([10.0, 25.0], [21.0, 22.0]),
        block([24.0, 25.0], [8.5, 21.5]),
    ];
    let target = Vec2::new(35.0, 15.0);
    for size in [0.25, 0.5] {
        let settings = Settings { cell: Some(size), ..Settings::default() };
        let store = solved(&outlines, &[goal(target.x, target.y)], &settings, Backend::Cpu);
        for start in
            [Vec2::new(23.0, 15.0), Vec2::new(23.6, 9.4), Vec2::new(12.0, 20.6), Vec2::new(24.5, 15.0)]
        {
            let (mut at, mut walked) = (start, 0.0);
            while at.distance(target) > 0.3 && walked < 100.0 {
                let to = target - at;
                let way = flow_direction(&store.flow_grid, &store.flow_way, 0, at.to_array(), to.to_array());
                let before = at;
                at += Vec2::from_array(way).normalize() * 0.05;
                walked += 0.05;
                // a start inside a wall may leave it, but no agent may enter one
                for wall in &outlines[1..] {
                    let inside = |p: Vec2| {
                        p.x > wall[0][0] && p.x < wall[1][0] && p.y > wall[0][1] && p.y < wall[2][1]
                    };
                    assert!(
                        inside(start) || inside(before) || !inside(at),
                        "cells {size} m, from {start}: into a wall at {at}"
                    );
                }
            }
            println!("from {start}: {walked} m");
            assert!(walked < 60.0, "cells {size} m, from {start}: lost at {at} after {walked} m");
        }
    }
}

#[test]
fn a_goal_in_a_wall_is_refused_by_name_and_a_pocket_leads_nowhere() {
    let outlines = vec![floor(20.0, 20.0), block([5.0, 10.0], [5.0, 10.0])];
    let mut store = Store::default();
    gaitway::sim::setup::scratch(&mut store);
    let error = lay(&mut store, &outlines, &[goal(7.5, 7.5)], &Settings::default()).unwrap_err().to_string();
    assert!(error.contains("\"there\"") && error.contains("(7.50, 7.50)"), "{error}");
    assert_eq!(store.flow_grid.field_count, 0, "nothing has changed");
    let error = lay(&mut store, &outlines, &[goal(70.5, 7.5)], &Settings::default()).unwrap_err().to_string();
    assert!(error.contains("outside"), "{error}");
    let tiny = Settings { cell: Some(0.001), ..Settings::default() };
    let error = lay(&mut store, &outlines, &[goal(2.0, 2.0)], &tiny).unwrap_err().to_string();
    assert!(error.contains("way_finding.cell") && error.contains("0.05"), "{error}");
    // a closed room
    let walls = [
        [[12.0, 12.0], [18.0, 12.0]],
        [[18.0, 12.0], [18.0, 18.0]],
        [[18.0, 18.0], [12.0, 18.0]],
        [[12.0, 18.0], [12.0, 12.0]],
    ];
    let mut outlines = outlines;
    outlines.extend(walls.map(|wall| wall.to_vec()));
    let store = solved(&outlines, &[goal(2.0, 2.0)], &Settings::default(), Backend::Cpu);
    let inside = |at: Vec2| at.cmpgt(Vec2::splat(12.0)).all() && at.cmplt(Vec2::splat(18.0)).all();
    for (at, distance) in cells(&store) {
        assert_eq!(distance >= FAR, inside(at), "{at}: {distance}");
    }
    let way = flow_direction(&store.flow_grid, &store.flow_way, 0, [15.0, 15.0], [-3.0, -4.0]);
    assert!(
        (way[0] + 3.0).abs() < 1e-6 && (way[1] + 4.0).abs() < 1e-6,
        "straight, for want of a way: {way:?}"
    );
}

#[test]
fn both_backends_find_the_same_ways_bit_for_bit() {
    let empty = Simulation::from_store(Store::default(), Backend::Vulkan, None);
    if gpu::on_device(empty).is_none() {
        return;
    }
    for (width, depth) in [(0.6, 0.6), (3.0, 3.0), (4.0, 29.7), (16.0, 16.0), (61.3, 8.2), (70.0, 50.0)] {
        let mut outlines = vec![floor(width, depth)];
        if width > 2.0 {
            outlines.push(block([width * 0.4, width * 0.5], [depth * 0.2, depth * 0.9]));
        }
        let goals = [goal(width * 0.8, depth * 0.5), goal(width * 0.1 + 0.2, depth * 0.5)];
        let [cpu, gpu] = [Backend::Cpu, Backend::Vulkan]
            .map(|backend| solved(&outlines, &goals, &Settings::default(), backend));
        assert!(cpu.flow_way == gpu.flow_way, "{width} x {depth}");
        let bits = |store: &Store| store.flow_distance.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        assert!(bits(&cpu) == bits(&gpu), "{width} x {depth}");
        assert_eq!(cpu.flow_args, gpu.flow_args);
    }
}

#[test]
fn closing_a_door_leads_to_the_other_one_and_opening_it_back() {
    let wall = |doors: &[[f32; 2]]| {
        let mut outlines = vec![floor(20.0, 20.0)];
        let mut from = 0.0;
        for door in doors {
            outlines.push(block([9.9, 10.1], [from, door[0]]));
            from = door[1];
        }
        outlines.push(block([9.9, 10.1], [from, 20.0]));
        outlines
    };
    let (near, far) = ([4.0, 5.2], [15.0, 16.2]);
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let mut store = Store::default();
        gaitway::sim::setup::scratch(&mut store);
        let made = Simulation::from_store(store, backend, None);
        let Some(mut simulation) = gpu::on_device(made) else { continue };
        simulation.set_goals(&wall(&[near, far]), vec![goal(18.0, 4.5)], Settings::default()).unwrap();
        let distance = |simulation: &mut Simulation| {
            let store = simulation.read(&[BufferId::FlowDistance]).unwrap();
            let found = cells(store);
            found.iter().find(|(at, _)| at.distance(Vec2::new(2.0, 4.5)) < 0.2).unwrap().1
        };
        let open = distance(&mut simulation);
        assert!((open - 16.0).abs() < 0.4, "{open}");
        simulation.set_obstacles(&wall(&[far])).unwrap();
        let closed = distance(&mut simulation);
        assert!(closed > 26.0 && closed < 30.0, "{closed}");
        let error = simulation.set_obstacles(&[wall(&[far]), vec![block([17.0, 19.0], [4.0, 5.0])]].concat());
        assert!(error.unwrap_err().to_string().contains("there"));
        assert!((distance(&mut simulation) - closed).abs() < 1e-6, "nothing has changed");
        simulation.set_obstacles(&wall(&[near, far])).unwrap();
        assert!((distance(&mut simulation) - open).abs() < 1e-6);
    }
}

/// A room of 20 m by 20 m: people start at the left, the exit is at the right.
fn scene(agents: u32, solids: &[Vec<[f32; 2]>], way_finding: &str) -> Scenario {
    let obstacles: String =
        solids.iter().map(|polygon| format!("[[obstacles]]\npolygon = {polygon:?}\n")).collect();
    let text = format!(
        "name = \"room\"\nbounds = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]]\n[population]\nagents = {agents}\n\
         [navigation]\ncrowding = 0.0\n[way_finding]\n{way_finding}\n{obstacles}\n[[spawns]]\n\
         polygon = [[1.0, 2.0], [8.0, 2.0], [8.0, 18.0], [1.0, 18.0]]\n[[stages]]\nname = \"out\"\nkind = \"exit\"\n\
         position = [19.0, 9.6]\nsize = [1.5, 3.0]\n[[journeys]]\nname = \"leave\"\nstages = [\"out\"]\n"
    );
    Scenario::parse(&text, "test").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn simulation(scenario: &Scenario, backend: Backend) -> Result<Simulation, gaitway::Error> {
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
    let crowd = populate(scenario, |emotion| library.gaits_for(emotion)).unwrap();
    Simulation::new(scenario, &crowd, &cast, backend, None)
}

fn present(simulation: &mut Simulation) -> u32 {
    measure::measures(simulation.state().unwrap()).present
}

#[test]
fn a_crowd_leaves_a_trap_along_the_field_and_stays_in_it_without() {
    // a cup open to the left between the people and the exit
    let cup =
        [block([9.0, 15.0], [3.0, 3.4]), block([9.0, 15.0], [16.0, 16.4]), block([15.0, 15.4], [3.0, 16.4])];
    for (way, arrive) in [("field", true), ("auto", true), ("straight", false)] {
        let mut simulation = simulation(&scene(30, &cup, &format!("way = \"{way}\"")), Backend::Cpu).unwrap();
        simulation.step(30 * 45).unwrap();
        let left = present(&mut simulation);
        println!("{way}: {left} are left");
        assert_eq!(left == 0, arrive, "{way}: {left} of 30 are still there");
    }
}

/// A wall with two doors, 1.2 m wide: one straight ahead, one farther away.
fn doors(open: &[f32]) -> Vec<Vec<[f32; 2]>> {
    let mut from = 0.0;
    let mut walls = Vec::new();
    for z in open {
        walls.push(block([9.9, 10.1], [from, z - 0.6]));
        from = z + 0.6;
    }
    walls.push(block([9.9, 10.1], [from, 20.0]));
    walls
}

#[test]
fn of_two_doors_a_crowd_that_minds_the_crowd_takes_both() {
    let far = |keys: &str, backend| {
        let scenario = scene(120, &doors(&[9.6, 16.0]), &format!("way = \"field\"\n{keys}"));
        let mut simulation = gpu::on_device(simulation(&scenario, backend))?;
        let mut before = simulation.state().unwrap().position.clone();
        let mut through = [0, 0];
        for _ in 0..40 * 6 {
            simulation.step(5).unwrap();
            let now = simulation.state().unwrap().position.clone();
            for (a, b) in before.iter().zip(&now) {
                if a[0] < 10.0 && b[0] >= 10.0 && b[0] < 100.0 {
                    through[usize::from(b[1] > 13.0)] += 1;
                }
            }
            before = now;
        }
        println!("{keys:?}: {through:?} by the near and the far door");
        Some((through, measure::state_hash(simulation.state().unwrap())))
    };
    let (plain, _) = far("", Backend::Cpu).unwrap();
    let (aware, hash) = far("density_weight = 1.0\nevery = 0.5", Backend::Cpu).unwrap();
    // agents that start nearest to the far door take it anyway
    assert!(aware[1] * 5 > plain[1] * 6, "{aware:?}, plain {plain:?}");
    if let Some((_, on_vulkan)) = far("density_weight = 1.0\nevery = 0.5", Backend::Vulkan) {
        assert_eq!(hash, on_vulkan, "the same on both backends");
    }
}

#[test]
fn when_a_door_closes_people_turn_to_the_other_one() {
    let outlines = |open: &[f32]| -> Outlines {
        let geometry = scene(40, &doors(open), "").geometry();
        geometry.outlines().map(|outline| outline.iter().map(Vec2::to_array).collect()).collect()
    };
    let mut hashes = Vec::new();
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let scenario = scene(40, &doors(&[9.6, 18.0]), "way = \"field\"");
        let Some(mut simulation) = gpu::on_device(simulation(&scenario, backend)) else { continue };
        simulation.step(60).unwrap();
        let inside = present(&mut simulation);
        simulation.set_obstacles(&outlines(&[18.0])).unwrap();
        assert_eq!(present(&mut simulation), inside, "everyone is where they were");
        simulation.step(30 * 60).unwrap();
        assert_eq!(present(&mut simulation), 0, "all have left by the other door");
        hashes.push(measure::state_hash(simulation.state().unwrap()));
    }
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:?}");
}

/// A model with a floor of squares (2 m) under the name `floor` and a roof above it.
fn model(squares: &[[f32; 2]]) -> Vec<u8> {
    let mut corners: Vec<f32> = Vec::new();
    for (y, list) in [(0.05_f32, squares), (4.0, &[[0.0, 0.0]])] {
        for [x, z] in list {
            for (dx, dz) in [(0.0, 0.0), (0.0, 2.0), (2.0, 2.0), (0.0, 0.0), (2.0, 2.0), (2.0, 0.0)] {
                corners.extend([x + dx, y, z + dz]);
            }
        }
    }
    let (count, floor) = (corners.len() / 3, squares.len() * 6);
    let view = |first: usize, count: usize| json!({ "buffer": 0, "byteOffset": first * 12, "byteLength": count * 12 });
    let accessor = |view: usize, count: usize| {
        let (low, high) = ([0, 0, 0], [20, 4, 20]);
        json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC3", "min": low, "max": high })
    };
    let mesh = |positions: usize| json!({ "primitives": [{ "attributes": { "POSITION": positions } }] });
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "name": "floor", "mesh": 0 }, { "name": "roof", "mesh": 1 }],
        "meshes": [mesh(0), mesh(1)],
        "accessors": [accessor(0, floor), accessor(1, 6)],
        "bufferViews": [view(0, floor), view(floor, 6)],
        "buffers": [{ "byteLength": count * 12 }],
    });
    glb::file(document.to_string(), corners.into_iter().flat_map(f32::to_le_bytes).collect())
}

#[test]
fn well_known_text_and_a_floor_of_gltf_give_the_field_of_the_polygon() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "[population]\nagents = 0\n";
    let squares: Vec<[f32; 2]> = (0..5_u8)
        .flat_map(|i| (0..4_u8).map(move |j| [f32::from(i) * 2.0, f32::from(j) * 2.0]))
        .filter(|at| *at != [4.0, 2.0] && *at != [4.0, 4.0])
        .collect();
    std::fs::write(folder.path().join("hall.glb"), model(&squares)).unwrap();
    let parts = "GEOMETRYCOLLECTION (POLYGON ((0 0, 4 0, 4 -8, 0 -8, 0 0)), MULTIPOLYGON (((4 0, 10 0, 10 -2, 4 -2, 4 0)), \
                 ((6 -2, 10 -2, 10 -6, 6 -6, 6 -2)), ((3 -6, 10 -6, 10 -8, 3 -8, 3 -6))))";
    std::fs::write(folder.path().join("area.wkt"), parts).unwrap();
    let whole = "POLYGON ((0 0, 10 0, 10 -8, 0 -8, 0 0), (4 -2, 6 -2, 6 -6, 4 -6, 4 -2))";
    let texts = [
        "bounds = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]]\n[[obstacles]]\npolygon = [[4.0, 2.0], [6.0, 2.0], [6.0, 6.0], [4.0, 6.0]]\n".to_owned(),
        format!("walkable_wkt = \"{whole}\"\n"),
        "walkable_file = \"area.wkt\"\n".to_owned(),
        "walkable_file = \"hall.glb\"\nwalkable_node = \"floor\"\n".to_owned(),
        "walkable_file = \"hall.glb\"\n".to_owned(),
    ];
    let mut ways = Vec::new();
    for (number, text) in texts.iter().enumerate() {
        let path = folder.path().join(format!("{number}.toml"));
        std::fs::write(&path, format!("name = \"hall\"\n{text}{rest}")).unwrap();
        let scenario = Scenario::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Scenario::parse(&scenario.to_toml().unwrap(), "again").unwrap(), scenario);
        let geometry = scenario.geometry();
        let outlines: Outlines =
            geometry.outlines().map(|outline| outline.iter().map(Vec2::to_array).collect()).collect();
        let store = solved(&outlines, &[goal(1.0, 4.0)], &Settings::default(), Backend::Cpu);
        assert!(Raster::new(&outlines, 0.25, 0.25).has_room(Vec2::new(2.0, 4.0)));
        ways.push(store.flow_way);
    }
    assert!(ways.iter().all(|way| *way == ways[0]));
    for (text, part) in [
        ("walkable_wkt = \"POLYGON ((0 0, 1 0))\"", "three corners"),
        ("walkable_wkt = \"MULTIPOLYGON (((0 0, 1 0, 1 1)), ((5 5, 6 5, 6 6)))\"", "2 parts"),
        ("walkable_file = \"none.wkt\"", "none.wkt"),
        ("walkable_file = \"hall.glb\"\nwalkable_node = \"flor\"", "there are floor, roof"),
        ("walkable_node = \"floor\"\nbounds = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]", "walkable_node"),
        (
            "walkable_wkt = \"POLYGON ((0 0, 9 0, 9 9))\"\nbounds = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]",
            "walkable_wkt",
        ),
    ] {
        let path = folder.path().join("wrong.toml");
        std::fs::write(&path, format!("name = \"hall\"\n{text}\n{rest}")).unwrap();
        let error = Scenario::load(&path).unwrap_err().to_string();
        assert!(error.contains(part) && error.contains("wrong.toml:2"), "{text}: {error}");
    }
}

/// Distance as colour, directions as arrows: written where `GAITWAY_PICTURES` says, to be looked at.
#[test]
fn a_field_as_a_picture() {
    use gaitway::picture::Image;
    let mut outlines = vec![floor(40.0, 30.0)];
    outlines.extend([
        block([10.0, 25.0], [8.0, 9.0]),
        block([10.0, 25.0], [21.0, 22.0]),
        block([24.0, 25.0], [8.5, 21.5]),
        block([30.0, 30.4], [0.0, 13.0]),
        block([30.0, 30.4], [14.2, 27.0]),
        vec![[4.0, 4.0], [8.0, 14.0]],
    ]);
    let store = solved(&outlines, &[goal(36.0, 5.0)], &Settings::default(), Backend::Cpu);
    let (grid, scale) = (store.flow_grid, 8);
    let mut image = Image::filled(grid.columns * scale, grid.rows * scale, [40, 40, 44, 255]);
    let most = cells(&store).iter().map(|(_, d)| *d).filter(|d| *d < FAR).fold(0.0, f32::max);
    for cell in 0..grid.cell_count {
        let (x, z) = (cell % grid.columns, cell / grid.columns);
        if store.flow_cells[cell as usize] & SOLID == 0 {
            let t = store.flow_distance[cell as usize] / most;
            let band = if (store.flow_distance[cell as usize] * 0.5).fract() < 0.12 { 0.75 } else { 1.0 };
            let mix = |a: f32, b: f32| ((a + (b - a) * t) * band) as u8;
            image.fill(
                x * scale,
                z * scale,
                scale,
                scale,
                [mix(250., 40.), mix(230., 60.), mix(90., 150.), 255],
            );
        }
    }
    for z in 0..60_u16 {
        for x in 0..80_u16 {
            let at = Vec2::new(f32::from(x) * 0.5 + 0.25, f32::from(z) * 0.5 + 0.25);
            let to = Vec2::new(36.0, 5.0) - at;
            let way = flow_direction(&grid, &store.flow_way, 0, at.to_array(), to.to_array());
            let way = Vec2::from_array(way).normalize_or_zero();
            for step in 0..12_u8 {
                let p = (at + way * (f32::from(step) * 0.03 - 0.1) - Vec2::from_array(grid.origin))
                    / grid.cell_size
                    * scale as f32;
                let ink = if step > 8 { [200, 20, 20, 255] } else { [0, 0, 0, 255] };
                image.set(p.x as u32, p.y as u32, ink);
            }
        }
    }
    // every free cell can be reached here, so all of it is coloured, and everyone outside a wall is led somewhere
    let led = |x: f32, z: f32| {
        let (at, goal) = (Vec2::new(x, z), Vec2::new(36.0, 5.0));
        let way = flow_direction(&grid, &store.flow_way, 0, at.to_array(), (goal - at).to_array());
        assert!(Vec2::from_array(way).length() > 0.5, "no way leads from {at}");
        Vec2::from_array(way)
    };
    assert!(led(20.0, 15.0).y.abs() > 0.1, "in the pocket straight on would be into the wall");
    led(2.0, 2.0);
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        let path = std::path::PathBuf::from(folder).join("flow.png");
        gaitway::export::image::write_png(&path, &image).unwrap();
    }
}
