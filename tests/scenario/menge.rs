//! Claims about Menge's scenes: what is taken over, what is named as not, and that everyone arrives.

use crate::common::data_set;
use gaitway::avatar::{Sex, generated};
use gaitway::ground::is_absent;
use gaitway::library::GaitLibrary;
use gaitway::scenario::menge::{Imported, import};
use gaitway::scenario::{RouteMode, Scenario, Way, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation};
use glam::Vec2;

const PROFILES: &str = r#"
  <AgentProfile name="one"><Common r="0.2" pref_speed="1.2" max_speed="2" neighbor_dist="6" max_neighbors="8"/>
    <ORCA tau="3.0" tauObst="0.15"/><Helbing mass="80"/></AgentProfile>
  <AgentProfile name="two" inherits="one"><Common r="0.35"><Property name="pref_speed" dist="u" min="0.6" max="0.8"/></Common></AgentProfile>"#;

/// Writes a project and imports it.
fn project(scene: &str, behaviour: &str, others: &[(&str, &str)]) -> Result<Imported, String> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "small.xml",
        "<?xml version=\"1.0\"?><Project scene=\"S.xml\" behavior=\"B.xml\" view=\"V.xml\" model=\"orca\"/>",
    );
    write("S.xml", &format!("<Experiment version=\"2.0\">{PROFILES}{scene}</Experiment>"));
    write("B.xml", &format!("<BFSM>{behaviour}</BFSM>"));
    for (name, text) in others {
        write(name, text);
    }
    import(&folder.path().join("small.xml"), 1).map_err(|error| match error {
        gaitway::scenario::Error::Syntax { place, message } => {
            format!("{}: {message}", place.rsplit('/').next().unwrap())
        }
        other => other.to_string(),
    })
}

fn group(profile: &str, state: &str, generator: &str) -> String {
    format!(
        "<AgentGroup><ProfileSelector type=\"const\" name=\"{profile}\"/><StateSelector type=\"const\" \
         name=\"{state}\"/>{generator}</AgentGroup>"
    )
}

const PAIR: &str =
    r#"<Generator type="explicit"><Agent p_x="-3" p_y="1"/><Agent p_x="-3" p_y="-1"/></Generator>"#;
const MIRROR: &str = r#"<State name="Walk" final="0"><GoalSelector type="mirror" mirror_x="1" mirror_y="0"/>
  <VelComponent type="goal"/></State><State name="Stop" final="1"/>
  <Transition from="Walk" to="Stop"><Condition type="goal_reached" distance="0.1"/></Transition>"#;

/// Runs until everyone whose way ends has arrived; the time that took, s.
fn arrive(scenario: &Scenario, most: f64) -> Result<f64, String> {
    let library = GaitLibrary::built_in().unwrap();
    let crowd = populate_from(scenario, &library).unwrap();
    let cast = AvatarSet::new(library.gaits(), vec![generated(Sex::Female), generated(Sex::Male)]).unwrap();
    let mut simulation = Simulation::new(scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let bounds: Vec<Vec2> = scenario.bounds.iter().map(|p| Vec2::from(*p)).collect();
    while simulation.time() < most {
        simulation.step(15).unwrap();
        let store = simulation.state().unwrap();
        let arrived =
            scenario.walkers.iter().zip(&store.route).filter(|(w, route)| !w.ends() || route.arrivals > 0);
        let arrived = arrived.count();
        for position in store.position.iter().filter(|p| !is_absent(**p)) {
            assert!(
                gaitway::scenario::polygon::contains(&bounds, Vec2::from(*position)),
                "{position:?} is outside"
            );
        }
        if arrived == scenario.walkers.len() {
            return Ok(simulation.time());
        }
    }
    let store = simulation.state().unwrap();
    let late: Vec<String> = (scenario.walkers.iter().zip(&store.route).zip(&store.position).enumerate())
        .filter(|(_, ((walker, route), _))| walker.ends() && route.arrivals == 0)
        .map(|(i, ((walker, route), p))| {
            format!("{i} at {p:?}, stage {} of {:?}", route.next, walker.waypoints)
        })
        .collect();
    Err(format!(
        "after {most} s {} of {} have not arrived: {}",
        late.len(),
        scenario.walkers.len(),
        late.join("; ")
    ))
}

#[test]
fn profiles_places_and_goals_come_over_in_our_frame() {
    let scene = group("two", "Walk", PAIR);
    let found = project(&scene, MIRROR, &[]).unwrap();
    let walkers = &found.scenario.walkers;
    assert_eq!(walkers.len(), 2);
    assert_eq!((walkers[0].position, &walkers[0].waypoints), ([-3.0, -1.0], &vec![[3.0, -1.0]]), "z = -y");
    assert_eq!((walkers[0].radius, walkers[0].goal_arrival), (Some(0.35), Some(0.1)));
    assert!(
        walkers.iter().all(|w| (0.6..=0.8).contains(&w.speed.unwrap()))
            && walkers[0].speed != walkers[1].speed
    );
    let navigation = &found.scenario.navigation;
    assert_eq!(
        (navigation.neighbour_distance, navigation.neighbour_cap, navigation.time_horizon),
        (6.0, 8, 3.0)
    );
    assert_eq!((found.report.with_an_end, found.report.unsupported.len()), (2, 0), "{:?}", found.report);
    let text = found.scenario.to_toml().unwrap();
    assert_eq!(Scenario::parse(&text, "again").unwrap(), found.scenario, "TOML and back");
    let library = GaitLibrary::built_in().unwrap();
    let agents = populate_from(&found.scenario, &library).unwrap().agents;
    assert_eq!((agents.len(), agents[0].radius, agents[0].speed), (2, 0.35, walkers[0].speed));
}

#[test]
fn generators_make_grids_and_lattices() {
    let grid = r#"<Generator type="rect_grid" anchor_x="1" anchor_y="2" offset_x="1" offset_y="-0.5" count_x="2" count_y="3" rotation="90"/>"#;
    let found = project(&group("one", "Walk", grid), MIRROR, &[]).unwrap();
    let places: Vec<Vec2> = found.scenario.walkers.iter().map(|w| Vec2::from(w.position)).collect();
    assert_eq!(places.len(), 6);
    // (1, 0) turned by 90 degrees is (0, 1), which is -z
    assert!(places[3].distance(Vec2::new(1.0, -3.0)) < 1e-5, "{places:?}");
    let lattice = r#"<Generator type="hex_lattice" anchor_x="1.5" anchor_y="0" alignment="center" row_direction="x"
        density="1.8" width="4.0" population="40" rotation="-90"/>"#;
    let found = project(&group("one", "Walk", lattice), MIRROR, &[]).unwrap();
    let places: Vec<Vec2> = found.scenario.walkers.iter().map(|w| Vec2::from(w.position)).collect();
    let nearest = places
        .iter()
        .map(|a| places.iter().filter(|b| *b != a).map(|b| a.distance(*b)).fold(f32::MAX, f32::min));
    let side = (2.0 / (3_f32.sqrt() * 1.8)).sqrt();
    assert!(nearest.into_iter().all(|d| (d - side).abs() < 1e-3));
    assert!(places.iter().all(|p| p.x >= 1.499 && p.y.abs() <= 2.0), "{places:?}");
}

#[test]
fn obstacles_are_solid_open_or_around() {
    let obstacle = |closed: u8, corners: &[[f32; 2]]| {
        let vertex = |[x, y]: &[f32; 2]| format!("<Vertex p_x=\"{x}\" p_y=\"{y}\"/>");
        format!("<Obstacle closed=\"{closed}\">{}</Obstacle>", corners.iter().map(vertex).collect::<String>())
    };
    let set = format!(
        "<ObstacleSet type=\"explicit\" class=\"1\">{}{}{}</ObstacleSet>",
        obstacle(1, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
        obstacle(0, &[[5.0, 0.0], [6.0, 0.0], [6.0, 2.0]]),
        obstacle(1, &[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]),
    );
    let found = project(&(group("one", "Walk", PAIR) + &set), MIRROR, &[]).unwrap();
    assert_eq!(found.report.obstacles, 1 + 2 + 4);
    assert_eq!(found.scenario.obstacles[0].polygon[2], [1.0, -1.0]);
    let approximated = &found.report.approximated;
    assert_eq!(approximated.len(), 2, "{approximated:?}");
    assert!(approximated[1].instead.contains("people start inside"), "{approximated:?}");
    assert_eq!((approximated[1].file.as_str(), approximated[1].element.as_str()), ("S.xml", "<Obstacle>"));
}

/// A wall between the start and the goal, longer than the room on either side of it; agents of `one` heed class 1.
fn wall(closed: u8) -> String {
    let corners = [[-0.2, -14.0], [0.2, -14.0], [0.2, 14.0], [-0.2, 14.0]];
    let vertex = |[x, y]: [f32; 2]| format!("<Vertex p_x=\"{x}\" p_y=\"{y}\"/>");
    let vertices: String = corners.map(vertex).concat();
    format!(
        "<ObstacleSet type=\"explicit\" class=\"1\"><Obstacle closed=\"{closed}\">{vertices}</Obstacle></ObstacleSet>"
    )
}

const TO_A_BOX: &str = r#"<State name="Walk" final="0"><GoalSelector type="explicit" goal_set="2" goal="5"/>
    <VelComponent type="vel_field" file_name="field.txt" use_nearest="1"/></State><State name="Stop" final="1"/>
  <GoalSet id="1"><Goal type="point" id="0" x="-9" y="0"/></GoalSet>
  <GoalSet id="2"><Goal type="AABB" id="5" min_x="4" min_y="-1" max_x="6" max_y="1"/></GoalSet>
  <Transition from="Walk" to="Stop"><Condition type="goal_reached" distance="0.25"/></Transition>"#;

#[test]
fn a_vector_field_becomes_way_finding_to_its_goal_round_the_obstacles() {
    let scene = group("one", "Walk", PAIR) + &wall(1);
    let field = "1 2\n4.0\n-4 -2\n0 1\n1 0\n";
    let found = project(&scene, TO_A_BOX, &[("field.txt", field)]).unwrap();
    let approximated = found.report.approximated.first().unwrap();
    assert_eq!((approximated.file.as_str(), approximated.line), ("B.xml", 2), "{approximated:?}");
    assert!(
        approximated.instead.contains("way-finding") && approximated.instead.contains("1 by 2 cells of 4 m")
    );
    let said = serde_json::to_value(&found.report).unwrap();
    assert_eq!(said["approximated"][0]["element"], "<VelComponent type=\"vel_field\">");
    assert_eq!(found.scenario.walkers[0].way, Some(Way::Auto));
    assert_eq!(found.scenario.walkers[0].waypoints, [[5.0, 0.0]], "one field for all");
    let reach = found.scenario.walkers[0].goal_arrival.unwrap();
    assert!(
        reach >= 1.25,
        "an agent {reach} m from its middle is in the box of 2 m, or as near as the transition asks"
    );
    let time = arrive(&found.scenario, 60.0).unwrap();
    println!("round a wall of 28 m in {time} s");
    assert!(time > 20.0, "{time} s: round the wall it is 31 m");
    let again = Scenario::parse(&found.scenario.to_toml().unwrap(), "again").unwrap();
    assert_eq!(again, found.scenario);
    // the file itself is not needed where there is a goal, but read if it is there
    assert_eq!(project(&scene, TO_A_BOX, &[]).unwrap().scenario.walkers, found.scenario.walkers);
    let said = project(&scene, TO_A_BOX, &[("field.txt", "1 2\n4.0\n-4 -2\n0 1\nnorth")]).unwrap_err();
    assert!(said.starts_with("field.txt:5: x of a velocity is \"north\""), "{said}");
    // without a goal: to the box in which the state ends, or to where the field itself ends
    let boxed = TO_A_BOX.replace("type=\"explicit\" goal_set=\"2\" goal=\"5\"", "type=\"identity\"").replace(
        "type=\"goal_reached\" distance=\"0.25\"",
        "type=\"AABB\" inside=\"1\" min_x=\"4\" min_y=\"-1\" max_x=\"6\" max_y=\"1\"",
    );
    let inside = project(&scene, &boxed, &[]).unwrap().scenario;
    assert_eq!(inside.walkers[0].waypoints, [[5.0, 0.0]]);
    let followed = TO_A_BOX.replace("type=\"explicit\" goal_set=\"2\" goal=\"5\"", "type=\"identity\"");
    let ends = project(&scene, &followed, &[("field.txt", field)]).unwrap().scenario.walkers[0].waypoints[0];
    assert!((-4.0..-3.0).contains(&ends[0]) || ends[1] < -1.0, "up the page is -z: {ends:?}");
}

#[test]
fn goal_sets_after_the_states_shared_goals_and_goals_of_every_kind_are_read() {
    let state = |name: &str, selector: &str| {
        format!(
            "<State name=\"{name}\" final=\"0\"><GoalSelector {selector}/><VelComponent type=\"goal\"/></State>"
        )
    };
    let to = |from: &str, to: &str| {
        format!(
            "<Transition from=\"{from}\" to=\"{to}\"><Condition type=\"and\"><Condition type=\"timer\" dist=\"c\" value=\"1\"/>\
                 <Condition type=\"goal_reached\" distance=\"0.2\"/></Condition></Transition>"
        )
    };
    let behaviour = [
        state("A", "type=\"nearest\" goal_set=\"7\""),
        state("B", "type=\"second_nearest\" goal_set=\"7\""),
        state("C", "type=\"explicit\" goal_set=\"9\" goal=\"3\""),
        state("D", "type=\"shared\" state_name=\"C\""),
        "<GoalSet id=\"7\"><Goal type=\"point\" id=\"0\" x=\"-2\" y=\"0\"/><Goal type=\"circle\" id=\"4\" x=\"0\" y=\"0\" radius=\"0\"/></GoalSet>".into(),
        "<GoalSet id=\"9\"><Goal type=\"OBB\" id=\"3\" x=\"8\" y=\"0\" width=\"2\" height=\"2\" angle=\"90\"/>\
         <Goal type=\"path\" id=\"5\" closed=\"1\"><Point x=\"1\" y=\"1\"/></Goal></GoalSet>".into(),
        to("A", "B"), to("B", "C"), to("C", "D"),
    ].concat();
    let found = project(&group("one", "A", PAIR), &behaviour, &[]).unwrap();
    let way = &found.scenario.walkers[0].waypoints;
    assert_eq!(way[0], [-2.0, 0.0], "{way:?}");
    assert_eq!(way[1], [0.0, 0.0], "the second nearest: {way:?}");
    assert!((way[2][0] - 6.0).abs() < 1e-4 && way[2] == way[3], "{way:?}");
    let kinds: Vec<&str> = found.report.approximated.iter().map(|one| one.element.as_str()).collect();
    assert!(
        kinds.contains(&"<Goal type=\"path\">") && kinds.contains(&"<Condition type=\"and\">"),
        "{kinds:?}"
    );
    let said =
        project(&group("one", "A", PAIR), &behaviour.replace("GoalSet id=\"9\"", "GoalSet id=\"8\""), &[]);
    assert!(said.unwrap_err().contains("no goal set 9, or it is empty; goal sets with goals: 7, 8"));
}

#[test]
fn obstacles_whose_edges_cross_or_that_no_agent_heeds_are_read() {
    let obstacle = |corners: &[[f32; 2]]| {
        let vertex = |[x, y]: &[f32; 2]| format!("<Vertex p_x=\"{x}\" p_y=\"{y}\"/>");
        format!("<Obstacle closed=\"1\">{}</Obstacle>", corners.iter().map(vertex).collect::<String>())
    };
    let set = |class: u32, inner: &str| {
        format!("<ObstacleSet type=\"explicit\" class=\"{class}\">{inner}</ObstacleSet>")
    };
    let bow = obstacle(&[[0.0, 4.0], [4.0, 6.0], [4.0, 4.0], [0.0, 6.0]]);
    let twice = obstacle(&[[0.0, 8.0], [1.0, 8.0], [1.0, 8.0], [1.0, 9.0], [0.0, 9.0], [0.0, 8.0]]);
    let line = obstacle(&[[6.0, 8.0], [7.0, 8.0]]);
    let scene = group("one", "Walk", PAIR) + &set(1, &(bow + &twice + &line));
    let found = project(&scene, MIRROR, &[]).unwrap();
    assert_eq!(found.report.obstacles, 2 + 1 + 1, "{:?}", found.report);
    let crossing = &found.report.approximated[0];
    assert!(
        crossing.instead.contains("cross") && crossing.instead.contains("2 solid pieces"),
        "{crossing:?}"
    );
    let library = GaitLibrary::built_in().unwrap();
    assert_eq!(populate_from(&found.scenario, &library).unwrap().agents.len(), 2);
    // across their way, in a class that they do not heed
    let heeding = PROFILES.replace("max_neighbors=\"8\"", "max_neighbors=\"8\" obstacleSet=\"1\"");
    let scene =
        group("one", "Walk", PAIR) + &set(2, &obstacle(&[[0.0, -9.0], [0.1, -9.0], [0.1, 9.0], [0.0, 9.0]]));
    let found =
        project(&(scene.clone() + &heeding.replace("name=\"one\"", "name=\"three\"")), MIRROR, &[]).unwrap();
    assert_eq!(found.report.obstacles, 1);
    let found = project(
        &(heeding.replace("\"one\"", "\"four\"") + &scene.replace("\"one\"", "\"four\"")),
        MIRROR,
        &[],
    )
    .unwrap();
    assert_eq!(found.report.obstacles, 0);
    assert!(
        found.report.unsupported[0].contains("class=\"2\"")
            && found.report.unsupported[0].contains("nobody heeds")
    );
}

#[test]
fn a_mesh_with_walls_after_which_none_follows_is_read() {
    // two rooms with a door of 2 m between them; one wall follows none, and a screen stands in the second room
    let mesh = "10\n 0 0\n 4 0\n 4 1\n 4 3\n 4 4\n 0 4\n 8 0\n 8 4\n 6 1\n 6 2\n
        1\n 2 3 0 1\n
        9\n 0 1 0 1\n 1 6 1 2\n 6 7 1 3\n 7 4 1 4\n 4 5 0 5\n 5 0 0 0\n 1 2 0 -1\n 3 4 0 -1\n 8 9 1 -1\n
        rooms\n2\n 2 2\n 6 0 1 2 3 4 5\n 0 0 0\n 1 0\n 1 0\n 6 2\n 6 1 6 7 4 3 2\n 0 0 0\n 1 0\n 1 1\n";
    let scene = group("one", "Walk", r#"<Generator type="explicit"><Agent p_x="1" p_y="0.6"/></Generator>"#)
        + "<ObstacleSet type=\"nav_mesh\" file_name=\"rooms.nav\" class=\"1\"/>";
    let behaviour = r#"<GoalSet id="0"><Goal type="point" id="0" x="7" y="3.4"/></GoalSet>
      <State name="Walk" final="0"><GoalSelector type="explicit" goal_set="0" goal="0"/><VelComponent type="nav_mesh" file_name="rooms.nav"/></State>
      <State name="Stop" final="1"/>
      <Transition from="Walk" to="Stop"><Condition type="goal_reached" distance="0.25"/></Transition>"#;
    let found = project(&scene, behaviour, &[("rooms.nav", mesh)]).unwrap();
    assert_eq!((found.scenario.bounds.len(), found.report.obstacles), (6, 3), "{:?}", found.report);
    assert!(
        found.report.approximated[0].instead.contains("3 rows of walls"),
        "{:?}",
        found.report.approximated
    );
    arrive(&found.scenario, 30.0).unwrap();
    let said = project(&scene, behaviour, &[("rooms.nav", &mesh.replace(" -1\n", " 99\n"))]).unwrap_err();
    assert!(said.contains("rooms.nav:") && said.contains("-1 where none follows"), "{said}");
}

#[test]
fn circles_of_states_are_walked_in_circles_and_teleports_by_boxes() {
    let circle = r#"<GoalSet id="0"><Goal type="point" id="0" x="-3" y="0"/><Goal type="point" id="1" x="3" y="0"/></GoalSet>
      <State name="A" final="0"><GoalSelector type="explicit" goal_set="0" goal="0"/><VelComponent type="goal"/></State>
      <State name="B" final="0"><GoalSelector type="explicit" goal_set="0" goal="1"/><VelComponent type="goal"/>
        <Action type="offset_property" property="r" dist="c" value="0.1"/></State>
      <Transition from="A" to="B"><Condition type="goal_reached" distance="0.2"/></Transition>
      <Transition from="B" to="A"><Condition type="goal_reached" distance="0.2"/></Transition>"#;
    let found = project(&group("one", "A", PAIR), circle, &[]).unwrap();
    assert_eq!(
        (found.scenario.walkers[0].mode, found.scenario.walkers[0].waypoints.len()),
        (RouteMode::Loop, 2)
    );
    assert!(
        found.report.unsupported[0].contains("B.xml:4")
            && found.report.unsupported[0].contains("offset_property")
    );
    let periodic = r#"<GoalSet id="0"><Goal type="point" id="0" x="15" y="0"/></GoalSet>
      <State name="A" final="0"><GoalSelector type="explicit" goal_set="0" goal="0"/><VelComponent type="goal"/></State>
      <State name="T" final="0"><GoalSelector type="identity"/><VelComponent type="zero"/>
        <Action type="teleport" dist="u" min_x="-9" max_x="-8" min_y="-1" max_y="1"/></State>
      <Transition from="A" to="T"><Condition type="AABB" min_x="8" max_x="30" min_y="-2" max_y="2" inside="1"/></Transition>
      <Transition from="T" to="A"><Condition type="auto"/></Transition>"#;
    let found = project(&group("one", "A", PAIR), periodic, &[]).unwrap();
    let teleport = found.scenario.walkers[0].teleport.unwrap();
    assert_eq!((teleport.from, teleport.to), ([[8.0, -2.0], [30.0, 2.0]], [[-9.0, -1.0], [-8.0, 1.0]]));
    assert_eq!(found.report.with_an_end, 0);
    let library = GaitLibrary::built_in().unwrap();
    let crowd = populate_from(&found.scenario, &library).unwrap();
    let cast = AvatarSet::new(library.gaits(), vec![generated(Sex::Female), generated(Sex::Male)]).unwrap();
    let mut simulation = Simulation::new(&found.scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let (mut jumps, mut before) = (0, simulation.state().unwrap().position.clone());
    for _ in 0..1200 {
        simulation.step(1).unwrap();
        let now = simulation.state().unwrap().position.clone();
        for (a, b) in before.iter().zip(&now) {
            jumps += u32::from(a[0] > 7.9 && b[0] < -7.5);
            assert!(b[0] < 8.2, "{b:?}");
        }
        before = now;
    }
    assert!(
        (5..=6).contains(&jumps),
        "{jumps} in 40 s of rounds of 17 m, after 11 m, by two people at 1.2 m/s"
    );
}

#[test]
fn roads_lead_round_walls() {
    let wall = r#"<ObstacleSet type="explicit" class="1"><Obstacle closed="1"><Vertex p_x="-0.2" p_y="-9"/>
        <Vertex p_x="0.2" p_y="-9"/><Vertex p_x="0.2" p_y="2"/><Vertex p_x="-0.2" p_y="2"/></Obstacle></ObstacleSet>"#;
    let roads = r#"<GoalSet id="0"><Goal type="AABB" id="0" min_x="3" max_x="5" min_y="-2" max_y="2"/></GoalSet>
      <State name="Walk" final="0"><GoalSelector type="nearest" goal_set="0"/><VelComponent type="road_map" file_name="map.txt"/></State>
      <State name="Stop" final="1"/>
      <Transition from="Walk" to="Stop"><Condition type="goal_reached" distance="0.25"/></Transition>"#;
    let scene = group("one", "Walk", PAIR) + wall;
    let found = project(&scene, roads, &[("map.txt", "2\n1 -1 3.5\n1 1 3.5\n1\n0 1\n")]).unwrap();
    let ways: Vec<_> = found.scenario.walkers.iter().map(|walker| &walker.waypoints).collect();
    assert!(ways.iter().all(|way| way.len() == 2 && way[0][1] == -3.5), "{ways:?}");
    assert!(ways[0][1] != ways[1][1], "each a place of its own");
    let time = arrive(&found.scenario, 30.0).unwrap();
    println!("round the wall in {time} s");
}

#[test]
fn what_is_wrong_is_named_with_file_and_line() {
    let ok = group("one", "Walk", PAIR);
    for (scene, behaviour, why) in [
        (group("three", "Walk", PAIR), MIRROR, "S.xml:4: there is no profile \"three\""),
        (ok.replace("p_x=\"-3\"", "p_x=\"west\""), MIRROR, "p_x=\"west\" of <Agent>"),
        (ok.replace(" p_y=\"1\"", ""), MIRROR, "has no attribute p_y"),
        (
            ok.clone(),
            "<State name=\"Walk\"><GoalSelector type=\"explicit\" goal_set=\"4\" goal=\"0\"/></State>",
            "no goal set 4",
        ),
        (ok.clone(), "<State", "B.xml:1"),
        (ok.replace("-3", "-3e9"), MIRROR, "within 50000 m of the origin"),
        (
            group(
                "one",
                "Walk",
                "<Generator type=\"rect_grid\" anchor_x=\"0\" anchor_y=\"0\" offset_x=\"1\" offset_y=\"1\" count_x=\"9999999\" count_y=\"1\"/>",
            ),
            MIRROR,
            "not 0 to 1000",
        ),
        (String::from("<AgentProfile name=\"x\" inherits=\"x\"/>"), MIRROR, "inherits from itself"),
    ] {
        let said = project(&scene, behaviour, &[]).unwrap_err();
        assert!(said.contains(why), "{why}: {said}");
    }
    let strange = "<Weather/>".to_owned() + &group("one", "Walk", "<Generator type=\"spiral\"/>");
    let found = project(&strange, MIRROR, &[]).unwrap();
    assert!(found.report.unsupported.iter().any(|line| line.contains("<Weather>")), "{:?}", found.report);
    assert!(found.report.unsupported.iter().any(|line| line.contains("spiral")), "{:?}", found.report);
}

#[test]
fn cut_files_are_answered() {
    let scene = group("one", "Walk", PAIR);
    for end in (0..scene.len()).step_by(7) {
        let _ = project(&scene[..end], MIRROR, &[]);
    }
    for end in (0..MIRROR.len()).step_by(7) {
        let _ = project(&scene, &MIRROR[..end], &[]);
    }
}

#[test]
fn in_every_scene_of_menge_everyone_arrives() {
    let Some(folder) = data_set("crowd-menge") else { return };
    let mut faults = Vec::new();
    for (name, agents, most) in [
        ("4square", 100, 120.0),
        ("bottleneck", 5, 60.0),
        ("circle", 100, 90.0),
        ("headon", 2, 20.0),
        ("stadium", 90, 90.0),
        ("steerbench/curves", 1, 90.0),
        ("steerbench/frogger", 4, 60.0),
        ("steerbench/oncomingObstacle", 2, 60.0),
        ("steerbench/simple", 1, 40.0),
        ("steerbench/surprise", 2, 60.0),
        ("steerbench/wallSqueeze", 3, 90.0),
    ] {
        let found = import(&folder.join(format!("{name}.xml")), 1).unwrap();
        assert_eq!(found.report.agents, agents, "{name}");
        assert_eq!(found.report.with_an_end, agents, "{name}");
        let outcome = arrive(&found.scenario, most);
        println!("{name}: {outcome:?} {:?} {:?}", found.report.unsupported, found.report.notes);
        faults.extend(outcome.err().map(|fault| format!("{name}: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn menges_scenes_without_an_end_go_on() {
    let Some(folder) = data_set("crowd-menge") else { return };
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), vec![generated(Sex::Female), generated(Sex::Male)]).unwrap();
    for (name, agents) in [("swap", 2), ("periodic", 200)] {
        let found = import(&folder.join(format!("{name}.xml")), 1).unwrap();
        println!("{name}: {:?} {:?}", found.report.unsupported, found.report.notes);
        assert_eq!((found.report.agents, found.report.with_an_end), (agents, 0), "{name}");
        let crowd = populate_from(&found.scenario, &library).unwrap();
        let mut simulation = Simulation::new(&found.scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
        let mut way = vec![0.0_f32; agents];
        let mut before = simulation.state().unwrap().position.clone();
        for _ in 0..1200 {
            simulation.step(1).unwrap();
            let now = simulation.state().unwrap().position.clone();
            for ((way, a), b) in way.iter_mut().zip(&before).zip(&now) {
                let step = Vec2::from(*a).distance(Vec2::from(*b));
                *way += if step < 1.0 { step } else { 0.0 };
            }
            before = now;
        }
        let least = way.iter().copied().fold(f32::MAX, f32::min);
        let mean = way.iter().sum::<f32>() / agents as f32;
        println!("{name}: in 40 s everyone walked at least {least:.1} m, {mean:.1} m on average");
        assert!(least > 4.0 && mean > 15.0, "{name}: {least} {mean}");
    }
}
