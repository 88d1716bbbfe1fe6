//! Arguments of commands that count the inertia of a motion.

use clap::ValueEnum;
use contrapposto::dynamics::{PUBLISHED_CUTOFF, Smoothing};

/// Whether inertia counts, and the filter of the motion then.
#[derive(Debug, clap::Args)]
pub(crate) struct DynamicsArgs {
    /// Count inertia: the motion is filtered, its splines give speeds and accelerations, as OpenSim's inverse dynamics makes them. Without
    /// this and --static, inertia counts where the centre of mass accelerates by more than 1 m/s2, a tenth of gravity, in more than
    /// 5 percent of the frames.
    #[arg(long, conflicts_with = "at_rest")]
    pub(crate) dynamics: bool,
    /// Leave inertia out: each posture is held at rest, and no motion is filtered.
    #[arg(long = "static")]
    pub(crate) at_rest: bool,
    /// Cut-off of the low-pass filter of the motion, Hz; `none` for no filter.
    #[arg(long, value_name = "HZ", value_parser = cutoff, default_value_t = CutOff(Some(PUBLISHED_CUTOFF)), conflicts_with = "at_rest")]
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

/// A cut-off in Hz, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutOff(pub(crate) Option<f64>);

impl std::fmt::Display for CutOff {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some(hertz) => write!(f, "{hertz}"),
            None => f.write_str("none"),
        }
    }
}

impl DynamicsArgs {
    pub(crate) fn smoothing(&self) -> Smoothing {
        match (self.cutoff_hz.0, self.filter) {
            (None, _) => Smoothing::None,
            (Some(cutoff), FilterChoice::Opensim) => Smoothing::OpenSim(cutoff),
            (Some(cutoff), FilterChoice::Filtfilt) => Smoothing::Filtfilt(cutoff),
        }
    }
}

fn cutoff(text: &str) -> Result<CutOff, String> {
    if text == "none" {
        return Ok(CutOff(None));
    }
    let hertz = text.parse().ok().filter(|hertz: &f64| hertz.is_finite() && *hertz > 0.0);
    hertz.map(|hertz| CutOff(Some(hertz))).ok_or_else(|| "a cut-off is a number of Hz above 0, or `none`".to_owned())
}
