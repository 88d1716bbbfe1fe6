//! Arguments of commands that count the inertia of a motion.

use clap::ValueEnum;
use contrapposto::dynamics::{PUBLISHED_CUTOFF, Smoothing};

/// Whether inertia counts, and the filter of the motion then.
#[derive(Debug, clap::Args)]
pub(crate) struct DynamicsArgs {
    /// Count inertia: the motion is filtered, its splines give speeds and accelerations, as OpenSim's inverse dynamics makes them. Without
    /// this and --static, inertia counts where the centre of mass accelerates by more than 1 m/s2, a tenth of gravity, in more than
    /// 5 percent of the time.
    #[arg(long, conflicts_with = "at_rest")]
    pub(crate) dynamics: bool,
    /// Leave inertia out: each posture is held at rest, and no motion is filtered.
    #[arg(long = "static")]
    pub(crate) at_rest: bool,
    /// Cut-off of the low-pass filter of the motion, Hz; `none` for no filter; `auto` for the one that residual analysis suggests.
    #[arg(long, value_name = "HZ", value_parser = cutoff, default_value_t = CutOff::Hertz(PUBLISHED_CUTOFF), conflicts_with = "at_rest")]
    pub(crate) cutoff_hz: CutOff,
    /// The low-pass filter of the motion.
    #[arg(long, value_enum, default_value = "opensim", conflicts_with = "at_rest")]
    pub(crate) filter: FilterChoice,
}

/// A low-pass filter that shifts nothing in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FilterChoice {
    /// OpenSim's: Butterworth, third order, forward and backward, of samples padded by half of their number.
    Opensim,
    /// Butterworth, second order, forward and backward as scipy's filtfilt.
    Filtfilt,
}

/// A cut-off, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CutOff {
    Hertz(f64),
    /// By residual analysis.
    Auto,
    None,
}

impl std::fmt::Display for CutOff {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Hertz(hertz) => write!(f, "{hertz}"),
            Self::Auto => f.write_str("auto"),
            Self::None => f.write_str("none"),
        }
    }
}

impl DynamicsArgs {
    /// The filter with a cut-off, Hz.
    pub(crate) fn smoothing(&self, cutoff: f64) -> Smoothing {
        match self.filter {
            FilterChoice::Opensim => Smoothing::OpenSim(cutoff),
            FilterChoice::Filtfilt => Smoothing::Filtfilt(cutoff),
        }
    }
}

fn cutoff(text: &str) -> Result<CutOff, String> {
    match text {
        "none" => return Ok(CutOff::None),
        "auto" => return Ok(CutOff::Auto),
        _ => {}
    }
    let hertz = text.parse().ok().filter(|hertz: &f64| hertz.is_finite() && *hertz > 0.0);
    hertz.map(CutOff::Hertz).ok_or_else(|| "a cut-off is a number of Hz above 0, `auto` or `none`".to_owned())
}
