//! Gives the scenarios of the repository that need no other file.

/// Name and text of each of the named files in the folder `scenarios`.
macro_rules! texts {
    ($($name:literal),* $(,)?) => {
        &[$(($name, scenario!($name))),*]
    };
}

/// Name and text (TOML) of each scenario, by name.
pub const EXAMPLES: &[(&str, &str)] = texts![
    "bus-stop",
    "chatter",
    "counter",
    "crouch",
    "figure-01",
    "figure-07",
    "figure-08",
    "figure-09",
    "figure-10",
    "figure-11",
    "figure-12",
    "figure-13",
    "figure-14",
    "hold-tool",
    "lean-on-table",
    "lift-box",
    "low-table",
    "overhead",
    "push",
    "reach-floor",
    "screw-overhead",
    "sit-and-type",
    "sit-slumped",
    "stand-ready",
    "stand-relaxed",
    "stand-relaxed-feet-fixed",
    "stand-shifting",
];
