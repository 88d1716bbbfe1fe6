//! Holds the things of the world as a scenario file writes them: held things, and things that carry the body.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::toml_file::{exactly, numbers};

/// A box held in both hands, on its two sides: half of its weight in each, the two palms at the middle of its sides.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BoxText {
    /// Mass, kg.
    pub(crate) mass_kg: f64,
    /// Lengths forward, up and sideways, m; the last is the distance of the palms.
    #[serde(deserialize_with = "exactly")]
    pub(crate) size_m: [f64; 3],
    /// Middle of the box, ground, m; where the hands have it at the start when left out.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) at_m: Option<[f64; 3]>,
}

/// A tool in one hand.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToolText {
    /// The hand that holds the tool.
    pub(crate) hand: SideText,
    /// Mass, kg; 0 when left out.
    #[serde(default)]
    pub(crate) mass_kg: f64,
    /// The force of the tool on the hand besides its weight, ground axes, N: `[0, -20, 0]` for a screw driven upward with 20 N.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) force_n: Option<[f64; 3]>,
    /// Place of the hand, ground, m; anywhere when left out: the tool is only carried.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) at_m: Option<[f64; 3]>,
}

/// A bag that is carried.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BagText {
    /// Mass, kg.
    pub(crate) mass_kg: f64,
    /// Part of the body that carries the bag.
    pub(crate) on: BagOnText,
}

/// A handle that is pushed or pulled: `push_n`, `pull_n`, or neither.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct HandleText {
    /// Middle of the handle, ground, m.
    #[serde(deserialize_with = "exactly")]
    pub(crate) at_m: [f64; 3],
    /// Hands that hold the handle; both when left out.
    #[serde(default)]
    pub(crate) hands: HandsText,
    /// Distance of the two hands, m; 0.4 when left out.
    pub(crate) spacing_m: Option<f64>,
    /// The force with which the person pushes it forward, N: it presses back on the hands.
    pub(crate) push_n: Option<f64>,
    /// The force with which the person pulls it backward, N: it pulls the hands forward.
    pub(crate) pull_n: Option<f64>,
}

/// The floor, y = 0, and the feet on it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FloorText {
    /// Feet that stand on it; when left out both, but for those that a `[[step]]` or a `[[support]]` carries.
    pub(crate) feet: Option<FeetText>,
    /// Whether the feet on it may be put elsewhere.
    #[serde(default)]
    pub(crate) may_step: bool,
    /// Distance of one foot ahead of the other at the start, m, 0 to 1.2; 0 when left out.
    #[serde(default)]
    pub(crate) stride_m: f64,
    /// The foot ahead; the right one when left out.
    #[serde(default)]
    pub(crate) ahead: FootText,
}

/// A step on the floor, under one foot.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepText {
    /// Height above the floor, m, 0 to 2.
    pub(crate) height_m: f64,
    /// The foot on it.
    pub(crate) under: FootText,
}

/// A table or a counter: nothing passes through it, and hands and forearms may rest on it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableText {
    /// Height of its top above the floor, m.
    pub(crate) height_m: f64,
    /// Distance of the near edge ahead, m: x of ground, 0 at the hips of the standing body.
    pub(crate) edge_m: f64,
    /// Lengths forward, up and sideways, m; 0.7, 0.03 and 1.4 for a table when left out, 0.6, 0.04 and 1.6 for a counter.
    #[serde(default, deserialize_with = "numbers")]
    pub(crate) size_m: Option<[f64; 3]>,
    /// Parts of the body that rest on it: `right_hand`, `left_hand`, `right_forearm`, `left_forearm`.
    #[serde(default)]
    pub(crate) carries: Vec<CarriedText>,
    /// Hands that `simulate` may put on it when a muscle group is tired: `right_hand`, `left_hand`.
    #[serde(default)]
    pub(crate) may_carry: Vec<HandText>,
}

/// The seat: pelvis and feet carry the sitter; a backrest the trunk, armrests the forearms.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SeatText {
    /// Height of the seat, with the sitter on it, above the floor, m.
    pub(crate) height_m: f64,
    /// Whether the back rests against a backrest.
    #[serde(default)]
    pub(crate) backrest: bool,
    /// Angle between seat and backrest, deg, 80 to 150; 100 when left out.
    pub(crate) backrest_deg: Option<f64>,
    /// Height of armrests, on which the forearms rest, above the floor, m; none when left out.
    pub(crate) armrests_m: Option<f64>,
}

/// A wall, upright: one of `ahead_m`, `behind_m`, `right_m` and `left_m`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WallText {
    /// Distance ahead of the origin of ground, m; the hips of the standing body are there.
    pub(crate) ahead_m: Option<f64>,
    /// The same behind it.
    pub(crate) behind_m: Option<f64>,
    /// The same to the right.
    pub(crate) right_m: Option<f64>,
    /// The same to the left.
    pub(crate) left_m: Option<f64>,
    /// Parts of the body that rest on it: `right_hand`, `left_hand`, or `back`.
    #[serde(default)]
    pub(crate) carries: Vec<CarriedText>,
}

/// A side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SideText {
    /// Right.
    Right,
    /// Left.
    Left,
}

/// One hand or both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HandsText {
    /// Both hands.
    #[default]
    Both,
    /// The right hand.
    Right,
    /// The left hand.
    Left,
}

/// Feet on the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FeetText {
    /// Both feet.
    Both,
    /// The right foot.
    Right,
    /// The left foot.
    Left,
    /// None.
    None,
}

/// A foot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FootText {
    /// The right foot.
    #[default]
    RightFoot,
    /// The left foot.
    LeftFoot,
}

/// Part of the body that carries a bag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum BagOnText {
    /// A strap over the right shoulder.
    RightShoulder,
    /// A strap over the left shoulder.
    LeftShoulder,
    /// The right hand.
    RightHand,
    /// The left hand.
    LeftHand,
    /// Both shoulders: a rucksack.
    Back,
}

/// A part of the body that rests on a thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CarriedText {
    /// The right palm.
    RightHand,
    /// The left palm.
    LeftHand,
    /// The right forearm.
    RightForearm,
    /// The left forearm.
    LeftForearm,
    /// The back, behind the shoulder blades.
    Back,
}

/// A palm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum HandText {
    /// The right palm.
    RightHand,
    /// The left palm.
    LeftHand,
}

impl HandText {
    pub(super) fn segment(self) -> &'static str {
        match self {
            Self::RightHand => SideText::Right.hand(),
            Self::LeftHand => SideText::Left.hand(),
        }
    }
}

impl SideText {
    /// The hand of this side.
    pub(super) fn hand(self) -> &'static str {
        match self {
            Self::Right => "hand_r",
            Self::Left => "hand_l",
        }
    }
}

impl FootText {
    /// The segment that stands.
    pub(super) fn segment(self) -> &'static str {
        match self {
            Self::RightFoot => "calcn_r",
            Self::LeftFoot => "calcn_l",
        }
    }
}

impl CarriedText {
    /// The segment that rests, and the word of the file.
    pub(super) fn segment_and_word(self) -> (&'static str, &'static str) {
        match self {
            Self::RightHand => ("hand_r", "right_hand"),
            Self::LeftHand => ("hand_l", "left_hand"),
            Self::RightForearm => ("radius_r", "right_forearm"),
            Self::LeftForearm => ("radius_l", "left_forearm"),
            Self::Back => ("torso", "back"),
        }
    }
}
