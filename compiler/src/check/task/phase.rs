//! A task as a phase of a sequence: when it gives way to the next, and which tests it checks.

use crate::check::context::{Checked, Checker};
use crate::check::init::InitialState;
use crate::check::observe::ObservedChannel;
use crate::check::reward::RewardTerm;
use crate::check::tests::CheckedTests;
use crate::diagnostics::FileId;
use crate::graph::NodeId;
use crate::resolve::Texts;
use crate::syntax::tree::{Expr, TaskStatement, Test};

/// How a phase of a sequence gives way to the next.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PhaseEnd {
    /// When the next phase begins.
    pub until: Option<NodeId>,
    /// Whether the phase itself has succeeded.
    pub succeeded: Option<NodeId>,
}

/// What is asked of a task as a phase of a sequence.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct InSequence<'a> {
    /// Names of all phases; empty for a task by itself.
    pub phases: &'a [String],
    /// Which of them this is.
    pub index: usize,
    /// When the next begins, with the file in which that stands.
    pub until: Option<(&'a Expr, FileId)>,
    /// The success of the sequence, if it declares one.
    pub success: Option<(&'a Expr, FileId)>,
    /// Whether a task by itself is a phase of a sequence somewhere.
    pub is_phase: bool,
    /// Whether its tests are checked as well.
    pub tests: bool,
    /// Control steps of all its phases, as far as tests are concerned.
    pub horizon: u32,
    /// Control steps that the phases before this one may take.
    pub before: u32,
}

impl<'a> Checker<'a> {
    /// The tests of a task, or of the sequence whose phase it is.
    pub(super) fn own_tests(
        &mut self,
        sequence: InSequence<'a>,
        init: &InitialState,
        seen: (&[RewardTerm<'a>], &[ObservedChannel]),
        success: NodeId,
        texts: &dyn Texts,
    ) -> Checked<Option<CheckedTests>> {
        let statements = self.statements;
        let tests: Vec<(&Test, FileId)> = statements
            .iter()
            .filter_map(
                |placed| if let TaskStatement::Test(test) = &placed.statement { Some((&**test, placed.file)) } else { None },
            )
            .collect();
        if !sequence.tests {
            return Ok(None);
        }
        // A sequence has succeeded in its last phase, or not yet.
        let last = sequence.index + 1 >= sequence.phases.len();
        let success = if last { success } else { self.graph.constant(0.0) };
        self.tests(&tests, init, seen, success, texts, sequence)
    }

    /// When a phase gives way, and whether it has then succeeded.
    pub(super) fn phase_end(&mut self, sequence: InSequence<'a>, succeeded: Option<NodeId>) -> Checked<PhaseEnd> {
        if sequence.phases.is_empty() {
            return Ok(PhaseEnd::default());
        }
        let until = sequence.until.map(|(expr, file)| self.in_file(file, |checker| checker.single_condition(expr))).transpose();
        Ok(PhaseEnd { until: until?.map(|condition| condition.node), succeeded })
    }
}
