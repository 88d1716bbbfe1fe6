//! Tests that capsule and iliotibial tract stand beside the muscles of a hip, and nowhere else.

use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::passive::PassiveLaw;
use contrapposto::posture::Posture;
use contrapposto_formats::scenario_model;
use contrapposto_formats::tissue::{HipTissue, MuscleUse, Person, SourcedModel};

/// Mass of the leg, kg, and distance of its centre from the hip, m.
const LEG: (f64, f64) = (12.0, 0.4);

/// A leg on the hip of a pelvis that is fixed to ground, with an abductor.
fn leg(coordinate: &str) -> String {
    let (mass, center) = LEG;
    format!(
        "<OpenSimDocument Version=\"40500\"><Model name=\"m\">
         <BodySet><objects><Body name=\"pelvis\"><mass>10</mass></Body>
           <Body name=\"femur_r\"><mass>{mass}</mass><mass_center>0 -{center} 0</mass_center></Body></objects></BodySet>
         <JointSet><objects><WeldJoint name=\"w\"><socket_parent_frame>/ground</socket_parent_frame>
           <socket_child_frame>/bodyset/pelvis</socket_child_frame></WeldJoint>
           <PinJoint name=\"hip_r\"><socket_parent_frame>pelvis_offset</socket_parent_frame><socket_child_frame>femur_offset</socket_child_frame>
           <frames>
             <PhysicalOffsetFrame name=\"pelvis_offset\"><socket_parent>/bodyset/pelvis</socket_parent><translation>0 -0.1 0.08</translation>
               <orientation>0 1.5707963267948966 0</orientation></PhysicalOffsetFrame>
             <PhysicalOffsetFrame name=\"femur_offset\"><socket_parent>/bodyset/femur_r</socket_parent><translation>0 0 0</translation>
               <orientation>0 1.5707963267948966 0</orientation></PhysicalOffsetFrame>
           </frames>
           <coordinates><Coordinate name=\"{coordinate}\"><range>-0.7 0.6</range></Coordinate></coordinates></PinJoint></objects></JointSet>
         <ForceSet><objects><Thelen2003Muscle name=\"abductor\"><GeometryPath><PathPointSet><objects>
         <PathPoint name=\"p\"><socket_parent_frame>/bodyset/pelvis</socket_parent_frame><location>0 0.05 0.12</location></PathPoint>
         <PathPoint name=\"o\"><socket_parent_frame>/bodyset/femur_r</socket_parent_frame><location>0 -0.1 0.05</location></PathPoint>
         </objects></PathPointSet></GeometryPath><max_isometric_force>2000</max_isometric_force>
         <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.15</tendon_slack_length></Thelen2003Muscle></objects></ForceSet>
         </Model></OpenSimDocument>"
    )
}

fn opened(text: &str, uses: MuscleUse) -> [SourcedModel; 2] {
    let mut opened =
        SourcedModel::read("leg.osim", text.as_bytes(), None, &mut |_: &str| Err("none".to_owned())).unwrap();
    let library = opened.clone().fill(&Person::default()).unwrap();
    opened.use_muscles(uses);
    [opened.fill(&Person::default()).unwrap(), library]
}

/// Passive torque at an angle (degrees), by the muscles and by the law near that posture.
fn passive(tissue: HipTissue, degrees: f64) -> [f64; 2] {
    let [mut model, library] = opened(&leg("hip_adduction_r"), MuscleUse::Both);
    model.add_hip_tracts(&library, tissue).unwrap();
    let (muscles, _) = model.scenario_muscles(&library).unwrap();
    let posture = Posture::new(vec![degrees.to_radians()]);
    let mut model = model.model;
    // A posture, not a run: the curve of this one muscle rises here and there.
    let (mut muscles, notes) = muscles.unwrap().settle(&mut model, &posture, false);
    assert!(matches!(model.coordinates()[0].passive, Some(PassiveLaw::Slice(_))), "{notes:?}");
    let mut body = JointTorques::new(&model);
    body.update(&model, &posture, &[], Quantities::TORQUES).unwrap();
    muscles.update(&model, &posture, body.kinematics()).unwrap();
    [muscles.passive_torques()[0][0], body.passive_torque().about_axes()[0]]
}

#[test]
fn muscles_and_band_carry_the_relaxed_leg_at_the_angle_of_the_test() {
    for (tissue, degrees) in [(HipTissue::Mean, 24.6), (HipTissue::Stiff, 17.3), (HipTissue::Flexible, 31.9)] {
        let weight = LEG.0 * 9.806_65 * LEG.1 * libm::cos(f64::to_radians(degrees));
        let [muscles, law] = passive(tissue, degrees);
        let [alone, _] = passive(HipTissue::Off, degrees);
        println!("{degrees}: weight {weight:.3}, muscles alone {alone:.3}, with the band {muscles:.3} N m");
        assert!((muscles + weight).abs() < 1e-3 * weight, "{muscles} {weight}");
        assert!((law - muscles).abs() < 1e-9, "{law} {muscles}");
        assert!(alone < -1e-3 && alone > -0.9 * weight, "the muscle is stretched, and does not suffice: {alone}");
    }
}

#[test]
fn the_band_is_refused_where_no_muscles_give_a_hip_its_passive_torque() {
    for (text, uses) in [(leg("hip_adduction_r"), MuscleUse::Strength), (leg("knee_angle_r"), MuscleUse::Both)] {
        let [mut model, library] = opened(&text, uses);
        let why = model.add_hip_tracts(&library, HipTissue::Mean).unwrap_err();
        assert!(why.contains("no hip has its passive torque from muscles"), "{why}");
        model.add_hip_tracts(&library, HipTissue::Off).unwrap();
    }
    let text = "format = 1\n[model]\nfile = \"leg.osim\"\nmuscles = \"strength\"\nhip_tract = \"mean\"\n";
    let report = format!("{:?}", miette::Report::new(scenario_model("leg.toml", text.as_bytes()).unwrap_err()));
    assert!(report.contains("`hip_tract` stands beside the passive torque of muscles"), "{report}");
    let text = "format = 1\n[model]\nhip_tract = \"mean\"\n";
    let report = format!("{:?}", miette::Report::new(scenario_model("leg.toml", text.as_bytes()).unwrap_err()));
    assert!(report.contains("`hip_tract` goes with a model file"), "{report}");
}
