//! Files that an MJCF model includes: inside the model's own folder, or an `.xml` inside the folder above it, whatever names and links
//! say.

use std::path::{Component, Path};

use crate::fail::Fail;
use crate::input::read;

/// A reader of included files for the model at `main`; how many and how deep is the format's own business.
pub(crate) fn confined(main: &Path, most: u64) -> impl FnMut(&str) -> Result<Vec<u8>, String> + use<> {
    let parent = main.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = if main == Path::new("-") {
        Err("a model from standard input has no folder to include from".to_owned())
    } else {
        parent.canonicalize().map_err(|error| error.to_string())
    };
    move |name| {
        let folder = folder.as_ref().map_err(String::clone)?;
        let relative = Path::new(name);
        if !relative.components().all(|part| matches!(part, Component::Normal(_) | Component::ParentDir)) {
            return Err("it is no path relative to the model's folder".to_owned());
        }
        // Links are followed before the folder is compared: one that leads out is refused, whatever its name.
        let real = folder.join(relative).canonicalize().map_err(|error| error.to_string())?;
        // The root of the disk is no folder of models.
        let above = folder.parent().filter(|above| above.parent().is_some());
        let beside = || above.is_some_and(|above| real.starts_with(above));
        let xml = || real.extension().is_some_and(|ending| ending == "xml");
        if !(real.starts_with(folder) || beside() && xml()) {
            return Err("it leads out of the model's folder, and to no .xml in the folder above".to_owned());
        }
        read(&real, most).map_err(|fail| match fail {
            Fail::Refused(why) => why,
            _ => "it cannot be read".to_owned(),
        })
    }
}
