//! Which gait an agent walks with, and mixtures by valence and arousal, as a scenario says.

use gaitway::Emotion;
use gaitway::gait::Gait;
use gaitway::gait::walker::Sex;
use gaitway::library::GaitLibrary;
use gaitway::library::blend::weights_from_affect;
use gaitway::perception::Perceiver;
use gaitway::scenario::{AgentStart, Condition, Scenario, populate, populate_from, populate_with};
use gaitway::scene::Scene;
use gaitway::sim::Backend;

fn scenario(population: &str) -> Scenario {
    let text = format!("name = \"test\"\nlayout = \"crossing\"\n[population]\nagents = 300\n{population}\n");
    Scenario::parse(&text, "test.toml").unwrap()
}

fn refused(population: &str) -> String {
    let text = format!("name = \"test\"\nlayout = \"crossing\"\n[population]\n{population}\n");
    Scenario::parse(&text, "test.toml").unwrap_err().to_string()
}

fn library() -> GaitLibrary {
    GaitLibrary::built_in().unwrap()
}

fn agents(scenario: &Scenario) -> Vec<AgentStart> {
    populate_from(scenario, &library()).unwrap().agents
}

#[test]
fn a_library_without_preferences_gives_the_crowd_that_its_ids_give() {
    let library = library();
    for mode in ["", "gaits = \"cycle\"", "gaits = \"first\"", "emotion_mode = \"blend\""] {
        let scenario = scenario(mode);
        let by_ids = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
        assert_eq!(populate_from(&scenario, &library).unwrap(), by_ids, "{mode}");
    }
}

#[test]
fn gaits_match_or_counter_the_gender_of_the_avatar() {
    let library = library();
    let sex = |agent: &AgentStart| library.gaits()[agent.gaits[0] as usize].provenance.sex.unwrap();
    for (word, same) in [("match", true), ("counter", false)] {
        for agent in agents(&scenario(&format!("prefer = {{ gender = \"{word}\" }}"))) {
            assert_eq!(sex(&agent) == Sex::ALL[agent.avatar as usize], same, "{word}");
        }
    }
    assert!(agents(&scenario("prefer = { gender = \"male\" }")).iter().all(|agent| sex(agent) == Sex::Male));
    let named = "avatars = [\"a.vrm\", \"female\"]\navatar_genders = [\"male\", \"female\"]\nprefer.gender = \"match\"";
    for agent in agents(&scenario(named)) {
        assert_eq!(sex(&agent), [Sex::Male, Sex::Female][agent.avatar as usize]);
    }
}

#[test]
fn agents_with_a_preferred_speed_walk_at_about_it() {
    let library = library();
    let speed = |agent: &AgentStart| library.gaits()[agent.gaits[0] as usize].speed;
    let mean = |population: &str| {
        let agents = agents(&scenario(population));
        agents.iter().map(speed).sum::<f32>() / 300.0
    };
    let only = "emotions = { neutral = 1.0 }\n";
    let slow = mean(&format!("{only}prefer = {{ speed = 1.0, speed_tolerance = 0.02 }}"));
    let fast = mean(&format!("{only}prefer = {{ speed = [1.4, 1.5], speed_tolerance = 0.02 }}"));
    let any = mean(only);
    println!("slow {slow:.2}, any {any:.2}, fast {fast:.2} m/s");
    assert!(slow < any - 0.05 && fast > any + 0.05);
}

/// Sees every gait of a man as itself and of a woman as anything.
struct Men;

impl Perceiver for Men {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        let mut seen = [0.25; 4];
        if let (Some(Sex::Male), Some(label)) = (gait.provenance.sex, gait.label) {
            seen = [0.0; 4];
            seen[label.index()] = 1.0;
        }
        seen
    }
}

#[test]
fn clear_gaits_are_preferred_by_ratings_or_by_a_perceiver() {
    let library = library();
    let clear = scenario("prefer = { margin_temperature = 0.2 }");
    let crowd = populate_with(&clear, &library, Some(&Men)).unwrap();
    assert!(
        crowd.agents.iter().all(|a| library.gaits()[a.gaits[0] as usize].provenance.sex == Some(Sex::Male))
    );
    let message = populate_from(&clear, &library).unwrap_err().to_string();
    assert!(message.contains("no ratings") && message.contains("margin_temperature"), "{message}");
    let message = populate(&clear, |emotion| library.gaits_for(emotion)).unwrap_err().to_string();
    assert!(message.contains("population.prefer"), "{message}");
    let mut gaits = library.gaits().to_vec();
    for gait in &mut gaits {
        let is_clear = gait.name.ends_with("-3");
        gait.ratings =
            Some(gait.label.unwrap().weights().map(|weight| 1.5 + weight * if is_clear { 3.0 } else { 2.1 }));
    }
    let rated = GaitLibrary::from_gaits(gaits).unwrap();
    let always = scenario("prefer = { margin_temperature = 0 }");
    let crowd = populate_from(&always, &rated).unwrap();
    assert!(crowd.agents.iter().all(|agent| rated.gaits()[agent.gaits[0] as usize].name.ends_with("-3")));
}

#[test]
fn the_baseline_is_one_gait_for_all_whatever_is_preferred() {
    let preferring =
        scenario("prefer = { gender = \"match\", speed = [0.8, 1.6] }").with_condition(Condition::Baseline);
    let agents = agents(&preferring);
    assert!(agents.iter().all(|agent| agent.gaits == agents[0].gaits));
    let affect = scenario("emotion_mode = \"affect\"\naffect = { valence = 1, arousal = [0.2, 1] }");
    let agents = self::agents(&affect.with_condition(Condition::Baseline));
    assert!(
        agents
            .iter()
            .all(|agent| agent.emotion == Emotion::Neutral.weights() && agent.gaits == agents[0].gaits)
    );
}

#[test]
fn valence_and_arousal_become_weights_and_gaits_of_those_emotions() {
    let library = library();
    let fixed = scenario("emotion_mode = \"affect\"\naffect = { valence = -0.57, arousal = 0.16 }");
    for agent in agents(&fixed) {
        assert_eq!(agent.emotion, weights_from_affect(f64::from(-0.57_f32), f64::from(0.16_f32)));
        assert_eq!(agent.emotion, agent.gait_weights);
        assert!(
            agent.emotion[1] > 0.4 && agent.emotion[2] > 0.4,
            "half angry, half sad: {:?}",
            agent.emotion
        );
    }
    let spread = scenario("emotion_mode = \"affect\"\naffect = { valence = [-1, 1], arousal = [-1, 1] }");
    let everyone = agents(&spread);
    let strongest =
        |agent: &AgentStart| (0..4).max_by(|&a, &b| agent.emotion[a].total_cmp(&agent.emotion[b])).unwrap();
    let mut counts = [0; 4];
    for agent in &everyone {
        counts[strongest(agent)] += 1;
        assert!((agent.emotion.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        for emotion in Emotion::ALL {
            if agent.emotion[emotion.index()] > 0.0 {
                let gait = &library.gaits()[agent.gaits[emotion.index()] as usize];
                assert_eq!(gait.label, Some(emotion));
            }
        }
    }
    println!("strongest emotion over the whole plane: {counts:?}");
    assert!(counts.iter().all(|&count| count > 15), "{counts:?}");
    for (few, full) in agents(&spread.clone().with_agents(40)).iter().zip(&everyone) {
        assert_eq!((few.emotion, few.gaits), (full.emotion, full.gaits), "an agent feels alike in any crowd");
    }
    assert_eq!(Scenario::parse(&spread.to_toml().unwrap(), "again").unwrap(), spread);
    let sad_only: Vec<Gait> =
        library.gaits().iter().filter(|g| g.label == Some(Emotion::Sad)).cloned().collect();
    let message =
        populate_from(&spread, &GaitLibrary::from_gaits(sad_only).unwrap()).unwrap_err().to_string();
    assert!(message.contains("no ") && message.contains("population.affect"), "{message}");
}

#[test]
fn wrong_values_are_named_with_their_line_range_and_way_out() {
    for (population, line, parts) in [
        ("prefer = { speed = [1.5, 1.0] }", 4, &["population.prefer.speed", "[1.5, 1]", "0.1 to 5"][..]),
        ("agents = 3\nprefer.speed = 0", 5, &["[0, 0]"]),
        ("prefer.speed = \"fast\"", 4, &["prefer", "[least, greatest]"]),
        ("prefer.speed = [1, 2, 3]", 4, &["prefer"]),
        ("prefer.speed_tolerance = -1", 4, &["speed_tolerance", "0 to 5"]),
        ("prefer.margin_temperature = -0.5", 4, &["margin_temperature = -0.5", "rating points"]),
        ("prefer.gender = \"woman\"", 4, &["woman", "female"]),
        ("prefer.genders = \"female\"", 4, &["did you mean `gender`"]),
        ("gaits = \"cycle\"\nprefer.gender = \"match\"", 4, &["population.gaits", "cycle", "random"]),
        ("avatars = [\"x.vrm\"]\nprefer.gender = \"match\"", 5, &["x.vrm", "population.avatar_genders"]),
        ("avatar_genders = [\"male\"]", 4, &["1 genders", "each of the 2 avatars"]),
        ("emotion_mode = \"affect\"", 4, &["population.emotion_mode", "affect = {"]),
        ("affect = { valence = 0, arousal = 0 }", 4, &["emotion_mode = \"affect\""]),
        (
            "emotion_mode = \"affect\"\naffect = { valence = 0, arousal = 2 }",
            5,
            &["arousal", "[2, 2]", "-1 to 1"],
        ),
        ("emotion_mode = \"affect\"\naffect = { valence = nan, arousal = 0 }", 5, &["valence", "NaN"]),
    ] {
        let message = refused(population);
        assert!(message.contains(&format!("test.toml:{line}")), "{population}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{population}: {message}");
    }
}

#[test]
fn agents_are_individuals_where_the_gaits_are_generated_and_nobodys() {
    let of = |population: &str, condition: Condition, library: Option<GaitLibrary>| {
        let mut builder =
            Scene::of(scenario(population)).agents(4).condition(condition).backend(Backend::Cpu);
        if let Some(library) = library {
            builder = builder.library(library);
        }
        let (simulation, _) = builder.build().unwrap().start_with_bodies().unwrap();
        simulation.store().frame.individuals
    };
    assert_eq!(of("", Condition::EvaG, None), 1.0);
    assert_eq!(of("expression = 1.0", Condition::EvaO, None), 1.0);
    // people of a library are themselves, and the baseline is one gait for all
    assert_eq!(of("", Condition::EvaG, Some(library())), 0.0);
    assert_eq!(of("", Condition::Baseline, None), 0.0);
    // what is said is done
    assert_eq!(of("individuals = 0.5", Condition::EvaG, None), 0.5);
    assert_eq!(of("individuals = 0", Condition::EvaG, None), 0.0);
    assert_eq!(of("individuals = 0.25", Condition::EvaG, Some(library())), 0.25);
    assert_eq!(of("individuals = 1.0", Condition::Baseline, None), 1.0);
    for wrong in ["-0.1", "1.1", "nan"] {
        let error = refused(&format!("individuals = {wrong}"));
        assert!(error.contains("population.individuals") && error.contains("0 to 1"), "{error}");
    }
}
