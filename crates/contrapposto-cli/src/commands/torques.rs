//! `contrapposto torques`: external, passive and active torque of every coordinate, at rest or in motion.

use std::path::Path;

use contrapposto::assessment::acceleration;
use contrapposto::dynamics::Inertia;
use contrapposto::joint_torques::{
    JointMuscles, JointReactions, JointTorques, JointTorquesError, MuscleWork, Quantities,
};
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::statics::Load;
use contrapposto_formats::loads::GroundReaction;
use contrapposto_formats::tissue::SourcedModel;

use crate::args::TorquesArgs;
use crate::fail::Fail;
use crate::model_file::open_with_muscles;
use crate::motion_file::{cut, loads_of, note_values_out_of_range, read_whole_motion};
use crate::moving::{Recorded, fast_motion, keep_overlap};
use crate::output::{Folder, Pending, folder_and_name, print_note};
use crate::view::muscle_work::reacted;
use crate::view::residual::Residual;
use crate::view::text::torques::{self as text, Columns};
use crate::view::torque_rows::{Frame, MusclesOfFrame, Order};

/// Model, frames and loads of the command.
struct Job {
    opened: SourcedModel,
    muscles: Option<JointMuscles>,
    recorded: Recorded,
    loads: Vec<Load>,
    ground: Option<GroundReaction>,
    gradient: bool,
    /// Whether single muscles and forces of joints are shown: in JSON, and of one frame.
    single_muscles: bool,
}

pub(crate) fn torques(args: &TorquesArgs) -> Result<(), Fail> {
    if args.model.model == Path::new("-") && args.postures == Path::new("-") {
        return Err(Fail::Refused("standard input is one file: MODEL or POSTURES, not both".to_owned()));
    }
    let target = args.out.as_deref().map(Target::new).transpose()?;
    let (mut opened, muscles, _) = open_with_muscles(&args.model, args.muscles.asked())?;
    let muscles = args.muscles.sharing.of(muscles);
    let mut notes = std::mem::take(&mut opened.notes);
    let model = &opened.model;
    let mut recorded = recorded(args, model, &mut notes)?;
    let (loads, ground) = loads_of(&args.under, model, &recorded.frames, &mut notes)?;
    keep_overlap(&mut recorded, ground.as_ref())?;
    let warnings = note_values_out_of_range(&opened, &recorded.frames, &mut notes);
    let of_forces: Vec<String> = ground.iter().flat_map(|ground| ground.doubts(model, &recorded.frames)).collect();
    of_forces.iter().chain(&recorded.doubts).chain(&warnings).for_each(|warning| print_note("warning", warning));
    let to_json = matches!(&target, Some(Target { form: Form::Json, .. }));
    let single_muscles = args.json || to_json || recorded.frames.len() == 1;
    let job = Job { opened, muscles, recorded, loads, ground, gradient: args.gradient, single_muscles };
    job.check()?;
    job.recorded.said.iter().for_each(|said| print_note("note", said));
    notes.iter().for_each(|note| print_note("note", note));

    let order = Order::new(&job.opened.model);
    let mut residual = Residual::new(&job.opened.model);
    if let Some(target) = target {
        let mut file = target.begin()?;
        let mut sink = |text: &str| file.append(text.as_bytes());
        match target.form {
            Form::Json => json(&job, &order, &mut residual, &mut sink)?,
            Form::Table(separator) => table(&job, &order, separator, &mut residual, &mut sink)?,
        }
        target.folder.commit(vec![file])?;
        residual = Residual::new(&job.opened.model);
    }
    let mut out = Printed::default();
    let mut sink = |text: &str| out.append(text);
    match (&args.out, job.recorded.frames.as_slice()) {
        _ if args.json => json(&job, &order, &mut residual, &mut sink)?,
        (_, [_]) => {
            job.run(&order, &mut residual, |_, frame| sink(&text::readable(&job.opened.model, &order, frame)))?
        }
        (Some(path), frames) => {
            job.run(&order, &mut residual, |_, _| Ok(()))?;
            sink(&format!("{} instants in {}\n", frames.len(), path.display()))?;
        }
        (None, _) => table(&job, &order, ',', &mut residual, &mut sink)?,
    }
    out.finish()?;
    if let Some((kind, text)) = residual.message(&job.opened.model, job.ground.is_some()) {
        print_note(kind, &text);
    }
    Ok(())
}

/// The motion, and whether its inertia counts.
fn recorded(args: &TorquesArgs, model: &Model, notes: &mut Vec<String>) -> Result<Recorded, Fail> {
    if args.postures == Path::new("default") {
        return match args.dynamics.dynamics {
            true => Err(Fail::Refused("--dynamics needs a motion; `default` is one posture".to_owned())),
            false => Ok(Recorded::at_rest(vec![(0.0, model.default_posture())])),
        };
    }
    let accepted = "POSTURES is a .mot, .sto or .csv file, or `default`";
    let span = &args.under.frames;
    let all = read_whole_motion(&args.postures, accepted, span, model, notes)?;
    let name = args.postures.display().to_string();
    if args.gradient {
        return Ok(Recorded::at_rest(cut(&name, all, span)?));
    }
    Recorded::new(&name, all, (&args.dynamics, span), model)
}

fn json(
    job: &Job,
    order: &Order,
    residual: &mut Residual,
    sink: &mut dyn FnMut(&str) -> Result<(), Fail>,
) -> Result<(), Fail> {
    sink("[")?;
    let mut before = "\n";
    job.run(order, residual, |opened, frame| {
        let text = serde_json::to_string(&text::json(opened, order, frame));
        sink(std::mem::replace(&mut before, ",\n"))?;
        sink(&text.map_err(|error| Fail::job("JSON", error))?)
    })?;
    sink("\n]\n")
}

fn table(
    job: &Job,
    order: &Order,
    separator: char,
    residual: &mut Residual,
    sink: &mut dyn FnMut(&str) -> Result<(), Fail>,
) -> Result<(), Fail> {
    let columns = Columns { gradient: job.gradient, inertia: job.recorded.said.as_deref() };
    sink(&text::header(&job.opened.model, order, job.recorded.frames.len(), separator, columns))?;
    job.run(order, residual, |_, frame| sink(&text::row(order, frame, separator)))
}

impl Job {
    fn body(&self) -> JointTorques {
        JointTorques::with_passive_ranges(&self.opened.model, &self.opened.passive_ranges())
            .with_muscles(self.muscles.clone())
    }

    /// Checks all frames before the first one is printed, and warns of a fast motion.
    fn check(&self) -> Result<(), Fail> {
        let mut body = self.body();
        let mut centers = vec![];
        let quantities = Quantities { passive_torque: true, ..Quantities::default() };
        for (time, posture) in &self.recorded.frames {
            body.update(&self.opened.model, posture, &[], quantities)
                .map_err(|why| Fail::Refused(format!("at {time} s: {why}")))?;
            centers.extend(body.kinematics().center_of_mass(&self.opened.model));
        }
        if self.recorded.rates.is_empty()
            && let Some(warning) = fast_motion(acceleration(&self.recorded.frames, &centers))
        {
            print_note("warning", &warning);
        }
        Ok(())
    }

    /// Computes frame after frame; `visit` gets the model with the strength of the posture, too.
    fn run(
        &self,
        order: &Order,
        residual: &mut Residual,
        mut visit: impl FnMut(&SourcedModel, &Frame<'_>) -> Result<(), Fail>,
    ) -> Result<(), Fail> {
        let model = &self.opened.model;
        let mut posed = self.opened.clone();
        let mut body = self.body();
        let quantities = Quantities { gradient: self.gradient, ..Quantities::TORQUES };
        let mut loads = vec![];
        let mut inertia = Inertia::new(model);
        let mut muscles =
            self.muscles.as_ref().filter(|_| self.single_muscles).and_then(|of| SingleMuscles::new(model, of));
        for (index, (time, posture)) in self.recorded.frames.iter().enumerate() {
            let failed = |why: JointTorquesError| Fail::Refused(format!("at {time} s: {why}"));
            body.place(model, posture).map_err(|error| failed(error.into()))?;
            loads.clone_from(&self.loads);
            if let Some(ground) = &self.ground {
                ground.loads(*time, model, body.kinematics(), &mut loads);
            }
            let rates = self.recorded.rates.get(index);
            if let Some(rates) = rates {
                let given = (rates.speeds.as_slice(), rates.accelerations.as_slice());
                let update = inertia.update(model, body.kinematics(), given, &loads);
                update.map_err(|why| Fail::Refused(format!("at {time} s: {why}")))?;
                body.apply_moving(model, &loads, &inertia, quantities).map_err(failed)?;
            } else {
                body.apply(model, &loads, quantities).map_err(failed)?;
            }
            if let Some(muscles) = body.muscles() {
                muscles.write_strength(&mut posed.model);
            }
            let mut frame = Frame::new(&body, &posed.model, order, (index, *time));
            if rates.is_some() {
                frame = frame.with_inertia(&inertia, model, order);
            }
            if self.gradient {
                frame = frame.with_gradient(body.gradient(), order);
            }
            if let Some(muscles) = &mut muscles {
                let found = muscles.of_frame(model, posture, &body);
                frame.muscles = Some(found.map_err(|why| Fail::Refused(format!("at {time} s: {why}")))?);
            }
            residual.record(&frame);
            visit(&posed, &frame)?;
        }
        Ok(())
    }
}

/// Single muscles, and the forces of the joints that they cross.
struct SingleMuscles {
    work: MuscleWork,
    reactions: JointReactions,
}

impl SingleMuscles {
    /// Of a body whose muscles give joints their strength.
    fn new(model: &Model, muscles: &JointMuscles) -> Option<Self> {
        let work = MuscleWork::new(model, muscles)?;
        Some(Self { reactions: JointReactions::new(model, muscles.musculature()), work })
    }

    fn of_frame(&mut self, model: &Model, posture: &Posture, body: &JointTorques) -> Result<MusclesOfFrame, String> {
        let active = model.coordinates().iter().map(|of| of.rate.map_or(0.0, |rate| body.active_torque()[rate]));
        self.work.update(model, posture, &active.collect::<Vec<_>>()).map_err(|why| why.to_string())?;
        let reactions = reacted(model, &self.work, body.loads(), &mut self.reactions);
        let muscles = &self.work.muscles().musculature().muscles;
        let tensions = muscles.iter().zip(self.work.tensions());
        Ok(MusclesOfFrame {
            tensions: tensions.map(|(muscle, tension)| (muscle.spec().name.clone(), *tension)).collect(),
            lack: self.work.missing(model).map(|of| (model.coordinates()[of.coordinate].name.clone(), of.torque)),
            reactions: reactions.map_err(|why| why.to_string())?,
        })
    }
}

/// A file for the results.
struct Target {
    folder: Folder,
    name: String,
    form: Form,
}

enum Form {
    Json,
    /// Cells apart by commas, or by tabs under OpenSim's header.
    Table(char),
}

impl Target {
    fn new(path: &Path) -> Result<Self, Fail> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let form = match ending.as_deref() {
            Some("csv") => Form::Table(','),
            Some("sto" | "mot") => Form::Table('\t'),
            Some("json") => Form::Json,
            _ => {
                let shown = path.display();
                return Err(Fail::Refused(format!("--out {shown}: the name must end in .csv, .sto, .mot or .json")));
            }
        };
        let (folder, name) = folder_and_name(path)?;
        Ok(Self { folder: Folder::open(&folder)?, name, form })
    }

    fn begin(&self) -> Result<Pending, Fail> {
        self.folder.begin(&self.name)
    }
}

/// Standard output, in pieces of some size.
#[derive(Default)]
struct Printed {
    waiting: String,
}

impl Printed {
    const PIECE: usize = 1 << 16;

    fn append(&mut self, text: &str) -> Result<(), Fail> {
        self.waiting.push_str(text);
        if self.waiting.len() >= Self::PIECE {
            crate::output::print(&self.waiting)?;
            self.waiting.clear();
        }
        Ok(())
    }

    fn finish(self) -> Result<(), Fail> {
        crate::output::print(&self.waiting)
    }
}
