//! Every scenario of the repository from its start to its end: every sample is in equilibrium, and the run gives the same bytes when it is continued
//! from any snapshot (of two long ones: from those of the first minutes and the last one), by any number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};

use contrapposto::simulation::{Run, RunSettings, Scenario};

use crate::common::runs::{Course, courses};
use crate::common::samples::digest;

/// Long runs that are repeated from the marks of this time only, s, and from the last one: the rest of them repeats what `stand-shifting` shows in
/// an hour.
const CUT: [(&str, f64); 2] = [("counter.toml", 300.0), ("sit-slumped.toml", 1000.0)];

/// In every sample of every scenario: forces on the root are zero, torques add up, feet stay, ground only pushes, within its
/// friction and inside the patch.
#[test]
fn every_sample_is_in_equilibrium() {
    for course in courses().iter().filter(|course| !course.scenario.supports.is_empty()) {
        course.worst.is_held(&course.name);
        assert!(course.worst.slip < 1.0, "{}", course.name); // less than a result warns of
    }
}

impl Course {
    /// The marks from which the run is repeated.
    fn repeated_marks(&self) -> Vec<usize> {
        let last = self.marks.len() - 1;
        let end = CUT.iter().find(|(cut, _)| *cut == self.name).map_or(f64::INFINITY, |(_, end)| *end);
        assert!(end.is_infinite() || self.scenario.run.duration > end, "{} need not be cut", self.name);
        let time = |mark: usize| self.marks[mark].samples as f64 * self.scenario.run.step;
        (0..=last).filter(|&mark| mark == last || time(mark) < end).collect()
    }

    /// From a mark the run comes to the next one, or to the end, in the same way and to the same state: what holds for every
    /// mark holds from each of them to the end.
    fn is_repeated_from(&self, mark: usize, scenario: &Scenario) {
        let first = self.marks[mark].samples as usize;
        let next = self.marks.get(mark + 1);
        // A mark is set by the sample after it.
        let last = next.map_or(self.shown.len(), |next| next.samples as usize + 1);
        let mut again = Run::resume(scenario, self.marks[mark].clone()).unwrap();
        for (i, &shown) in self.shown.iter().enumerate().take(last).skip(first) {
            let sample = again.next_sample().unwrap().unwrap();
            assert!(digest(&sample) == shown, "{}: sample {i} from mark {mark} is another one", scenario.title);
        }
        match next {
            Some(next) => assert!(again.snapshot() == next, "{}: mark {mark} leads elsewhere", scenario.title),
            None => {
                assert!(again.next_sample().unwrap().is_none());
                assert_eq!(again.summary(), self.summary);
            }
        }
    }
}

fn with_threads(scenario: &Scenario, threads: usize) -> Scenario {
    Scenario { run: RunSettings { threads, ..scenario.run }, ..scenario.clone() }
}

/// Alone from start to end, then from every mark to the next one: every third mark by two threads, every third by three, by
/// eight; and each start by as many threads for its search.
#[test]
fn every_run_is_the_same_from_every_mark_and_for_any_number_of_threads() {
    let courses = courses();
    for Course { scenario, shown, marks, .. } in courses {
        println!("{}: {} samples, {} marks", scenario.title, shown.len(), marks.len());
        assert!(marks.len() >= 3 || !scenario.has_supports_or_tasks(), "no share for each number of threads");
    }
    for (share, threads) in [2, 3, 8].into_iter().enumerate() {
        let mut pieces = vec![];
        let threaded: Vec<Scenario> = courses.iter().map(|course| with_threads(&course.scenario, threads)).collect();
        for (of_all, (scenario, course)) in threaded.iter().zip(courses).enumerate() {
            if of_all % 3 == share {
                let begun = Run::new(scenario).unwrap();
                assert!(begun.snapshot() == &course.marks[0], "{}: {threads} threads begin elsewhere", scenario.title);
            }
            let marks = course.repeated_marks();
            let of_share = |(i, _): &(usize, usize)| marks.len() < 3 || i % 3 == share;
            pieces.extend(marks.iter().copied().enumerate().filter(of_share).map(|(_, mark)| (course, mark, scenario)));
        }
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some((course, mark, scenario)) = pieces.get(next.fetch_add(1, Ordering::Relaxed)) {
                course.is_repeated_from(*mark, scenario);
            }
        };
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
        println!("{threads} threads: {} pieces the same", pieces.len());
    }
}
