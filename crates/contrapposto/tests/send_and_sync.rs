//! Types that other languages and threads hold are `Send` and `Sync`: a type that is not does not compile here.

use contrapposto::assessment::Assessment;
use contrapposto::batch::Statics;
use contrapposto::equilibria::Equilibria;
use contrapposto::joint_torques::JointTorques;
use contrapposto::model::Model;
use contrapposto::posture_solver::{Engine, SolvedPosture};
use contrapposto::simulation::{Run, Scenario, Simulation, Snapshot, Summary};
use contrapposto::verdict::Verdict;

fn send_and_sync<T: Send + Sync>() {}

#[test]
fn models_engines_runs_and_results_are_send_and_sync() {
    send_and_sync::<Model>();
    send_and_sync::<JointTorques>();
    send_and_sync::<Statics>();
    send_and_sync::<Engine<'static>>();
    send_and_sync::<Scenario>();
    send_and_sync::<Simulation<'static>>();
    send_and_sync::<Run<'static>>();
    send_and_sync::<(SolvedPosture, Equilibria, Assessment, Summary, Snapshot, Verdict)>();
}
