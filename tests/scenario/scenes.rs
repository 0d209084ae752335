//! Claims about scenarios: files, the four scenes at every size, populations.

use gaitway::Emotion;
use gaitway::scenario::{
    AgentStart, Clearance, Condition, Crowd, EmotionMode, EnvironmentMesh, Error, Finish, Geometry, Layout,
    PropKind, ROUTE_CLEARANCE, Scenario, User, polygon, populate,
};
use glam::{Vec2, Vec3};
use std::time::Instant;

/// GEA of a made-up library: five gaits per emotion.
fn gaits(emotion: Emotion) -> &'static [u32] {
    const GAITS: [[u32; 5]; 4] =
        [[0, 1, 2, 3, 4], [5, 6, 7, 8, 9], [10, 11, 12, 13, 14], [15, 16, 17, 18, 19]];
    &GAITS[emotion.index()]
}

fn scenes(sizes: &[u32]) -> Vec<Scenario> {
    let of = |name: &&str| {
        sizes.iter().map(|&n| Scenario::builtin(name).unwrap().with_agents(n)).collect::<Vec<_>>()
    };
    Scenario::builtin_names().iter().flat_map(of).collect()
}

fn label(scenario: &Scenario) -> String {
    format!("{} with {} agents", scenario.name, scenario.population.agents)
}

const SIZES: [u32; 4] = [8, 100, 2_000, 10_000];

#[test]
fn the_papers_four_scenes_have_the_papers_numbers() {
    let counts: Vec<(String, u32)> = Scenario::builtin_names()
        .iter()
        .map(|name| Scenario::builtin(name).unwrap())
        .map(|s| (s.name, s.population.agents))
        .collect();
    let paper = [("crossing", 8), ("garden", 4), ("parking", 8), ("scifi", 4)];
    assert_eq!(counts, paper.map(|(name, n)| (name.to_owned(), n)));
    for (name, n) in paper {
        let crowd = populate(&Scenario::builtin(&name.to_uppercase()).unwrap(), gaits).unwrap();
        assert_eq!(crowd.agents.len(), n as usize);
    }
    let error = Scenario::builtin("gardn").unwrap_err().to_string();
    assert!(error.contains("gardn") && error.contains("crossing, garden, parking, scifi"), "{error}");
}

#[test]
fn scenario_text_round_trips() {
    for scenario in scenes(&[8, 100]) {
        for scenario in [scenario.expanded(), scenario] {
            let text = scenario.to_toml().unwrap();
            assert_eq!(Scenario::parse(&text, "again").unwrap(), scenario, "{text}");
        }
    }
}

#[test]
fn an_expanded_scene_is_the_same_place_and_crowd() {
    for scenario in scenes(&[100]) {
        let expanded = scenario.expanded();
        assert_eq!(expanded.layout, Layout::Custom);
        let (mut made, written) = (scenario.geometry(), expanded.geometry());
        // Only the suggested camera belongs to the generator.
        made.overview = written.overview;
        assert_eq!(written, made);
        assert_eq!(populate(&expanded, gaits).unwrap(), populate(&scenario, gaits).unwrap());
    }
}

/// Closest distance between two polygons' outlines, 0 when one is inside the other.
fn gap(a: &[Vec2], b: &[Vec2]) -> f32 {
    if polygon::contains(a, b[0]) || polygon::contains(b, a[0]) {
        return 0.0;
    }
    let pairs = polygon::edges(a).flat_map(|e| polygon::edges(b).map(move |f| (e, f)));
    pairs.map(|((a, b), (c, d))| polygon::segment_distance(a, b, c, d)).fold(f32::INFINITY, f32::min)
}

#[test]
fn obstacles_are_disjoint_with_passages_of_a_metre_and_a_half() {
    for scenario in scenes(&SIZES) {
        let Geometry { bounds, obstacles, .. } = scenario.geometry();
        assert!(polygon::signed_area(&bounds) < 0.0, "bounds run clockwise");
        let boxes: Vec<(Vec2, Vec2)> = obstacles
            .iter()
            .map(|p| {
                (p.iter().copied().reduce(Vec2::min).unwrap(), p.iter().copied().reduce(Vec2::max).unwrap())
            })
            .collect();
        for (i, a) in obstacles.iter().enumerate() {
            assert!(polygon::signed_area(a) > 0.0, "solids run counter-clockwise");
            assert_eq!(polygon::self_intersection(a), None);
            assert!(
                a.iter().all(|&p| polygon::contains(&bounds, p)),
                "{}: {a:?} sticks out",
                label(&scenario)
            );
            let edges = polygon::edges(&bounds);
            let to_bounds = edges.flat_map(|(c, d)| polygon::edges(a).map(move |(e, f)| (c, d, e, f)));
            let to_bounds =
                to_bounds.map(|(c, d, e, f)| polygon::segment_distance(c, d, e, f)).fold(9.0, f32::min);
            assert!(to_bounds >= 1.5, "{}: {a:?} is {to_bounds} m from the bounds", label(&scenario));
            for (j, b) in obstacles.iter().enumerate().skip(i + 1) {
                let apart = (boxes[j].0 - boxes[i].1).max(boxes[i].0 - boxes[j].1);
                if apart.max_element() < 1.5 {
                    let gap = gap(a, b);
                    assert!(gap >= 1.5, "{}: {gap} m between {a:?} and {b:?}", label(&scenario));
                }
            }
        }
    }
}

#[test]
fn density_stays_walkable_everywhere() {
    for scenario in scenes(&[8, 100, 1_000, 2_000, 10_000, 40_000]) {
        let most = if scenario.layout == Layout::Crossing { 0.35 } else { 0.25 };
        let geometry = scenario.geometry();
        let mean = f64::from(scenario.population.agents) / geometry.walkable_area();
        assert!(mean <= most, "{}: {mean}", label(&scenario));
        // Locally: agents within 10 m of each of a thousand agents, over the area of that disc.
        let crowd = populate(&scenario, gaits).unwrap();
        let step = crowd.agents.len().div_ceil(1000);
        let near = |a: &Vec2| crowd.agents.iter().filter(|b| b.position.distance(*a) < 10.0).count();
        let worst = crowd.agents.iter().step_by(step).map(|a| near(&a.position)).max().unwrap();
        #[allow(clippy::cast_precision_loss, reason = "a few hundred agents")]
        let worst = worst as f32 / (100.0 * std::f32::consts::PI);
        println!("{}: mean {mean:.3}, worst {worst:.3} agents/m2", label(&scenario));
        assert!(worst < 0.5, "{}: {worst} agents/m2 somewhere", label(&scenario));
    }
}

fn routes_are_clear(scenario: &Scenario, crowd: &Crowd) {
    let geometry = scenario.geometry();
    let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let mut seen = std::collections::HashSet::new();
    for agent in &crowd.agents {
        let route = &crowd.stages[agent.route_start as usize..][..agent.route_length as usize];
        assert!(agent.waypoint < agent.route_length && !route.is_empty());
        let body = agent.radius;
        let first = route[agent.waypoint as usize];
        assert!(free.passes(agent.position, first.position, body), "{}: first leg", label(scenario));
        if !seen.insert(agent.route_start) {
            continue;
        }
        let legs = if agent.loops { route.len() } else { route.len() - 1 };
        for i in 0..legs {
            let (a, b) = (route[i], route[(i + 1) % route.len()]);
            assert!(a.radius >= 0.5 && a.position.is_finite());
            assert!(
                free.passes(a.position, b.position, ROUTE_CLEARANCE),
                "{}: {:?} to {:?}",
                label(scenario),
                a.position,
                b.position
            );
        }
    }
}

#[test]
fn every_agent_can_walk_its_route_and_none_starts_in_an_obstacle() {
    for scenario in scenes(&SIZES) {
        let crowd = populate(&scenario, gaits).unwrap();
        routes_are_clear(&scenario, &crowd);
        let geometry = scenario.geometry();
        let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
        let (user, at) = scenario.user.zip(geometry.user).unwrap();
        assert!(free.admits(at, user.radius), "{}: the user stands free", label(&scenario));
        let mut sorted: Vec<&_> = crowd.agents.iter().collect();
        sorted.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        for (i, a) in sorted.iter().enumerate() {
            assert!(
                free.admits(a.position, a.radius),
                "{}: {:?} starts in something",
                label(&scenario),
                a.position
            );
            let away = a.position.distance(at);
            assert!(away > a.radius + user.radius, "{}: {away} m from the user", label(&scenario));
            for b in sorted[i + 1..].iter().take_while(|b| b.position.x - a.position.x < 1.0) {
                assert!(
                    a.position.distance(b.position) > a.radius + b.radius,
                    "{} overlap",
                    label(&scenario)
                );
            }
        }
    }
}

#[test]
fn goals_are_spread_and_streams_oppose_and_cross() {
    let crowd = populate(&Scenario::builtin("crossing").unwrap().with_agents(2_000), gaits).unwrap();
    let goals: std::collections::HashSet<(u32, u32)> = crowd
        .agents
        .iter()
        .map(|a| crowd.stages[(a.route_start + a.waypoint) as usize].position)
        .map(|p| (p.x.to_bits(), p.y.to_bits()))
        .collect();
    assert!(goals.len() > 200, "{} goals", goals.len());
    let heading_to =
        |direction: Vec2| crowd.agents.iter().filter(|a| a.velocity.normalize().dot(direction) > 0.9).count();
    for direction in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
        assert!(heading_to(direction) > 200, "{direction}");
    }
    for diagonal in [Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0)] {
        assert!(heading_to(diagonal.normalize()) > 5, "{diagonal}");
    }
}

#[test]
fn conditions_are_the_papers_three_algorithms() {
    let of = |condition| {
        let scenario = Scenario::builtin("crossing").unwrap().with_agents(4_000).with_condition(condition);
        populate(&scenario, gaits).unwrap().agents
    };
    let (baseline, eva_o, eva_g) = (of(Condition::Baseline), of(Condition::EvaO), of(Condition::EvaG));
    assert!(baseline.iter().all(|a| a.gaits == baseline[0].gaits && !a.gazes));
    assert!(gaits(Emotion::Neutral).contains(&baseline[0].gaits[0]));
    assert!(eva_o.iter().all(|a| !a.gazes) && eva_g.iter().all(|a| a.gazes));
    for emotion in Emotion::ALL {
        let felt: Vec<_> = eva_g.iter().filter(|a| a.emotion == emotion.weights()).collect();
        assert!(felt.len().abs_diff(1000) < 120, "{emotion}: {}", felt.len());
        for &gait in gaits(emotion) {
            let used = felt.iter().filter(|a| a.gaits[0] == gait).count();
            assert!(used.abs_diff(200) < 60, "{emotion} gait {gait}: {used}");
        }
        assert!(felt.iter().all(|a| gaits(emotion).contains(&a.gaits[0])));
    }
    for (o, g) in eva_o.iter().zip(&eva_g) {
        assert_eq!((o.position, o.gaits, o.emotion, o.colors), (g.position, g.gaits, g.emotion, g.colors));
    }
    assert_eq!(baseline[7].position, eva_g[7].position, "the three trials differ in nothing else");
}

#[test]
fn a_blend_is_the_same_mixture_for_all() {
    let mut scenario = Scenario::builtin("garden").unwrap().with_agents(50);
    scenario.population.emotion_mode = EmotionMode::Blend;
    scenario.population.emotions.sad = 0.0;
    scenario.population.emotions.happy = 2.0;
    for agent in populate(&scenario, gaits).unwrap().agents {
        assert_eq!(agent.emotion, [0.5, 0.25, 0.0, 0.25]);
        assert_eq!(agent.gait_weights, agent.emotion);
        assert!(gaits(Emotion::Angry).contains(&agent.gaits[1]));
    }
}

#[test]
fn an_agent_is_the_same_whatever_else_changes() {
    let base = Scenario::builtin("crossing").unwrap();
    let crowd = |n| populate(&base.clone().with_agents(n), gaits).unwrap();
    let (few, many) = (crowd(100), crowd(3_000));
    for (a, b) in few.agents.iter().zip(&many.agents) {
        assert_eq!((a.emotion, a.gaits, a.phase, a.avatar), (b.emotion, b.gaits, b.phase, b.avatar));
        assert_eq!(
            (a.scale.to_bits(), a.colors, a.radius.to_bits()),
            (b.scale.to_bits(), b.colors, b.radius.to_bits())
        );
    }
    assert_eq!(few, crowd(100));
    let other = populate(&base.clone().with_agents(100).with_seed(2), gaits).unwrap();
    assert_ne!(few.agents[0].position, other.agents[0].position);
    // As many of one avatar as of the other.
    assert_eq!(many.agents.iter().filter(|a| a.avatar == 0).count(), 1_500);
}

#[test]
fn a_missing_gait_names_the_emotion_and_the_way_out() {
    let none = |e: Emotion| if e == Emotion::Sad { &[][..] } else { gaits(e) };
    let scenario = Scenario::builtin("garden").unwrap();
    let error = populate(&scenario, none).unwrap_err().to_string();
    assert!(error.contains("no sad gait") && error.contains("give no share to sad"), "{error}");
    assert!(populate(&scenario.with_condition(Condition::Baseline), none).is_ok());
}

#[test]
fn no_agents_make_an_empty_crowd() {
    assert_eq!(
        populate(&Scenario::builtin("scifi").unwrap().with_agents(0), gaits).unwrap(),
        Crowd::default()
    );
}

const ROOM: &str = r#"
name = "room"
bounds = [[-10, -10], [10, -10], [10, 10], [-10, 10]]

[population]
agents = 20

[user]
position = [8.0, 8.0]

[[obstacles]]
polygon = [[-1, -1], [1, -1], [1, 1], [-1, 1]]

[[spawns]]
polygon = [[-9, -9], [9, -9], [9, -5], [-9, -5]]
routes = ["up"]

[[routes]]
name = "up"
waypoints = [[-5, -6], [-5, 6]]
width = 4.0
mode = "once"
"#;

#[test]
fn a_custom_room_is_filled_from_its_spawn_region() {
    let scenario = Scenario::parse(ROOM, "room.toml").unwrap();
    let crowd = populate(&scenario, gaits).unwrap();
    routes_are_clear(&scenario, &crowd);
    assert!(crowd.agents.iter().all(|a| a.position.y < -5.0 && !a.loops));
}

#[test]
fn wrong_values_name_file_line_key_value_range_and_way_out() {
    let broken = |from: &str, to: &str| {
        assert!(ROOM.contains(from), "{from}");
        let text = ROOM.replacen(from, to, 1);
        match Scenario::parse(&text, "room.toml") {
            Err(error) => error.to_string(),
            Ok(scenario) => populate(&scenario, gaits).unwrap_err().to_string(),
        }
    };
    for (from, to, wanted) in [
        (
            "agents = 20",
            "agents = 2000000",
            "room.toml:6: population.agents = 2000000: must be 0 to 1000000; ",
        ),
        ("agents = 20", "agentz = 20", "room.toml:6: population.agentz: unknown field `agentz`"),
        ("agents = 20", "agentz = 20", "did you mean `agents`?"),
        ("agents = 20", "agents = \"many\"", "room.toml:6: population.agents: invalid type: string \"many\""),
        ("agents = 20", "agents = 5000", "no free place for agent"),
        ("agents = 20", "agents = 20\nscale = [1.2, nan]", "room.toml:7: population.scale = [1.2, NaN]"),
        ("mode = \"once\"", "mode = \"onec\"", "did you mean `once`?"),
        ("width = 4.0", "width = -4.0", "room.toml:21: routes[0].width = -4: must be 0 to 10000"),
        (
            "[\"up\"]",
            "[\"op\"]",
            "room.toml:16: spawns[0].routes[0] = \"op\": must be the name of a route; did you mean \"up\"?",
        ),
        ("[1, 1], [-1, 1]]", "[-1, 1], [1, 1]]", "room.toml:12: obstacles[0].polygon = edges"),
        ("[[-10, -10], ", "[[-10, inf], ", "room.toml:3: bounds[0] = [-10, inf]: must be within 50000 m"),
        (
            "bounds = [[-10, -10], [10, -10], [10, 10], [-10, 10]]",
            "",
            "bounds = 0 corners: must be 3 to 1024",
        ),
    ] {
        let error = broken(from, to);
        assert!(error.contains(wanted), "wanted {wanted:?} in {error:?}");
    }
}

#[test]
fn a_blocked_route_says_where() {
    let text = ROOM.replacen("[[-5, -6], [-5, 6]]", "[[0, -6], [0, 6]]", 1).replacen(
        "width = 4.0",
        "width = 1.0",
        1,
    );
    let error = populate(&Scenario::parse(&text, "room.toml").unwrap(), gaits).unwrap_err();
    assert!(matches!(error, Error::Populate { .. }));
    let error = error.to_string();
    assert!(
        error.contains("route \"up\"") && error.contains("waypoint 0") && error.contains("0.00 m"),
        "{error}"
    );
}

#[test]
fn mutilated_files_are_refused_or_read_but_never_panic() {
    let mut texts: Vec<String> = scenes(&[8]).iter().map(|s| s.to_toml().unwrap()).collect();
    texts.push(ROOM.to_owned());
    texts.push(
        Scenario::builtin("garden").unwrap().expanded().to_toml().unwrap().chars().take(4000).collect(),
    );
    let junk = [
        "[",
        "]",
        "\"",
        "=",
        "-",
        "9",
        "nan",
        "inf",
        "\n",
        "1e39",
        "{",
        "}",
        "é",
        "#",
        "99999999999999999999",
        "''",
    ];
    let mut state = 1_u32;
    let mut next = |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    for text in &texts {
        for cut in (0..text.len()).step_by(7).filter(|&cut| text.is_char_boundary(cut)) {
            let _ = Scenario::parse(&text[..cut], "cut");
        }
        for _ in 0..600 {
            let mut mutated = text.clone();
            for _ in 0..=next(3) {
                let at = next(mutated.len());
                let end = (at + next(4)).min(mutated.len());
                if mutated.is_char_boundary(at) && mutated.is_char_boundary(end) {
                    mutated.replace_range(at..end, junk[next(junk.len())]);
                }
            }
            if let Ok(scenario) = Scenario::parse(&mutated, "mutated")
                && scenario.population.agents <= 100
            {
                let _ = populate(&scenario, gaits);
            }
        }
    }
    let deep = format!("a = {}", "[".repeat(100_000));
    assert!(Scenario::parse(&deep, "deep").is_err());
}

#[test]
fn scenery_has_a_sane_mesh_at_every_size() {
    for scenario in scenes(&[4, 100, 10_000, 1_000_000]) {
        let geometry = scenario.geometry();
        println!("{}: {} obstacles", label(&scenario), geometry.obstacles.len());
        let plain = sane(&geometry.scenery_of(Finish::Plain), &label(&scenario));
        assert!((5_000..=60_000).contains(&plain), "{}: {plain} triangles", label(&scenario));
        let fine = sane(&geometry.scenery_of(Finish::Fine), &label(&scenario));
        assert!((plain + 1..=200_000).contains(&fine), "{}: {fine} triangles", label(&scenario));
        assert_eq!(geometry.scenery(), geometry.scenery_of(Finish::Plain));
    }
}

/// Checks a mesh; how many triangles it has.
fn sane(mesh: &EnvironmentMesh, name: &str) -> usize {
    println!("{name}: {} triangles", mesh.triangle_count());
    for count in [mesh.normals.len(), mesh.colors.len(), mesh.layers.len(), mesh.materials.len()] {
        assert_eq!(mesh.positions.len(), count);
    }
    for t in mesh.indices.chunks(3).chain(mesh.far_indices.chunks(3)) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.positions[i as usize]);
        let face = (b - a).cross(c - a);
        assert!(face.is_finite() && face.length() > 0.0, "{name}: {a} {b} {c}");
        let normal = mesh.normals[t[0] as usize];
        assert!((normal.length() - 1.0).abs() < 1e-3);
        assert!(face.normalize().dot(normal) > -1e-3, "{name}: {a} {b} {c} faces inwards");
    }
    assert!(mesh.colors.iter().all(|c| c.min_element() >= 0.0 && c.max_element() <= 4.0));
    // Nothing that lies flat may be above the feet.
    assert!(mesh.positions.iter().any(|p| p.y > 2.0) && mesh.positions.iter().all(|p| p.y >= 0.0));
    mesh.triangle_count()
}

#[test]
fn from_afar_houses_and_cars_have_their_size_and_two_fifths_of_their_triangles() {
    for scenario in scenes(&[1000]) {
        let mesh = scenario.geometry().scenery_of(Finish::Fine);
        let has_any = scenario
            .environment
            .props
            .iter()
            .any(|prop| matches!(prop.kind, PropKind::Building | PropKind::Car));
        assert!(!has_any || !mesh.distant.is_empty(), "{}", label(&scenario));
        let (mut near_count, mut far_count) = (0, 0);
        for thing in &mesh.distant {
            let (near, far) = (&mesh.indices[thing.near.clone()], &mesh.far_indices[thing.far.clone()]);
            let bounds = |indices: &[u32]| {
                let corners = || indices.iter().map(|index| mesh.positions[*index as usize]);
                (corners().fold(Vec3::MAX, Vec3::min), corners().fold(Vec3::MIN, Vec3::max))
            };
            let ((low, high), (far_low, far_high)) = (bounds(near), bounds(far));
            let off = (low - far_low).abs().max((high - far_high).abs());
            assert!(off.max_element() < 0.2, "{}: {low} {high}, {far_low} {far_high}", label(&scenario));
            near_count += near.len();
            far_count += far.len();
        }
        println!("{}: {} triangles from afar for {}", label(&scenario), far_count / 3, near_count / 3);
        assert!(5 * far_count <= 2 * near_count, "{}: {far_count} for {near_count}", label(&scenario));
        assert!(scenario.geometry().scenery().distant.is_empty(), "low quality has none");
    }
}

#[test]
fn a_hundred_thousand_agents_are_populated_in_seconds() {
    for scenario in scenes(&[100_000]) {
        let start = Instant::now();
        let crowd = populate(&scenario, gaits).unwrap();
        println!("{}: {:?}, {} stages", label(&scenario), start.elapsed(), crowd.stages.len());
        assert_eq!(crowd.agents.len(), 100_000);
    }
}

#[test]
fn a_large_crowd_is_numbered_by_place_and_its_people_and_groups_stay() {
    let crowd = |agents: u32| {
        let mut scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
        scenario.population.groups.sizes = vec![0.6, 0.3, 0.1];
        populate(&scenario, gaits).unwrap().agents
    };
    let (small, large) = (crowd(16_384), crowd(16_400));
    // how many rows of a metre are between people whose numbers are near
    let rows = |agents: &[AgentStart]| {
        let away = |pair: &[AgentStart]| (pair[0].position.y - pair[63].position.y).abs();
        let mut all: Vec<f32> = agents.windows(64).map(away).collect();
        all.sort_by(f32::total_cmp);
        all[all.len() / 2]
    };
    println!("{} and {} rows", rows(&small), rows(&large));
    assert!(rows(&small) > 20.0 && rows(&large) < 5.0);
    // who is at a place may change, what people are like by number does not
    assert!(
        small
            .iter()
            .zip(&large)
            .take(16_000) // the last group ends where the crowd does
            .all(|(a, b)| (a.avatar, a.radius, a.companions) == (b.avatar, b.radius, b.companions))
    );
    let apart = |agent: &AgentStart| {
        let companions = agent.companions.iter().filter(|other| **other != u32::MAX);
        companions.map(|other| large[*other as usize].position.distance(agent.position)).fold(0.0, f32::max)
    };
    let farthest = large.iter().map(apart).fold(0.0, f32::max);
    assert!(large.iter().any(|agent| apart(agent) > 0.0) && farthest < 5.0, "{farthest} m");
}

#[test]
fn a_user_is_put_in_where_there_is_room_and_only_where_there_is_none() {
    let place = |more: &str| {
        let text = format!(
            "name = \"place\"\nbounds = [[2, 2], [22, 2], [22, 12], [2, 12]]\n{more}\n[population]\nagents = 0\n"
        );
        Scenario::parse(&text, "place").unwrap()
    };
    let put_in = |mut scenario: Scenario| {
        assert_eq!(scenario.geometry().user, None, "without [user] there is no user");
        scenario.put_in(User::default());
        scenario.geometry().user.unwrap()
    };
    assert_eq!(put_in(place("")), Vec2::new(12.0, 7.0), "the middle");
    let pillar = place("[[obstacles]]\npolygon = [[11, 5], [14, 5], [14, 9], [11, 9]]\n");
    let at = put_in(pillar.clone());
    let geometry = pillar.geometry();
    assert!(Clearance::new(&geometry.bounds, &geometry.obstacles).admits(at, 0.3), "{at} is solid");
    assert!(at.distance(Vec2::new(12.0, 7.0)) < 2.0, "{at} is farther from the middle than it need be");
    // a layout has its own place, and agents there stay
    let mut layout = Scenario::builtin("crossing").unwrap();
    let own = layout.geometry().user;
    layout.put_in(User { position: Some([1.0, 1.0]), ..User::default() });
    assert_eq!(layout.geometry().user, own);
    layout.user = None;
    layout.put_in(User::default());
    assert_eq!(layout.geometry().user, own);
    let there = place("[user]\nposition = [5, 5]\n");
    assert_eq!((there.geometry().user, there.geometry().focus), (Some(Vec2::splat(5.0)), Vec2::splat(5.0)));
}

#[test]
fn the_overview_is_of_the_place_and_not_of_the_origin() {
    let text = "name = \"far\"\nbounds = [[500, 300], [540, 300], [540, 320], [500, 320]]\n[population]\nagents = 0\n";
    let (eye, target) = Scenario::parse(text, "far").unwrap().geometry().overview;
    assert_eq!((target.x, target.z), (520.0, 310.0));
    assert!(eye.distance(target) < 40.0, "{eye}");
}
