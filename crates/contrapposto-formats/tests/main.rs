//! All tests of readers, writers, scenarios and answers from outside: one program, which is linked once and keeps all cores busy.

#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a test that cannot go on says where, and prints its seed"
)]
#![allow(unreachable_pub, reason = "nothing uses a test from outside")]

mod answers;
mod attacks;
mod batch;
mod c3d;
mod capacity;
mod capacity_of_muscles;
mod clearance;
mod common;
mod couplings;
mod effort;
mod effort_slsqp;
mod error_keys;
mod events;
mod expression;
mod fatigue;
mod force_plates;
mod fuzz_seeds;
mod gltf;
mod ground_reaction;
mod hanging_arms;
mod heel;
mod hip_tracts;
mod holding_times;
mod idle_arms;
mod inertia;
mod joint_reactions;
mod largest_inputs;
mod largest_inputs_of_motion;
mod least_effort;
mod markers;
mod mirror_images;
mod mjcf;
mod motion;
mod motor_strength;
mod muscles;
mod muscles_in_scenarios;
mod muscles_tire;
mod myo_sim;
mod odd_numbers;
mod osim;
mod osim_refused;
mod overlay;
mod person;
mod pose;
mod postures;
mod quiet_standing;
mod relaxed_moments;
mod rests;
mod rigs;
mod robots;
mod scaling;
mod scenario;
mod shoulder_rhythm;
mod soles;
mod springs;
mod standing;
mod suggestions;
mod surfaces;
mod sweep_plan;
mod tendons;
mod two_ways;
mod upright;
mod urdf;
mod vectors;
mod verdict;
mod whole_runs;
mod world;
mod worlds;
mod wraps;
mod write;
mod xml;
