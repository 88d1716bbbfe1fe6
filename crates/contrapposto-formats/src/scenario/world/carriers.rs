//! Reads things that carry the body or stand in its way: floor, steps, tables, seat and walls become supports and obstacles.

use contrapposto::model::Model;
use nalgebra::Vector3;

use super::drawn;
use super::held::in_segment;
use super::plan::{World, forearm};
use super::text::{CarriedText, FeetText, FloorText, FootText, SeatText, TableText, WallText};
use super::word::Word;
use crate::input_error::InputError;
use crate::scenario::obstacle_text::ObstacleText;
use crate::scenario::rest_text::RestText;
use crate::scenario::support::FEET;
use crate::scenario::task_text::{GroundText, HeelText, NamedPlaceText, OnText, PlaceText, PlaneText, SupportText};
use crate::scenario::text::ScenarioText;
use crate::toml_file::{Located, shown};

/// Heights of tables, seats, armrests and steps above the floor, m.
const HEIGHTS: (f64, f64) = (0.0, 2.5);
/// Strides, m.
const STRIDES: (f64, f64) = (0.0, 1.2);
/// Distances of walls and edges from the origin of ground, m.
const DISTANCES: (f64, f64) = (-5.0, 5.0);
/// Angles between seat and backrest, deg.
const BACKREST_DEG: (f64, f64) = (80.0, 150.0);
/// The angle where the file names none, deg (assumed; office chairs: 95 to 110, recalled).
pub(super) const BACKREST_DEFAULT_DEG: f64 = 100.0;
/// Lengths of a table forward, up and sideways, m (assumed).
const TABLE: [f64; 3] = [0.7, 0.03, 1.4];
/// The same of a counter, which is open below (assumed).
const COUNTER: [f64; 3] = [0.6, 0.04, 1.6];
/// Lengths of a seat forward and up, m (assumed; office chairs: 0.38 to 0.44 deep, recalled).
const SEAT: [f64; 2] = [0.40, 0.05];
/// Width of a seat in distances of a shoulder joint from the midline (assumed: arms that hang beside the seat are clear of it).
const SEAT_WIDTH: f64 = 1.5;
/// Width of a seat for a body without shoulders, m (assumed).
const SEAT_WIDTH_ALONE: f64 = 0.32;
/// Distance of a hand or the middle of a forearm behind the near edge of a table, m (assumed).
const BEHIND_EDGE: f64 = 0.12;

/// Least distance of the middle of a palm from the edges of a table, m (assumed).
const PALM_INSIDE: f64 = 0.06;
/// Greatest distance of the middle of a palm behind the near edge, m (assumed).
const PALM_REACH: f64 = 0.45;
/// Greatest distance of the middle of a palm outside its shoulder, m (assumed).
const PALM_ASIDE: f64 = 0.30;
/// Greatest distance of the middle of a palm on the other side of the midline, m (assumed).
const PALM_ACROSS: f64 = 0.05;

/// Reads all of them.
pub(super) fn read(world: &mut World, at: &Located, text: &ScenarioText, model: &Model) -> Result<(), InputError> {
    let has_things = !world.is_empty() || text.seat.is_some() || {
        [text.step.len(), text.table.len(), text.counter.len(), text.wall.len()].iter().any(|count| *count > 0)
    };
    let has_feet = [FootText::RightFoot, FootText::LeftFoot].iter().all(|foot| model.segment(foot.segment()).is_some());
    if text.floor.is_some() || (has_things && has_feet && !stands(text)) {
        read_floor(world, &Word::new(at, &["floor"]), &text.floor.clone().unwrap_or_default(), text)?;
    }
    for (i, step) in text.step.iter().enumerate() {
        let word = Word::new(at, &["step", &i.to_string()]);
        let height = word.number("height_m", step.height_m, (0.0, 2.0), "m")?;
        let support = SupportText { step_m: Some(height), ..rests(step.under.segment(), floor()) };
        world.support(&word, support);
    }
    if let Some(seat) = &text.seat {
        read_seat(world, &Word::new(at, &["seat"]), seat, model)?;
    }
    for (table, size, texts) in [("table", TABLE, &text.table), ("counter", COUNTER, &text.counter)] {
        for (i, text) in texts.iter().enumerate() {
            read_table(world, &Word::new(at, &[table, &i.to_string()]), (table, size), text, model)?;
        }
    }
    for (i, wall) in text.wall.iter().enumerate() {
        read_wall(world, &Word::new(at, &["wall", &i.to_string()]), wall, model)?;
    }
    Ok(())
}

fn read_floor(
    world: &mut World,
    word: &Word<'_>,
    floor_text: &FloorText,
    text: &ScenarioText,
) -> Result<(), InputError> {
    let stride = word.number("stride_m", floor_text.stride_m, STRIDES, "m")?;
    let elsewhere = |foot: FootText| {
        text.step.iter().any(|step| step.under == foot)
            || text.support.iter().any(|support| support.segment == foot.segment())
    };
    for foot in [FootText::RightFoot, FootText::LeftFoot] {
        let stands = match floor_text.feet {
            None => !elsewhere(foot),
            Some(FeetText::Both) => true,
            Some(FeetText::Right) => foot == FootText::RightFoot,
            Some(FeetText::Left) => foot == FootText::LeftFoot,
            Some(FeetText::None) => false,
        };
        if stands {
            let place = if floor_text.may_step { NamedPlaceText::Free } else { NamedPlaceText::Start };
            let support = SupportText { place: PlaceText::Named(place), ..rests(foot.segment(), floor()) };
            world.support(word, support);
        }
        if stride > 0.0 {
            let ahead = if foot == floor_text.ahead { 0.5 } else { -0.5 };
            world.strides.push((foot.segment(), ahead * stride));
        }
    }
    Ok(())
}

fn read_seat(world: &mut World, word: &Word<'_>, text: &SeatText, model: &Model) -> Result<(), InputError> {
    let height = word.number("height_m", text.height_m, HEIGHTS, "m")?;
    world.sits = true;
    world.support(word, rests("pelvis", level(height)));
    let [depth, thickness] = SEAT;
    let shoulder = model.segment("pelvis").zip(model.segment("humerus_r"));
    let width = shoulder.map_or(SEAT_WIDTH_ALONE, |(pelvis, arm)| SEAT_WIDTH * in_segment(model, pelvis, arm).z.abs());
    let middle = Vector3::new(0.0, height - 0.5 * thickness, 0.0);
    world.obstacle(word, block("seat", middle, [depth, thickness, width]));
    world.drawn.extend(drawn::legs("seat", middle, [depth, thickness, width], true));
    let angle = word.number("backrest_deg", text.backrest_deg.unwrap_or(BACKREST_DEFAULT_DEG), BACKREST_DEG, "deg")?;
    if text.backrest {
        let recline = (angle - 90.0).to_radians();
        let plane = PlaneText { normal: [libm::cos(recline), libm::sin(recline), 0.0], point_m: None };
        let corners_m = Some(back(word, model, "backrest")?);
        world.rests.push("torso");
        world.support(word, SupportText { corners_m, ..rests("torso", OnText::Plane(plane)) });
    } else if text.backrest_deg.is_some() {
        let help = Some("add `backrest = true`, or leave it out".to_owned());
        return Err(word.at.key_error(&word.keys("backrest_deg"), "the seat has no backrest", help));
    }
    if let Some(armrests) = text.armrests_m {
        let bones = armrests + forearm(model);
        if let Some((lowest, highest)) = elbows(model, height)
            && !(lowest..=highest).contains(&bones)
        {
            let [lowest, highest] = [lowest, highest].map(|bones| (100.0 * (bones - forearm(model))).round() / 100.0);
            let message = format!(
                "armrests_m is {} m; on a seat of {} m the arms of this body reach armrests of {lowest} to {highest} m",
                shown(armrests),
                shown(height)
            );
            return Err(word.error("armrests_m", message, None));
        }
        for segment in ["radius_r", "radius_l"] {
            world.rests.push(segment);
            world.support(word, rests(segment, level(bones)));
        }
    }
    Ok(())
}

/// Heights of the bones of level forearms of an upright sitter, m: with the arms hanging down, and with the elbows at the shoulders.
fn elbows(model: &Model, seat: f64) -> Option<(f64, f64)> {
    /// By so little the trunk gives way (assumed).
    const SLUMP: f64 = 0.02;
    let pelvis = model.segment("pelvis")?;
    let patch = &model.segments()[pelvis].patch;
    let buttocks = patch.iter().map(|corner| corner.y).fold(f64::INFINITY, f64::min);
    let above = |name: &str| Some(seat - buttocks + in_segment(model, pelvis, model.segment(name)?).y);
    (!patch.is_empty()).then_some(())?;
    Some((above("ulna_r")? - SLUMP, above("humerus_r")?))
}

fn read_table(
    world: &mut World,
    word: &Word<'_>,
    (name, default): (&str, [f64; 3]),
    text: &TableText,
    model: &Model,
) -> Result<(), InputError> {
    let height = word.number("height_m", text.height_m, HEIGHTS, "m")?;
    let edge = word.number("edge_m", text.edge_m, DISTANCES, "m")?;
    let size = match text.size_m {
        Some(size) => word.size(size)?,
        None => default,
    };
    let middle = Vector3::new(edge + 0.5 * size[0], height - 0.5 * size[1], 0.0);
    world.obstacle(word, block(name, middle, size));
    world.drawn.extend(drawn::legs(name, middle, size, false));
    for carried in &text.carries {
        let (segment, named) = carried.segment_and_word();
        if *carried == CarriedText::Back {
            let help = Some("a [seat] with `backrest = true` or a [[wall]] carries the back".to_owned());
            return Err(word.error("carries", format!("a {name} does not carry the {named}"), help));
        }
        world.support(word, rests(segment, level(height)));
        place_arm(world, model, segment, edge + BEHIND_EDGE);
    }
    for hand in &text.may_carry {
        let region_m = region_of_hand(model, hand.segment(), (edge, height), size);
        let on = PlaneText { normal: [0.0, 1.0, 0.0], point_m: Some([0.0, height, 0.0]) };
        let segment = hand.segment().to_owned();
        let rest = RestText { segment, on, region_m, friction: None, share_max: None, corners_m: None };
        world.may_rest.push((rest, word.path.clone()));
    }
    Ok(())
}

/// The part of a table's top in which the middle of a palm may be put: within reach, on the hand's own side.
fn region_of_hand(model: &Model, hand: &str, (edge, height): (f64, f64), size: [f64; 3]) -> Vec<[f64; 3]> {
    let [from, to] = [edge + PALM_INSIDE, (edge + size[0] - PALM_INSIDE).min(edge + PALM_REACH)];
    let shoulder = if hand.ends_with("_r") { "humerus_r" } else { "humerus_l" };
    let aside = model.segment("pelvis").zip(model.segment(shoulder)).map_or(0.0, |(a, b)| in_segment(model, a, b).z);
    let side = if hand.ends_with("_r") { 1.0 } else { -1.0 };
    let outer = (aside.abs() + PALM_ASIDE).min(0.5 * size[2] - PALM_INSIDE);
    let [inner, outer] = [-side * PALM_ACROSS, side * outer];
    vec![[from, height, inner], [to, height, inner], [to, height, outer], [from, height, outer]]
}

/// Wants a hand or forearm so far ahead, and as far aside as the shoulder.
fn place_arm(world: &mut World, model: &Model, segment: &'static str, ahead: f64) {
    let shoulder = if segment.ends_with("_r") { "humerus_r" } else { "humerus_l" };
    if let (Some(pelvis), Some(arm)) = (model.segment("pelvis"), model.segment(shoulder)) {
        world.places.push((segment, [ahead, in_segment(model, pelvis, arm).z]));
    }
}

fn read_wall(world: &mut World, word: &Word<'_>, text: &WallText, model: &Model) -> Result<(), InputError> {
    let given = [
        ("ahead_m", text.ahead_m, [-1.0, 0.0, 0.0]),
        ("behind_m", text.behind_m, [1.0, 0.0, 0.0]),
        ("right_m", text.right_m, [0.0, 0.0, -1.0]),
        ("left_m", text.left_m, [0.0, 0.0, 1.0]),
    ];
    let given: Vec<_> = given.into_iter().filter_map(|(key, value, normal)| value.map(|v| (key, v, normal))).collect();
    let [(key, distance, normal)] = given[..] else {
        let help = Some("give one of `ahead_m`, `behind_m`, `right_m` and `left_m`".to_owned());
        let message = format!("where the wall is, is said {} times", given.len());
        return Err(word.at.error(&word.path.iter().map(String::as_str).collect::<Vec<_>>(), message, help));
    };
    let distance = word.number(key, distance, (0.0, DISTANCES.1), "m")?;
    let point = -distance * Vector3::from(normal);
    let obstacle = ObstacleText {
        name: "wall".to_owned(),
        normal: Some(normal),
        point_m: Some(point.into()),
        ..ObstacleText::default()
    };
    world.obstacle(word, obstacle);
    world.drawn.push(drawn::wall(normal.into(), point));
    for carried in &text.carries {
        let (segment, named) = carried.segment_and_word();
        let plane = OnText::Plane(PlaneText { normal, point_m: Some(point.into()) });
        let corners_m = match carried {
            CarriedText::Back if key == "behind_m" => Some(back(word, model, "carries")?),
            CarriedText::Back => {
                let message = format!("the {named} rests on a wall behind the body only");
                return Err(word.error("carries", message, Some("give `behind_m`".to_owned())));
            }
            _ => None,
        };
        world.support(word, SupportText { corners_m, ..rests(segment, plane) });
        if key == "ahead_m" && *carried != CarriedText::Back {
            place_arm(world, model, segment, distance);
        }
    }
    Ok(())
}

/// Corners of the back, behind the shoulder blades, in the frame of the torso, m: shares of the height of the neck's joint above the
/// torso's origin (assumed).
fn back(word: &Word<'_>, model: &Model, key: &str) -> Result<Vec<[f64; 3]>, InputError> {
    const BEHIND: f64 = 0.46;
    const FROM_TO: [f64; 2] = [0.23, 0.92];
    const ASIDE: f64 = 0.46;
    let (torso, head) = (word.segment(model, key, "torso")?, word.segment(model, key, "head")?);
    let height = in_segment(model, torso, head).y;
    let [low, high] = FROM_TO.map(|share| share * height);
    let (behind, aside) = (-BEHIND * height, ASIDE * height);
    Ok(vec![[behind, low, aside], [behind, low, -aside], [behind, high, aside], [behind, high, -aside]])
}

fn floor() -> OnText {
    OnText::Named(GroundText::Floor)
}

/// The level plane at a height.
fn level(height: f64) -> OnText {
    OnText::Plane(PlaneText { normal: [0.0, 1.0, 0.0], point_m: Some([0.0, height, 0.0]) })
}

/// A support as the longhand has it where it says nothing more.
fn rests(segment: &str, on: OnText) -> SupportText {
    SupportText {
        segment: segment.to_owned(),
        on: Some(on),
        step_m: None,
        friction: None,
        share_max: None,
        corners_m: None,
        place: PlaceText::default(),
        heel: HeelText::default(),
    }
}

fn block(name: &str, middle: Vector3<f64>, size: [f64; 3]) -> ObstacleText {
    ObstacleText { name: name.to_owned(), middle_m: Some(middle.into()), size_m: Some(size), ..ObstacleText::default() }
}

/// Whether a foot of the file's own supports stands somewhere.
fn stands(text: &ScenarioText) -> bool {
    text.support.iter().any(|support| FEET.contains(&support.segment.as_str()))
}
