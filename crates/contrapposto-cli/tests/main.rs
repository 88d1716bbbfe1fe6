//! All tests of the program from outside: one program, which is linked once and keeps all cores busy.

#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a test that cannot go on says where, and prints its seed"
)]
#![allow(unreachable_pub, reason = "nothing uses a test from outside")]

mod advice;
mod assess;
mod attacks;
mod c3d;
mod capacity;
mod compare;
mod cycles;
mod doubts;
mod figures;
mod first_line;
mod gltf_validator;
mod inspect;
mod minimize;
mod muscle;
mod muscle_hold;
mod muscle_work;
mod muscles;
#[rustfmt::skip] // as its author left it
mod oracle;
mod out_of_reach;
mod own_export;
mod passive;
mod phone;
mod population;
mod pose;
#[cfg(target_os = "linux")]
mod power_loss;
mod readme;
mod relax;
mod relax_muscles;
mod repeats;
mod report;
mod result_sets;
mod rigs;
mod robots;
mod scale;
mod simulate;
mod skin;
mod stored_numbers;
mod studio;
mod support;
mod sweep;
mod torques;
mod track;
