//! Weights wished for one by one, on a command line or by an agent.

use msk_compiler::diagnostics::nearest;
use msk_compiler::task::{CompiledTask, Origin};
use msk_compiler::weights::Problem;
use std::sync::Arc;

/// A weight that is wished for.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// `pose`, or `stand.pose` where several tasks have a term of that name.
    pub term: String,
    /// The weight.
    pub weight: f64,
}

/// Why wishes are refused: everything that is wrong with them.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct WishError(pub Vec<Problem>);

/// Tasks with wishes laid over them.
#[derive(Clone)]
pub struct Laid {
    /// The tasks, in their order.
    pub tasks: Vec<Arc<CompiledTask>>,
    /// Which task and which of its terms each wish concerned.
    pub places: Vec<(usize, usize)>,
}

/// Lays wishes over tasks.
///
/// # Errors
/// A term that no task has or several have, one that is given twice, or a weight that is not allowed.
pub fn wished(tasks: &[Arc<CompiledTask>], wishes: &[Wish], origin: &Origin) -> Result<Laid, WishError> {
    let (mut problems, mut places) = (Vec::new(), Vec::new());
    for wish in wishes {
        match place(tasks, &wish.term) {
            Ok(found) if places.contains(&found) => problems.push(Problem::Twice { term: wish.term.clone() }),
            Ok((task, term)) => {
                problems.extend(tasks[task].check_weight(term, wish.weight).err());
                places.push((task, term));
            }
            Err(problem) => problems.push(problem),
        }
    }
    if !problems.is_empty() {
        return Err(WishError(problems));
    }
    let mut laid = tasks.to_vec();
    for (wish, &(task, term)) in wishes.iter().zip(&places) {
        laid[task] = Arc::new(laid[task].reweighted(&[(term, wish.weight)], origin).map_err(|refused| WishError(refused.0))?);
    }
    Ok(Laid { tasks: laid, places })
}

/// Which task and term a name means: `term`, `task.term`, or the term of a phase with or without its task.
fn place(tasks: &[Arc<CompiledTask>], name: &str) -> Result<(usize, usize), Problem> {
    let full = |task: &CompiledTask, term: &str| format!("{}.{term}", task.name);
    let mut found = Vec::new();
    for (index, task) in tasks.iter().enumerate() {
        for (term, known) in task.terms.iter().enumerate() {
            if known.name == name || full(task, &known.name) == name {
                found.push((index, term));
            }
        }
    }
    match found.as_slice() {
        [only] => Ok(*only),
        [] => {
            let qualified = name.contains('.');
            let names = tasks.iter().flat_map(|task| {
                task.terms.iter().map(move |term| if qualified { full(task, &term.name) } else { term.name.clone() })
            });
            let names: Vec<String> = names.collect();
            let near = nearest(name, names.iter().map(String::as_str)).into_iter().map(str::to_owned).collect();
            Err(Problem::Unknown { term: name.to_owned(), nearest: near })
        }
        several => {
            let tasks = several.iter().map(|(task, _)| tasks[*task].name.clone()).collect();
            Err(Problem::Ambiguous { term: name.to_owned(), tasks })
        }
    }
}
