//! `contrapposto new`: a commented scenario to begin with.

use std::io::{ErrorKind, Write};

use crate::args::{JobChoice, NewArgs};
use crate::fail::Fail;
use crate::output::print;

/// The scenario of a job.
fn template(job: JobChoice) -> &'static str {
    match job {
        JobChoice::Lift => include_str!("new/lift.toml"),
        JobChoice::Overhead => include_str!("new/overhead.toml"),
        JobChoice::Sit => include_str!("new/sit.toml"),
        JobChoice::Push => include_str!("new/push.toml"),
        JobChoice::Stand => include_str!("new/stand.toml"),
        JobChoice::Carry => include_str!("new/carry.toml"),
    }
}

pub(crate) fn new(args: &NewArgs) -> Result<(), Fail> {
    let name = args.out.display();
    let file = std::fs::OpenOptions::new().write(true).create_new(true).open(&args.out);
    let mut file = file.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Fail::Refused(format!("--out {name}: is there already; give another name")),
        _ => Fail::Refused(format!("--out {name}: {error}")),
    })?;
    file.write_all(template(args.job).as_bytes()).map_err(|error| Fail::job(&name, error))?;
    print(&format!(
        "{name} is written. Change it, look at it, run it:\n  contrapposto inspect {name}\n  contrapposto simulate {name} --out out\n"
    ))
}
