//! The part of a program: a second run of it, on the stock that the first one showed.

use std::collections::BTreeMap;

use turnwright_control::Setup;
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_export::mesh::Mesh;
use turnwright_export::part::PartShape;
use turnwright_export::wound::{Turns, Unwound, Wound, half_planes};
use turnwright_stock::Section;
use turnwright_stock::machining::{RapidRates, TooLong};
use turnwright_verify::Inferred;
use turnwright_verify::figures::{FigureSearch, Figures};
use turnwright_verify::measuring::{self, Judged};
use turnwright_verify::part::{Part, PartRun};
use turnwright_verify::target::Target;

use crate::arguments::Machine;
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::finding::Finding;
use crate::report::Measure;
use crate::session::Session;

/// What the part is held against.
#[derive(Clone, Debug)]
pub(crate) enum Aim {
    /// A drawing of all of it.
    Drawing(Box<Section>),
    /// The figures of the program's finishing cycles.
    Finishing,
}

/// Cuts the program out of its stock, and measures what it does, when that is wanted. `inferred` is the whole setup, and
/// the figures that are finished, as the first run showed them; nothing comes back when there is no stock, for the
/// program cuts nothing. The section along the program is kept when the path is.
///
/// # Errors
/// What the caller's look at the run gives: it may write what has been measured so far.
pub(crate) fn machined(
    text: &ProgramText,
    session: &Session,
    options: &Machine,
    inferred: &Inferred,
    aim: Option<&Aim>,
    mut measure: Option<&mut Measure>,
    look: &mut dyn FnMut(&Execution<'_>, &mut Measure) -> Result<(), Finding>,
) -> Result<Option<Part>, Finding> {
    let setup = &inferred.setup;
    if setup.stock.is_none() && measure.is_none() {
        return Ok(None);
    }
    // What the program prints was written by the first run.
    let options = Machine { program_output: None, ..options.clone() };
    let machine = session.machine()?;
    let rates =
        RapidRates { x_mm_per_min: machine.rapid_x_mm_per_min, z_mm_per_min: machine.rapid_z_mm_per_min };
    let mut execution = Execution::new(text, session, &options)?;
    let start = execution.interpreter().position();
    // A setup that is no setup was told of by the first run.
    let mut run = PartRun::new(setup, &session.setup, start, rates).ok().flatten();
    if let Some(new) = run {
        let figures = figures(text, session, &options, inferred)?;
        let new = new.with_figures(&figures.found);
        run = Some(match aim {
            Some(Aim::Drawing(drawing)) => new.with_target(Target::Drawing(drawing.clone())),
            Some(Aim::Finishing) if !figures.found.is_empty() => {
                new.with_target(Target::Figures(figures.found))
            }
            _ => new,
        });
    }
    if measure.as_ref().is_some_and(|measure| measure.path.is_some()) {
        run = run.map(PartRun::with_history).map(PartRun::with_scenes);
    }
    while let Some(command) = execution.next_command() {
        let removed = run.as_mut().map(|run| run.add(&command));
        match &mut measure {
            Some(measure) => {
                measure.add(command, removed.flatten());
                look(&execution, measure)?;
            }
            None if run.as_ref().is_none_or(PartRun::is_full) => break,
            None => {}
        }
    }
    let part = run.map(PartRun::finish);
    if let Some(measure) = measure {
        measure.finish();
        measure.threads.known = part.as_ref().map_or(BTreeMap::new(), |part| part.thread_ways.clone());
        measure.threads.has_stock = part.as_ref().is_some_and(|part| part.has_stock);
    }
    Ok(part)
}

/// The figures that finishing cycles follow, as they are programmed: where compensation leads a round nose along them,
/// another run with sharp tools shows them.
fn figures(
    text: &ProgramText,
    session: &Session,
    options: &Machine,
    inferred: &Inferred,
) -> Result<Figures, Finding> {
    if !inferred.figures.is_compensated {
        return Ok(inferred.figures.clone());
    }
    let mut execution = Execution::new(text, session, options)?.with_sharp_noses();
    let mut search = FigureSearch::new(execution.interpreter().position());
    while let Some(command) = execution.next_command() {
        search.add(&command);
    }
    Ok(search.finish())
}

/// The sizes that the setup file asks for, measured; none where the program stopped short or too much of it was cut, for
/// then the part is not the finished one. No part at all has none of the sizes.
pub(crate) fn judged(part: Option<&Part>, setup: &Setup, alarm: Option<&Diagnostic>) -> Vec<Judged> {
    let is_incomplete = |part: &Part| part.findings.iter().any(|finding| finding.key == "part-incomplete");
    if alarm.is_some() || part.is_some_and(is_incomplete) {
        return Vec::new();
    }
    // A setup with sizes that cannot be was refused when it was read.
    let measures = setup.measures().unwrap_or_default();
    part.map_or_else(
        || measuring::judge(&Section::default(), &[], &measures),
        |part| measuring::judge(&part.section, &part.threads, &measures),
    )
}

/// What is to be told of sizes.
pub(crate) fn out_of_tolerance(judged: &[Judged]) -> impl Iterator<Item = Diagnostic> {
    judged.iter().enumerate().filter_map(|(index, one)| one.finding(index + 1))
}

/// How a part is drawn; nothing when nothing is left of it.
pub(crate) fn drawn(part: Part) -> Option<(Part, PartShape)> {
    let shape = PartShape::new(&part.section, &part.plain, &part.threads)?;
    Some((part, shape))
}

/// A part as triangles.
#[derive(Debug, Default)]
pub(crate) struct Meshed {
    /// Them; nothing when the part has more edges than a solid may have.
    pub(crate) mesh: Option<Mesh>,
    /// The part in half-planes all round, when its threads wind.
    pub(crate) turns: Option<Turns>,
    /// Why its threads do not wind.
    pub(crate) finding: Option<Diagnostic>,
}

/// The triangles of a part, within `chord_mm` of it.
pub(crate) fn meshed(part: &Part, shape: &PartShape, chord_mm: f64) -> Meshed {
    let plain = || Mesh::new(shape, chord_mm);
    let Some(all) = part.half_planes.as_deref().filter(|_| !part.threads.is_empty()) else {
        return Meshed { mesh: plain(), ..Meshed::default() };
    };
    let wound = all
        .sections(half_planes(shape, chord_mm), &part.section)
        .map_err(|TooLong| Unwound::TooFine)
        .and_then(Turns::new)
        .and_then(|turns| Ok((Wound::new(shape, &turns, chord_mm)?, turns)));
    match wound {
        Ok((wound, turns)) => Meshed { mesh: Some(Mesh::Wound(wound)), turns: Some(turns), finding: None },
        Err(reason) => {
            let key = match reason {
                Unwound::TooFine => "threads-too-long-to-wind",
                Unwound::InPieces => "threads-in-pieces",
            };
            let finding = Diagnostic::new(Severity::Note, key);
            Meshed { mesh: plain(), turns: None, finding: Some(finding) }
        }
    }
}
