//! Reads things that hands and shoulders carry: boxes, tools, bags and handles become loads, and tasks of the hands.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::statics::{FixedIn, Load, LoadKind};
use nalgebra::Vector3;

use super::drawn;
use super::plan::{HandTarget, HandTask, World};
use super::text::{BagOnText, BagText, BoxText, HandleText, HandsText, SideText, ToolText};
use super::word::Word;
use crate::input_error::InputError;
use crate::scenario::error_keys::load_key;
use crate::scenario::text::ScenarioText;
use crate::toml_file::Located;

/// Distance of two hands on a handle, m, where the file names none.
const SPACING: f64 = 0.4;
/// Masses of a box, kg: those of a load.
const BOX_MASSES: (f64, f64) = (0.0, 1e9);
/// Length of a handle beyond the two hands, m (drawn only).
const BEYOND_HANDS: f64 = 0.12;
/// Greatest distance of two hands, m.
const WIDEST: f64 = 2.0;
/// Place of a strap between the midline (0) and the shoulder joint (1) (assumed: between neck and acromion).
const STRAP: f64 = 0.7;
/// Distance of a rucksack's centre of mass behind the shoulder joints, m (assumed: half the depth of trunk and of rucksack).
const RUCKSACK_BEHIND: f64 = 0.22;

/// Reads all of them.
pub(super) fn read(world: &mut World, at: &Located, text: &ScenarioText, model: &Model) -> Result<(), InputError> {
    for (i, text) in text.boxes.iter().enumerate() {
        read_box(world, &Word::new(at, &["box", &i.to_string()]), text, model)?;
    }
    for (i, text) in text.tool.iter().enumerate() {
        read_tool(world, &Word::new(at, &["tool", &i.to_string()]), text, model)?;
    }
    for (i, text) in text.handle.iter().enumerate() {
        read_handle(world, &Word::new(at, &["handle", &i.to_string()]), text, model)?;
    }
    for (i, text) in text.bag.iter().enumerate() {
        read_bag(world, &Word::new(at, &["bag", &i.to_string()]), text, model)?;
    }
    Ok(())
}

/// Both hands with the side on which each is, the right one first.
fn both_hands(word: &Word<'_>, model: &Model, key: &str) -> Result<[(usize, f64); 2], InputError> {
    let hand = |side: SideText| word.segment(model, key, side.hand());
    Ok([(hand(SideText::Right)?, 1.0), (hand(SideText::Left)?, -1.0)])
}

fn read_box(world: &mut World, word: &Word<'_>, text: &BoxText, model: &Model) -> Result<(), InputError> {
    let size = word.size(text.size_m)?;
    word.number("size_m", size[2], (0.0, WIDEST), "m")?;
    let mass = word.number("mass_kg", text.mass_kg, BOX_MASSES, "kg")?;
    let middle = text.at_m.map(|at| word.place(at)).transpose()?;
    let mut hands = vec![];
    for (hand, side) in both_hands(word, model, "mass_kg")? {
        let weight = LoadKind::Weight(0.5 * mass);
        world.loads.push(load(word, model, (hand, model.segments()[hand].center_of_mass), weight)?);
        let aside = 0.5 * side * size[2];
        let target =
            middle.map_or(HandTarget::Beside(aside), |middle| HandTarget::At(middle + Vector3::new(0.0, 0.0, aside)));
        hands.push((hand, target));
    }
    world.tasks.push(HandTask { name: "box", size: Some(size.into()), hands });
    Ok(())
}

fn read_tool(world: &mut World, word: &Word<'_>, text: &ToolText, model: &Model) -> Result<(), InputError> {
    let hand = word.segment(model, "hand", text.hand.hand())?;
    let station = (hand, model.segments()[hand].center_of_mass);
    if text.mass_kg != 0.0 {
        world.loads.push(load(word, model, station, LoadKind::Weight(text.mass_kg))?);
    }
    if let Some(force) = text.force_n {
        let force = LoadKind::Force(Vector3::from(force), FixedIn::World);
        world.loads.push(load(word, model, station, force)?);
    }
    if text.mass_kg != 0.0 || text.force_n.is_some() {
        world.drawn.extend(drawn::tool(model, hand, text.force_n.map(Vector3::from)));
    }
    if let Some(at) = text.at_m {
        let hands = vec![(hand, HandTarget::At(word.place(at)?))];
        world.tasks.push(HandTask { name: "tool", size: None, hands });
    } else if text.mass_kg == 0.0 && text.force_n.is_none() {
        let help = Some("give it `mass_kg`, `force_n` or `at_m`".to_owned());
        return Err(word.error("hand", "the tool has neither mass nor force nor place".to_owned(), help));
    }
    Ok(())
}

fn read_handle(world: &mut World, word: &Word<'_>, text: &HandleText, model: &Model) -> Result<(), InputError> {
    const FORCES: (f64, f64) = (0.0, 1e5);
    let middle = word.place(text.at_m)?;
    let hands: Vec<(usize, f64)> = match text.hands {
        HandsText::Both => {
            let spacing = word.number("spacing_m", text.spacing_m.unwrap_or(SPACING), (0.0, WIDEST), "m")?;
            both_hands(word, model, "hands")?.map(|(hand, side)| (hand, 0.5 * side * spacing)).into()
        }
        one => {
            if text.spacing_m.is_some() {
                let help = Some("leave it out".to_owned());
                let message = "one hand alone has no distance from the other";
                return Err(word.at.key_error(&word.keys("spacing_m"), message, help));
            }
            let side = if one == HandsText::Right { SideText::Right } else { SideText::Left };
            vec![(word.segment(model, "hands", side.hand())?, 0.0)]
        }
    };
    let on_hands = match (text.push_n, text.pull_n) {
        (Some(push), None) => -word.number("push_n", push, FORCES, "N")?,
        (None, Some(pull)) => word.number("pull_n", pull, FORCES, "N")?,
        (None, None) => 0.0,
        (Some(_), Some(_)) => {
            let help = Some("keep one of `push_n` and `pull_n`".to_owned());
            return Err(word.at.key_error(&word.keys("pull_n"), "the handle is both pushed and pulled", help));
        }
    };
    for &(hand, _) in &hands {
        if on_hands != 0.0 {
            let force = LoadKind::Force(Vector3::new(on_hands / hands.len() as f64, 0.0, 0.0), FixedIn::World);
            world.loads.push(load(word, model, (hand, model.segments()[hand].center_of_mass), force)?);
        }
    }
    let target = |(hand, aside): (usize, f64)| (hand, HandTarget::At(middle + Vector3::new(0.0, 0.0, aside)));
    let apart = hands.iter().map(|(_, aside)| 2.0 * aside.abs()).fold(0.0, f64::max);
    let size = Some(Vector3::new(drawn::BAR, drawn::BAR, apart + BEYOND_HANDS));
    world.tasks.push(HandTask { name: "handle", size, hands: hands.into_iter().map(target).collect() });
    Ok(())
}

fn read_bag(world: &mut World, word: &Word<'_>, text: &BagText, model: &Model) -> Result<(), InputError> {
    let side = match text.on {
        BagOnText::RightHand | BagOnText::LeftHand => {
            let side = if text.on == BagOnText::RightHand { SideText::Right } else { SideText::Left };
            let hand = word.segment(model, "on", side.hand())?;
            let station = (hand, model.segments()[hand].center_of_mass);
            world.loads.push(load(word, model, station, LoadKind::Weight(text.mass_kg))?);
            world.drawn.extend(drawn::bag_in_hand(model, hand));
            return Ok(());
        }
        BagOnText::RightShoulder => "humerus_r",
        BagOnText::LeftShoulder => "humerus_l",
        BagOnText::Back => "humerus_r",
    };
    let torso = word.segment(model, "on", "torso")?;
    let arm = word.segment(model, "on", side)?;
    let shoulder = in_segment(model, torso, arm);
    let point = match text.on {
        BagOnText::Back => Vector3::new(shoulder.x - RUCKSACK_BEHIND, model.segments()[torso].center_of_mass.y, 0.0),
        _ => Vector3::new(shoulder.x, shoulder.y, STRAP * shoulder.z),
    };
    world.loads.push(load(word, model, (torso, point), LoadKind::Weight(text.mass_kg))?);
    world.drawn.push(drawn::bag_on_trunk(torso, point));
    Ok(())
}

/// The joint of a segment in the frame of another one, in the default posture, m.
pub(super) fn in_segment(model: &Model, frame: usize, segment: usize) -> Vector3<f64> {
    let kinematics = Kinematics::new(model);
    let place = kinematics.placement(model, segment).translation.vector;
    kinematics.placement(model, frame).inverse_transform_point(&place.into()).coords
}

/// A checked load at a point of a segment.
fn load(
    word: &Word<'_>,
    model: &Model,
    (segment, point): (usize, Vector3<f64>),
    kind: LoadKind,
) -> Result<Load, InputError> {
    let load = Load { segment, point, kind };
    load.check(model).map_err(|error| word.error(load_key(&error), error.to_string(), None))?;
    Ok(load)
}
