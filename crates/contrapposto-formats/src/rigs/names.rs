//! Finds the joints of a rig that stand for the adult's segments, by the names that known programs give.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Rig;

/// A segment of the adult, and the names of joints that stand for it, the surest first. Compared are small letters and digits only.
struct Known {
    /// Segment, without side.
    segment: &'static str,
    sided: bool,
    needed: bool,
    /// Names without side.
    names: &'static [&'static str],
}

/// Names of the skeletons of Mixamo and MotionBuilder (`LeftUpLeg`), of the CMU captures (`LHipJoint`, `LowerBack`), Rokoko (`LeftThigh`), Poser and Daz
/// (`lShldr`), Biovision (`LeftKnee`), Unreal (`calf_l`), MakeHuman (`upperleg01.L`), SMPL (`L_Ankle`) and of the adult itself (recalled from
/// published files of each).
const KNOWN: [Known; 13] = [
    Known { segment: "pelvis", sided: false, needed: true, names: &["hips", "pelvis", "hip"] },
    Known { segment: "abdomen", sided: false, needed: false, names: &[] },
    Known { segment: "torso", sided: false, needed: true, names: &[] },
    Known { segment: "head", sided: false, needed: false, names: &["head"] },
    Known {
        segment: "humerus",
        sided: true,
        needed: true,
        names: &["humerus", "upperarm", "upperarm01", "arm", "shldr", "shoulder"],
    },
    Known {
        segment: "ulna",
        sided: true,
        needed: true,
        names: &["ulna", "forearm", "lowerarm", "lowerarm01", "elbow"],
    },
    Known { segment: "radius", sided: true, needed: false, names: &["radius"] },
    Known { segment: "hand", sided: true, needed: true, names: &["wrist", "hand"] },
    Known {
        segment: "femur",
        sided: true,
        needed: true,
        names: &["femur", "upleg", "upperleg", "upperleg01", "thigh", "hip"],
    },
    Known {
        segment: "tibia",
        sided: true,
        needed: true,
        names: &["tibia", "lowerleg", "lowerleg01", "shin", "calf", "leg", "knee"],
    },
    Known { segment: "talus", sided: true, needed: false, names: &["talus"] },
    Known { segment: "calcn", sided: true, needed: true, names: &["calcn", "ankle", "foot"] },
    Known { segment: "toes", sided: true, needed: false, names: &["toes"] },
];

/// Words before the names of some programs' joints.
const PREFIXES: [&str; 3] = ["mixamorig", "bip001", "bip01"];
/// Share of the motion between pelvis and chest that is lumbar: the ranges of lumbar and thoracic flexion of the built-in adult, 60 and 35 deg.
const LUMBAR: f64 = 60.0 / (60.0 + 35.0);

/// Most names of joints in a template.
const MOST_LISTED: usize = 200;

/// Names of the adult's segments that a rig can move, and whether a rig must have them.
pub(super) fn segments() -> Vec<(String, bool)> {
    let sides = |known: &Known| if known.sided { vec!["_r", "_l"] } else { vec![""] };
    KNOWN.iter().flat_map(|k| sides(k).into_iter().map(|side| (format!("{}{side}", k.segment), k.needed))).collect()
}

/// The joints of a rig by the adult's segments that they move.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    joints: BTreeMap<String, usize>,
}

/// Joints that a rig must have, and that were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MissingJoints {
    /// No joint is known to be these segments.
    #[error(
        "no joint of the rig is known to be {}; name them in a file, --rig FILE.toml:\n\n{template}",
        list(segments)
    )]
    Unknown {
        /// Segments of the adult.
        segments: Vec<String>,
        /// A file of names with all that was found.
        template: String,
    },
    /// A joint hangs on another one than the body needs.
    #[error(
        "the joint `{joint}` ({segment}) does not hang on `{above}` ({on}), directly or by others; name other joints in a file, --rig FILE.toml:\n\n{template}"
    )]
    Elsewhere {
        /// The joint.
        joint: String,
        /// Segment of that joint.
        segment: String,
        /// The joint on which it should hang.
        above: String,
        /// The segment of that joint.
        on: String,
        /// A file of names with all that was found.
        template: String,
    },
}

fn list(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

impl Assignment {
    /// The joints of known names; those of `given` (segment and name of its joint) are as given.
    ///
    /// # Errors
    /// [`MissingJoints`] names segments without a joint, or joints that hang on wrong ones.
    pub fn find(rig: &Rig, given: &BTreeMap<String, String>) -> Result<Self, MissingJoints> {
        let plain: Vec<String> = rig.joints.iter().map(|joint| plain(&joint.name)).collect();
        let mut joints: BTreeMap<String, usize> =
            given.iter().filter_map(|(segment, name)| Some((segment.clone(), rig.joint(name)?))).collect();
        for known in &KNOWN {
            for (side, words) in [("", ["", ""]), ("_r", ["right", "r"]), ("_l", ["left", "l"])] {
                let segment = format!("{}{side}", known.segment);
                if side.is_empty() == known.sided || joints.contains_key(&segment) {
                    continue;
                }
                let is = |name: &str, stem: &str| {
                    words.iter().any(|w| name == format!("{w}{stem}") || name == format!("{stem}{w}"))
                };
                let found = known.names.iter().find_map(|stem| plain.iter().position(|name| is(name, stem)));
                let found = found.filter(|joint| !joints.values().any(|taken| taken == joint));
                joints.extend(found.map(|joint| (segment, joint)));
            }
        }
        // The ground bends toes, and an animation has none: only a rig with the joints of the adult, or a file, moves them.
        for side in ["_r", "_l"] {
            let toes = format!("toes{side}");
            if !given.contains_key(&toes) && !joints.contains_key(&format!("talus{side}")) {
                joints.remove(&toes);
            }
        }
        let mut assignment = Self { joints };
        assignment.find_trunk(rig);
        assignment.check(rig)?;
        Ok(assignment)
    }

    /// The joint that moves a segment.
    pub fn joint(&self, segment: &str) -> Option<usize> {
        self.joints.get(segment).copied()
    }

    /// Segments and joints, by the segments' names.
    pub fn pairs(&self) -> impl Iterator<Item = (&str, usize)> {
        self.joints.iter().map(|(segment, joint)| (segment.as_str(), *joint))
    }

    /// The joint of a segment that every rig has.
    pub(super) fn needed(&self, segment: &str) -> usize {
        self.joints.get(segment).copied().unwrap_or(0)
    }

    /// The chest is the last joint that carries both arms; the abdomen is the joint below it with the lumbar share of the spine's joints.
    fn find_trunk(&mut self, rig: &Rig) {
        let (Some(right), Some(left)) = (self.joint("humerus_r"), self.joint("humerus_l")) else { return };
        let chest = self.joint("torso").or_else(|| rig.chain(right).skip(1).find(|&joint| rig.carries(joint, left)));
        let Some((chest, pelvis)) = chest.zip(self.joint("pelvis")) else { return };
        if chest == pelvis {
            return;
        }
        self.joints.insert("torso".to_owned(), chest);
        let mut spine: Vec<usize> = rig.chain(chest).take_while(|&joint| joint != pelvis).collect();
        spine.reverse();
        // A joint at the place of the one before turns with it.
        let lumbar = ((LUMBAR * spine.len() as f64).round() as usize).min(spine.len() - 1);
        if let Some(&joint) = lumbar.checked_sub(1).and_then(|index| spine.get(index)) {
            self.joints.entry("abdomen".to_owned()).or_insert(joint);
        }
    }

    fn check(&self, rig: &Rig) -> Result<(), MissingJoints> {
        let template = || names_template(rig, self);
        let missing: Vec<String> = segments()
            .into_iter()
            .filter(|(segment, needed)| *needed && self.joint(segment).is_none())
            .map(|s| s.0)
            .collect();
        if !missing.is_empty() {
            return Err(MissingJoints::Unknown { segments: missing, template: template() });
        }
        let chains = ["_r", "_l"].into_iter().flat_map(|side| {
            let on = |below: &str, above: &str| (format!("{below}{side}"), above.to_owned());
            let both = |below: &str, above: &str| (format!("{below}{side}"), format!("{above}{side}"));
            [
                on("femur", "pelvis"),
                both("tibia", "femur"),
                both("calcn", "tibia"),
                on("humerus", "torso"),
                both("ulna", "humerus"),
                both("hand", "ulna"),
            ]
        });
        let trunk = [("torso".to_owned(), "pelvis".to_owned())];
        for (segment, on) in trunk.into_iter().chain(chains) {
            let (joint, above) = (self.needed(&segment), self.needed(&on));
            if joint == above || !rig.carries(above, joint) {
                let name = |joint: usize| rig.joints[joint].name.clone();
                return Err(MissingJoints::Elsewhere {
                    joint: name(joint),
                    segment,
                    above: name(above),
                    on,
                    template: template(),
                });
            }
        }
        Ok(())
    }
}

/// Small letters and digits of a name, without the words before it.
fn plain(name: &str) -> String {
    let name = name.rsplit([':', '|']).next().unwrap_or(name);
    let plain: String = name.chars().filter(|c| c.is_ascii_alphanumeric()).map(|c| c.to_ascii_lowercase()).collect();
    let stripped = PREFIXES.iter().find_map(|prefix| plain.strip_prefix(prefix));
    stripped.filter(|rest| !rest.is_empty()).map_or(plain.clone(), str::to_owned)
}

/// A file of names with the joints that were found, and all joints of the rig in comments.
pub fn names_template(rig: &Rig, found: &Assignment) -> String {
    let mut text = String::from("# the adult's segment = the rig's joint at its upper end\n");
    for (segment, needed) in segments() {
        let joint = found.joint(&segment).map(|joint| toml::Value::String(rig.joints[joint].name.clone()).to_string());
        let _ = match (joint, needed) {
            (Some(joint), _) => writeln!(text, "{segment} = {joint}"),
            (None, true) => writeln!(text, "{segment} = \"\"   # needed"),
            (None, false) => writeln!(text, "# {segment} = \"\"   # may be left out"),
        };
    }
    let names: Vec<&str> = rig.joints.iter().take(MOST_LISTED).map(|joint| joint.name.as_str()).collect();
    let more = if rig.joints.len() > MOST_LISTED { ", ..." } else { "" };
    let _ = writeln!(text, "# joints of the rig: {}{more}", names.join(", "));
    text
}
