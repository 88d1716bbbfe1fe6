//! Plans of many runs are read or refused by name with line and column, and their values reach the scenario as if they were written there.

use contrapposto_formats::{Design, Distribution, InputError, Template, Value, read_plan, read_run, scenario_model};
use miette::Diagnostic;

const PLAN: &str = r#"base = "../hold-tool.toml"
seed = 1
design = "sobol"
rows = 60
rows_per_part = 7
[parameters]
"model.adult.stature_m" = { normal = [1.65, 0.06] }
"load.0.mass_kg" = { range = [1, 5] }
"strength.spread" = { normal = [1, 0.2], correlate = { "passive.spread" = 0.3 } }
"passive.spread" = { lognormal = [1, 0.2] }
"model.adult.sex" = { list = ["female", "male"] }
"#;

/// Line, column, and message with help.
fn message(error: &InputError) -> (usize, usize, String) {
    let span = error.labels().into_iter().flatten().next().unwrap();
    let found = error.source_code().unwrap().read_span(span.inner(), 0, 0).unwrap();
    let help = error.help().map_or(String::new(), |help| help.to_string());
    (found.line() + 1, found.column() + 1, format!("{error}; {help}"))
}

#[test]
fn a_plan_has_its_parameters_in_the_order_of_the_file_and_parts_by_its_rows() {
    let plan = read_plan("plan.toml", PLAN.as_bytes()).unwrap();
    let keys: Vec<&str> = plan.parameters.iter().map(|parameter| parameter.key.as_str()).collect();
    assert_eq!(
        keys,
        ["model.adult.stature_m", "load.0.mass_kg", "strength.spread", "passive.spread", "model.adult.sex"]
    );
    assert_eq!((plan.design, plan.rows, plan.parts()), (Design::Sobol, 60, 9));
    assert_eq!((plan.rows_of(0), plan.rows_of(8)), (0..7, 56..60));
    assert_eq!(plan.parameters[3].distribution, Distribution::Lognormal { median: 1.0, deviation: 0.2 });
    let mixing = plan.mixing.unwrap();
    assert_eq!(mixing[3][2], 0.3);
    assert!((mixing[3][3] - 0.91f64.sqrt()).abs() < 1e-15);
}

#[test]
fn a_refused_plan_names_the_key_with_line_and_column_and_the_accepted_alternative() {
    for (from, to, line, column, words) in [
        ("rows = 60", "rows = 0", 4, 8, "`rows` is 0; it must lie in 1..10000000"),
        ("rows = 60\n", "", 1, 1, "the key `rows` is missing"),
        ("\"sobol\"", "\"sobel\"", 3, 10, "did you mean `sobol`?"),
        ("seed", "sede", 2, 1, "did you mean `seed`?"),
        ("rows_per_part = 7", "rows_per_part = 0", 5, 17, "`rows_per_part` is 0; it must lie in 1..100000"),
        ("[1.65, 0.06]", "[1.65, -1]", 7, 38, "the standard deviation is -1; it must be positive"),
        ("[1.65, 0.06]", "[1.65, nan]", 7, 45, "`nan` is not a finite number"),
        ("[1.65, 0.06]", "[1.65]", 7, 38, "1 numbers are given; 2 are due"),
        ("[1, 5]", "[5, 1]", 8, 30, "the range goes from 5 to 1; it must rise"),
        ("range = [1, 5]", "", 8, 20, "`load.0.mass_kg` has no values"),
        ("range = [1, 5]", "range = [1, 5], list = [1]", 8, 20, "keep one of normal"),
        ("range = [1, 5]", "range = [1, 5], levels = 3", 8, 47, "`levels` goes with the design \"grid\""),
        (
            "[1.65, 0.06]",
            "[1.65, 0.06], within = [1.7, 2]",
            7,
            61,
            "from 1.7 to 2; the mean 1.65 must lie between them",
        ),
        ("[1, 0.2] }\n\"model", "[1, 0.2], within = [2, 0.5] }\n\"model", 10, 53, "the median 1 must lie between them"),
        ("[1, 5]", "[1, 5], within = [2, 3]", 8, 47, "`within` goes with normal and lognormal"),
        ("\"passive.spread\" = 0.3", "\"passive.sprea\" = 0.3", 9, 56, "did you mean `passive.spread`?"),
        ("\"passive.spread\" = 0.3", "\"passive.spread\" = 1", 9, 75, "the correlation is 1; it must lie between"),
        ("\"load.0.mass_kg\"", "\"load..mass_kg\"", 8, 1, "`load..mass_kg` is no path of a key"),
        ("[\"female\", \"male\"]", "[]", 11, 30, "the list is empty"),
        ("\"sobol\"", "\"grid\"", 7, 27, "a grid needs the number of values"),
        (
            "[1, 0.2] }\n\"model",
            "[0, 0.2] }\n\"model",
            10,
            34,
            "median and standard deviation of the logarithm are 0 and 0.2; both must be",
        ),
        ("base = \"../hold-tool.toml\"", "base = \"\"", 1, 8, "`base` is no name of a file"),
    ] {
        let text = PLAN.replacen(from, to, 1);
        assert_ne!(text, PLAN, "{from}");
        let error = message(&read_plan("plan.toml", text.as_bytes()).unwrap_err());
        assert_eq!((error.0, error.1), (line, column), "{to}: {}", error.2);
        assert!(error.2.contains(words), "{to}: {}", error.2);
    }
}

#[test]
fn correlations_that_no_parameters_can_have_at_once_are_refused() {
    let text = "base = \"a.toml\"\ndesign = \"random\"\nrows = 2\n[parameters]\na = { range = [0, 1], correlate = { b = 0.9, c = 0.9 } }\n\
        b = { range = [0, 1], correlate = { c = -0.9 } }\nc = { range = [0, 1] }\n";
    let error = message(&read_plan("plan.toml", text.as_bytes()).unwrap_err());
    assert!(error.0 == 6 && error.2.contains("not positive definite"), "{error:?}");
    assert!(read_plan("plan.toml", text.replace("-0.9", "0.9").as_bytes()).is_ok());
    let twice = text.replace("{ c = -0.9 }", "{ a = 0.1 }");
    assert!(message(&read_plan("plan.toml", twice.as_bytes()).unwrap_err()).2.contains("correlated already"));
}

#[test]
fn each_design_is_read_by_its_word() {
    let designs = [Design::Sobol, Design::ShiftedSobol, Design::LatinHypercube, Design::Random];
    for (design, word) in designs.into_iter().zip(["sobol", "shifted_sobol", "latin_hypercube", "random"]) {
        let plan = read_plan("plan.toml", PLAN.replace("\"sobol\"", &format!("\"{word}\"")).as_bytes()).unwrap();
        assert_eq!((plan.design, plan.design.word()), (design, word));
    }
}

#[test]
fn a_grid_has_as_many_rows_as_combinations() {
    let text = "base = \"a.toml\"\ndesign = \"grid\"\n[parameters]\na = { range = [0, 1], levels = 4 }\nb = { list = [1, 2, 3] }\n";
    assert_eq!(read_plan("plan.toml", text.as_bytes()).unwrap().rows, 12);
    let error = message(&read_plan("plan.toml", format!("rows = 5\n{text}").as_bytes()).unwrap_err());
    assert!(error.0 == 1 && error.2.contains("the grid has 12 combinations"), "{error:?}");
    let refused =
        |from: &str, to: &str| message(&read_plan("plan.toml", text.replace(from, to).as_bytes()).unwrap_err()).2;
    assert!(refused("levels = 4", "levels = 0").contains("`levels` is 0; it must lie in 1..10000000"));
    assert!(
        refused("[1, 2, 3]", "[1, 2, 3], levels = 3")
            .contains("leave `levels` out: a list has its own number of values")
    );
    assert!(refused("levels = 4", "levels = 4, correlate = { b = 0.5 }").contains("a grid has no correlation"));
    let none = "base = \"a.toml\"\ndesign = \"random\"\nrows = 2\n[parameters]\n";
    assert!(
        message(&read_plan("plan.toml", none.as_bytes()).unwrap_err()).2.contains("0 parameters; there must be 1 to")
    );
    let huge = text.replace("levels = 4", "levels = 4000000");
    assert!(message(&read_plan("plan.toml", huge.as_bytes()).unwrap_err()).2.contains("more than 10000000"));
}

const BASE: &str = "format = 1\ntitle = \"A\"\n[model]\nadult = { sex = \"male\", stature_m = 1.75, mass_kg = 73, part = \"right_arm\" } # a man\n\
    [coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n[[load]]\nsegment = \"hand_r\"\nmass_kg = 3\n\
    at_m = [0, -0.07, 0]\n[run]\nduration_s = 10";

fn number(value: f64) -> Value {
    Value::Number(value)
}

#[test]
fn values_take_the_place_of_those_in_the_file_and_new_keys_are_added() {
    let keys = [
        "model.adult.stature_m",
        "load.0.at_m.1",
        "strength.spread",
        "passive.spread",
        "run.step_s",
        "load.0.mass_kg",
        "strength.deviations",
        "model.adult.lengths_m.humerus",
        "upright",
    ];
    let values: Vec<Value> = [1.625, -0.1, 0.9, 1.1, 0.1, 1e-7, -1.0, 0.3].into_iter().map(number).collect();
    let template = Template::new("a.toml", BASE.as_bytes(), keys).unwrap();
    let text = template.text(&[&values[..], &[Value::Bool(false)]].concat());
    assert_eq!(
        text,
        "upright = false\nformat = 1\ntitle = \"A\"\n[model]\nadult = { lengths_m.humerus = 0.3, sex = \"male\", stature_m = 1.625, mass_kg = 73, \
         part = \"right_arm\" } # a man\n[coordinates]\nfree = [\"elbow_flex_r\"]\n[strategy]\nkind = \"active\"\n[[load]]\nsegment = \"hand_r\"\n\
         mass_kg = 0.0000001\nat_m = [0, -0.1, 0]\n[run]\nstep_s = 0.1\nduration_s = 10\n[strength]\nspread = 0.9\ndeviations = -1\n\n\
         [passive]\nspread = 1.1\n"
    );
    let run = read_run("a.toml", text.as_bytes(), None).unwrap();
    assert_eq!(run.scenario.run.step, 0.1);
}

#[test]
fn paths_that_lead_nowhere_are_refused_and_misspelled_keys_are_refused_by_the_reader_of_scenarios() {
    for (key, line, words) in [
        ("load.1.mass_kg", 9, "`1` of `load.1.mass_kg`: there are 1 entries, counted from 0"),
        ("title.a", 2, "`title.a` leads through a value that is no table"),
        ("model.adult", 4, "`model.adult` is a table, not a value"),
        ("load.0.at_m", 12, "`load.0.at_m.0` is its first entry"),
        ("load.0.at_m.3", 12, "there are 3 entries"),
    ] {
        let error = message(&Template::new("a.toml", BASE.as_bytes(), [key]).unwrap_err());
        assert!(error.0 == line && error.2.contains(words), "{error:?}");
    }
    for (key, words) in [
        ("model.adult.statur_m", "did you mean `stature_m`?"),
        ("strenght.spread", "did you mean `strength`?"),
        ("strength.spred", "did you mean `spread`?"),
    ] {
        let text = Template::new("a.toml", BASE.as_bytes(), [key]).unwrap().text(&[number(1.5)]);
        let error = message(&read_run("a.toml", text.as_bytes(), None).unwrap_err());
        assert!(error.2.contains(words), "{error:?}");
    }
}

/// Strength of the flexors at 80 deg, and passive torque at 10 deg, of the elbow.
fn elbow(strength: &str, passive: &str) -> [f64; 2] {
    let text = format!("{BASE}\n[strength]\n{strength}\n[passive]\n{passive}\n");
    let model = read_run("a.toml", text.as_bytes(), None).unwrap().scenario.model;
    let elbow = &model.coordinates()[model.coordinate("elbow_flex_r").unwrap()];
    let flexors = &elbow.groups.as_ref().unwrap()[0].strength;
    [flexors.torque(80f64.to_radians()), elbow.curve().unwrap().torque(10f64.to_radians())]
}

#[test]
fn spreads_multiply_strength_and_passive_torque_and_deviations_use_the_coefficient_of_the_group() {
    let mean = elbow("", "");
    let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * b.abs());
    assert!(close(elbow("spread = 1.2", "spread = 0.8"), [1.2 * mean[0], 0.8 * mean[1]]));
    // data/strength.toml: 0.277 for the groups of the arm.
    assert!(close(elbow("deviations = -1", ""), [(1.0 - 0.277) * mean[0], mean[1]]));
    assert!(close(elbow("deviations = 2\nspread = 0.5", ""), [0.5 * (1.0 + 2.0 * 0.277) * mean[0], mean[1]]));
    let curve = "elbow_flex_r = { curve = \"elbow_neutral\", reshape = true }";
    let reshaped = elbow("", curve);
    assert!(close(elbow("", &format!("spread = 3\n{curve}")), [mean[0], 3.0 * reshaped[1]]));
}

#[test]
fn spreads_beyond_people_are_refused_with_their_limits() {
    for (table, key, value, limits) in [
        ("strength", "spread", "0", "0.05..5"),
        ("strength", "deviations", "3.6", "-3.5..3.5"),
        ("passive", "spread", "5.1", "0.05..5"),
        ("passive", "spread", "-1", "0.05..5"),
    ] {
        let text = format!("{BASE}\n[{table}]\n{key} = {value}\n");
        let error = message(&read_run("a.toml", text.as_bytes(), None).unwrap_err());
        assert_eq!((error.0, error.1), (16, key.len() + 4), "{error:?}");
        assert!(error.2.contains(&format!("`{table}.{key}` is {value}; it must lie in {limits}")), "{error:?}");
    }
    let text = format!("{BASE}\n[passive]\nelbow_flx_r = {{ curve = \"elbow_neutral\" }}\n");
    let error = message(&read_run("a.toml", text.as_bytes(), None).unwrap_err());
    assert!(error.0 == 16 && error.2.contains("did you mean `elbow_flex_r`?"), "{error:?}");
}

#[test]
fn a_spread_of_strength_beside_the_strength_of_muscles_is_refused() {
    let text = "format = 1\n[model]\nfile = \"a.osim\"\nmuscles = \"strength\"\n[strength]\nspread = 2\n";
    let error = message(&scenario_model("a.toml", text.as_bytes()).unwrap_err());
    assert!(error.0 == 5 && error.2.contains("not that of muscles; leave [strength] out"), "{error:?}");
    assert!(scenario_model("a.toml", text.replace("\"strength\"", "\"off\"").as_bytes()).is_ok());
    assert!(scenario_model("a.toml", text.replace("\"strength\"", "\"passive\"").as_bytes()).is_ok());
    let text = "format = 1\n[model]\nfile = \"a.osim\"\nmuscles = \"both\"\n[passive]\nspread = 2\n";
    let error = message(&scenario_model("a.toml", text.as_bytes()).unwrap_err());
    assert!(error.2.contains("not that of muscles; leave [passive] spread out"), "{error:?}");
    // Without the key the data are multiplied, and muscles give nothing.
    let file = scenario_model("a.toml", text.replace("muscles = \"both\"\n", "").as_bytes()).unwrap().unwrap();
    assert!(file.muscles.is_none() && file.multiplies_data);
}
