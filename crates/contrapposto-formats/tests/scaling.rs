//! Scaling of OpenSim models: a model of k times the size is the model seen from k times as near, whatever it holds.

use std::collections::BTreeMap;

use contrapposto::kinematics::Kinematics;
use contrapposto::muscle::{PathGeometry, PathRule};
use contrapposto_formats::markers::{marker_set, scale_setup};
use contrapposto_formats::osim::scaling::{Scaling, scaled, with_markers, with_path_lengths, with_placed_markers};
use contrapposto_formats::tissue::SourcedModel;
use nalgebra::Vector3;

/// A thigh and a shank whose joint slides along a spline, with every kind of thing that scales.
const LEG: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<OpenSimDocument Version="40000">
<Model name="leg">
  <!-- a comment that stays -->
  <gravity>0 -9.80665 0</gravity>
  <BodySet><objects>
    <Body name="thigh"><mass>8</mass><mass_center>0.01 -0.17 0.02</mass_center><inertia>0.13 0.035 0.14 0.001 0 0</inertia>
      <attached_geometry><Mesh name="m"><socket_frame>..</socket_frame><mesh_file>f.vtp</mesh_file></Mesh></attached_geometry>
      <WrapObjectSet><objects><WrapCylinder name="knee"><xyz_body_rotation>0.1 0.2 0</xyz_body_rotation>
        <translation>0 -0.4 0</translation><radius>0.03</radius><length>0.2</length></WrapCylinder></objects></WrapObjectSet></Body>
    <Body name="shank"><mass>3</mass><mass_center>0 -0.18 0</mass_center><inertia>0.05 0.005 0.05 0 0 0</inertia></Body>
  </objects></BodySet>
  <JointSet><objects>
    <PinJoint name="hip"><socket_parent_frame>ground_offset</socket_parent_frame><socket_child_frame>thigh_offset</socket_child_frame>
      <coordinates><Coordinate name="hip"><default_value>0.2</default_value></Coordinate></coordinates>
      <frames><PhysicalOffsetFrame name="ground_offset"><socket_parent>/ground</socket_parent></PhysicalOffsetFrame>
        <PhysicalOffsetFrame name="thigh_offset"><socket_parent>/bodyset/thigh</socket_parent><translation>0 0.02 0.01</translation></PhysicalOffsetFrame></frames></PinJoint>
    <CustomJoint name="knee"><socket_parent_frame>thigh_knee</socket_parent_frame><socket_child_frame>shank_offset</socket_child_frame>
      <coordinates><Coordinate name="knee"><default_value>-0.5</default_value></Coordinate></coordinates>
      <frames><PhysicalOffsetFrame name="thigh_knee"><socket_parent>/bodyset/thigh</socket_parent><translation>0.005 -0.4 0</translation>
          <orientation>0.05 0 0.02</orientation></PhysicalOffsetFrame>
        <PhysicalOffsetFrame name="shank_offset"><socket_parent>/bodyset/shank</socket_parent></PhysicalOffsetFrame></frames>
      <SpatialTransform>
        <TransformAxis name="rotation1"><coordinates>knee</coordinates><axis>0 0 1</axis><LinearFunction name="function"><coefficients>1 0</coefficients></LinearFunction></TransformAxis>
        <TransformAxis name="translation1"><coordinates>knee</coordinates><axis>1 0 0</axis><SimmSpline name="function"><x>-2 -1 0 1</x><y>0.01 0.02 0.01 0</y></SimmSpline></TransformAxis>
        <TransformAxis name="translation2"><axis>0 1 0</axis><MultiplierFunction name="function"><function><Constant><value>0.01</value></Constant></function><scale>0.5</scale></MultiplierFunction></TransformAxis>
      </SpatialTransform></CustomJoint>
  </objects></JointSet>
  <ForceSet><objects>
    <Millard2012EquilibriumMuscle name="quad"><optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.3</tendon_slack_length>
      <GeometryPath name="geometrypath"><PathPointSet><objects>
        <PathPoint name="a"><socket_parent_frame>/bodyset/thigh</socket_parent_frame><location>0.05 -0.05 0</location></PathPoint>
        <MovingPathPoint name="b"><socket_parent_frame>/bodyset/shank</socket_parent_frame><socket_x_coordinate>/jointset/knee/knee</socket_x_coordinate>
          <socket_y_coordinate>/jointset/knee/knee</socket_y_coordinate><socket_z_coordinate>/jointset/knee/knee</socket_z_coordinate>
          <x_location><LinearFunction><coefficients>0.01 0.04</coefficients></LinearFunction></x_location>
          <y_location><Constant><value>-0.05</value></Constant></y_location><z_location><Constant><value>0</value></Constant></z_location></MovingPathPoint>
      </objects></PathPointSet><PathWrapSet><objects><PathWrap name="w"><wrap_object>knee</wrap_object></PathWrap></objects></PathWrapSet></GeometryPath></Millard2012EquilibriumMuscle>
    <Ligament name="band"><resting_length>0.05</resting_length><GeometryPath name="geometrypath"><PathPointSet><objects>
        <PathPoint name="a"><socket_parent_frame>/bodyset/thigh</socket_parent_frame><location>-0.02 -0.38 0</location></PathPoint>
        <ConditionalPathPoint name="b"><socket_parent_frame>/bodyset/shank</socket_parent_frame><location>-0.02 -0.05 0</location>
          <socket_coordinate>/jointset/knee/knee</socket_coordinate><range>-3 3</range></ConditionalPathPoint>
      </objects></PathPointSet></GeometryPath></Ligament>
  </objects></ForceSet>
  <MarkerSet><objects>
    <Marker name="free"><socket_parent_frame>/jointset/knee/thigh_knee</socket_parent_frame><location>0.03 0.01 0.04</location></Marker>
    <Marker name="fixed"><socket_parent_frame>/bodyset/shank</socket_parent_frame><location>0 -0.3 0.04</location><fixed>true</fixed></Marker>
  </objects></MarkerSet>
</Model>
</OpenSimDocument>
"#;

fn opened(text: &str) -> SourcedModel {
    SourcedModel::read("leg.osim", text.as_bytes(), None, &mut |_| Err(String::new())).unwrap()
}

fn path_lengths(model: &SourcedModel, body: &Kinematics) -> Vec<f64> {
    let mut geometry = PathGeometry::new(&model.model, &model.muscles.paths);
    geometry.update(&model.model, body, &model.muscles.paths, PathRule::OpenSim);
    geometry.lengths().to_vec()
}

fn all(factors: Vector3<f64>) -> BTreeMap<String, Vector3<f64>> {
    ["thigh", "shank"].map(|body| (body.to_owned(), factors)).into()
}

/// [`LEG`] with a coordinate along which the shank slides as the knee bends.
fn sliding() -> String {
    let slide = "<TransformAxis name=\"translation3\"><coordinates>slide</coordinates><axis>0 0 1</axis>\
                 <LinearFunction name=\"function\"><coefficients>1 0</coefficients></LinearFunction></TransformAxis></SpatialTransform>";
    let coupling = "<ConstraintSet><objects><CoordinateCouplerConstraint name=\"c\"><coupled_coordinates_function>\
                    <LinearFunction><coefficients>0.02 0.01</coefficients></LinearFunction></coupled_coordinates_function>\
                    <independent_coordinate_names>knee</independent_coordinate_names><dependent_coordinate_name>slide</dependent_coordinate_name>\
                    </CoordinateCouplerConstraint></objects></ConstraintSet><ForceSet>";
    let knee = "<Coordinate name=\"knee\"><default_value>-0.5</default_value></Coordinate>";
    LEG.replace("</SpatialTransform>", slide)
        .replace("<ForceSet>", coupling)
        .replace(knee, &format!("{knee}<Coordinate name=\"slide\"><range>-1 1</range></Coordinate>"))
}

/// [`LEG`] with another surface in place of its cylinder.
fn over(surface: &str) -> String {
    let (from, to) =
        (LEG.find("<WrapCylinder").unwrap(), LEG.find("</WrapCylinder>").unwrap() + "</WrapCylinder>".len());
    format!("{}{surface}{}", &LEG[..from], &LEG[to..])
}

#[test]
fn equal_factors_make_a_similar_body() {
    is_similar(LEG);
    is_similar(&sliding());
    let place = "<xyz_body_rotation>0.1 0.2 0</xyz_body_rotation><translation>0 -0.4 0</translation>";
    for (kind, sizes) in [
        ("WrapSphere", "<radius>0.04</radius>"),
        ("WrapSphere", ""),
        ("WrapEllipsoid", "<dimensions>0.03 0.04 0.06</dimensions>"),
        ("WrapTorus", "<inner_radius>0.02</inner_radius><outer_radius>0.07</outer_radius>"),
    ] {
        is_similar(&over(&format!("<{kind} name=\"knee\">{place}{sizes}</{kind}>")));
    }
}

#[test]
fn a_sliding_coordinate_that_follows_another_needs_equal_factors() {
    let scaling = Scaling { factors: all(Vector3::new(1.1, 1.2, 0.9)), ..Scaling::default() };
    let error = scaled(&sliding(), "leg.osim", &scaling).unwrap_err().to_string();
    assert!(
        error.contains("a coupling of the distance `slide` on a body with three factors is not supported"),
        "{error}"
    );
}

/// Whether a body that is scaled by one factor has all lengths times that factor.
fn is_similar(text: &str) {
    const FACTOR: f64 = 1.37;
    let scaling = Scaling { factors: all(Vector3::repeat(FACTOR)), ..Scaling::default() };
    let found = scaled(text, "leg.osim", &scaling).unwrap();
    assert!(found.left.is_empty(), "{:?}", found.left);
    assert!(found.text.contains("<!-- a comment that stays -->") && found.text.contains("f.vtp"));
    let (before, after) = (opened(text), opened(&found.text));
    assert!((after.model.mass() - 11.0 * FACTOR.powi(3)).abs() < 1e-12);
    let mut posture = before.model.default_posture();
    let (mut small, mut large) = (Kinematics::new(&before.model), Kinematics::new(&after.model));
    for knee in [-1.4, -0.5, 0.3] {
        posture.values_mut()[before.model.coordinate("knee").unwrap()] = knee;
        small.update(&before.model, &posture).unwrap();
        large.update(&after.model, &posture).unwrap();
        for (marker, other) in before.markers.iter().zip(&after.markers) {
            let at = small.station(&before.model, marker.segment, marker.point);
            let now = large.station(&after.model, other.segment, other.point);
            assert!((now - FACTOR * at).amax() < 1e-12, "{}: {now} is not {FACTOR} times {at}", marker.name);
        }
        let lengths = path_lengths(&before, &small).into_iter().zip(path_lengths(&after, &large));
        for (before, after) in lengths {
            assert!((after - FACTOR * before).abs() < 1e-12, "{after} is not {FACTOR} times {before}");
        }
    }
    for (a, b) in before.model.segments().iter().zip(after.model.segments()) {
        assert!((b.center_of_mass - FACTOR * a.center_of_mass).amax() < 1e-12);
        assert!((b.inertia - FACTOR.powi(5) * a.inertia).amax() < 1e-12);
    }
}

#[test]
fn masses_keep_their_proportions_or_grow_with_the_volumes() {
    let mut factors = all(Vector3::new(1.1, 1.2, 0.9));
    factors.insert("shank".to_owned(), Vector3::repeat(1.0));
    for (preserve, share) in [(true, 8.0 / 11.0), (false, 8.0 * 1.188 / (8.0 * 1.188 + 3.0))] {
        let preserve_mass_distribution = preserve;
        let (mass, name) = (Some(14.5), Some("Ann & Bo".to_owned()));
        let scaling = Scaling { factors: factors.clone(), preserve_mass_distribution, mass, name };
        let after = opened(&scaled(LEG, "leg.osim", &scaling).unwrap().text);
        let masses: Vec<f64> = after.model.segments().iter().map(|segment| segment.mass).collect();
        assert!((masses[0] - 14.5 * share).abs() < 1e-12 && (masses[1] - 14.5 * (1.0 - share)).abs() < 1e-12);
        assert_eq!(after.model.name(), "Ann & Bo");
    }
}

#[test]
fn lengths_of_muscles_follow_their_paths() {
    let growth = |name: &str| [("quad", 1.25), ("band", 0.5)].into_iter().find(|(n, _)| *n == name).map(|(_, g)| g);
    let found = with_path_lengths(LEG, "leg.osim", &growth).unwrap();
    let after = opened(&found.text);
    let spec = after.muscles.muscles[0].spec();
    assert!((spec.optimal_fiber_length - 0.125).abs() < 1e-15 && (spec.tendon_slack_length - 0.375).abs() < 1e-15);
    assert!(found.text.contains("<resting_length>0.025</resting_length>"));
    let none = with_path_lengths(LEG, "leg.osim", &|_| None).unwrap();
    assert_eq!(none.left.values().sum::<usize>(), 2);
    assert_eq!(none.text, LEG);
}

#[test]
fn markers_come_from_a_set_and_move_unless_they_are_fixed() {
    let set = r#"<OpenSimDocument Version="20302"><MarkerSet><objects>
        <Marker name="new &lt;1>"><body> thigh </body><location> 0.1 0.2 0.3 </location></Marker>
        <Marker name="free"><body>shank</body><location>1 2 3</location><fixed>false</fixed></Marker></objects></MarkerSet></OpenSimDocument>"#;
    let bodies = ["thigh".to_owned(), "shank".to_owned()];
    let markers = marker_set("set.xml", set.as_bytes(), &bodies).unwrap();
    let text = with_markers(LEG, "leg.osim", &markers).unwrap();
    let model = opened(&text);
    let place = |model: &SourcedModel, name: &str| {
        let marker = model.markers.iter().find(|marker| marker.name == name).unwrap();
        (model.model.segments()[marker.segment].name.clone(), marker.point)
    };
    assert_eq!(place(&model, "new <1>"), ("thigh".to_owned(), Vector3::new(0.1, 0.2, 0.3)));
    assert_eq!(place(&model, "free"), ("shank".to_owned(), Vector3::new(1.0, 2.0, 3.0)));
    assert_eq!(model.markers.len(), 3);
    let unknown = marker_set("set.xml", set.replace("thigh", "thigth").as_bytes(), &bodies).unwrap_err().to_string();
    assert!(unknown.starts_with("set.xml:2:9: `new <1>` lies on `thigth`"), "{unknown}");
    assert!(unknown.ends_with("did you mean `thigh`?"), "{unknown}");
    let goal = Vector3::new(-0.3, 0.2, 0.1);
    // `free` lies on a frame that is turned and moved from its body.
    let placed = with_placed_markers(LEG, "leg.osim", &|_| Some(goal), &|name| name != "gone").unwrap();
    let after = opened(&placed.text);
    assert!((place(&after, "free").1 - goal).amax() < 1e-15);
    assert_eq!(place(&after, "fixed").1, Vector3::new(0.0, -0.3, 0.04));
    assert_eq!(placed.moved.len(), 1);
    let fewer = with_placed_markers(LEG, "leg.osim", &|_| None, &|name| name != "free").unwrap();
    assert_eq!((fewer.removed, opened(&fewer.text).markers.len()), (vec!["free".to_owned()], 1));
}

#[test]
fn older_documents_and_setup_files_of_other_tools_are_refused_by_name() {
    let old = scaled(&LEG.replace("40000", "30000"), "leg.osim", &Scaling::default()).unwrap_err().to_string();
    assert!(old.contains("leg.osim") && old.contains("open an older file in OpenSim 4 and save it"), "{old}");
    let no_mass = LEG.replace("<mass>8<", "<mass>0<").replace("<mass>3<", "<mass>0<");
    let no_mass = scaled(&no_mass, "leg.osim", &Scaling { mass: Some(70.0), ..Scaling::default() }).unwrap_err();
    assert!(no_mass.to_string().contains("a body of 0 kg is not supported"), "{no_mass}");
    let other = scale_setup("ik.xml", b"<OpenSimDocument><InverseKinematicsTool/></OpenSimDocument>").unwrap_err();
    let other = other.to_string();
    assert!(other.contains("holds <InverseKinematicsTool>; the setup file of a ScaleTool is accepted"), "{other}");
    let zero = "<ScaleTool><ModelScaler><ScaleSet><objects><Scale><scales>1 0 1</scales><segment>thigh</segment></Scale></objects></ScaleSet></ModelScaler></ScaleTool>";
    let zero = scale_setup("s.xml", zero.as_bytes()).unwrap_err().to_string();
    assert!(zero.contains("the factor of `thigh` is 0; 0.01 to 100 is accepted"), "{zero}");
    let tool = |inside: &str| scale_setup("s.xml", format!("<ScaleTool>{inside}</ScaleTool>").as_bytes());
    let measured = |inside: &str| {
        let set = format!(
            "<MeasurementSet><objects><Measurement name=\"m\"><apply>true</apply>{inside}</Measurement></objects></MeasurementSet>"
        );
        tool(&format!("<ModelScaler>{set}</ModelScaler>"))
    };
    for (setup, words) in [
        (
            tool("<ModelScaler><scaling_order>measure</scaling_order></ModelScaler>"),
            "<scaling_order> has `measure`; `measurements` and",
        ),
        (
            measured(
                "<MarkerPairSet><objects><MarkerPair><markers>a b c</markers></MarkerPair></objects></MarkerPairSet>",
            ),
            "<markers> has 3 names; a pair has two",
        ),
        (
            measured(
                "<BodyScaleSet><objects><BodyScale name=\"thigh\"><axes>X W</axes></BodyScale></objects></BodyScaleSet>",
            ),
            "<axes> is `X W`; some of X, Y and Z are accepted",
        ),
        (tool("<MarkerPlacer><IKTaskSet file=\"tasks.xml\"/></MarkerPlacer>"), "put the IKTaskSet into the setup file"),
    ] {
        let error = setup.unwrap_err().to_string();
        assert!(error.starts_with("s.xml") && error.contains(words), "{error}");
    }
    let files = tool(
        "<GenericModelMaker><model_file>m.osim</model_file></GenericModelMaker><MarkerPlacer><marker_file>still.trc</marker_file></MarkerPlacer>",
    );
    let named: Vec<String> =
        files.unwrap().named.into_iter().map(|file| format!("{} {}", file.element, file.name)).collect();
    assert_eq!(named, ["model_file m.osim", "marker_file still.trc"]);
}

#[test]
fn a_wrong_set_of_markers_is_refused_where_it_stands() {
    let bodies = ["thigh".to_owned()];
    let marker = |name: &str, place: &str| {
        format!("<Marker name=\"{name}\"><body>thigh</body><location>{place}</location></Marker>")
    };
    let set =
        |inside: &str| format!("<OpenSimDocument><MarkerSet><objects>{inside}</objects></MarkerSet></OpenSimDocument>");
    for (text, words) in [
        ("<OpenSimDocument/>".to_owned(), "holds no <MarkerSet>; a file of markers has one"),
        (set(&marker("a", "0 0 0").repeat(2)), "two markers are named `a`"),
        (set(&marker("a/b", "0 0 0")), "the <Marker> has no name, or one with `/`"),
        (set(&marker("a", "0 0")), "<location> is `0 0`; three finite numbers are accepted"),
        (set(&marker("a", "0 0 1e10")), "three finite numbers are accepted"),
        (set(&marker("a", "0 0 0").replace("thigh", "tigh")), "did you mean `thigh`?"),
    ] {
        let error = marker_set("set.xml", text.as_bytes(), &bodies).unwrap_err().to_string();
        assert!(error.starts_with("set.xml") && error.contains(words), "{error}");
    }
}

#[test]
fn what_is_not_scaled_is_counted_by_its_kind() {
    let geometry = "<ContactGeometrySet><objects><ContactHalfSpace name=\"floor\"/><ContactSphere name=\"heel\"/></objects></ContactGeometrySet>";
    let text = LEG.replace("<MarkerSet>", &format!("{geometry}<MarkerSet>"));
    let scaling = Scaling { factors: all(Vector3::repeat(1.1)), ..Scaling::default() };
    assert_eq!(scaled(&text, "leg.osim", &scaling).unwrap().left, BTreeMap::from([("contact geometries", 2)]));
}
