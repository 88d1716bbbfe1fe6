//! Calls what moves a body by its name: muscles, or the motors of a robot.

use crate::fatigue::FatigueLaw;
use crate::model::Model;

/// Words about muscles, and those about motors.
const MOTOR_WORDS: [[&str; 2]; 4] =
    [["muscle group", "motor"], ["Muscle group", "Motor"], ["muscle", "motor"], ["Muscle", "Motor"]];

/// Whether motors move the body: it has groups of known strength, and none of them tires. The strength of such a body comes from the limits of
/// effort in its model file.
pub fn has_motors(model: &Model) -> bool {
    let mut groups =
        model.coordinates().iter().filter_map(|coordinate| coordinate.groups.as_ref()).flatten().peekable();
    groups.peek().is_some() && groups.all(|group| group.fatigue == FatigueLaw::Tireless)
}

/// A text about the muscles of a body, with the word for what moves this one.
pub fn muscles_or_motors(model: &Model, text: &str) -> String {
    let words: &[[&str; 2]] = if has_motors(model) { &MOTOR_WORDS } else { &[] };
    words.iter().fold(text.to_owned(), |text, [muscle, motor]| text.replace(muscle, motor))
}
