//! Runs the science inside a browser: one session, which takes requests as JSON texts and answers them as JSON texts.
//!
//! A session holds a scenario as a document (`document.rs`). Everything that it shows is computed from what the readers of
//! `contrapposto-formats` make of that document, so an exported scenario is the one that was shown. The same calls can be made natively:
//! [`Studio`] has no part of the browser in it.
//!
//! | File | Holds |
//! |---|---|
//! | `message` | requests and answers |
//! | `document`, `events` | the scenario file, its changes, the files that it names |
//! | `things`, `strategies` | tables of the file that put things there, and of strategies by region |
//! | `person` | the people that a size stands for |
//! | `history` | all states of the document, for undo and redo |
//! | `body` | what the readers make of the document |
//! | `mover` | steps of a posture: dragged, or settling |
//! | `figure` | a body in a posture, with its mover |
//! | `skin` | the mesh of the built-in adult |
//! | `shown` | everything that is shown of one posture |
//! | `balance` | the torques of one joint over its range |
//! | `drawn` | glTF and BVH |
//! | `recorded` | a motion of a file |
//! | `report` | report.html |
//! | `rest` | the different ways to rest |
//! | `sides` | left and right exchanged |
//! | `sample`, `play` | a run over time |
//! | `job`, `studio` | the session |

/// Whether the module has the readers of model files, and the writers of files for other programs.
pub(crate) const HAS_ALL: bool = cfg!(feature = "all");

mod balance;
mod body;
mod document;
mod drawn;
mod error;
mod events;
mod figure;
mod history;
mod job;
mod message;
mod mover;
mod person;
mod play;
mod recorded;
mod report;
mod rest;
mod sample;
mod shown;
mod sides;
mod skin;
mod strategies;
mod studio;
mod things;

use std::cell::RefCell;

use wasm_bindgen::prelude::wasm_bindgen;

pub use studio::Studio;

thread_local! {
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_name = tellSought)]
    fn tell_sought(sought: u32);
}

/// A session of the page.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Session(Studio);

#[wasm_bindgen]
impl Session {
    /// A session with the body that a new page shows. A panic from then on is kept for [`last_panic`].
    #[wasm_bindgen(constructor)]
    #[allow(clippy::new_without_default, reason = "the constructor of a JavaScript class")]
    pub fn new() -> Self {
        std::panic::set_hook(Box::new(|panic| {
            LAST_PANIC.with(|last| *last.borrow_mut() = panic.to_string());
        }));
        Self(Studio::new())
    }

    /// Takes the bytes of the file of the skin, which the request `skin` needs.
    pub fn take_skin(&mut self, file: Vec<u8>) {
        self.0.take_skin(file);
    }

    /// Takes the text of the chart library, which the request `report` needs.
    pub fn take_charts(&mut self, text: String) {
        self.0.take_charts(text);
    }

    /// Answers a request; a search tells the function `tellSought` of the worker how many postures it has sought.
    pub fn call(&mut self, request: &str) -> String {
        self.0.call_watched(request, &mut |sought| tell_sought(u32::try_from(sought).unwrap_or(u32::MAX)))
    }
}

/// The message of the panic that ended the last call; empty without one. The module must not be used for anything else after a panic.
#[wasm_bindgen]
pub fn last_panic() -> String {
    LAST_PANIC.with(|last| last.borrow().clone())
}

/// Version of the program.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
