//! One level: least squares over its rows in the null space of everything above, by active set.

use crate::factor::Entry;
use crate::linalg::{add_scaled, dot, norm};
use crate::problem::Problem;
use crate::solver::{INDEPENDENT, MULTIPLIER, ROUNDING, Role, Side, Solver};

/// The last digits of a value, as a share of its rounding.
const DIGITS: f64 = 1e-3;

impl Solver {
    /// Minimises level `k` and fixes what it reached. `false` if it did not come to an end.
    pub(crate) fn level(&mut self, problem: &Problem, k: usize) -> bool {
        let damped = problem.levels[k].damping > 0.0;
        self.choose_soft_rows(problem, k);
        'active_set: loop {
            let base = self.factor.len();
            self.factorise_level(problem, k);
            for attempt in 0..4 {
                self.solve_level(problem, k, base);
                if attempt == 3 || !self.level_moves(base, damped) {
                    break;
                }
                self.level_step(base, damped);
                let (share, block) = self.first_block(problem, k);
                self.advance(problem, share);
                let Some((entry, side)) = block else {
                    if self.is_where_expected(problem) {
                        break;
                    }
                    continue;
                };
                if !self.may_change() || !share.is_finite() {
                    return false;
                }
                self.factor.truncate(base);
                self.activate(problem, k, entry, side);
                continue 'active_set;
            }
            let Some(entry) = self.weigh(problem, k, base) else { break };
            if !self.may_change() {
                return false;
            }
            self.factor.truncate(base);
            match entry {
                Entry::Row(row) if self.roles[row] == Role::Soft => self.let_go(problem, row),
                _ => self.leave(problem, entry),
            }
        }
        self.fix(k);
        true
    }

    /// What blocked a step of level `k` becomes active.
    pub(crate) fn activate(&mut self, problem: &Problem, k: usize, entry: Entry, side: Side) {
        match entry {
            Entry::Bound(i) => {
                self.activate_bound(problem, i, side);
            }
            Entry::Row(row) if row >= self.offsets[k] => (self.roles[row], self.sides[row]) = (Role::Soft, side),
            Entry::Row(row) => {
                (self.roles[row], self.sides[row]) = (Role::Active, side);
                if !self.activate_row(problem, row) {
                    self.lay_aside(row);
                }
            }
        }
    }

    /// A soft row that pulls the wrong way has come past its side: it holds, or is now short of its other side.
    fn let_go(&mut self, problem: &Problem, row: usize) {
        let (k, i) = self.place(row);
        let (lower, upper) = (problem.levels[k].lower[i], problem.levels[k].upper[i]);
        let value = self.value(problem, row, &self.x);
        let rounding = self.rounding(row);
        (self.roles[row], self.sides[row]) = match self.sides[row] {
            Side::Lower if value > upper + rounding => (Role::Soft, Side::Upper),
            Side::Upper if value < lower - rounding => (Role::Soft, Side::Lower),
            _ => (Role::Out, Side::None),
        };
    }

    /// Equations, broken inequalities, and those that were active the last time.
    fn choose_soft_rows(&mut self, problem: &Problem, k: usize) {
        let level = &problem.levels[k];
        for i in 0..level.rows() {
            let row = self.offsets[k] + i;
            let (lower, upper) = (level.lower[i], level.upper[i]);
            if lower == upper {
                (self.roles[row], self.sides[row]) = (Role::Soft, Side::Both);
                continue;
            }
            let value = self.value(problem, row, &self.x);
            let rounding = self.rounding(row);
            self.sides[row] = match self.sides[row] {
                _ if value > upper + rounding => Side::Upper,
                _ if value < lower - rounding => Side::Lower,
                Side::Upper if upper.is_finite() => Side::Upper,
                Side::Lower if lower.is_finite() => Side::Lower,
                _ => Side::None,
            };
            self.roles[row] = if self.sides[row] == Side::None { Role::Out } else { Role::Soft };
        }
    }

    /// The value that a soft row aims at.
    fn aim(&self, problem: &Problem, row: usize) -> f64 {
        let (k, i) = self.place(row);
        if self.sides[row] == Side::Lower { problem.levels[k].lower[i] } else { problem.levels[k].upper[i] }
    }

    /// Turns the soft rows and appends the independent ones to the factor, the longest remainder first.
    fn factorise_level(&mut self, problem: &Problem, k: usize) {
        let n = problem.unknowns();
        let w = self.factor.width();
        let base = self.factor.len();
        let level = &problem.levels[k];
        self.soft.clear();
        self.soft.extend((self.offsets[k]..self.offsets[k + 1]).filter(|&row| self.roles[row] == Role::Soft));
        let c = self.factor.padded();
        self.turned.resize(self.soft.len() * c, 0.0);
        for (s, &row) in self.soft.iter().enumerate() {
            let i = row - self.offsets[k];
            let t = &mut self.turned[s * c..(s + 1) * c];
            self.factor.gather(&level.matrix[i * n..(i + 1) * n], t);
            self.factor.turn(t, 0, base);
        }
        self.left.clear();
        for (s, &row) in self.soft.iter().enumerate() {
            let left = norm(&self.turned[s * c + base..s * c + w]);
            let share = if self.is_something(row) { (left / self.norms[row]).powi(2) } else { 0.0 };
            self.left.push((share, share));
        }
        // Rows `..pivots` of `soft` and `turned` are in the factor; `left` is the share of each row beyond it, squared, and
        // what it was when it was last summed.
        for pivots in 0..self.soft.len() {
            let r = self.factor.len();
            let best = (pivots..self.soft.len())
                .fold(pivots, |best, s| if self.left[s].0 > self.left[best].0 { s } else { best });
            if r == w || self.left[best].0 <= INDEPENDENT * INDEPENDENT {
                break;
            }
            self.soft.swap(pivots, best);
            self.left.swap(pivots, best);
            let (head, tail) = self.turned.split_at_mut((pivots + 1) * c);
            if best > pivots {
                head[pivots * c..].swap_with_slice(&mut tail[(best - pivots - 1) * c..(best - pivots) * c]);
            }
            self.factor.append(&head[pivots * c..], Entry::Row(self.soft[pivots]));
            for (t, s) in tail.chunks_exact_mut(c).zip(pivots + 1..self.soft.len()) {
                let (share, summed) = &mut self.left[s];
                if *summed == 0.0 {
                    continue;
                }
                self.factor.turn(t, r, r + 1);
                let norm_of_row = self.norms[self.soft[s]];
                *share -= (t[r] / norm_of_row).powi(2);
                if *share < 1e-3 * *summed {
                    *share = (norm(&t[r + 1..w]) / norm_of_row).powi(2);
                    *summed = *share;
                }
            }
        }
    }

    /// The level's step in the directions that its rows reach, `y`.
    fn solve_level(&mut self, problem: &Problem, k: usize, base: usize) {
        let c = self.factor.padded();
        let level = &problem.levels[k];
        let rank = self.factor.len() - base;
        self.right.clear();
        for &row in &self.soft {
            let value = self.value(problem, row, &self.x);
            self.right.push(self.aim(problem, row) - value);
        }
        let rows = self.soft.len();
        if rows == rank && level.damping == 0.0 {
            self.factor.solve_lower(base, &self.right, &mut self.y);
            self.kept.clear();
            self.kept.resize(rows, 0.0);
        } else {
            let damped = if level.damping > 0.0 { rank } else { 0 };
            self.least.begin(rows + damped, rank);
            for s in 0..rows {
                if s < rank {
                    self.least.set(s, &self.factor.lower_row(base + s)[base..], self.right[s]);
                    self.least.set_entry(s, s, self.factor.diagonal(base + s));
                } else {
                    self.least.set(s, &self.turned[s * c + base..s * c + base + rank], self.right[s]);
                }
            }
            if level.damping > 0.0 {
                self.turned_x.resize(c, 0.0);
                self.factor.gather(&self.x, &mut self.turned_x);
                self.factor.turn(&mut self.turned_x, 0, base + rank);
            }
            for r in 0..damped {
                self.least.set(rows + r, &[], -level.damping * self.turned_x[base + r]);
                self.least.set_entry(rows + r, r, level.damping);
            }
            self.least.solve(&mut self.y);
            self.kept.clear();
            self.kept.extend(self.least.residual()[..rows].iter().map(|r| -r));
        }
    }

    /// The level's step by unknown. What its rows do not reach is only damped, all the way.
    fn level_step(&mut self, base: usize, damped: bool) {
        let (rank, w) = (self.factor.len() - base, self.factor.width());
        self.work.fill(0.0);
        self.work[base..base + rank].copy_from_slice(&self.y[..rank]);
        if damped {
            for (work, x) in self.work[base + rank..w].iter_mut().zip(&self.turned_x[base + rank..w]) {
                *work = -x;
            }
        }
        self.factor.turn_back(&mut self.work);
        self.scatter_step();
    }

    /// `work`, by free column, becomes `step`, by unknown.
    pub(crate) fn scatter_step(&mut self) {
        self.step.fill(0.0);
        for (c, &i) in self.factor.free.iter().enumerate() {
            if self.bounds[i] == Side::None {
                self.step[i] = self.work[c];
            }
        }
    }

    /// Would the step change any row by as much as [`Solver::is_where_expected`] notices (of a damped level by more than
    /// rounding), or what is only damped?
    fn level_moves(&self, base: usize, damped: bool) -> bool {
        let c = self.factor.padded();
        let rank = self.factor.len() - base;
        if damped && norm(&self.turned_x[base + rank..self.factor.width()]) > ROUNDING * self.length {
            return true;
        }
        let share = if damped { 1.0 } else { 0.1 };
        self.soft.iter().enumerate().any(|(s, &row)| {
            let change = if s < rank {
                dot(&self.factor.lower_row(base + s)[base..], &self.y[..s]) + self.factor.diagonal(base + s) * self.y[s]
            } else {
                dot(&self.turned[s * c + base..s * c + base + rank], &self.y[..rank])
            };
            change.abs() > share * self.rounding(row)
        })
    }

    /// Has a whole step left of each soft row what it should, up to rounding?
    fn is_where_expected(&self, problem: &Problem) -> bool {
        self.soft.iter().zip(&self.kept).all(|(&row, kept)| {
            let left = self.value(problem, row, &self.x) - self.aim(problem, row);
            10.0 * (left - kept).abs() <= self.rounding(row)
        })
    }

    /// A soft inequality that pulls the wrong way, the strongest one. Judged by what the least squares leave of it, which is
    /// right for light rows beside heavy ones; `nothing` is what counts as zero.
    fn wrong_soft_row(&self, nothing: f64) -> Option<usize> {
        let mut found: Option<(f64, usize)> = None;
        for (kept, &row) in self.kept.iter().zip(&self.soft) {
            let wrong = self.norms[row]
                * match self.sides[row] {
                    Side::Upper => -kept,
                    Side::Lower => *kept,
                    Side::Both | Side::None => continue,
                };
            let zero = if self.is_weary() { nothing } else { self.zero(row) };
            if wrong > zero && found.is_none_or(|(most, _)| wrong > most) {
                found = Some((wrong, row));
            }
        }
        found.map(|(_, row)| row)
    }

    /// What counts as zero in the pull of a soft row: beside heavy rows a light one still counts when it keeps more than its
    /// own rounding.
    fn zero(&self, row: usize) -> f64 {
        (MULTIPLIER * self.size).min(10.0 * self.rounding(row) * self.norms[row])
    }

    /// A row that only what is above can move, and that holds up to rounding, keeps nothing: rounding above made what it is
    /// off, and presses on nothing.
    fn forget_what_cannot_move(&mut self, base: usize) {
        let (rank, c) = (self.factor.len() - base, self.factor.padded());
        for s in rank..self.soft.len() {
            let row = self.soft[s];
            let own = &self.turned[s * c + base..s * c + base + rank];
            if self.kept[s].abs() <= self.rounding(row) && norm(own) <= INDEPENDENT * self.norms[row] {
                self.kept[s] = 0.0;
            }
        }
    }

    /// Multipliers of everything above. Answers an active bound or row that the level would rather leave.
    fn weigh(&mut self, problem: &Problem, k: usize, base: usize) -> Option<Entry> {
        let n = problem.unknowns();
        let level = &problem.levels[k];
        self.work.fill(0.0);
        self.gradient.fill(0.0);
        let damped = level.damping > 0.0;
        let square = level.damping * level.damping;
        self.forget_what_cannot_move(base);
        let parts = self.kept.iter().zip(&self.soft);
        self.size = parts.clone().map(|(kept, &row)| kept.abs() * self.norms[row]).sum();
        // A row of zeros keeps what nothing can change.
        let mut real =
            parts.clone().filter(|(kept, row)| kept.abs() > self.rounding(**row) && self.is_something(**row));
        if damped {
            // Rows keep as little as the damping asks for: all counts that is above the last digits of their values.
            let digits: f64 = self.soft.iter().map(|&row| DIGITS * self.rounding(row) * self.norms[row]).sum();
            self.size += square * norm(&self.x) + digits / MULTIPLIER;
        } else if real.next().is_none() {
            self.size = 0.0;
        }
        if self.size > 0.0 {
            if let Some(row) = self.wrong_soft_row(MULTIPLIER * self.size) {
                return Some(Entry::Row(row));
            }
            // What is turned is in the factor and beside it; the whole gradient is only asked where unknowns are left out.
            let (rank, c, left_out) = (self.factor.len() - base, self.factor.padded(), self.factor.width() < n);
            for (s, (kept, &row)) in self.kept.iter().zip(&self.soft).enumerate() {
                let turned = if s < rank { self.factor.lower_row(base + s) } else { &self.turned[s * c..s * c + base] };
                add_scaled(&mut self.work[..base], *kept, &turned[..base]);
                if left_out {
                    let i = row - self.offsets[k];
                    add_scaled(&mut self.gradient, *kept, &level.matrix[i * n..(i + 1) * n]);
                }
            }
        }
        if damped {
            add_scaled(&mut self.work[..base], square, &self.turned_x[..base]);
            add_scaled(&mut self.gradient, square, &self.x);
        }
        self.multiply(problem, k, base, self.size, !damped)
    }

    /// Multipliers of the first `base` entries and of the bounds, into the table, for the gradient in `work` (turned) and
    /// `gradient` (at the unknowns left out). Answers the active bound or
    /// row whose multiplier has the wrong sign, the worst one; otherwise notes (`hold`) which are needed from now on.
    pub(crate) fn multiply(
        &mut self,
        problem: &Problem,
        k: usize,
        base: usize,
        size: f64,
        hold: bool,
    ) -> Option<Entry> {
        let n = problem.unknowns();
        let (bounds, rows) = self.table.level_mut(k);
        bounds.fill(0.0);
        rows.fill(0.0);
        if size == 0.0 {
            return None;
        }
        self.factor.solve_upper(base, &mut self.work);
        let left_out = self.factor.width() < n;
        for (e, entry) in self.factor.entries[..base].iter().enumerate() {
            let multiplier = -self.work[e];
            match *entry {
                Entry::Bound(i) => bounds[i] = multiplier,
                Entry::Row(row) => {
                    rows[row] = multiplier;
                    if !left_out {
                        continue;
                    }
                    let j = self.offsets.partition_point(|&start| start <= row) - 1;
                    let i = row - self.offsets[j];
                    add_scaled(&mut self.gradient, multiplier, &problem.levels[j].matrix[i * n..(i + 1) * n]);
                }
            }
        }
        for &i in &self.factor.left_out {
            bounds[i] = -self.gradient[i];
        }
        let nothing = MULTIPLIER * size;
        let mut worst: Option<(f64, Entry)> = None;
        let mut consider = |multiplier: f64, norm: f64, side: Side, entry: Entry| {
            let wrong = match side {
                Side::Upper => -multiplier * norm,
                Side::Lower => multiplier * norm,
                Side::Both | Side::None => return,
            };
            if wrong > nothing && worst.is_none_or(|(most, _)| wrong > most) {
                worst = Some((wrong, entry));
            }
        };
        for (i, side) in self.bounds.iter().enumerate() {
            if !self.held[i] {
                consider(bounds[i], 1.0, *side, Entry::Bound(i));
            }
        }
        for entry in &self.factor.entries[..base] {
            if let Entry::Row(row) = *entry
                && self.roles[row] == Role::Active
            {
                consider(rows[row], self.norms[row], self.sides[row], *entry);
            }
        }
        if let Some((_, entry)) = worst {
            return Some(entry);
        }
        if hold {
            for (held, bound) in self.held.iter_mut().zip(bounds.iter()) {
                *held |= bound.abs() > nothing;
            }
            for entry in &self.factor.entries[..base] {
                if let Entry::Row(row) = *entry
                    && rows[row].abs() * self.norms[row] > nothing
                {
                    self.roles[row] = Role::Fixed;
                }
            }
        }
        None
    }

    /// What the level reached holds from now on.
    fn fix(&mut self, k: usize) {
        let rank =
            self.factor.entries.iter().filter(|e| matches!(e, Entry::Row(row) if *row >= self.offsets[k])).count();
        for s in 0..self.soft.len() {
            let row = self.soft[s];
            let needed = self.kept[s].abs() * self.norms[row] > self.zero(row);
            self.roles[row] =
                if self.sides[row] == Side::Both || (self.size > 0.0 && needed) { Role::Fixed } else { Role::Active };
            if s >= rank {
                self.lay_aside(row);
            }
        }
    }
}
