//! A forearm on muscles, and scenarios of bodies with muscles in use.

use contrapposto::simulation::Scenario;
use contrapposto_formats::read_run;
use contrapposto_formats::tissue::{MuscleUse, Person, SourcedModel};

/// A muscle `arm` metres in front of the elbow.
fn muscle(name: &str, arm: f64) -> String {
    format!(
        "<Thelen2003Muscle name=\"{name}\"><GeometryPath><PathPointSet><objects>
         <PathPoint name=\"p\"><socket_parent_frame>/ground</socket_parent_frame><location>{arm} 0.2 0</location></PathPoint>
         <PathPoint name=\"o\"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>{arm} -0.3 0</location></PathPoint>
         </objects></PathPointSet></GeometryPath><max_isometric_force>900</max_isometric_force>
         <optimal_fiber_length>0.2</optimal_fiber_length><tendon_slack_length>0.28</tendon_slack_length></Thelen2003Muscle>"
    )
}

/// A forearm on the adult's elbow, with a muscle on each side of it.
pub fn arm() -> String {
    arm_on(&[("front", 0.05), ("back", -0.05)])
}

/// A forearm on the adult's elbow, with muscles so many metres in front of it.
pub fn arm_on(muscles: &[(&str, f64)]) -> String {
    let muscles: String = muscles.iter().map(|(name, arm)| muscle(name, *arm)).collect();
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"b\"><mass>1.5</mass><mass_center>0 -0.2 0</mass_center></Body></objects></BodySet>
         <JointSet><objects><PinJoint name=\"j\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/b</socket_child_frame>
           <coordinates><Coordinate name=\"elbow_flex_r\"><range>0 2.4</range></Coordinate></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects>{muscles}</objects></ForceSet></Model></OpenSimDocument>"
    )
}

/// The body of a file whose muscles are used, and the same with the built-in data alone.
pub fn opened(bytes: &[u8], uses: MuscleUse) -> [SourcedModel; 2] {
    let no_includes = &mut |_: &str| Err("none".to_owned());
    let mut opened = SourcedModel::read("arm.osim", bytes, None, no_includes).unwrap();
    let library = opened.clone().fill(&Person::default()).unwrap();
    assert!(opened.use_muscles(uses));
    [opened.fill(&Person::default()).unwrap(), library]
}

/// The scenario, and the notes about it.
pub fn scenario(bytes: &[u8], text: &str, uses: MuscleUse) -> (Scenario, Vec<String>) {
    let [mut model, library] = opened(bytes, uses);
    let (muscles, _) = model.scenario_muscles(&library).unwrap();
    let mut run = read_run("tired.toml", text.as_bytes(), Some(model.model)).unwrap();
    run.notes.clear();
    run.take_muscles(muscles).unwrap();
    (run.scenario, run.notes)
}
