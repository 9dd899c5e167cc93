//! A whole job, end to end (T5): its text is read and interpreted, the stock is cut, and every axis is played at a
//! thousand ticks a second.

use std::fmt::Write;

use turnwright_control::{Control, Setup};
use turnwright_diagnostics::SourceId;
use turnwright_geometry::Outline;
use turnwright_interpreter::{Interpreter, Options, Step};
use turnwright_motion::{Dynamics, MachineRates, Player, Sample};
use turnwright_stock::machining::{RapidRates, ToolShape};
use turnwright_stock::{Machining, Section};

use crate::board::Board;
use crate::motion::Stopwatch;
use crate::removal::{finger, insert};
use crate::work::Memory;

/// A shaft of 60 mm: roughed and finished along lines and arcs, a form in short blocks as from a CAM system, a groove, a
/// thread.
fn shaft() -> String {
    let mut form = String::new();
    for block in 0..800 {
        let way = f64::from(block) * 0.05;
        let _ = writeln!(form, "X{:.3} Z{:.3}", 55.6 - 1.2 * (way / 6.0).sin().powi(2), -44.0 - way);
    }
    format!(
        "O0001\nG18 G21 G40 G97 S1200 M3\nG50 S3000\nG96 S200\n\
         T0101\nG0 X62. Z2.\nG71 U2. R0.5\nG71 P100 Q200 U0.4 W0.1 F0.25\n\
         N100 G0 X16.\nG1 Z0 F0.15\nX20. Z-2.\nZ-14.\nX24. Z-16.\nG2 X32. Z-20. R4.\nG1 Z-28.\nG3 X40. Z-32. R4.\n\
         G1 X50. Z-40.\nX56. Z-42.\nZ-86.\nN200 X62.\n\
         G0 X100. Z50.\nT0202\nG0 X62. Z2.\nG70 P100 Q200\n\
         G0 X62. Z-44.\nG1 X55.6 F0.2\nF0.1\n{form}G0 X100. Z50.\n\
         T0303\nG97 S800\nG0 X34. Z-24.\nG75 R0.5\nG75 X26. Z-26. P1000 Q600 F0.08\nG0 X100. Z50.\n\
         T0404\nG97 S1000\nG0 X22. Z4.\nG76 P020060 Q50 R0.05\nG76 X17.546 Z-12. P1227 Q300 F2.\nG0 X100. Z50.\nM30\n"
    )
}

/// What a job was.
struct Outcome {
    blocks: u32,
    ticks: u64,
    machine_s: f64,
    removed_mm2: f64,
}

/// Runs the job once.
fn run_once(text: &str, [insert, finger]: &[Outline; 2]) -> Result<Outcome, String> {
    let control = Control::load("fanuc-0i-tf").map_err(|fault| format!("{fault:?}"))?;
    let mut memory = Memory(text.as_bytes().to_vec());
    let mut interpreter = Interpreter::new(control, &Setup::default(), SourceId(0), Options::default())
        .map_err(|fault| fault.message)?;
    let rates = MachineRates { dynamics: Some(Dynamics::default()), ..MachineRates::default() };
    let start = interpreter.position();
    let bar = Section::bar(30.0, -120.0, 0.0).map_err(|fault| format!("{fault:?}"))?;
    let whole_mm2 = bar.area_mm2();
    let rapids =
        RapidRates { x_mm_per_min: rates.rapid_x_mm_per_min, z_mm_per_min: rates.rapid_z_mm_per_min };
    let mut machining = Machining::new(bar, start, rapids);
    for (tool, cutting) in [(1, insert), (2, finger), (3, finger), (4, finger)] {
        machining.set_tool(tool, &ToolShape { cutting: cutting.clone(), body: None });
    }
    let mut player = Player::new(start, rates, 1000.0);
    let (mut blocks, mut ticks, mut sum) = (0, 0u64, 0.0);
    let mut sink = |sample: &Sample| {
        ticks += 1;
        sum += sample.place[0] + sample.place[1];
    };
    loop {
        match interpreter.step(&mut memory) {
            Step::Emit(command) => {
                blocks += 1;
                machining.advance(&command, &mut |_| {});
                player.push(&command, &mut sink);
            }
            Step::NeedSync(_) => {}
            Step::Alarm(alarm) => return Err(format!("alarm {} at {:?}", alarm.key, alarm.place)),
            Step::End => break,
        }
    }
    player.finish(&mut sink);
    std::hint::black_box(sum);
    let removed_mm2 = whole_mm2 - machining.section().area_mm2();
    Ok(Outcome { blocks, ticks, machine_s: player.played_s(), removed_mm2 })
}

/// T5: jobs, one after the other, beside the machine's own time.
pub fn run(samples: u64, board: &mut Board) -> Result<(), String> {
    let (text, outlines) = (shaft(), [insert()?, finger()?]);
    let stopwatch = Stopwatch::start();
    let (mut ticks, mut machine_s, mut jobs) = (0, 0.0, 0u32);
    let mut last = None;
    while ticks < samples {
        let outcome = run_once(&text, &outlines)?;
        (ticks, machine_s, jobs) = (ticks + outcome.ticks, machine_s + outcome.machine_s, jobs + 1);
        last = Some(outcome);
    }
    let times = machine_s / stopwatch.seconds();
    board.note("T5", times);
    if let Some(Outcome { blocks, machine_s, removed_mm2, .. }) = last {
        println!(
            "T5 a job of {blocks} commands, {machine_s:.0} s on the machine, {removed_mm2:.1} mm² cut away: read, interpreted, cut \
             and played at 1000 ticks a second {times:.0} x as fast as the machine runs ({jobs} times)"
        );
    }
    Ok(())
}
