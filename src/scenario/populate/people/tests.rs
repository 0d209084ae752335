use super::*;

fn scenario(classes: &str) -> Scenario {
    let mut scenario = Scenario::builtin("crossing").unwrap().with_agents(4000);
    scenario.population = toml::from_str(&format!("agents = 4000\n{classes}")).unwrap();
    scenario
}

#[test]
fn classes_have_their_shares_and_numbers_within_their_spreads() {
    let scenario = scenario(
        "[[classes]]\nname = 'old'\nshare = 1\nage = [60, 80]\npriority = 1\n\
         [[classes]]\nname = 'normal'\nshare = 3\nspeed = { mean = 1.34, deviation = 0.26, least = 0.8 }\n\
         radius = [0.2, 0.3]\nreaction = 5\navatars = ['male']\n",
    );
    scenario.validate().unwrap();
    let people: Vec<Person<'_>> = (0..4000).map(|agent| person(&scenario, agent)).collect();
    let is_old = |p: &&Person<'_>| p.class.unwrap().name == "old";
    let old = people.iter().filter(is_old).count();
    assert!((900..1100).contains(&old), "{old}");
    for p in people.iter().filter(is_old) {
        assert!((0.68..=1.41).contains(&p.speed.unwrap()) && p.avoidance.priority > 0.99);
    }
    let normal: Vec<f32> = people.iter().filter(|p| !is_old(p)).filter_map(|p| p.speed).collect();
    let mean = normal.iter().sum::<f32>() / normal.len() as f32;
    let variance = normal.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / normal.len() as f32;
    assert!((mean - 1.35).abs() < 0.02 && (variance.sqrt() - 0.25).abs() < 0.02, "{mean} {variance}");
    assert!(normal.iter().all(|v| (0.8..=2.12).contains(v)));
    assert!((largest_radius(&scenario) - 0.3).abs() < 1e-6, "{}", largest_radius(&scenario));
    for agent in 0..100 {
        let p = person(&scenario, agent);
        if p.class.unwrap().name == "normal" {
            assert_eq!(p.avatar(&scenario, agent), Some(1));
            assert!((0.2..=0.3).contains(&p.radius(&scenario.navigation, 1.0)));
        }
    }
}

#[test]
fn personality_changes_parameters_in_proportion_and_stays_in_range() {
    let half = scenario("[[classes]]\nshare = 1\npersonality = { neuroticism = 0.5 }\n");
    half.validate().unwrap();
    let p = person(&half, 0);
    assert!((p.radius_factor - 1.5).abs() < 1e-6 && (p.speed_factor - 0.946).abs() < 1e-3, "{p:?}");
    assert!((largest_radius(&half) - crate::scenario::BODY_RADIUS * 1.07 * 1.5).abs() < 1e-5);
    let wild =
        scenario("[[classes]]\nshare = 1\npersonality = { impulsive = 1, tense = 1, neuroticism = 1 }\n");
    let p = person(&wild, 0);
    assert!(p.radius_factor <= 2.0 && p.avoidance.neighbour_cap <= 10 && p.avoidance.time_horizon <= 20.0);
    let own = scenario(
        "traits = { openness = [1, 1, 2, 1, 1] }\n[[classes]]\nshare = 1\npersonality = { openness = 1 }\n",
    );
    own.validate().unwrap();
    assert!((person(&own, 3).avoidance.time_horizon - 4.0).abs() < 1e-6);
    let unknown = scenario("[[classes]]\nshare = 1\npersonality = { openness = 1 }\n").validate();
    assert!(unknown.unwrap_err().to_string().contains("openness"));
}

#[test]
fn values_out_of_range_and_two_speeds_are_refused() {
    for (wrong, key) in [
        ("share = -1", "share"),
        ("share = 1\npriority = 1.5", "priority"),
        ("share = 1\nradius = [0.3, 0.2]", "radius"),
        ("share = 1\nage = 30\nspeed = 1", "speed"),
        ("share = 1\nspeed = { mean = 1, deviation = 1 }", "speed"),
        ("share = 1\nneighbour_cap = 11", "neighbour_cap"),
        ("share = 1\navatars = ['dog']", "avatars"),
        ("share = 0", "classes"),
    ] {
        let error = scenario(&format!("[[classes]]\n{wrong}\n")).validate().unwrap_err().to_string();
        assert!(error.contains(key), "{wrong}: {error}");
    }
}
