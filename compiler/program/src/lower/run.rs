//! Executing a program.

use super::formula::View;
use super::lane::{Run, STEP};
use super::program::{Deed, Program, Statement};
use crate::extremes::maximum;
use crate::graph::operation::{Chance, Memory};

/// Which moment of the episode is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moment {
    /// Before the initial state: only what is drawn first.
    First,
    /// The reset snapshot, step 0.
    Reset,
    /// A control step with its number.
    Step(u32),
}

/// How often a random is tried before that is an error.
const TRIES: u32 = 64;

/// A draw none of whose tries was taken.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NoneTaken {
    pub draw: usize,
    pub tries: u32,
    pub last: Vec<f64>,
}

/// Gives the next number of a draw.
type Source<'a> = &'a mut dyn FnMut(usize, Chance) -> f64;

impl Program {
    /// Makes the record that an episode finds, and writes which of the earlier phases succeeded.
    pub(crate) fn prepare(&self, successes: &[bool], record: &mut Vec<f64>) {
        record.clone_from(&self.record);
        for &(phase, cell) in &self.successes {
            record[cell] = f64::from(u8::from(successes.get(phase) == Some(&true)));
        }
    }

    /// Gives a draw a value that it shall keep.
    pub(crate) fn keep(&self, draw: usize, value: &[f64], record: &mut [f64]) {
        let cell = self.draws[draw].cell;
        record[cell..cell + value.len()].copy_from_slice(value);
    }

    /// The present value of a draw.
    pub(crate) fn value_of_draw<'a>(&self, draw: usize, record: &'a [f64]) -> &'a [f64] {
        let draw = &self.draws[draw];
        &record[draw.cell..draw.cell + draw.candidate.width()]
    }

    /// Draws what is drawn before the initial state and computes what that settles.
    pub(crate) fn first(&self, record: &mut [f64], kept: &dyn Fn(usize) -> bool, source: Source<'_>) -> Result<(), NoneTaken> {
        let list = self.first.iter().map(|&index| &self.before[index]);
        self.drawing(list, Moment::First, &[], record, kept, source)
    }

    /// Computes the reset snapshot: every memory starts, every state takes its first value, the other randoms are drawn.
    pub(crate) fn reset(
        &self,
        frame: &[f64],
        record: &mut [f64],
        kept: &dyn Fn(usize) -> bool,
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        record[STEP] = 0.0;
        self.drawing(self.before.iter(), Moment::Reset, frame, record, kept, source)?;
        self.execute_all(&self.after, Moment::Reset, frame, record);
        Ok(())
    }

    /// Executes a list; a random is drawn where it is first read.
    fn drawing<'a>(
        &self,
        list: impl Iterator<Item = &'a Statement>,
        moment: Moment,
        frame: &[f64],
        record: &mut [f64],
        kept: &dyn Fn(usize) -> bool,
        source: Source<'_>,
    ) -> Result<(), NoneTaken> {
        for statement in list {
            if let Statement::Deed(deed) = statement
                && let Deed::Draw { draw, .. } = **deed
                && self.draws[draw].first == (moment == Moment::First)
                && !kept(draw)
            {
                self.draw(draw, moment, frame, record, source)?;
            }
            self.execute(statement, moment, frame, record);
        }
        Ok(())
    }

    /// Tries until a candidate is taken.
    fn draw(&self, index: usize, moment: Moment, frame: &[f64], record: &mut [f64], source: Source<'_>) -> Result<(), NoneTaken> {
        let draw = &self.draws[index];
        for _ in 0..TRIES {
            for number in &mut record[draw.noise.clone()] {
                *number = source(index, draw.chance);
            }
            self.execute_all(&draw.tries, moment, frame, record);
            if draw.accept.as_ref().is_none_or(|accept| accept.holds(&View { frame, record })) {
                draw.candidate.write_within(frame, record, draw.cell);
                return Ok(());
            }
        }
        let mut last = vec![0.0; draw.candidate.width()];
        draw.candidate.write(&View { frame, record }, &mut last);
        Err(NoneTaken { draw: index, tries: TRIES, last })
    }

    /// Computes control step number `step`: memories advance, formulas see states before their update, observations after.
    pub(crate) fn step(&self, step: u32, frame: &[f64], record: &mut [f64], source: Source<'_>) -> Result<(), NoneTaken> {
        let moment = Moment::Step(step);
        record[STEP] = f64::from(step);
        self.execute_all(&self.before, moment, frame, record);
        self.updates.iter().for_each(|update| self.carry_out(update, moment, frame, record));
        let mut drawn = Ok(());
        for (index, draw) in self.draws.iter().enumerate() {
            let wanted = draw.redraw.as_ref().is_some_and(|redraw| redraw.holds(&View { frame, record }));
            if wanted && drawn.is_ok() {
                drawn = self.draw(index, moment, frame, record, source);
            }
        }
        self.execute_all(&self.after, moment, frame, record);
        drawn
    }

    fn execute_all(&self, list: &[Statement], moment: Moment, frame: &[f64], record: &mut [f64]) {
        list.iter().for_each(|statement| self.execute(statement, moment, frame, record));
    }

    // What most steps consist of stays in the loop, the rest out of it: a call for each would cost as much as the statement.
    #[inline(always)]
    fn execute(&self, statement: &Statement, moment: Moment, frame: &[f64], record: &mut [f64]) {
        match statement {
            Statement::Store { at, formula } => record[*at] = formula(&View { frame, record }),
            Statement::Remember { memory, cell, input } => {
                let inputs = [input.read(&View { frame, record }), 0.0, 0.0];
                remember(*memory, moment, &mut record[*cell..=*cell], inputs);
            }
            Statement::Deed(deed) => self.carry_out(deed, moment, frame, record),
        }
    }

    #[inline(never)]
    fn carry_out(&self, deed: &Deed, moment: Moment, frame: &[f64], record: &mut [f64]) {
        match deed {
            Deed::Put { at, plan } => plan.write_within(frame, record, *at),
            Deed::Begin { at, plan } => {
                if moment == Moment::Reset {
                    plan.write_within(frame, record, *at);
                }
            }
            Deed::Draw { draw, at } => {
                let draw = &self.draws[*draw];
                record.copy_within(draw.cell..draw.cell + draw.candidate.width(), *at);
            }
            Deed::Remember { memory, cell, lanes, at } => {
                for (index, inputs) in lanes.iter().enumerate() {
                    let inputs = inputs.each_ref().map(|input| input.read(&View { frame, record }));
                    let first = cell + index * memory.cells();
                    let value = remember(*memory, moment, &mut record[first..first + memory.cells()], inputs);
                    if let Some(at) = at {
                        record[at + index] = value;
                    }
                }
            }
            Deed::Block(block) => block.execute(frame, record),
            Deed::Pick { list, place, at, width } => {
                let place = place.read(&View { frame, record });
                // Proven to lie within while compiling; a number that is none picks the first element.
                let last = (list.length / (*width).max(1)).saturating_sub(1);
                let from = list.from + (maximum(place, 0.0) as usize).min(last) * width;
                Run { from, length: *width, ..*list }.copy_within(frame, record, *at);
            }
            Deed::Follow { track, time, at } => {
                let time = time.read(&View { frame, record });
                track.read(time, &mut record[*at..at + track.columns.len()]);
            }
        }
    }
}

#[inline(always)]
fn remember(memory: Memory, moment: Moment, cells: &mut [f64], inputs: [f64; 3]) -> f64 {
    match moment {
        Moment::First | Moment::Reset => memory.start(cells, inputs),
        Moment::Step(step) => memory.advance(cells, step, inputs),
    }
}
