//! `contrapposto inspect`: what is in a model, what was ignored, and how far every number can be trusted.

use crate::args::InspectArgs;
use crate::fail::Fail;
use crate::model_file::open;
use crate::output::{json_text, print};
use crate::view::text::inspect::{readable, report};

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Fail> {
    let opened = open(&args.model, true)?;
    let file = args.model.model.display().to_string();
    if args.json {
        let text = report(&opened, &file);
        return print(&json_text("JSON", &text)?);
    }
    print(&readable(&opened, &file))
}
