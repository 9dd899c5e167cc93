//! Reading words with the crate `gcode`, beside our scanner (P9).

use std::path::Path;

use gcode::core::{
    BlockVisitor, CommandVisitor, ControlFlow, Diagnostics, HasDiagnostics, Noop, Number, ProgramVisitor,
    Span, Value,
};

#[derive(Default)]
struct Sum {
    words: u64,
    sum: f64,
    faults: Noop,
}

struct OfBlock<'a>(&'a mut Sum);
struct OfCommand<'a>(&'a mut Sum);

impl HasDiagnostics for Sum {
    fn diagnostics(&mut self) -> &mut dyn Diagnostics {
        &mut self.faults
    }
}

impl HasDiagnostics for OfBlock<'_> {
    fn diagnostics(&mut self) -> &mut dyn Diagnostics {
        &mut self.0.faults
    }
}

impl HasDiagnostics for OfCommand<'_> {
    fn diagnostics(&mut self) -> &mut dyn Diagnostics {
        &mut self.0.faults
    }
}

#[expect(refining_impl_trait, reason = "the visitors are known here")]
impl ProgramVisitor for Sum {
    fn start_block(&mut self) -> ControlFlow<OfBlock<'_>> {
        ControlFlow::Continue(OfBlock(self))
    }
}

#[expect(refining_impl_trait, reason = "the visitors are known here")]
impl BlockVisitor for OfBlock<'_> {
    fn start_general_code(&mut self, _: Number) -> ControlFlow<OfCommand<'_>> {
        self.0.words += 1;
        ControlFlow::Continue(OfCommand(self.0))
    }
}

impl CommandVisitor for OfCommand<'_> {
    fn argument(&mut self, _: char, value: Value<'_>, _: Span) {
        self.0.words += 1;
        if let Value::Literal(number) = value {
            self.0.sum += f64::from(number);
        }
    }
}

/// Reads a file, and its words as often as our side does.
pub fn read(path: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut sum = Sum::default();
    for _ in 0..crate::LEX_TIMES {
        gcode::core::parse(&text, &mut sum);
    }
    println!("{} words, sum {}", sum.words, sum.sum);
    Ok(())
}
