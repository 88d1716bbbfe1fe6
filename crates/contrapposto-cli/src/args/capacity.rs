//! Arguments of `contrapposto capacity`.

use std::path::PathBuf;

use clap::Parser;

use super::time::time;

#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  contrapposto capacity scenarios/push.toml --at hand_r --out out\n  \
    contrapposto capacity scenarios/hold-tool.toml --at hand_r --hold 2min --json\n\n\
    The force is the one that the body exerts, in 642 directions around the point, besides the loads of the scenario. The first line names \
    the weakest and the strongest direction and what limits them. The posture is the last one of a scenario with [run], and the posture of \
    `pose` of one without; everybody is rested. Writes capacity.json, report.html, capacity.csv and capacity.svg/.png into DIR. \
    Exit code 1 when the posture cannot be held without a force either.")]
pub(crate) struct CapacityArgs {
    /// Scenario file (TOML); `-` reads standard input.
    pub(crate) scenario: PathBuf,
    /// The segment that exerts the force, such as hand_r; `contrapposto inspect SCENARIO` lists all.
    #[arg(long, value_name = "SEGMENT")]
    pub(crate) at: String,
    /// Point of the force in the segment's frame, m; when left out the middle of the segment's patch (palm, sole), else its centre of mass.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub(crate) point: Option<[f64; 3]>,
    /// Time for which the force is held: 30s, 2min, 1.5h. Without it a force of an instant.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) hold: Option<f64>,
    /// Folder for the results; made if it is not there. Nothing is written without it.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print capacity.json instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Three numbers.
fn point(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse::<f64>()).collect();
    let numbers = numbers.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    let finite = numbers.filter(|numbers| numbers.iter().all(|number| number.abs() <= 1e3));
    finite.ok_or_else(|| "three numbers in m, each at most 1000 in size, such as 0,-0.07,0, are accepted".to_owned())
}

#[cfg(test)]
mod tests {
    use super::point;

    #[test]
    fn points_have_three_finite_numbers() {
        assert_eq!(point("0, -0.07,0").unwrap(), [0.0, -0.07, 0.0]);
        for wrong in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "a,b,c"] {
            assert!(point(wrong).is_err(), "{wrong}");
        }
    }
}
