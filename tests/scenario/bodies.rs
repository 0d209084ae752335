//! How people of a scenario are built.

use gaitway::avatar::anthropometry::Build;
use gaitway::kernels::layout::Physique;
use gaitway::scenario::{AgentStart, Scenario, populate};

/// A hall with people of `population`'s further lines.
fn hall(lines: &str) -> Scenario {
    let text = format!(
        "name = \"hall\"\nbounds = [[0, 0], [60, 0], [60, 60], [0, 60]]\n[population]\nagents = 600\n{lines}\n\
         [[routes]]\nname = \"way\"\nwaypoints = [[4, 30], [56, 30]]\nwidth = 50\n"
    );
    Scenario::parse(&text, "hall.toml").unwrap()
}

fn people(lines: &str) -> Vec<AgentStart> {
    populate(&hall(lines), |_| &[0]).unwrap().agents
}

fn mean(people: &[AgentStart], of: impl Fn(&AgentStart) -> f32) -> f32 {
    people.iter().map(of).sum::<f32>() / people.len() as f32
}

/// Stature, m: the generated bodies are 1.64 and 1.76 m high.
fn stature(agent: &AgentStart) -> f32 {
    [1.64, 1.76][agent.avatar as usize] * agent.scale * agent.build.stature
}

fn waist(agent: &AgentStart) -> f32 {
    Physique::ratios_in(agent.build.physique.waist).iter().sum::<f32>() * 0.5 * agent.scale
}

#[test]
fn bodies_differ_by_default_at_the_sizes_that_the_scale_gives_them() {
    let [default, as_avatars] = ["", "bodies.sizes = \"avatar\""].map(people);
    for (own, plain) in default.iter().zip(&as_avatars) {
        assert_eq!((own.scale, own.position, own.radius), (plain.scale, plain.position, plain.radius));
        assert_eq!(plain.build, Build::default());
        assert!((own.build.stature - 1.0).abs() < 0.12, "{own:?}");
    }
    let tall = mean(&default, |agent| agent.build.stature);
    assert!((tall - 1.0).abs() < 0.01, "{tall}");
    let first = default[0].build.physique;
    assert!(default.iter().skip(1).all(|agent| agent.build.physique != first));
    assert_eq!(people(""), default, "the same seed, the same people");
}

#[test]
fn statures_and_weights_come_from_the_tables_that_a_scenario_names() {
    for (lines, women, men) in [
        ("bodies.sizes = \"ansur\"", 1.628, 1.756),
        ("bodies = { sizes = \"nhanes\", ages = [20, 29.9] }", 1.618, 1.763),
        ("bodies = { sizes = \"nhanes\", ages = 6.04 }", 1.154, 1.157),
    ] {
        let all = people(lines);
        let of = |avatar: u32| -> Vec<AgentStart> {
            all.iter().filter(|agent| agent.avatar == avatar).cloned().collect()
        };
        for (avatar, want) in [(0, women), (1, men)] {
            let found = mean(&of(avatar), stature);
            assert!((found / want - 1.0).abs() < 0.015, "{lines}: {found} not {want} m");
        }
        assert!(all.iter().all(|agent| agent.radius > 0.0 && agent.scale > 0.29));
    }
    let child = people("bodies = { sizes = \"nhanes\", ages = 6 }");
    let heads = mean(&child, |agent| Physique::ratios_in(agent.build.physique.head_and_shoulders)[0]);
    assert!(heads > 1.2, "children have large heads: {heads}");
}

#[test]
fn the_body_mass_index_and_ages_of_classes_shape_people() {
    let [slim, heavy] = ["bodies.body_mass_index = 20", "bodies.body_mass_index = 35"]
        .map(|lines| mean(&people(lines), waist));
    assert!(heavy > 1.3 * slim, "{heavy} {slim}");
    let classes = "bodies.sizes = \"nhanes\"\nclasses = [{ share = 1, age = 8 }, { share = 1, age = 40 }]";
    let all = people(classes);
    let children = all.iter().filter(|agent| stature(agent) < 1.45).count();
    assert!((240..360).contains(&children), "{children} children of 600");
}

#[test]
fn without_variety_a_stature_and_a_weight_make_one_shape() {
    let all = people("scale = [1, 1]\nbodies = { variety = 0, body_mass_index = 24 }");
    for avatar in [0, 1] {
        let mut of = all.iter().filter(|agent| agent.avatar == avatar);
        let first = of.next().unwrap();
        assert!(of.all(|agent| agent.build == first.build));
    }
}

#[test]
fn wrong_builds_are_refused() {
    for (lines, said) in [
        ("bodies.variety = 1.5", "population.bodies.variety = 1.5"),
        ("bodies.ages = [1, 5]", "population.bodies.ages"),
        ("bodies.body_mass_index = 4", "population.bodies.body_mass_index"),
        ("bodies.sizes = \"huge\"", "unknown variant `huge`"),
    ] {
        let text = hall("").to_toml().unwrap().replace("[population]", &format!("[population]\n{lines}"));
        let text = text.replace("[population.bodies]", "[population.was]");
        let error = Scenario::parse(&text, "hall.toml").map(drop).unwrap_err().to_string();
        assert!(error.contains(said), "{lines}: {error}");
    }
}
