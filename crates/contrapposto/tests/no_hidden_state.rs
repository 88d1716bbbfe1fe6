//! No stage keeps hidden state: each computes several postures in order, each twice, then in reverse, with the
//! same workspace: answers are the same to the bit, those of a new workspace too, and the model is what it was. A stage that
//! keeps a state on purpose is restarted.

use crate::support;

use contrapposto::assessment::{AssessSettings, assess};
use contrapposto::constraint::{HalfSpace, relief_step};
use contrapposto::contact::{ContactForces, Support};
use contrapposto::equilibria::{Aim, Search, equilibria, stability};
use contrapposto::fatigue::Hysteresis;
use contrapposto::hybrid::{Problem, Strategy, minimise, minimise_literal};
use contrapposto::joint_torques::{JointTorques, Quantities};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, Side, adult};
use contrapposto::posture::Posture;
use contrapposto::posture_solver;
use contrapposto::simulation::{ReliefSettings, RunSettings, Scenario, StrategySettings, Tables, TaskSettings, run};
use contrapposto::statics::{ExternalTorque, FixedIn, Gradient, Load, LoadKind, PassiveTorque};
use contrapposto::tasks::PriorityLevel;
use contrapposto::tasks::{Effort, Point, Task};
use nalgebra::Vector3;
use rand::RngExt;

/// Everything that a stage answers: as text, in which every bit of a number shows.
type Stage<'a> = Box<dyn FnMut(&Posture) -> String + 'a>;

/// A body on both feet with something in its hand and something to do.
struct Setting {
    model: Model,
    supports: Vec<Support>,
    goals: Vec<PriorityLevel>,
    loads: Vec<Load>,
}

impl Setting {
    fn new() -> Self {
        let model = adult(&Adult::default()).unwrap();
        let foot = |name: &str| {
            let segment = model.segment(name).unwrap();
            let corners = model.segments()[segment].patch.clone();
            Support {
                segment,
                corners,
                normal: Vector3::y(),
                friction: 0.6,
                share_max: 1.0,
                place: contrapposto::contact::Place::Fixed,
            }
        };
        let hand = model.segment("hand_r").unwrap();
        let mut kinematics = Kinematics::new(&model);
        kinematics.update(&model, &model.default_posture()).unwrap();
        let target = kinematics.station(&model, hand, Vector3::zeros()) + Vector3::new(0.2, 0.3, 0.0);
        let reach = Task::Point(Point { segment: hand, point: Vector3::zeros(), target, axes: [true; 3] });
        let push = LoadKind::Force(Vector3::new(5.0, -10.0, 3.0), FixedIn::Segment);
        Self {
            supports: vec![foot("calcn_r"), foot("calcn_l")],
            goals: vec![reach.into(), Task::Effort(Effort::whole(&model)).into()],
            loads: vec![
                Load::weight(&model, hand, 2.0),
                Load { segment: model.segment("hand_l").unwrap(), point: Vector3::zeros(), kind: push },
            ],
            model,
        }
    }

    fn scenario(&self, start: &Posture) -> Scenario {
        let n = self.model.coordinates().len();
        let task = |goal: &PriorityLevel| TaskSettings { goal: goal.clone(), above_relief: false };
        Scenario {
            title: "twice".into(),
            model: self.model.clone(),
            start: start.clone(),
            free: vec![true; n],
            loads: self.loads.clone(),
            supports: self.supports.clone(),
            rests: vec![],
            limits: vec![],
            tasks: self.goals.iter().map(task).collect(),
            events: vec![],
            strategies: vec![],
            strategy: StrategySettings { kind: Strategy::Passive, minimum_decrease_ratio: 0.9 },
            relief: ReliefSettings {
                step_gain: 0.3,
                max_step: 0.01,
                torque_tolerance: 0.5,
                effort_factor: 1.25,
                tables: Tables::Total,
            },
            hysteresis: Hysteresis { critical_level: 0.6, recovery_level: 0.3 },
            muscles: None,
            muscles_tire: false,
            start_fatigue: vec![[0.5; 2]; n],
            run: RunSettings { duration: 0.5, step: 1.0 / 30.0, stop_when_settled: false, threads: 1 },
        }
    }

    fn torques(&self) -> Stage<'_> {
        let model = &self.model;
        let mut kinematics = Kinematics::new(model);
        let (mut external, mut passive) = (ExternalTorque::new(model), PassiveTorque::new(model));
        let mut gradient = Gradient::new(model);
        Box::new(move |posture| {
            kinematics.update(model, posture).unwrap();
            external.update(model, &kinematics, &self.loads).unwrap();
            passive.update(model, &kinematics).unwrap();
            external.gradient(model, &kinematics, &mut gradient);
            let center = kinematics.center_of_mass(model);
            let rows: Vec<_> = (0..gradient.size()).map(|row| gradient.row(row)).collect();
            format!("{:?} {:?} {center:?} {rows:?}", external.torques(), passive.torques())
        })
    }

    fn contact(&self) -> Stage<'_> {
        let model = &self.model;
        let mut torques = JointTorques::new(model);
        let mut contact = ContactForces::new(model, self.supports.clone()).unwrap();
        Box::new(move |posture| {
            contact.forget();
            torques.update_with_contact(model, posture, &self.loads, &mut contact, Quantities::TORQUES).unwrap();
            format!(
                "{:?} {:?} {:?} {:?}",
                contact.balance(),
                contact.forces(),
                contact.torques(),
                torques.active_torque()
            )
        })
    }

    /// Decision, half-space, strength and fatigue of every joint.
    fn joints(&self) -> Stage<'_> {
        let model = &self.model;
        let mut external = ExternalTorque::new(model);
        Box::new(move |posture| {
            let mut kinematics = Kinematics::new(model);
            kinematics.update(model, posture).unwrap();
            external.update(model, &kinematics, &self.loads).unwrap();
            let mut all = vec![];
            for (i, coordinate) in model.coordinates().iter().enumerate() {
                let (Some(law), Some(groups), Some(rate)) = (&coordinate.passive, &coordinate.groups, coordinate.rate)
                else {
                    continue;
                };
                let curve = law.curve_at(i, posture.values(), coordinate.range).unwrap();
                let angle = posture.values()[i];
                let problem = Problem {
                    curve: &curve,
                    angle,
                    external_torque: external.torques()[rate],
                    external_slope: external.own_slope(&kinematics, model, rate),
                    strategy: Strategy::Active,
                    minimum_decrease_ratio: 0.5,
                    torque_tolerance: 0.05,
                    accepted: None,
                };
                let decisions = [minimise(&problem).unwrap(), minimise_literal(&problem).unwrap()];
                let mut space = HalfSpace::new(model.coordinates().len());
                let mut step = vec![0.0; model.coordinates().len()];
                step[i] = decisions[0].goal.map_or(0.0, |goal| relief_step(goal, angle, 0.3, 0.03));
                let asked = space.ask_for(posture.values(), &step);
                let group = &groups[Side::of(external.torques()[rate]).index()];
                let load = external.torques()[rate].abs() / group.strength.torque(angle);
                let tired = group.fatigue.advance(group.fatigue.start(0.3, load), load, 10.0);
                all.push(format!("{decisions:?} {space:?} {asked} {tired:?} {:?}", tired.level(load)));
            }
            all.join("\n")
        })
    }

    fn pose(&self) -> Stage<'_> {
        let options = posture_solver::Options { max_steps: 40, ..posture_solver::Options::inverse_kinematics() };
        let mut engine = posture_solver::Engine::new(&self.model, self.goals.clone(), &self.loads, options).unwrap();
        Box::new(move |posture| format!("{:?}", engine.solve(posture)))
    }

    fn rest(&self) -> Stage<'_> {
        let (model, options) =
            (&self.model, posture_solver::Options { max_steps: 30, ..posture_solver::Options::least_effort() });
        let (supports, goals) = (self.supports.clone(), self.goals.clone());
        let start = model.default_posture();
        let mut engine =
            posture_solver::Engine::with_supports(model, &start, supports, goals, &self.loads, options).unwrap();
        Box::new(move |posture| format!("{:?} {:?}", engine.solve(posture), engine.contact().forces()))
    }

    fn steadiness(&self) -> Stage<'_> {
        let mut body = JointTorques::new(&self.model);
        let locked = vec![false; self.model.rates().len()];
        Box::new(move |posture| {
            let needs = Quantities::ALL;
            body.update(&self.model, posture, &self.loads, needs).unwrap();
            format!("{:?}", stability(&self.model, &body, &self.supports, &self.loads, &locked))
        })
    }

    fn search(&self) -> Stage<'_> {
        Box::new(move |posture| {
            let (model, supports, goals, loads) = (&self.model, &self.supports, &self.goals, &self.loads);
            let search = Search {
                model,
                start: posture,
                supports,
                limits: &[],
                goals,
                loads,
                locked: &[],
                most_work: usize::MAX,
                scattered: contrapposto::equilibria::SCATTERED_STARTS,
                aim: Aim::Ways,
                threads: 1,
            };
            format!(
                "{:?}",
                equilibria(
                    &search,
                    posture_solver::Options { max_steps: 15, ..posture_solver::Options::least_effort() }
                )
            )
        })
    }

    fn course(&self) -> Stage<'_> {
        Box::new(move |posture| {
            let mut shown = String::new();
            let ended = run(&self.scenario(posture), |sample| shown += &format!("{sample:?}"));
            format!("{ended:?} {shown}")
        })
    }

    fn assessment(&self) -> Stage<'_> {
        Box::new(move |posture| {
            let motion = [(0.0, self.model.default_posture()), (30.0, posture.clone()), (60.0, posture.clone())];
            let settings = AssessSettings { supports: self.supports.clone(), ..AssessSettings::default() };
            let loads = |_: f64, _: &Kinematics, loads: &mut Vec<Load>| loads.extend(&self.loads);
            format!("{:?}", assess(&self.model, &motion, loads, &settings, |_| {}))
        })
    }
}

#[test]
fn every_stage_twice_and_in_another_order() {
    let setting = Setting::new();
    let before = format!("{:?}", setting.model);
    let mut random = support::random(8);
    let postures: Vec<Posture> = (0..4)
        .map(|_| {
            let near = |c: &contrapposto::model::Coordinate| {
                let by = if c.groups.is_some() { random.random_range(-0.05..0.05) } else { 0.0 };
                (c.default + by).clamp(c.range.0, c.range.1)
            };
            Posture::new(setting.model.coordinates().iter().map(near).collect())
        })
        .collect();
    type Make = for<'a> fn(&'a Setting) -> Stage<'a>;
    let stages: [(&str, Make); 9] = [
        ("torques", Setting::torques),
        ("contact forces", Setting::contact),
        ("decisions, half-spaces, fatigue", Setting::joints),
        ("pose", Setting::pose),
        ("posture of least effort", Setting::rest),
        ("stability", Setting::steadiness),
        ("search", Setting::search),
        ("run", Setting::course),
        ("assessment", Setting::assessment),
    ];
    for (name, make) in stages {
        // A search takes seconds.
        let order: &[usize] = if name == "search" { &[1, 0, 0] } else { &[0, 0, 1, 1, 2, 2, 3, 3, 3, 2, 1, 0] };
        let most = order.iter().max().unwrap();
        let fresh: Vec<String> = postures[..=*most].iter().map(|posture| make(&setting)(posture)).collect();
        assert!(fresh[0] != fresh[1], "{name} sees no posture");
        assert!(!fresh[0].contains("Err("), "{name} is refused: {}", fresh[0]);
        let mut stage = make(&setting);
        for &i in order {
            assert!(stage(&postures[i]) == fresh[i], "{name} remembers: posture {i}");
        }
        println!("{name}: {} bytes the same", fresh.iter().map(String::len).sum::<usize>());
    }
    assert!(format!("{:?}", setting.model) == before, "the model was changed");
}
