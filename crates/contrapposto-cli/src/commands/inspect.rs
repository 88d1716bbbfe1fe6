//! `contrapposto inspect`: the contents of a model, its ignored parts, and the source of every number.

use crate::args::InspectArgs;
use crate::fail::Fail;
use crate::model_file::open;
use crate::output::{json_text, print};
use crate::view::text::inspect::{readable, report};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Fail> {
    let opened = open(&args.model, true)?.with_fatigue(&args.fatigue.choice()?);
    let file = args.model.model.display().to_string();
    if args.json {
        let text = report(&opened, &file);
        return print(&json_text("JSON", &text)?);
    }
    print(&readable(&opened, &file))
}
