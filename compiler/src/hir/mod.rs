//! The typed HIR of one task: every formula that was checked, with the definitions that its names stand for, its type (shape,
//! frame and wrapping are part of it) and the node of the graph that computes it.
//!
//! 1. Type checking opens an expression before its parts and closes it with its value, so that a whole stands before its parts
//!    and these are a range of the arena. Nothing of the syntax tree is copied but spans and operators.
//! 2. Functions are inlined: the formula of a function stands here once for each call, as a part of that call. The formula of a
//!    name is checked once; [`Expr::formula`] leads to it from every use.
//! 3. Lints query it with [`Hir::read_by`], the language server with [`TypedFormulas`].

mod describe;
pub mod types;
pub mod value;
mod verify;

pub use describe::{Description, Members, TypedFormulas};
pub(crate) use describe::{entity_name, parts_of};

use crate::diagnostics::{FileId, Span};
use crate::signals::Signal;
use crate::syntax::tree::{self, BinaryOperator, UnaryOperator};
use std::collections::{BTreeMap, BTreeSet};
use value::Value;

/// A definition: the place of the name that a text declares. The same in all tasks and files of a compilation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DefinitionId {
    /// In which file it is declared.
    pub file: FileId,
    /// Where its name stands there.
    pub span: Span,
}

/// What a name stands for.
#[derive(Debug, Clone, Copy)]
pub enum Resolution {
    /// A declaration of a text: `let`, `const`, `fn`, an argument, a loop variable, ...
    Definition(DefinitionId),
    /// A function of the language, by its name in the table.
    Function(&'static str),
    /// A signal of the language.
    Signal(&'static Signal),
    /// A part of the body or of the scene, or a set of them: the value tells which.
    Entity,
}

/// What an expression is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExprKind {
    /// A number or a truth value.
    Literal,
    /// A name, a pattern of names or a selector.
    Name,
    /// `base.name`
    Field,
    /// A call; the arguments and the formula of the function are its parts.
    Call,
    /// `list[i]`
    Index,
    /// A list, written out or as a comprehension.
    List,
    /// `(...)`
    Paren,
    /// `-x`, `not c`
    Unary(UnaryOperator),
    /// `a + b`
    Binary(BinaryOperator),
    /// `a < b < c`
    Compare,
    /// `v in pelvis`
    InFrame,
    /// `if a then b else c`
    If,
    /// `x when c`
    When,
    /// `ended by fallen`
    EndedBy,
    /// What has no value by itself.
    Other,
}

impl From<&tree::ExprKind> for ExprKind {
    fn from(kind: &tree::ExprKind) -> Self {
        use tree::ExprKind as T;
        match kind {
            T::Number(_) | T::Bool(_) => Self::Literal,
            T::Name(_) | T::Selector { .. } => Self::Name,
            T::Field { .. } => Self::Field,
            T::Call { .. } => Self::Call,
            T::Index { .. } => Self::Index,
            T::List(_) | T::Comprehension { .. } => Self::List,
            T::Paren(_) => Self::Paren,
            T::Unary { operator, .. } => Self::Unary(*operator),
            T::Binary { operator, .. } => Self::Binary(*operator),
            T::Compare { .. } => Self::Compare,
            T::InFrame { .. } => Self::InFrame,
            T::If { .. } => Self::If,
            T::When { .. } => Self::When,
            T::EndedBy(_) => Self::EndedBy,
            T::Range { .. } | T::Text(_) | T::At { .. } | T::Error(_) => Self::Other,
        }
    }
}

/// An expression of a [`Hir`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExprId(u32);

/// A checked expression.
#[derive(Debug, Clone)]
pub struct Expr {
    /// In which file it stands.
    pub file: FileId,
    /// Where.
    pub span: Span,
    /// What it is.
    pub kind: ExprKind,
    /// What the name in it stands for: of a name itself, of a field its last word, of a call the function.
    pub name: Option<(Span, Resolution)>,
    /// The formula that its name stands for.
    pub formula: Option<ExprId>,
    /// Its type, and the node or the part of the body that it stands for; nothing where it is rejected.
    pub value: Option<Value>,
    /// The first expression that is no part of it.
    end: u32,
}

/// A name that stands for something.
#[derive(Debug, Clone, Copy)]
pub struct NameUse {
    /// In which file it stands.
    pub file: FileId,
    /// Where.
    pub span: Span,
    /// For what.
    pub resolution: Resolution,
    /// The expression around it, if it stands in a formula.
    pub expr: Option<ExprId>,
}

/// How far a [`Hir`] had come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mark(usize, usize);

/// The typed HIR of one task.
#[derive(Debug, Clone, Default)]
pub struct Hir {
    exprs: Vec<Expr>,
    uses: Vec<NameUse>,
    /// Documentation of the definitions that are named.
    docs: BTreeMap<DefinitionId, String>,
    /// Expressions that are being checked, the innermost last.
    open: Vec<ExprId>,
}

impl Hir {
    /// Opens an expression: those opened until it is closed are its parts.
    pub(crate) fn open(&mut self, file: FileId, span: Span, kind: ExprKind) -> ExprId {
        let id = self.next();
        self.exprs.push(Expr { file, span, kind, name: None, formula: None, value: None, end: id.0 + 1 });
        self.open.push(id);
        id
    }

    /// Closes the expression that was opened last.
    pub(crate) fn close(&mut self, id: ExprId, value: Option<&Value>) {
        let last = self.open.pop();
        debug_assert_eq!(last, Some(id), "expressions are closed in the order in which they were opened");
        let end = self.next().0;
        if let Some(expr) = self.exprs.get_mut(id.0 as usize) {
            (expr.end, expr.value) = (end, value.cloned());
        }
    }

    /// The expression that is opened next.
    pub(crate) fn next(&self) -> ExprId {
        // What a task may cost is bounded far below.
        ExprId(u32::try_from(self.exprs.len()).unwrap_or(u32::MAX))
    }

    /// Records what a name stands for; the innermost open expression is that in which it stands.
    pub(crate) fn resolved(&mut self, file: FileId, span: Span, resolution: Resolution) {
        let expr = self.open.last().copied();
        self.uses.push(NameUse { file, span, resolution, expr });
        if let Some(expr) = expr.and_then(|id| self.exprs.get_mut(id.0 as usize))
            && expr.file == file
        {
            expr.name.get_or_insert((span, resolution));
        }
    }

    /// Records the formula for which the name of the innermost open expression stands.
    pub(crate) fn stands_for(&mut self, formula: Option<ExprId>) {
        if let Some(expr) = self.open.last().and_then(|id| self.exprs.get_mut(id.0 as usize)) {
            expr.formula = expr.formula.or(formula);
        }
    }

    /// Records the documentation of a definition.
    pub(crate) fn documented(&mut self, definition: DefinitionId, docs: Option<&tree::Docs>) {
        if let Some(docs) = docs {
            self.docs.entry(definition).or_insert_with(|| docs.text.clone());
        }
    }

    /// How far it has come.
    pub(crate) fn mark(&self) -> Mark {
        Mark(self.exprs.len(), self.uses.len())
    }

    /// Takes back what was added since a mark.
    pub(crate) fn rewind(&mut self, mark: Mark) {
        self.exprs.truncate(mark.0);
        self.uses.truncate(mark.1);
        // What is being checked goes on, without what is taken back.
        for id in &self.open {
            if let Some(expr) = self.exprs.get_mut(id.0 as usize) {
                expr.formula = expr.formula.filter(|formula| (formula.0 as usize) < mark.0);
            }
        }
    }

    /// One expression.
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.0 as usize]
    }

    /// All expressions, wholes before their parts.
    pub fn exprs(&self) -> &[Expr] {
        &self.exprs
    }

    /// All names that stand for something, in the order in which they were resolved.
    pub fn uses(&self) -> &[NameUse] {
        &self.uses
    }

    /// The parts of an expression and their parts.
    pub fn parts(&self, id: ExprId) -> impl DoubleEndedIterator<Item = ExprId> + use<> {
        (id.0 + 1..self.expr(id).end).map(ExprId)
    }

    /// The direct parts of an expression, in the order in which they were checked.
    pub fn children(&self, id: ExprId) -> impl Iterator<Item = ExprId> + '_ {
        let end = self.expr(id).end;
        let first = Some(ExprId(id.0 + 1)).filter(|next| next.0 < end);
        std::iter::successors(first, move |child| Some(ExprId(self.expr(*child).end)).filter(|next| next.0 < end))
    }

    /// An expression, its parts, and the formulas of all names within it, each once: a whole before its parts.
    pub fn read_by(&self, id: ExprId) -> Vec<ExprId> {
        let (mut found, mut pending, mut seen) = (Vec::new(), vec![id], BTreeSet::new());
        while let Some(root) = pending.pop() {
            for part in std::iter::once(root).chain(self.parts(root)) {
                // The formula of a name is a part of its first use.
                if seen.insert(part) {
                    found.push(part);
                    pending.extend(self.expr(part).formula);
                }
            }
        }
        found
    }

    /// What an expression comes to behind parentheses and names.
    pub fn behind_names(&self, mut id: ExprId) -> ExprId {
        loop {
            let expr = self.expr(id);
            let next = match expr.kind {
                ExprKind::Paren => self.children(id).next(),
                ExprKind::Name => expr.formula,
                _ => None,
            };
            // A formula is checked while its first use is open, so it stands behind that; later uses lead back to it.
            match next {
                Some(next) => id = next,
                None => return id,
            }
        }
    }

    /// The expression at a place that was checked last.
    pub(crate) fn latest(&self, file: FileId, span: Span) -> Option<ExprId> {
        let place = self.exprs.iter().rposition(|expr| expr.file == file && expr.span == span)?;
        u32::try_from(place).ok().map(ExprId)
    }

    /// The documentation of a definition.
    pub fn docs(&self, definition: DefinitionId) -> &str {
        self.docs.get(&definition).map_or("", String::as_str)
    }
}
