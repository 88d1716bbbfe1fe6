//! Holds a session: requests and answers as JSON, and the job that was opened last.

use crate::HAS_ALL;
use crate::document::{Document, FIRST};
use crate::error::Refusal;
use crate::job::Job;
use crate::message::{Answer, Request};
use crate::skin;

/// The scenario of a model file that is opened on its own; the name stands for `{}`.
const OF_MODEL: &str = "format = 1\ntitle = \"{}\"\n[model]\nfile = \"{}\"\n[[task]]\nkind = \"effort\"\n";

/// A session.
#[derive(Debug, Default)]
pub struct Studio {
    job: Option<Job>,
    /// The file of the skin.
    skin: Option<Vec<u8>>,
    /// The chart library of a report.
    charts: Option<String>,
}

impl Studio {
    /// A session without a body; every request before the first scenario opens a standing adult.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the bytes of the file of the skin, which the request `skin` needs.
    pub fn take_skin(&mut self, file: Vec<u8>) {
        self.skin = Some(file);
    }

    /// Takes the text of the chart library, which the request `report` needs.
    pub fn take_charts(&mut self, text: String) {
        self.charts = Some(text);
    }

    /// Answers a request; both are JSON. A request that is refused changes nothing.
    pub fn call(&mut self, request: &str) -> String {
        self.call_watched(request, &mut |_| ())
    }

    /// The same; `watch` is told how many postures a search of `relax` has sought so far.
    pub fn call_watched(&mut self, request: &str, watch: &mut dyn FnMut(usize)) -> String {
        let answer = serde_json::from_str(request)
            .map_err(|error| Refusal(format!("the request cannot be read: {error}")))
            .and_then(|request| self.answer(request, watch))
            .unwrap_or_else(|Refusal(sentence)| Answer::Refused { sentence });
        // An answer is made of numbers and texts, which JSON can always hold.
        serde_json::to_string(&answer).unwrap_or_default()
    }

    fn answer(&mut self, request: Request, watch: &mut dyn FnMut(usize)) -> Result<Answer, Refusal> {
        match request {
            Request::Open { scenario, files } => {
                let text = if scenario.trim().is_empty() { FIRST } else { &scenario };
                if !HAS_ALL && crate::body::has_model_file(text)? {
                    return Ok(Answer::Elsewhere { state: String::new(), course: None, samples: 0 });
                }
                crate::body::check(text, &files)?;
                self.open(Document::new(text, files)?)
            }
            Request::OpenModel { .. } if !HAS_ALL => {
                Ok(Answer::Elsewhere { state: String::new(), course: None, samples: 0 })
            }
            Request::OpenModel { name, text } => {
                let scenario = OF_MODEL.replace("{}", &name.replace(['"', '\\'], "_"));
                self.open(Document::new(&scenario, [(name, text)].into())?)
            }
            request => {
                if self.job.is_none() {
                    self.open(Document::new(FIRST, Default::default())?)?;
                }
                let job = self.job.as_mut().ok_or_else(|| Refusal::of("no scenario is open"))?;
                let skin = self.skin.as_deref();
                match request {
                    Request::Skin {} => {
                        let file = skin.ok_or_else(|| Refusal::of("the skin has not been loaded"))?;
                        Ok(Answer::Skin { skin: skin::scene(job.model(), file) })
                    }
                    Request::Gltf { .. } | Request::Bvh { .. } | Request::Report {} if !HAS_ALL => job.elsewhere(),
                    Request::Gltf { wooden, course } => job.gltf(if wooden { None } else { skin }, course),
                    Request::Report {} => {
                        let charts = self.charts.as_deref();
                        job.report(skin, charts.ok_or_else(|| Refusal::of("the chart library has not been loaded"))?)
                    }
                    request => job.answer(request, watch),
                }
            }
        }
    }

    fn open(&mut self, document: Document) -> Result<Answer, Refusal> {
        let mut job = Job::new(document)?;
        let scene = job.scene()?;
        self.job = Some(job);
        Ok(scene)
    }
}
