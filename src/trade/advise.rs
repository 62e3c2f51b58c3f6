//! The cheapest configuration within a budget, found without trying them all.
//!
//! Configurations that differ only in a knob that makes them better and dearer step by step (a map's size) form a line. On
//! a line, error falls and cost rises, so the first step within the budget is found by bisection; and once some
//! configuration will do, another line is only asked whether it has one that is cheaper, which one or two trials settle.

use crate::technique::{Cost, Spec};

/// The knobs along which error falls and cost rises.
const RISING: [&str; 1] = ["size"];

/// Configurations in the order of rising cost and falling error.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its steps; a configuration without such a knob is a line of its own.
    pub steps: Vec<Spec>,
}

/// What a trial of one configuration showed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// What the budget binds.
    pub error: f64,
    /// What is to be small.
    pub cost: f64,
    /// The next step of the line costs no less than this; `cost` where nothing more is known.
    pub next_cost: f64,
    /// No step of the line costs less than this; 0 where nothing is known.
    pub least_cost: f64,
    /// Whether all that the budget does not bind (a limit on time) is kept.
    pub is_allowed: bool,
}

impl Trial {
    /// A trial whose cost is counted work, of which the map's side changes only what is drawn and stored; `None` without
    /// pipeline statistics.
    #[must_use]
    pub fn by_work(spec: &Spec, error: f64, cost: &Cost) -> Option<Self> {
        /// 32-bit words of the least and of the largest texel there is.
        const WORDS_PER_TEXEL: [f64; 2] = [0.5, 1.0];
        /// The most views that a map has.
        const MOST_VIEWS: f64 = 8.0;
        let work = cost.work()? as f64;
        let Some(name) = knob(spec) else {
            return Some(Self { error, cost: work, next_cost: work, least_cost: work, is_allowed: true });
        };
        let texels = (spec.integer(name) as f64).powi(2);
        let is_one_view = spec.technique().id() == "map" && spec.choice("projection").0 == "single";
        let views = if is_one_view { 1.0 } else { MOST_VIEWS };
        let of_size = cost.fragments? as f64 + views * texels * WORDS_PER_TEXEL[1];
        let (next_cost, least_cost) = (work + 3.0 * texels * WORDS_PER_TEXEL[0], work - of_size);
        Some(Self { error, cost: work, next_cost, least_cost, is_allowed: true })
    }
}

/// A configuration that was tried: line, step, and what it showed.
pub type Tried = (usize, usize, Trial);

/// How a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Everything tried, in order.
    pub tried: Vec<Tried>,
    /// The cheapest within the budget: line and step.
    pub answer: Option<(usize, usize)>,
}

/// The lines of some configurations, in the order of their first ones.
#[must_use]
pub fn lines(specs: &[Spec]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for spec in specs {
        match lines.iter_mut().find(|line| line.steps.first().is_some_and(|first| differ_in_knob_only(first, spec))) {
            Some(line) => line.steps.push(spec.clone()),
            None => lines.push(Line { steps: vec![spec.clone()] }),
        }
    }
    for line in &mut lines {
        line.steps.sort_by_key(|spec| knob(spec).map(|name| spec.integer(name)));
    }
    lines
}

/// The knob of a specification's family.
#[must_use]
pub fn knob(spec: &Spec) -> Option<&'static str> {
    RISING.into_iter().find(|name| spec.technique().params().iter().any(|param| param.name == *name))
}

fn differ_in_knob_only(a: &Spec, b: &Spec) -> bool {
    let Some(name) = knob(a).filter(|_| a.technique().id() == b.technique().id()) else { return false };
    a.with(name, &b.integer(name).to_string()).is_ok_and(|moved| moved == *b)
}

/// Searches lines of the given lengths for the cheapest step whose error is at most `budget`. `try_step` tries one; `None`
/// is a step that gave no answer, which rules out its line.
///
/// # Errors
/// The first that `try_step` returns.
pub fn search<E>(
    lengths: &[usize],
    budget: f64,
    mut try_step: impl FnMut(usize, usize) -> Result<Option<Trial>, E>,
) -> Result<Search, E> {
    let mut search = Search { tried: Vec::new(), answer: None };
    let mut best: Option<(usize, f64)> = None;
    for (line, &length) in lengths.iter().enumerate() {
        let mut steps = Steps { line, budget, try_step: &mut try_step, tried: &mut search.tried };
        let found = match best {
            None => steps.first_good(length)?,
            Some((step, cost)) => match steps.cheaper_than(cost, step.min(length.saturating_sub(1)), length)? {
                // What is cheaper may not be the cheapest of its line.
                Some(cheaper) => steps.bisect(0, cheaper)?.or(Some(cheaper)),
                None => None,
            },
        };
        if let Some(step) = found
            && let Some(trial) = steps.trial(step)?.filter(|trial| trial.is_allowed)
        {
            best = Some((step, trial.cost));
            search.answer = Some((line, step));
        }
    }
    Ok(search)
}

/// Trials on one line.
struct Steps<'a, F> {
    line: usize,
    budget: f64,
    try_step: &'a mut F,
    tried: &'a mut Vec<Tried>,
}

impl<E, F: FnMut(usize, usize) -> Result<Option<Trial>, E>> Steps<'_, F> {
    /// What a step shows; it is tried once.
    fn trial(&mut self, step: usize) -> Result<Option<Trial>, E> {
        let known = self.tried.iter().find(|(line, known, _)| (*line, *known) == (self.line, step));
        if let Some((.., trial)) = known {
            return Ok(Some(*trial));
        }
        let trial = (self.try_step)(self.line, step)?;
        self.tried.extend(trial.map(|trial| (self.line, step, trial)));
        Ok(trial)
    }

    /// The first step that keeps to the budget. The middle is tried before the dearest, and that before all others: a line
    /// without an answer takes two trials.
    fn first_good(&mut self, length: usize) -> Result<Option<usize>, E> {
        let Some(last) = length.checked_sub(1) else { return Ok(None) };
        let middle = length / 2;
        match self.trial(middle)? {
            None => self.bisect(0, middle),
            Some(trial) if trial.error <= self.budget => Ok(self.bisect(0, middle)?.or(Some(middle))),
            Some(_) => match self.trial(last)? {
                Some(top) if top.error > self.budget => Ok(None),
                top => Ok(self.bisect(middle + 1, last)?.or(top.map(|_| last))),
            },
        }
    }

    /// The first of the steps from `low` up to, not including, `high` that keeps to the budget.
    fn bisect(&mut self, low: usize, high: usize) -> Result<Option<usize>, E> {
        let (mut low, mut end) = (low, high);
        while low < end {
            let middle = usize::midpoint(low, end);
            match self.trial(middle)? {
                Some(trial) if trial.error <= self.budget => end = middle,
                Some(_) => low = middle + 1,
                // No answer: what is larger will have none either.
                None => return if middle == low { Ok(None) } else { self.bisect(low, middle) },
            }
        }
        Ok(Some(end).filter(|end| *end < high))
    }

    /// The dearest step that is cheaper than `cost`, if it keeps to the budget; looked for around `guess`.
    fn cheaper_than(&mut self, cost: f64, guess: usize, length: usize) -> Result<Option<usize>, E> {
        let mut step = guess;
        while let Some(trial) = self.trial(step)? {
            let is_good = trial.error <= self.budget;
            let may_go_up = step + 1 < length && trial.next_cost < cost && !self.is_known(step + 1);
            match (trial.cost < cost, is_good) {
                (true, true) => return Ok(Some(step)),
                (true, false) if may_go_up => step += 1,
                (false, true) if step > 0 && trial.least_cost < cost => step -= 1,
                // Cheaper steps are worse, dearer ones too dear.
                _ => return Ok(None),
            }
        }
        Ok(None)
    }

    fn is_known(&self, step: usize) -> bool {
        self.tried.iter().any(|(line, known, _)| (*line, *known) == (self.line, step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trade::specs_of_grids;
    use std::convert::Infallible;

    /// Lines × steps of a made-up grid, of which no two lines are alike.
    const LINES: usize = 25;
    const STEPS: usize = 8;

    /// Error falls and cost rises along each line; a cheap random generator moves the lines against one another.
    fn made_up(seed: u64) -> Vec<Vec<Trial>> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut line = || -> Vec<Trial> {
            let (quality, price, slope) = (10_f64.powf(-2.0 * random()), 1.0 + random(), 0.3 + 0.6 * random());
            let trial = |step: usize| {
                let texels = 4_f64.powi(step as i32);
                let cost = 50.0 * price + price * texels;
                Trial {
                    error: quality * slope.powi(step as i32),
                    cost,
                    next_cost: cost + 3.0 * texels,
                    least_cost: 50.0 * price,
                    is_allowed: true,
                }
            };
            (0..STEPS).map(trial).collect()
        };
        (0..LINES).map(|_| line()).collect()
    }

    fn exhaustive(grid: &[Vec<Trial>], budget: f64) -> Option<f64> {
        let good = grid.iter().flatten().filter(|trial| trial.error <= budget);
        good.map(|trial| trial.cost).min_by(f64::total_cmp)
    }

    #[test]
    fn it_agrees_with_trying_everything_and_tries_at_most_a_quarter() {
        let mut most = 0;
        for seed in 1..=200 {
            let grid = made_up(seed);
            for budget in [0.1, 0.01, 0.001, 1e-7] {
                let step = |line: usize, step: usize| Ok::<_, Infallible>(Some(grid[line][step]));
                let Ok(search) = search(&[STEPS; LINES], budget, step);
                let cost = search.answer.map(|(line, step)| grid[line][step].cost);
                assert_eq!(cost, exhaustive(&grid, budget), "seed {seed}, budget {budget}");
                let mut once = search.tried.iter().map(|(line, step, _)| (line, step)).collect::<Vec<_>>();
                once.dedup();
                assert_eq!(once.len(), search.tried.len());
                if budget > 1e-6 {
                    most = most.max(search.tried.len());
                }
            }
        }
        assert!(4 * most <= LINES * STEPS, "{most} of {} tried", LINES * STEPS);
    }

    #[test]
    fn what_gives_no_answer_and_what_is_not_allowed_is_passed_over() {
        let trial = |cost: f64| Trial { error: 0.0, cost, next_cost: cost, least_cost: 0.0, is_allowed: cost > 1.0 };
        let step = |line: usize, _: usize| Ok::<_, Infallible>([None, Some(trial(1.0)), Some(trial(2.0))][line]);
        let Ok(found) = search(&[1, 1, 1], 0.5, step);
        assert_eq!(found.answer, Some((2, 0)));
        let Ok(none) = search(&[1, 1], 0.5, step);
        assert_eq!(none.answer, None);
    }

    #[test]
    fn lines_run_along_the_size() {
        let grids =
            ["map:filter=pcf-box3|nearest,size=512|128..256".to_owned(), "volume:count=z-pass|z-fail".to_owned()];
        let lines = lines(&specs_of_grids(&grids).unwrap());
        let shorts: Vec<Vec<String>> = lines.iter().map(|line| line.steps.iter().map(Spec::short).collect()).collect();
        assert_eq!(
            shorts,
            [
                vec!["map:size=128,filter=pcf-box3", "map:size=256,filter=pcf-box3", "map:size=512,filter=pcf-box3"],
                vec!["map:size=128", "map:size=256", "map:size=512"],
                vec!["volume:count=z-pass"],
                vec!["volume"],
            ]
        );
    }
}
