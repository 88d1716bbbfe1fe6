//! All tests of the core from outside: one program, which is linked once and keeps all cores busy.

#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a test that cannot go on says where, and prints its seed"
)]
#![allow(unreachable_pub, reason = "nothing uses a test from outside")]

mod adult;
mod allocation;
mod angle_error;
mod architecture;
mod assess;
mod axes;
mod batch;
mod built_in_curves;
mod capacity;
mod clearance;
mod closed_chains;
mod contact;
mod drawn_muscles;
mod dynamics;
mod fatigue;
mod fatigue_tables;
mod fiber_equilibrium;
mod free_places;
mod hip_tract;
mod hybrid_minimisation;
mod jacobians;
mod joint_reaction;
mod laws_without_numbers;
mod muscle_fatigue;
mod muscles;
mod no_chatter;
mod no_hidden_state;
mod out_of_reach;
mod passive_curves;
mod path_tension;
mod relax;
mod repeats;
mod send_and_sync;
mod simulation;
mod stability;
mod static_optimisation;
mod statics;
mod support;
mod tasks;
mod three_axis_joints;
mod tracking;
mod trees;
mod whole_adult;
