//! Writes a report of a small hand-made path, for the browser test and for looking at.
//!
//! `cargo run -p turnwright-export --example demo_report -- REPORT.html [PICTURE.svg [PICTURE.png [en|zh]]]`
//!
//! The path is that of the program below: rough turning in passes, finishing along a figure with arcs, a
//! groove, a thread. The moves are computed here and not by the interpreter, so that the test of the report
//! rests on this crate alone.

#![allow(clippy::disallowed_methods)]

use std::num::NonZeroU32;

use turnwright_canon::{
    Action, Command, CycleLabel, CycleOrigin, Dwell, Origin, Phase, RapidPath, Shape, Turn,
};
use turnwright_diagnostics::Severity;
use turnwright_export::Language;
use turnwright_export::formats::html::{
    CycleTable, Fact, OperationRow, Report, ReportDiagnostic, write_html,
};
use turnwright_export::formats::svg::{PictureOptions, write_svg};
use turnwright_export::passes::{BlockFacts, Cycle, GivenWord, PassRecorder, Setting};
use turnwright_export::path::PathRecorder;
use turnwright_units::{
    Angle, Feed, FeedPerRevolution, Lead, LeastIncrement, Length, Position, Radius, Seconds, WorkTip,
};

const PROGRAM: &str = "\
%
O0001 (DEMO SHAFT)
N10 G00 X150. Z100.
N20 T0101
N30 G50 S2500
N40 G96 S180 M03
N50 G00 X52. Z2. M08
N60 G71 U2. R0.5
N70 G71 P80 Q150 U0.4 W0.1 F0.3
N80 G00 X16.
N90 G01 Z0. F0.15
N100 X20. Z-2.
N110 Z-25.
N120 X26.
N130 G03 X36. Z-30. R5.
N140 G01 Z-45.
N145 G02 X50. Z-52. R7.
N150 G01 X52.
N160 G70 P80 Q150
N170 G00 X150. Z100.
N180 T0303 (GROOVE 3 MM)
N190 G97 S800 M03
N200 G00 X28. Z-25.
N210 G01 X16. F0.08
N220 G04 X0.5
N230 G00 X28.
N240 X150. Z100.
N250 T0505 (THREAD M20X1.5)
N260 G00 X24. Z5.
N270 G76 P020060 Q100 R0.05
N280 G76 X18.16 Z-23. P920 Q350 F1.5
N290 G00 X150. Z100. M09
N300 T0000 (</script><b>not bold</b> & 车刀)
N310 M30
%";

fn at(diameter_mm: f64, z_mm: f64) -> Position<WorkTip> {
    let exact = |mm| Length::from_mm_rounded(mm, LeastIncrement::METRIC_B).expect("in range");
    Position::new(Radius(exact(diameter_mm).half()), exact(z_mm))
}

/// Feeds commands into a recorder, with a rough time for each.
struct Demo {
    path: PathRecorder,
    passes: PassRecorder,
    origin: Origin,
}

impl Demo {
    fn line(&mut self, line: u32) {
        self.origin = Origin::line(line);
    }

    fn cycle(&mut self, label: u16, pass: u32, phase: Phase, figure_line: Option<NonZeroU32>) {
        self.origin.cycle = Some(CycleOrigin { label: CycleLabel(label), pass, phase });
        self.origin.figure_line = figure_line.map(NonZeroU32::get);
    }

    fn add(&mut self, action: Action, seconds: f64) {
        let command = Command::new(action, self.origin);
        self.path.add(&command, seconds);
        self.passes.add(&command, facts);
    }

    fn rapid(&mut self, diameter_mm: f64, z_mm: f64) {
        self.add(Action::Rapid { to: at(diameter_mm, z_mm), path: RapidPath::EachAxis, others: None }, 0.3);
    }

    fn cut(&mut self, diameter_mm: f64, z_mm: f64, shape: Shape) {
        let feed = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(300_000)));
        self.add(Action::Feed { to: at(diameter_mm, z_mm), shape, feed, others: None }, 1.5);
    }

    fn thread(&mut self, diameter_mm: f64, z_mm: f64) {
        let lead = Lead(Length::from_nm(1_500_000));
        let to = at(diameter_mm, z_mm);
        self.add(
            Action::Thread {
                to,
                lead,
                lead_end: None,
                start_angle: Angle::ZERO,
                shape: Shape::Line,
                is_chained: false,
            },
            1.8,
        );
    }
}

/// What a control would say of the block that runs a cycle.
fn facts(command: &Command) -> BlockFacts {
    let setting = |name, number: &str, value, text: &str| Setting {
        name,
        number: number.into(),
        value,
        given: Some(GivenWord { text: text.into(), line: command.origin.line - 1 }),
    };
    let (function, words, settings, crest): (_, &[(u8, &str)], _, _) = match command.origin.line {
        9 => ("rough-turning", &[], vec![setting("cycle-depth-of-cut", "5132", 2.0, "U2.")], None),
        31 => {
            let least = setting("thread-minimum-depth", "5140", 0.1, "Q100");
            ("multi-thread", &[(b'P', "P920"), (b'Q', "Q350")], vec![least], Some(at(20.0, 0.0).x))
        }
        _ => ("finishing", &[], vec![], None),
    };
    let words = words.iter().map(|(letter, text)| (*letter, (*text).to_string())).collect();
    BlockFacts { function: function.into(), words, settings, crest }
}

/// Where the figure is at this diameter, and the line that shapes it there.
fn figure_z_mm(diameter_mm: f64) -> (f64, u32) {
    let radius_mm = diameter_mm / 2.0;
    if diameter_mm >= 36.0 {
        (-45.0 - (49.0 - (25.0 - radius_mm).powi(2)).max(0.0).sqrt(), 17)
    } else if diameter_mm >= 26.0 {
        (-30.0 + (25.0 - (radius_mm - 13.0).powi(2)).max(0.0).sqrt(), 15)
    } else if diameter_mm > 20.0 {
        (-25.0, 14)
    } else {
        (-(diameter_mm - 16.0) / 2.0, 12)
    }
}

fn run() -> (PathRecorder, Vec<Cycle>) {
    let start = at(200.0, 150.0);
    let path = PathRecorder::new(start, 8_000.0, 12_000.0);
    let mut demo = Demo { path, passes: PassRecorder::new(start), origin: Origin::line(1) };
    demo.line(3);
    demo.rapid(150.0, 100.0);
    demo.line(4);
    demo.add(Action::Tool { tool: 1, offset: 1 }, 1.0);
    demo.line(7);
    demo.rapid(52.0, 2.0);
    rough_and_finish(&mut demo);
    demo.line(20);
    demo.rapid(150.0, 100.0);
    demo.line(21);
    demo.add(Action::Tool { tool: 3, offset: 3 }, 1.0);
    demo.line(23);
    demo.rapid(28.0, -25.0);
    demo.line(24);
    demo.cut(16.0, -25.0, Shape::Line);
    demo.line(25);
    demo.add(Action::Dwell(Dwell::Time(Seconds(0.5))), 0.5);
    demo.line(26);
    demo.rapid(28.0, -25.0);
    demo.line(27);
    demo.rapid(150.0, 100.0);
    demo.line(28);
    demo.add(Action::Tool { tool: 5, offset: 5 }, 1.0);
    demo.line(29);
    demo.rapid(24.0, 5.0);
    demo.line(31);
    for pass in 1..=6u32 {
        let depth_mm = 2.0 * (0.35 * f64::from(pass).sqrt()).min(0.92);
        demo.cycle(760, pass, Phase::Infeed, None);
        demo.rapid(20.0 - depth_mm, 5.0 - depth_mm * 0.28);
        demo.cycle(760, pass, Phase::Thread, None);
        demo.thread(20.0 - depth_mm, -23.0);
        demo.cycle(760, pass, Phase::Out, None);
        demo.rapid(24.0, -23.0);
        demo.cycle(760, pass, Phase::Return, None);
        demo.rapid(24.0, 5.0);
    }
    demo.line(32);
    demo.origin.cycle = None;
    demo.rapid(150.0, 100.0);
    (demo.path, demo.passes.finish().0)
}

fn rough_and_finish(demo: &mut Demo) {
    demo.line(9);
    demo.cycle(710, 0, Phase::Approach, None);
    demo.rapid(52.4, 2.1);
    for pass in 1..=9u32 {
        let diameter_mm = 52.0 - 4.0 * f64::from(pass);
        let (z_mm, figure_line) = figure_z_mm(diameter_mm - 0.4);
        demo.cycle(710, pass, Phase::Infeed, None);
        demo.rapid(diameter_mm, 2.1);
        demo.cycle(710, pass, Phase::Cut, NonZeroU32::new(figure_line));
        demo.cut(diameter_mm, z_mm + 0.1, Shape::Line);
        demo.cycle(710, pass, Phase::Escape, None);
        demo.cut(diameter_mm + 1.0, z_mm + 0.6, Shape::Line);
        demo.cycle(710, pass, Phase::Return, None);
        demo.rapid(diameter_mm + 1.0, 2.1);
    }
    for (allowance_mm, phase, line, label) in [(0.4, Phase::Contour, 9, 710), (0.0, Phase::Finish, 19, 700)] {
        demo.line(line);
        let end_z_mm = allowance_mm / 4.0;
        let figure = |demo: &mut Demo, line| demo.cycle(label, 10, phase, NonZeroU32::new(line));
        let d = |diameter_mm| diameter_mm + allowance_mm;
        let arc = |turn, diameter_mm, z_mm| Shape::Arc { turn, centre: at(diameter_mm, z_mm) };
        figure(demo, 10);
        demo.rapid(d(16.0), 2.0 + end_z_mm);
        let lines = [(11, 16.0, 0.0), (12, 20.0, -2.0), (13, 20.0, -25.0), (14, 26.0, -25.0)];
        for (line, diameter_mm, z_mm) in lines {
            figure(demo, line);
            demo.cut(d(diameter_mm), z_mm + end_z_mm, Shape::Line);
        }
        figure(demo, 15);
        demo.cut(d(36.0), -30.0 + end_z_mm, arc(Turn::CounterClockwise, d(26.0), -30.0 + end_z_mm));
        figure(demo, 16);
        demo.cut(d(36.0), -45.0 + end_z_mm, Shape::Line);
        figure(demo, 17);
        demo.cut(d(50.0), -52.0 + end_z_mm, arc(Turn::Clockwise, d(50.0), -45.0 + end_z_mm));
        figure(demo, 18);
        demo.cut(52.0 + allowance_mm, -52.0 + end_z_mm, Shape::Line);
        demo.cycle(label, 10, Phase::Home, None);
        demo.rapid(52.0, 2.0);
    }
}

fn report(language: Language, cycles: Vec<Cycle>) -> Report<'static> {
    let row = |index, tool, name: [&str; 2], code: &str, lines: (u32, u32), passes, numbers: [f64; 3]| {
        let [cutting_mm, rapid_mm, seconds] = numbers;
        OperationRow {
            index,
            tool: Some(tool),
            name_en: name[0].into(),
            name_zh: name[1].into(),
            code: code.into(),
            first_line: lines.0,
            last_line: lines.1,
            passes,
            cutting_mm,
            rapid_mm,
            seconds,
        }
    };
    let fact = |en: &str, zh: &str, value: &str| Fact {
        label_en: en.into(),
        label_zh: zh.into(),
        value: value.into(),
    };
    let found = |severity, id: &str, key: &str, place: (u32, u32, u32), en: [&str; 3], zh: [&str; 3]| {
        ReportDiagnostic {
            severity,
            id: id.into(),
            key: key.into(),
            line: place.0,
            column: place.1,
            end_column: place.2,
            message_en: en[0].into(),
            cause_en: en[1].into(),
            remedy_en: en[2].into(),
            message_zh: zh[0].into(),
            cause_zh: zh[1].into(),
            remedy_zh: zh[2].into(),
            mark: None,
        }
    };
    let cycles = cycles.into_iter().map(|cycle| {
        let [name_en, name_zh] = match cycle.line {
            9 => ["Rough turning", "粗车外圆"],
            31 => ["Thread in many passes", "多重螺纹切削"],
            _ => ["Finish turning", "精车"],
        }
        .map(String::from);
        let names = |setting: &Setting| match setting.name {
            "thread-minimum-depth" => ["Least depth", "最小切深"].map(String::from),
            _ => ["Depth of cut", "切深"].map(String::from),
        };
        let setting_names = cycle.settings.iter().map(names).collect();
        CycleTable { cycle, name_en, name_zh, setting_names }
    });
    Report {
        assumptions: Vec::new(),
        title: "demo-shaft.nc".into(),
        control: "fanuc-0i-tf".into(),
        control_reason: "nothing else was asked for".into(),
        source: 0,
        program_lines: PROGRAM.lines().map(str::to_owned).collect(),
        operations: vec![
            row(1, 1, ["Rough turning", "粗车外圆"], "G71", (7, 9), 10, [338.4, 402.7, 62.5]),
            row(2, 1, ["Finish turning", "精车"], "G70", (19, 19), 1, [71.2, 120.3, 21.0]),
            row(3, 3, ["Groove", "切槽"], "G01", (21, 27), 1, [6.0, 244.8, 4.1]),
            row(4, 5, ["Thread", "车螺纹"], "G76", (28, 32), 6, [162.0, 512.4, 22.8]),
        ],
        cycles: cycles.collect(),
        diagnostics: vec![
            found(
                Severity::Warning,
                "V41",
                "thread-run-in-short",
                (29, 15, 18),
                [
                    "The run-in of the thread is short.",
                    "The axis needs 3.2 mm to reach the lead; there are 5 mm less the infeed.",
                    "Start the thread at Z6.",
                ],
                ["螺纹引入距离偏短。", "轴需要 3.2 mm 才能达到导程速度。", "将螺纹起点改为 Z6。"],
            ),
            found(
                Severity::Note,
                "V07",
                "tool-cancelled-at-the-end",
                (33, 6, 11),
                ["The offset is cancelled away from the work.", "", ""],
                ["在远离工件处取消刀补。", "", ""],
            ),
            found(
                Severity::Alarm,
                "PS0010",
                "g-code-unknown",
                (34, 1, 5),
                ["IMPROPER G-CODE", "Shown here only to show an alarm.", "Nothing to do."],
                ["G 代码错误", "此处仅用于演示报警。", "无需处理。"],
            ),
        ],
        facts: vec![
            fact("X of the cuts", "切削 X 范围", "⌀16 … ⌀52.4"),
            fact("Z of the cuts", "切削 Z 范围", "−52 … 2.1"),
            fact("Tools", "刀具", "T01, T03, T05"),
        ],
        estimated_note_en:
            "Times are estimates: rapid rates and accelerations are those of a typical machine.".into(),
        estimated_note_zh: "时间为估算值：快移速度与加速度取自典型机床。".into(),
        language,
        ..Report::default()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let html_path =
        arguments.first().ok_or("usage: demo_report REPORT.html [PICTURE.svg [PICTURE.png [en|zh]]]")?;
    let language =
        if arguments.get(3).is_some_and(|tag| tag == "zh") { Language::Chinese } else { Language::English };
    let (path, cycles) = run();
    std::fs::write(html_path, write_html(&path, &report(language, cycles)))?;
    let options = PictureOptions { title: "demo-shaft.nc".into(), language, ..PictureOptions::default() };
    let svg = write_svg(&path, &options);
    if let Some(svg_path) = arguments.get(1) {
        std::fs::write(svg_path, &svg)?;
    }
    #[cfg(feature = "png")]
    if let Some(png_path) = arguments.get(2) {
        std::fs::write(png_path, turnwright_export::formats::png::write_png(&svg, 1.0)?)?;
    }
    Ok(())
}
