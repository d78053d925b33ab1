//! Diagnostics of the compiler.

use msk_compiler::diagnostics::{self, Style};
use pyo3::prelude::*;

pyo3::import_exception!(msk.errors, CompileError);

/// The diagnostics of a compilation, with the texts that they point into.
#[pyclass(frozen, module = "msk._native")]
pub struct Report(diagnostics::Report);

#[pymethods]
impl Report {
    /// All diagnostics as JSON: `{"diagnostics": [...]}`.
    fn to_json(&self) -> String {
        self.0.to_json().to_string()
    }

    /// As text, with the source and carets; with the colours of a terminal if `coloured`.
    fn render(&self, coloured: bool) -> String {
        self.0.render(if coloured { Style::Coloured } else { Style::Plain })
    }
}

impl Report {
    /// Those of a report.
    pub fn of(report: diagnostics::Report) -> Self {
        Self(report)
    }

    /// The exception that carries this report.
    pub fn into_error(self) -> PyErr {
        CompileError::new_err((self,))
    }
}
