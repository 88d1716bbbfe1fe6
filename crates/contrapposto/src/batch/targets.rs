//! Solves one problem for each of many targets in several threads.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Solves every target in as many `threads` (0 counts as 1), each with a solver of its own, and answers the results in the order of the
/// targets. A thread that has finished a target takes the next one.
///
/// The results do not depend on the number of threads if `solve` gives the same result for a target whatever its solver has solved
/// before: [`crate::posture_solver::Engine::solve`] restarts the engine, searches and runs begin anew anyway.
///
/// ```
/// use contrapposto::batch;
/// use contrapposto::model::{Adult, adult};
/// use contrapposto::posture_solver::{Engine, Options};
/// use contrapposto::tasks::{Point, Task};
/// use nalgebra::Vector3;
///
/// // Three places for the right hand.
/// let model = adult(&Adult::right_arm())?;
/// let hand = model.segment("hand_r").unwrap();
/// let targets = [0.30, 0.35, 0.40].map(|x| Vector3::new(x, -0.30, 0.20));
/// let reach = Point { segment: hand, point: Vector3::zeros(), target: targets[0], axes: [true; 3] };
/// let engine = Engine::new(&model, vec![Task::Point(reach).into()], &[], Options::inverse_kinematics())?;
/// let start = model.default_posture();
/// let solved = batch::over(&targets, 2, || engine.clone(), |engine, target| {
///     engine.levels_mut()[0].tasks[0].retarget(*target);
///     engine.solve(&start)
/// });
/// assert_eq!(solved.len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn over<T: Sync, S, R: Send>(
    targets: &[T],
    threads: usize,
    solver: impl Fn() -> S + Sync,
    solve: impl Fn(&mut S, &T) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut solver, mut solved) = (solver(), vec![]);
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(target) = targets.get(i) else { return solved };
            solved.push((i, solve(&mut solver, target)));
        }
    };
    let threads = threads.clamp(1, targets.len().max(1));
    let mut solved = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut solved = work();
        let panicked = |panic| std::panic::resume_unwind(panic);
        others.into_iter().for_each(|other| solved.extend(other.join().unwrap_or_else(panicked)));
        solved
    });
    solved.sort_unstable_by_key(|(i, _)| *i);
    solved.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_targets_for_any_number_of_threads() {
        let targets: Vec<u64> = (0..100).collect();
        for threads in [0, 1, 2, 3, 8, 200] {
            let solved = over(
                &targets,
                threads,
                || 0u64,
                |count, target| {
                    *count += 1;
                    target * target
                },
            );
            assert!(solved.iter().zip(&targets).all(|(result, target)| *result == target * target));
            assert_eq!(solved.len(), targets.len());
        }
    }

    #[test]
    fn no_targets_give_no_results() {
        assert_eq!(over(&[], 4, || (), |(), target: &f64| *target), Vec::<f64>::new());
    }
}
