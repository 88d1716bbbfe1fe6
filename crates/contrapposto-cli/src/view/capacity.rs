//! The greatest forces at a point of a body, of the mean person and of weaker and stronger ones, with their words.

use contrapposto::capacity::{Capacity, CapacityError, Demand, GreatestForce, People, Situation, Solid, Station};
use contrapposto::model::Model;
use contrapposto_formats::ForceText;
use nalgebra::Vector3;

use super::axes::directions;
use super::words::{how_long, plain, sentence};

/// A component of a direction from here on is said. Assumed: half of a right angle and a little less than a quarter.
const SAID: f64 = 0.36;
/// Force from which on newtons are said without decimals, N.
const WHOLE: f64 = 9.95;

/// The forces in a posture that can be held.
pub(crate) struct Forces {
    /// The mean person's.
    pub(crate) solid: Solid,
    /// Capacity of the mean person, of weaker and of stronger people; `None` where these cannot hold the posture.
    programs: [Option<Capacity>; 3],
    /// Least force in any direction of weaker and stronger people, and greatest, N.
    pub(crate) least: [f64; 2],
    pub(crate) greatest: [f64; 2],
    /// Point at which the force acts, ground, m.
    pub(crate) place: Vector3<f64>,
}

impl Forces {
    /// `None` where the posture cannot be held.
    pub(crate) fn of(
        situation: &Situation<'_>,
        station: Station,
        hold: Option<f64>,
    ) -> Result<Option<Self>, CapacityError> {
        let of = |people| Capacity::new(situation, station, Demand { hold, people });
        let mut programs = [of(People::Mean)?, of(People::Weaker)?, of(People::Stronger)?];
        let Some(mean) = &mut programs[0] else { return Ok(None) };
        let (place, solid) = (mean.place(), mean.solid());
        let [(least_of_weaker, most_of_weaker), (least_of_stronger, most_of_stronger)] = [1, 2].map(|who: usize| {
            let solid = programs[who].as_mut().map(Capacity::solid);
            solid.map_or((0.0, 0.0), |solid| (solid.weakest.force, solid.strongest.force))
        });
        let least = [least_of_weaker, least_of_stronger];
        Ok(Some(Self { solid, programs, least, greatest: [most_of_weaker, most_of_stronger], place }))
    }

    /// Whether people whose strength is one standard deviation below the mean can hold the posture.
    pub(crate) fn weaker_can_hold(&self) -> bool {
        self.programs[1].is_some()
    }

    /// The force in a direction of ground.
    pub(crate) fn text(&mut self, model: &Model, greatest: &GreatestForce) -> ForceText {
        let others = [1, 2].map(|who: usize| {
            self.programs[who].as_mut().map_or(0.0, |program| program.in_direction(&greatest.direction).force)
        });
        ForceText::new(model, greatest, toward(model, &greatest.direction), others)
    }

    /// Forward, back, up, down, left and right.
    pub(crate) fn main(&mut self, model: &Model) -> Vec<ForceText> {
        let [right, ahead, up] = directions(model);
        let named = [ahead, -ahead, up, -up, -right, right];
        let found = named.map(|direction| self.in_direction(&direction));
        found.into_iter().flatten().map(|greatest| self.text(model, &greatest)).collect()
    }

    /// The mean person's greatest force in a direction of ground.
    pub(crate) fn in_direction(&mut self, direction: &Vector3<f64>) -> Option<GreatestForce> {
        self.programs[0].as_mut().map(|program| program.in_direction(direction))
    }
}

/// `forward, up and left`: the largest component first.
pub(crate) fn toward(model: &Model, direction: &Vector3<f64>) -> String {
    let [right, ahead, up] = directions(model);
    let mut parts: Vec<(f64, &str)> = [(ahead, ["forward", "back"]), (up, ["up", "down"]), (right, ["right", "left"])]
        .into_iter()
        .map(|(axis, [positive, negative])| {
            let along = axis.dot(direction);
            (along.abs(), if along < 0.0 { negative } else { positive })
        })
        .filter(|(along, _)| *along > SAID)
        .collect();
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    super::words::list(&parts.into_iter().map(|(_, word)| word.to_owned()).collect::<Vec<_>>())
}

/// `84 N`, `3.2 N`, `no limit`.
pub(crate) fn newtons(force: Option<f64>) -> String {
    match force {
        None => "no limit".to_owned(),
        Some(force) if force >= WHOLE => format!("{force:.0}\u{a0}N"),
        Some(force) => format!("{force:.1}\u{a0}N"),
    }
}

/// `right shoulder flexion limits`, `nothing limits`.
pub(crate) fn limited_by(force: &ForceText) -> String {
    force.limits.first().map_or_else(|| "nothing limits".to_owned(), |limit| format!("{} limits", limit.name()))
}

/// `Right hand: at least 84 N in every direction, the weakest up and back (right shoulder flexion limits); at most 310 N, down (balance
/// limits). For two of three people the least is 60 N to 108 N, the greatest 310 N.`
pub(crate) fn finding(
    segment: &str,
    hold: Option<f64>,
    forces: &Forces,
    weakest: &ForceText,
    strongest: &ForceText,
) -> String {
    let held = hold.map_or(String::new(), |seconds| format!(", held for {}", how_long(seconds)));
    format!(
        "{}{held}: at least {} in every direction, the weakest {} ({}); at most {}, {} ({}). For two of three people the least is {}, the \
         greatest {}.",
        sentence(&plain(segment)),
        newtons(weakest.force_n),
        weakest.toward,
        limited_by(weakest),
        newtons(strongest.force_n),
        strongest.toward,
        limited_by(strongest),
        range(forces.least),
        range(forces.greatest)
    )
}

/// `60 N to 108 N`; one number where both are said alike.
pub(crate) fn range(ends: [f64; 2]) -> String {
    let [least, greatest] = ends.map(|force| newtons(force.is_finite().then_some(force)));
    if least == greatest { least } else { format!("{least} to {greatest}") }
}

/// The assumptions of the computation, a sentence each.
pub(crate) fn assumptions(
    hold: Option<f64>,
    held_by_hand: bool,
    by_muscles: bool,
    weaker_can_hold: bool,
) -> Vec<String> {
    let mut all = vec![
        "The force is the one that the body exerts, besides the loads of the scenario; posture and places of the supports do not change."
            .to_owned(),
        "Strengths are those at the present angles; that of the grip and of the skin is not counted.".to_owned(),
        "Friction is a pyramid inside of its cone: where friction limits, the force is up to 29 % below that of the cone.".to_owned(),
    ];
    if by_muscles {
        all.push(
            "Muscles of the model share the torques of the joints that they cross; each is as strong and tires as the group for which it \
             works."
                .to_owned(),
        );
    }
    if let Some(seconds) = hold {
        all.push(format!(
            "Everybody is rested at first and holds the force for {}; nobody moves meanwhile.",
            how_long(seconds)
        ));
    } else {
        all.push("Everybody is rested, and the force lasts an instant; --hold asks for one that lasts.".to_owned());
    }
    if held_by_hand {
        all.push(
            "There are no supports: the root of the body is held as if by hand, and balance limits nothing.".to_owned(),
        );
    }
    if !weaker_can_hold {
        all.push(
            "People whose strength is one standard deviation below the mean cannot hold the posture itself: 0 N."
                .to_owned(),
        );
    }
    all
}
