//! Commands and options.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Args, FromArgMatches, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use turnwright_control::SectionSpot;
use turnwright_export::mesh::CHORD_MM;

use crate::operator::{OperatorActions, PanelOptions};
use crate::output::PartFile;
use crate::speech::Speech;

/// Yellow headings and green literals, as the tools beside it have them.
const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Yellow.on_default().bold())
    .usage(AnsiColor::Yellow.on_default().bold())
    .literal(AnsiColor::Green.on_default());

/// Runs turning-centre NC programs as the control would, before the chuck turns.
#[derive(Debug, Parser)]
#[command(name = "turnwright", version, styles = STYLES, propagate_version = true, after_long_help = text("exit-status"))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) presentation: Presentation,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// How things are said.
#[derive(Debug, Args)]
pub(crate) struct Presentation {
    /// Language of messages and reports [default: from LC_ALL, LC_MESSAGES or LANG]
    #[arg(long, global = true, value_enum, value_name = "LANG")]
    pub(crate) lang: Option<Lang>,
    /// Colours on the terminal; auto honours NO_COLOR
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t = Colour::Auto)]
    pub(crate) color: Colour,
}

/// A language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Lang {
    /// English
    En,
    /// 中文
    Zh,
}

/// When to colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Colour {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// Even into a file or a pipe
    Always,
    /// Not at all
    Never,
}

/// What is to be done.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Run(Run),
    Check(Check),
    Trace(Trace),
    Plot(Plot),
    Part(PartOptions),
    Motion(Motion),
    Time(Time),
    Measure(Measure),
    Diff(Diff),
    Explain(Explain),
    Controls(Controls),
    Data(Data),
    Setup(SetupOptions),
    Completions(Completions),
    Man(Man),
}

/// What describes the options of a command.
type Describe = fn(clap::Command) -> clap::Command;

/// Every command by its name.
const COMMANDS: [(&str, Describe); 15] = [
    ("run", Run::augment_args),
    ("check", Check::augment_args),
    ("trace", Trace::augment_args),
    ("plot", Plot::augment_args),
    ("part", PartOptions::augment_args),
    ("motion", Motion::augment_args),
    ("time", Time::augment_args),
    ("measure", Measure::augment_args),
    ("diff", Diff::augment_args),
    ("explain", Explain::augment_args),
    ("controls", Controls::augment_args),
    ("data", Data::augment_args),
    ("setup", SetupOptions::augment_args),
    ("completions", Completions::augment_args),
    ("man", Man::augment_args),
];

impl Arguments {
    /// What `words` ask for, where the first of them names a command and nothing is wrong with the others. Whoever has
    /// to be helped needs the description of all commands.
    pub(crate) fn of_one_command(words: &[OsString]) -> Option<Self> {
        let wanted = words.get(1)?;
        let (name, describe) = COMMANDS.into_iter().find(|(name, _)| wanted == name)?;
        let mut all = Presentation::augment_args(clap::Command::new("turnwright"))
            .subcommand(describe(clap::Command::new(name)));
        let matches = all.try_get_matches_from_mut(words).ok()?;
        // Taking a description apart would take a good part of a short run.
        std::mem::forget(all);
        Self::from_arg_matches(&matches).ok()
    }
}

/// Which control and setup a program meets, and the switches of the machine.
#[derive(Clone, Debug, Args)]
pub(crate) struct Machine {
    /// Control to run as [default: the program's own (CONTROL name), else the setup file's, else the usual one]
    #[arg(long, value_name = "NAME")]
    pub(crate) control: Option<String>,
    /// Setup file: machine, offsets, parameters [default: the program's name with .toml, beside it]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) setup: Option<PathBuf>,
    /// Sets a parameter of the control, for example 5130=10, 3401#0=1 or, of one axis, 1221.Z=-50; may be repeated
    #[arg(long = "param", value_name = "NO[#BIT][.AXIS]=VALUE", value_parser = assignment)]
    pub(crate) parameters: Vec<(String, String)>,
    /// Block skip switches that are on, 1 to 9: blocks with /1 … /9 are passed over (/ is /1)
    #[arg(long, value_name = "1,3", value_delimiter = ',', value_parser = clap::value_parser!(u8).range(1..=9))]
    pub(crate) skip: Vec<u8>,
    /// M01 stops
    #[arg(long)]
    pub(crate) optional_stop: bool,
    /// The program was typed in at the panel: G70 to G73, jumps and loops are refused in it
    #[arg(long)]
    pub(crate) mdi: bool,
    /// Treats a warning as an error: its name or number, or "warnings" for all; may be repeated
    #[arg(long, value_name = "NAME|warnings", value_delimiter = ',')]
    pub(crate) deny: Vec<String>,
    /// Does not tell a warning: its name or number; may be repeated
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) allow: Vec<String>,
    /// Blocks executed before the run is stopped
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) max_blocks: Option<u64>,
    /// Blocks of loops executed without a single move before the run is stopped
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) max_idle_blocks: Option<u64>,
    /// Writes what the program prints with DPRNT and BPRNT to this file
    #[arg(long, value_name = "FILE", value_hint = clap::ValueHint::FilePath)]
    pub(crate) program_output: Option<PathBuf>,
}

/// The form of diagnostics and reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    #[default]
    Human,
    /// For scripts
    Json,
    /// SARIF 2.1.0, for code review tools
    Sarif,
}

/// The form of what is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum LookupFormat {
    /// For people
    #[default]
    Human,
    /// For scripts
    Json,
}

/// The form of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TraceFormat {
    /// One JSON object a line; the default unless the output is a terminal
    #[value(alias = "json")]
    Jsonl,
    /// The listing alone
    Text,
    /// The listing with line numbers; the default on a terminal
    Human,
}

/// Runs a program and reports alarms, warnings, tools, extents, the part and the time.
///
/// The program runs as on the control: cycles, corners, feeds and all. The part is cut out of the stock that the setup
/// gives, or that the program seems to be written for. With --out the report, the path, the part (drawing, solid, mesh)
/// and the trace are written into a folder.
#[derive(Debug, Args)]
#[command(after_long_help = examples("run"))]
pub(crate) struct Run {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// Folder for the report, the pictures, the part and the trace; made when it does not exist
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Leaves the view in space out of report.html, which is 0.6 MB smaller then
    #[arg(long, requires = "out")]
    pub(crate) no_3d: bool,
    /// Form of the report
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Reports alarms and warnings of programs.
///
/// Folders are searched for .nc .cnc .tap .txt .mpf .ngc .min .prg .iso and files named O and a number. Files
/// are checked in parallel, the output keeps their order.
#[derive(Debug, Args)]
#[command(after_long_help = examples("check"))]
pub(crate) struct Check {
    /// Programs and folders; - for standard input
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// The control's own alarms and nothing more
    #[arg(long, conflicts_with = "deny")]
    pub(crate) alarms_only: bool,
    /// Form of the diagnostics
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Prints every move and action of a program, one a line.
///
/// Lengths are millimetres, X is a diameter. An alarm is the last line.
#[derive(Debug, Args)]
#[command(after_long_help = examples("trace"))]
pub(crate) struct Trace {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// Form of the trace
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) format: Option<TraceFormat>,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Draws the tool path of a program.
#[derive(Debug, Args)]
#[command(after_long_help = examples("plot"))]
pub(crate) struct Plot {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// The picture, a name that ends in .svg or .png, or the lines and arcs for CAD, .dxf
    #[arg(short, long, value_name = "OUT.svg|OUT.png|OUT.dxf", value_parser = path_name)]
    pub(crate) output: PathBuf,
    /// Form of the diagnostics
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Writes the finished part: a drawing, a solid or a mesh.
///
/// The part is cut out of the stock that the setup gives, or that the program seems to be written for. Lengths are
/// millimetres, the spindle axis is Z, zero is that of the program; glTF has metres, with the axis along X. Threads are
/// plain surfaces with a name and a colour of their own.
#[derive(Debug, Args)]
#[command(name = "part", after_long_help = examples("part"))]
pub(crate) struct PartOptions {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// The part: .svg or .png the drawing, .step the solid, .stl or .glb triangles, .dxf the half-section
    #[arg(short, long, value_name = "OUT.step|…", value_parser = part_name)]
    pub(crate) output: PathBuf,
    /// How far the triangles of .stl and .glb may lie off the part, mm
    #[arg(long, value_name = "MM", default_value_t = CHORD_MM, value_parser = chord)]
    pub(crate) chord: f64,
    /// Form of the diagnostics
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Writes where the axes are at every tick, with acceleration and jerk, as a table (CSV or Parquet).
///
/// Lengths are millimetres, X is a diameter, places are those of the tool tip in work coordinates. In polar and
/// cylindrical interpolation X and V are those of the virtual plane. The operator may come between: overrides, dry run,
/// single block and feed hold, from the start or at any second.
#[derive(Debug, Args)]
#[command(after_long_help = examples("motion"))]
pub(crate) struct Motion {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// Ticks a second
    #[arg(long, value_name = "HZ", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) rate: u32,
    /// The table; - for standard output, as CSV
    #[arg(short, long, value_name = "OUT.csv|OUT.parquet", value_parser = samples_name)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) panel: PanelOptions,
    #[command(flatten)]
    pub(crate) actions: OperatorActions,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Tells how long programs take, and what for.
///
/// One program: by cause, tool, operation and line. Many programs and folders: a table with a line for each and their
/// sum. What only the shop knows, such as tool change, bar feed and M codes, stands in the setup file under [rates].
#[derive(Debug, Args)]
#[command(after_long_help = examples("time"))]
pub(crate) struct Time {
    /// Programs and folders; - for standard input
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Times block by block (.csv; of many programs a line for each), or drawn over time (.svg, .png)
    #[arg(short, long, value_name = "OUT.csv|OUT.svg|OUT.png", value_hint = clap::ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Form of the answer
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
    #[command(flatten)]
    pub(crate) panel: PanelOptions,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Measures the part that a program cuts.
///
/// Without --at all its sizes are listed: diameters, bores, tapers, radii, faces, grooves, threads, volume, and mass where
/// the setup names the material. Sizes that the setup file gives with [[measure]] are judged by their tolerance.
///
/// With --target the part is held against a drawing, or against the figure that its finishing cycle (G70) follows as it is
/// programmed: what is cut too deep and what is left standing, with the places and the lines that cut. A drawing is the
/// half-section above the axis as DXF: X of the drawing is Z of the machine, Y is the radius, as in part.dxf; lines on the
/// axis count for nothing, inches come from its $INSUNITS. Exit status 1 when anything is out of tolerance.
#[derive(Debug, Args)]
#[command(after_long_help = examples("measure"))]
pub(crate) struct Measure {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// Where to measure: Z-32 for diameters and wall, X25 for lengths and widths at a diameter; may be repeated
    #[arg(long, value_name = "PLACE", value_parser = SectionSpot::parse)]
    pub(crate) at: Vec<SectionSpot>,
    /// What the part ought to be: a half-section as DXF, or g70 for the figure of the finishing cycles
    #[arg(long, value_name = "FIGURE.dxf|g70", value_hint = clap::ValueHint::FilePath)]
    pub(crate) target: Option<PathBuf>,
    /// Layer of the DXF file that holds the contour [default: PART, else the only layer with lines]
    #[arg(long, value_name = "NAME", requires = "target")]
    pub(crate) layer: Option<String>,
    /// How far the part may lie off its target, mm
    #[arg(long, value_name = "MM", default_value_t = 0.01, value_parser = tolerance, requires = "target")]
    pub(crate) tolerance: f64,
    /// Draws part and target over each other: a name that ends in .svg or .png
    #[arg(short, long, value_name = "OUT.svg|OUT.png", value_parser = picture_name, requires = "target")]
    pub(crate) output: Option<PathBuf>,
    /// Form of the answer
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Tells what an edit changed in passes, part and time, not in text.
///
/// Exit status: 0 the programs do the same, 1 they differ, 2 trouble. With the seven arguments of a git external diff it
/// shows the same and exits with 0, as git wants it; see the README for the lines that make git use it.
#[derive(Debug, Args)]
#[command(after_long_help = examples("diff"))]
pub(crate) struct Diff {
    /// The old and the new program; or the seven arguments that git gives an external diff
    #[arg(required = true, num_args = 2..=9, value_names = ["OLD", "NEW"])]
    pub(crate) files: Vec<PathBuf>,
    /// Draws both parts over each other: a name that ends in .svg or .png
    #[arg(short, long, value_name = "OUT.svg|OUT.png", value_parser = picture_name)]
    pub(crate) output: Option<PathBuf>,
    /// Form of the answer
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Says what a G or M code, an alarm or a parameter means, or what each pass of a cycle does and why.
#[derive(Debug, Args)]
#[command(after_long_help = examples("explain"))]
pub(crate) struct Explain {
    /// G71, M03, PS0062, 062, cut-depth-illegal, 5130, 3401#0 …; with --line a program
    #[arg(value_name = "CODE|FILE")]
    pub(crate) code: String,
    /// Shows every pass of the cycle that this line of the program runs, and what caused it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) line: Option<u32>,
    /// Draws that cycle with its passes numbered: a name that ends in .svg or .png
    #[arg(short, long, value_name = "OUT.svg|OUT.png", value_parser = picture_name, requires = "line")]
    pub(crate) output: Option<PathBuf>,
    /// Form of the answer
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Lists the controls and what differs between them.
#[derive(Debug, Args)]
#[command(after_long_help = examples("controls"))]
pub(crate) struct Controls {
    /// The control to show in full
    #[arg(conflicts_with = "diff")]
    pub(crate) name: Option<String>,
    /// Shows only what differs between two controls
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    pub(crate) diff: Option<Vec<String>>,
    /// Form of the answer
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
}

/// Shows offsets, work zeros and parameters, and exchanges them with the control's own text form.
///
/// The data is that of a setup file. --import takes texts that the control has put out into it: lines of G10, lines of
/// parameters (N_ P_). --export writes such a text. Parameters that are not known here are kept and written again.
#[derive(Debug, Args)]
#[command(after_long_help = examples("data"))]
pub(crate) struct Data {
    /// Setup file to start from [default: an empty one]
    #[arg(value_name = "SETUP.toml")]
    pub(crate) setup: Option<PathBuf>,
    /// Text of the control to take in; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub(crate) import: Vec<PathBuf>,
    /// Data to write as the control's text
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(crate) export: Option<Export>,
    /// Where to write the setup file, or with --export the text; - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Control whose data it is [default: the setup file's, else the usual one]
    #[arg(long, value_name = "NAME")]
    pub(crate) control: Option<String>,
    /// Form of what is shown
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: LookupFormat,
}

/// Writes the setup that a program seems to be written for, to be edited.
///
/// Stock, chuck and tools are taken from the program where its setup file and its comments leave them open; each
/// assumption stands as a comment beside its value.
#[derive(Debug, Args)]
#[command(name = "setup", after_long_help = examples("setup"))]
pub(crate) struct SetupOptions {
    /// The program; - for standard input
    pub(crate) file: PathBuf,
    /// Where to write the setup file; - for standard output, which is the default
    #[arg(short, long, value_name = "FILE.toml", value_hint = clap::ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Form of the diagnostics
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) machine: Machine,
}

/// Kinds of stored data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Export {
    /// Tool offsets
    Offsets,
    /// Work zeros and shifts
    Work,
    /// Parameters
    Parameters,
    /// All of these, one record each
    All,
}

/// Prints a completion script for a shell.
#[derive(Debug, Args)]
#[command(after_long_help = examples("completions"))]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

/// Prints the manual page.
#[derive(Debug, Args)]
#[command(after_long_help = examples("man"))]
pub(crate) struct Man {
    /// The command whose page is wanted [default: that of turnwright itself]
    #[arg(value_parser = COMMAND_NAMES)]
    pub(crate) command: Option<String>,
}

/// The commands that have a page.
const COMMAND_NAMES: [&str; 15] = [
    "run",
    "check",
    "trace",
    "plot",
    "part",
    "motion",
    "time",
    "measure",
    "diff",
    "explain",
    "controls",
    "data",
    "setup",
    "completions",
    "man",
];

/// A text of the help, in the language of the environment: the options are not known yet.
fn text(key: &'static str) -> &'static str {
    Speech::new(None).get(key)
}

/// The examples of a command.
fn examples(command: &str) -> &'static str {
    Speech::new(None).find(&format!("examples-{command}"))
}

fn picture_name(text: &str) -> Result<PathBuf, String> {
    named(text, &["svg", "png"]).ok_or("expected a name that ends in .svg or .png".to_string())
}

fn path_name(text: &str) -> Result<PathBuf, String> {
    picture_name(text).or_else(|_| {
        named(text, &["dxf"]).ok_or("expected a name that ends in .svg, .png or .dxf".to_string())
    })
}

fn part_name(text: &str) -> Result<PathBuf, String> {
    let ends = PartFile::ENDS.map(|(end, _)| end);
    named(text, &ends).ok_or_else(|| format!("expected a name that ends in .{}", ends.join(", .")))
}

/// A path whose extension is one of these.
fn named(text: &str, ends: &[&str]) -> Option<PathBuf> {
    let path = PathBuf::from(text);
    let is_known = |end: &&str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(end));
    ends.iter().any(is_known).then_some(path)
}

/// The forms of a table of samples.
pub(crate) const PARQUET: &str = "parquet";

fn samples_name(text: &str) -> Result<PathBuf, String> {
    let path = if text == "-" { Some(PathBuf::from(text)) } else { named(text, &["csv", PARQUET]) };
    path.ok_or("expected -, or a name that ends in .csv or .parquet".to_string())
}

/// Whether a table is written for data programs.
pub(crate) fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(PARQUET))
}

fn tolerance(text: &str) -> Result<f64, String> {
    let tolerance: Option<f64> = text.parse().ok().filter(|tolerance| (0.001..=10.0).contains(tolerance));
    tolerance.ok_or_else(|| "expected a length from 0.001 to 10 mm".to_string())
}

fn chord(text: &str) -> Result<f64, String> {
    let chord: Option<f64> = text.parse().ok().filter(|chord| (0.0001..=10.0).contains(chord));
    chord.ok_or_else(|| "expected a length from 0.0001 to 10 mm".to_string())
}

fn assignment(text: &str) -> Result<(String, String), String> {
    let fault = || format!("expected NO=VALUE or NO#BIT=VALUE, for example 5130=10, not {text:?}");
    let (number, value) = text.split_once('=').ok_or_else(fault)?;
    if number.trim().is_empty() || value.trim().is_empty() {
        return Err(fault());
    }
    Ok((number.trim().to_string(), value.trim().to_string()))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn each_command_alone_is_as_it_is_among_all() {
        let mut all = Arguments::command();
        all.build();
        let names = |command: &clap::Command| -> Vec<String> {
            command.get_arguments().map(|argument| format!("{argument:?}")).collect()
        };
        let commands = all.get_subcommands().filter(|command| command.get_name() != "help");
        let mut known = COMMANDS.into_iter();
        for command in commands {
            let (name, describe) = known.next().expect("is in the list");
            assert_eq!(name, command.get_name());
            let mut alone = Presentation::augment_args(
                clap::Command::new("turnwright").version("1").propagate_version(true),
            )
            .subcommand(describe(clap::Command::new(name)));
            alone.build();
            let alone = alone.find_subcommand(name).expect("was added");
            assert_eq!(names(alone), names(command), "{name}");
        }
        assert!(known.next().is_none());
    }

    #[test]
    fn what_is_wrong_or_asks_for_help_is_left_to_the_description_of_all() {
        let ask = |line: &str| {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            Arguments::of_one_command(&words).map(|arguments| format!("{arguments:?}"))
        };
        for line in [
            "turnwright",
            "turnwright --lang zh check a.nc",
            "turnwright help check",
            "turnwright check --help",
            "turnwright check -V",
            "turnwright check",
            "turnwright chek a.nc",
            "turnwright check a.nc --skip 10",
            "turnwright check a.nc --alarms-only --deny warnings",
        ] {
            assert_eq!(ask(line), None, "{line}");
        }
        for line in [
            "turnwright check a.nc --alarms-only --lang zh",
            "turnwright time a.nc --color never",
            "turnwright controls",
        ] {
            let all = Arguments::try_parse_from(line.split(' ')).expect("is in order");
            assert_eq!(ask(line), Some(format!("{all:?}")), "{line}");
        }
    }
}
