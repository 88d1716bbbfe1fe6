//! Arguments of scaling.

use std::path::PathBuf;

use clap::Parser;
use contrapposto_formats::markers::Measurement;

use super::track::UnitChoice;

#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  contrapposto scale gait2392.osim static.trc --setup Setup_Scale.xml --out subject.osim\n  \
    contrapposto scale model.osim static.trc --measure thigh=R.ASIS,R.Knee:femur_r --measure pelvis=R.ASIS,L.ASIS:pelvis:Z \
    --mass 72.6 --place-markers --out subject.osim\n  \
    contrapposto track subject.osim walk.trc --tasks Setup_IK.xml --out tracked\n\n\
    The model's own file is scaled as OpenSim 4.6 does it: masses, inertia, frames, markers, meshes, paths of muscles with their surfaces, \
    and lengths of fibres and tendons by the length of their path. All other parts stay as they are."
)]
pub(crate) struct ScaleArgs {
    /// Model file of OpenSim 4 (.osim).
    pub(crate) model: PathBuf,
    /// Measured markers of a person who stands still (.trc, .c3d).
    pub(crate) markers: PathBuf,
    /// Setup file of OpenSim's ScaleTool (.xml): measurements, factors given by hand, the person's mass, and the tasks that place markers.
    #[arg(long, value_name = "SETUP.xml")]
    pub(crate) setup: Option<PathBuf>,
    /// A measurement, `NAME=MARKER,MARKER:BODY,BODY:XYZ`: the distance of two markers (more pairs after a semicolon: their mean) gives the factor of
    /// bodies along axes. May be repeated; comes after those of a setup file.
    #[arg(long, value_name = "NAME=M,M:BODY:XYZ", value_parser = Measurement::parse)]
    pub(crate) measure: Vec<Measurement>,
    /// Mass of the person, kg; as the setup file says when left out.
    #[arg(long, value_name = "KG")]
    pub(crate) mass: Option<f64>,
    /// Masses of bodies keep their proportions; without it, and where no setup file says so, they grow with the volumes.
    #[arg(long)]
    pub(crate) preserve_mass_distribution: bool,
    /// Track the static posture and move the markers of the model onto the measured ones, as a setup file with a MarkerPlacer does.
    #[arg(long)]
    pub(crate) place_markers: bool,
    /// Unit of the markers, whatever the file says.
    #[arg(long, value_enum)]
    pub(crate) units: Option<UnitChoice>,
    /// Begin of the times that are averaged, s; as the setup file says when left out.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// End of the times that are averaged, s; as the setup file says when left out.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// File to write (.osim).
    #[arg(long, value_name = "FILE.osim")]
    pub(crate) out: PathBuf,
}
