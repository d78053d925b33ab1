//! Named sets of objects.

use super::Stage;
use crate::check::context::{Checked, Checker};
use crate::check::lookup::fits;
use crate::check::scene::object::dotted;
use crate::diagnostics::codes;
use crate::syntax::tree::{Expr, ExprKind, Group};

impl<'a> Checker<'a> {
    /// `group poles = pole_{*}`
    pub(super) fn scene_group(&mut self, stage: &mut Stage<'a>, group: &'a Group) -> Checked<()> {
        let name = group.name.text.as_str();
        let objects = stage.scene.objects.iter().any(|object| object.name == name);
        let groups = stage.scene.groups.iter().any(|(known, _)| known == name);
        if objects || groups || self.means_something(name) || ["root", "world", "robot"].contains(&name) {
            let message = format!("`{name}` is already defined");
            return Err(self.error(codes::names::DECLARED_TWICE, group.name.span, message));
        }
        let mut members = Vec::new();
        self.group_members(stage, &group.members, &mut members)?;
        stage.scene.groups.push((name.to_owned(), members));
        Ok(())
    }

    fn group_members(&mut self, stage: &Stage<'a>, expr: &'a Expr, members: &mut Vec<usize>) -> Checked<()> {
        match &expr.kind {
            ExprKind::Paren(inner) => self.group_members(stage, inner, members),
            ExprKind::List(elements) => elements.iter().try_for_each(|element| self.group_members(stage, element, members)),
            ExprKind::Name(name) => {
                for pattern in self.names_of(name)? {
                    self.add_members(stage, &pattern, expr, members)?;
                }
                Ok(())
            }
            _ => match dotted(expr) {
                Some(name) => self.add_members(stage, &name, expr, members),
                None => {
                    let message = "a group of a scene lists objects by name";
                    let diagnostic = self
                        .diagnostic(codes::types::WRONG_TYPE, expr.span, message)
                        .help("write `group poles = pole_{*}` or `group chair = [seat, back]`");
                    Err(self.report(diagnostic))
                }
            },
        }
    }

    fn add_members(&mut self, stage: &Stage<'a>, pattern: &str, expr: &Expr, members: &mut Vec<usize>) -> Checked<()> {
        let objects = &stage.scene.objects;
        // A star stands for whole things, not for parts of parts.
        let depth = pattern.matches('.').count();
        let whole = |name: &str| name.matches('.').count() == depth && fits(pattern, name);
        let fitting: Vec<usize> = (0..objects.len()).filter(|&index| whole(&objects[index].name)).collect();
        if fitting.is_empty() {
            if self.means_something(pattern) {
                let message = format!("`{pattern}` is not an object of the scene; groups of the body are declared in its file");
                return Err(self.error(codes::types::WRONG_TYPE, expr.span, message));
            }
            let known = objects.iter().map(|object| object.name.clone()).collect();
            return Err(self.unknown_name(pattern, expr.span, known));
        }
        for index in fitting {
            if members.contains(&index) {
                let message = format!("`{}` occurs twice in the group", objects[index].name);
                return Err(self.error(codes::tasks::REPEATED, expr.span, message));
            }
            members.push(index);
        }
        Ok(())
    }
}
