//! Names the numbers of a scenario, for errors.

/// A number of a scenario; prints as its name with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Number of free flags: one a coordinate.
    FreeFlags,
    /// Number of strategies: none, or one a coordinate.
    Strategies,
    /// Time of an event.
    EventTime,
    /// Number of the task that an event changes.
    EventTask,
    /// Number of fatigue pairs: one a coordinate.
    FatiguePairs,
    /// Fatigue of a muscle group at the start.
    StartFatigue,
    /// Least decrease ratio `R_min`.
    MinimumDecreaseRatio,
    /// Step gain `beta` of Eq. 9.
    StepGain,
    /// Greatest step `delta theta_max` of Eq. 9.
    MaxStep,
    /// Torque tolerance `eps`.
    TorqueTolerance,
    /// Greatest effort of the body, by the effort before all present reliefs.
    EffortFactor,
    /// Fatigue at which relief begins.
    CriticalLevel,
    /// Fatigue at which relief ends.
    RecoveryLevel,
    /// Simulated time.
    Duration,
    /// Time from one sample to the next.
    TimeStep,
    /// Duration in time steps.
    Steps,
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::FreeFlags => "number of free flags",
            Self::Strategies => "number of strategies",
            Self::EventTime => "time of an event (s)",
            Self::EventTask => "place of a task that an event changes",
            Self::FatiguePairs => "number of fatigue pairs",
            Self::StartFatigue => "fatigue at the start",
            Self::MinimumDecreaseRatio => "minimum decrease ratio",
            Self::StepGain => "step gain",
            Self::MaxStep => "greatest step (rad)",
            Self::TorqueTolerance => "torque tolerance (N m)",
            Self::EffortFactor => "effort factor",
            Self::CriticalLevel => "critical level",
            Self::RecoveryLevel => "recovery level",
            Self::Duration => "duration (s)",
            Self::TimeStep => "time step (s)",
            Self::Steps => "number of steps",
        })
    }
}
