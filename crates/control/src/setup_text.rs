//! A setup as the text of a file, plain or with a comment at each key of what is in and around the chuck.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::setup::typed;
use crate::{
    Bar, CheckSwitches, Chuck, Language, MeasureEntry, OffsetRow, OutlinePoint, Setup, Stock, Tailstock,
    ThreadRecord, ToolEntry,
};

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    en: String,
    zh: String,
}

/// Section, then key; the empty key is the section itself.
static KEYS: LazyLock<BTreeMap<String, BTreeMap<String, Words>>> = LazyLock::new(|| {
    toml::from_str(include_str!("../../../data/setup-keys.toml"))
        .unwrap_or_else(|error| unreachable!("data/setup-keys.toml is read by a test: {error}"))
});

/// What a key of a section means; of the section itself when the key is empty.
pub fn setup_key_words(section: &str, key: &str, language: Language) -> Option<&'static str> {
    let words = KEYS.get(section)?.get(key)?;
    Some(match language {
        Language::English => &words.en,
        Language::Chinese => &words.zh,
    })
}

/// A key of a section and its value as TOML.
type Line = (&'static str, String);

/// Adds the lines that have a value.
fn given(lines: impl IntoIterator<Item = (&'static str, Option<String>)>) -> Vec<Line> {
    lines.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
}

fn number(value: f64) -> String {
    value.to_string()
}

fn text(value: &str) -> String {
    quoted(value)
}

fn points(points: &[OutlinePoint]) -> Option<String> {
    let one = |point: &OutlinePoint| {
        let arc = match (point.r, point.turn) {
            (Some(radius), Some(turn)) => format!(", r = {radius}, turn = {}", quoted(turn.word())),
            _ => String::new(),
        };
        format!("{{ x = {}, z = {}{arc} }}", point.x, point.z)
    };
    let all: Vec<String> = points.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("[{}]", all.join(", ")))
}

fn stock_lines(stock: &Stock) -> Vec<Line> {
    given([
        ("material", stock.material.as_deref().map(text)),
        ("diameter_mm", stock.diameter_mm.map(number)),
        ("bore_mm", stock.bore_mm.map(number)),
        ("length_mm", stock.length_mm.map(number)),
        ("face_mm", Some(number(stock.face_mm))),
        ("profile", points(&stock.profile)),
    ])
}

fn chuck_lines(chuck: &Chuck) -> Vec<Line> {
    given([
        ("grip", Some(text(chuck.grip.word()))),
        ("grip_mm", Some(number(chuck.grip_mm))),
        ("jaw_z_mm", chuck.jaw_z_mm.map(number)),
        ("jaw_length_mm", Some(number(chuck.jaw_length_mm))),
        ("jaw_height_mm", Some(number(chuck.jaw_height_mm))),
        ("diameter_mm", Some(number(chuck.diameter_mm))),
        ("length_mm", Some(number(chuck.length_mm))),
        ("rpm_max", chuck.rpm_max.map(|rpm| rpm.to_string())),
        ("grip_force_kn", chuck.grip_force_kn.map(number)),
        ("grip_force_max_kn", chuck.grip_force_max_kn.map(number)),
    ])
}

fn bar_lines(bar: &Bar) -> Vec<Line> {
    given([
        ("behind_mm", bar.behind_mm.map(number)),
        ("diameter_mm", bar.diameter_mm.map(number)),
        ("bore_mm", bar.bore_mm.map(number)),
        ("end", Some(text(bar.end.word()))),
    ])
}

fn tailstock_lines(tailstock: &Tailstock) -> Vec<Line> {
    given([
        ("point_z_mm", tailstock.point_z_mm.map(number)),
        ("point_angle_deg", Some(number(tailstock.point_angle_deg))),
        ("centre_mm", Some(number(tailstock.centre_mm))),
        ("centre_length_mm", Some(number(tailstock.centre_length_mm))),
        ("quill_mm", Some(number(tailstock.quill_mm))),
        ("quill_length_mm", Some(number(tailstock.quill_length_mm))),
    ])
}

fn record_lines(record: &ThreadRecord) -> Vec<Line> {
    given([
        ("x", record.x.map(number)),
        ("z", record.z.map(number)),
        ("angle_deg", Some(number(record.angle_deg))),
    ])
}

fn measure_lines(entry: &MeasureEntry) -> Vec<Line> {
    given([
        ("name", entry.name.as_deref().map(text)),
        ("at", entry.at.as_deref().map(text)),
        ("from", entry.from.as_deref().map(text)),
        ("to", entry.to.as_deref().map(text)),
        ("diameter_mm", entry.diameter_mm.map(number)),
        ("bore_mm", entry.bore_mm.map(number)),
        ("wall_mm", entry.wall_mm.map(number)),
        ("width_mm", entry.width_mm.map(number)),
        ("length_mm", entry.length_mm.map(number)),
        ("major_mm", entry.major_mm.map(number)),
        ("minor_mm", entry.minor_mm.map(number)),
        ("lead_mm", entry.lead_mm.map(number)),
        ("tolerance_mm", entry.tolerance_mm.as_ref().map(inline)),
    ])
}

fn check_lines(checks: &CheckSwitches) -> Vec<Line> {
    let names = |names: &[String]| {
        let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
        (!names.is_empty()).then(|| format!("[{}]", names.join(", ")))
    };
    given([("allow", names(&checks.allow)), ("deny", names(&checks.deny))])
}

fn tool_lines(tool: &ToolEntry) -> Vec<Line> {
    given([
        ("name", tool.name.as_deref().map(text)),
        ("kind", tool.kind.map(|kind| text(kind.word()))),
        ("side", tool.side.map(|side| text(side.word()))),
        ("insert", tool.insert.as_deref().map(text)),
        ("holder", tool.holder.as_deref().map(text)),
        ("entering_angle_deg", tool.entering_angle_deg.map(number)),
        ("hand", tool.hand.map(|hand| text(hand.word()))),
        ("post", tool.post.map(|post| text(post.word()))),
        ("insert_faces", tool.insert_faces.map(|way| text(way.word()))),
        ("nose_radius_mm", tool.nose_radius_mm.map(number)),
        ("tip", tool.tip.map(|tip| tip.to_string())),
        ("width_mm", tool.width_mm.map(number)),
        ("reach_mm", tool.reach_mm.map(number)),
        ("clearance_deg", tool.clearance_deg.map(number)),
        ("diameter_mm", tool.diameter_mm.map(number)),
        ("point_angle_deg", tool.point_angle_deg.map(number)),
        ("thread_angle_deg", tool.thread_angle_deg.map(number)),
        ("length_mm", tool.length_mm.map(number)),
        ("shank_mm", tool.shank_mm.map(number)),
        ("outline", points(&tool.outline)),
        ("holder_outline", points(&tool.holder_outline)),
    ])
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => out.extend(['\\', character]),
            character if character.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(character))),
            character => out.push(character),
        }
    }
    out.push('"');
    out
}

/// A key of TOML: bare where that reads as one key.
fn key(text: &str) -> String {
    let is_bare = !text.is_empty()
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
    if is_bare { text.to_string() } else { quoted(text) }
}

/// A value of TOML on one line.
fn inline(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => quoted(text),
        toml::Value::Table(table) => {
            let entries: Vec<String> =
                table.iter().map(|(key, value)| format!("{} = {}", self::key(key), inline(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        toml::Value::Array(values) => {
            let values: Vec<String> = values.iter().map(inline).collect();
            format!("[{}]", values.join(", "))
        }
        other => typed(other),
    }
}

/// A file in the making.
struct Writer<'a> {
    out: String,
    /// The comment at a section, or at one of its keys.
    comment: &'a dyn Fn(&str, &str) -> Vec<String>,
}

impl Writer<'_> {
    fn comments(&mut self, section: &str, key: &str) {
        for line in (self.comment)(section, key).iter().flat_map(|comment| comment.lines()) {
            self.out.push_str(&format!("# {line}\n"));
        }
    }

    fn section(&mut self, name: &str, lines: &[(String, String)]) {
        if lines.is_empty() {
            return;
        }
        self.out.push_str(if self.out.is_empty() { "" } else { "\n" });
        // A list of sections has its name in two brackets.
        let section = name.trim_matches(['[', ']']);
        self.comments(section, "");
        self.out.push_str(&format!("[{name}]\n"));
        for (key, value) in lines {
            self.comments(section, key);
            self.out.push_str(&format!("{} = {value}\n", self::key(key)));
        }
    }

    fn part(&mut self, name: &str, lines: Vec<Line>) {
        let lines: Vec<_> = lines.into_iter().map(|(key, value)| (key.to_string(), value)).collect();
        self.section(name, &lines);
    }
}

impl Setup {
    /// The setup as a file; comments of the file it was read from are not in it.
    pub fn to_toml(&self) -> String {
        self.to_commented_toml(&|_, _| Vec::new())
    }

    /// The setup as a file with comments: `comment` is asked for each section, with the empty key, and for each key
    /// of it.
    pub fn to_commented_toml(&self, comment: &dyn Fn(&str, &str) -> Vec<String>) -> String {
        let mut writer = Writer { out: String::new(), comment };
        for (key, value) in [("control", &self.control), ("machine", &self.machine)] {
            if let Some(value) = value {
                writer.comments("", key);
                writer.out.push_str(&format!("{key} = {}\n", quoted(value)));
            }
        }
        let value = |(key, value): (&String, &toml::Value)| (key.clone(), inline(value));
        writer.section("parameters", &self.parameters.iter().map(value).collect::<Vec<_>>());
        writer.section("rates", &self.rates.iter().map(value).collect::<Vec<_>>());
        let kept = self.kept.iter().map(|(key, value)| (key.clone(), quoted(value)));
        writer.section("kept", &kept.collect::<Vec<_>>());
        let work = self.work.iter();
        let work = work.map(|(name, row)| {
            let axes = row.shown().map(|(axis, value)| format!("{} = {value}", axis.letter().to_lowercase()));
            (name.clone(), format!("{{ {} }}", axes.collect::<Vec<_>>().join(", ")))
        });
        writer.section("work", &work.collect::<Vec<_>>());
        if let Some(stock) = &self.stock {
            writer.part("stock", stock_lines(stock));
        }
        if let Some(chuck) = &self.chuck {
            writer.part("chuck", chuck_lines(chuck));
        }
        if let Some(bar) = &self.bar {
            writer.part("bar", bar_lines(bar));
        }
        if let Some(tailstock) = &self.tailstock {
            writer.part("tailstock", tailstock_lines(tailstock));
        }
        if let Some(record) = &self.thread_repair {
            writer.part("thread-repair", record_lines(record));
        }
        writer.part("checks", check_lines(&self.checks));
        for entry in &self.measure {
            writer.part("[measure]", measure_lines(entry));
        }
        for (name, tool) in by_number(&self.tools) {
            writer.part(&format!("tools.{}", key(name)), tool_lines(tool));
        }
        for (name, offset) in by_number(&self.offsets) {
            let row = |row: &OffsetRow| {
                let y = if row.y == 0.0 { String::new() } else { format!("y = {}, ", row.y) };
                format!("{{ x = {}, {y}z = {}, r = {} }}", row.x, row.z, row.r)
            };
            let lines = vec![
                ("geometry", row(&offset.geometry)),
                ("wear", row(&offset.wear)),
                ("tip", offset.tip.to_string()),
            ];
            writer.part(&format!("offsets.{}", key(name)), lines);
        }
        writer.out
    }
}

/// Entries in the order of their numbers.
fn by_number<T>(entries: &BTreeMap<String, T>) -> Vec<(&String, &T)> {
    let mut entries: Vec<_> = entries.iter().collect();
    entries.sort_by_key(|(name, _)| name.parse::<u32>().unwrap_or(u32::MAX));
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A setup that says everything there is to say about stock, workholding and tools.
    const WHOLE: &str = "[stock]\nmaterial = \"45\"\ndiameter_mm = 50\nbore_mm = 10.5\nlength_mm = 80\nface_mm = 1\n\
        [chuck]\ngrip = \"outside\"\ngrip_mm = 25\njaw_z_mm = -54\njaw_length_mm = 30\njaw_height_mm = 20\n\
        diameter_mm = 160\nlength_mm = 80\nrpm_max = 4500\ngrip_force_kn = 30\ngrip_force_max_kn = 60\n\
        [bar]\nbehind_mm = 600\ndiameter_mm = 50\nbore_mm = 10.5\nend = \"guided\"\n\
        [tailstock]\npoint_z_mm = -4\npoint_angle_deg = 60\ncentre_mm = 20\ncentre_length_mm = 50\nquill_mm = 60\n\
        quill_length_mm = 100\n\
        [thread-repair]\nx = 30\nz = -12.5\nangle_deg = 90.25\n\
        [checks]\nallow = [\"tool-offset-differs\"]\ndeny = [\"stop-in-cut\", \"T095\"]\n\
        [tools.1]\nname = \"rough \\\"A\\\"\"\nkind = \"turning\"\nside = \"outside\"\ninsert = \"CNMG120408\"\n\
        holder = \"PCLNR2525M12\"\nentering_angle_deg = 95\nhand = \"right\"\npost = \"front\"\ninsert_faces = \"up\"\nnose_radius_mm = 0.8\n\
        tip = 3\nlength_mm = 150\nshank_mm = 25\n\
        [tools.10]\nkind = \"grooving\"\nwidth_mm = 3\nreach_mm = 15\nclearance_deg = 0.5\n\
        outline = [{ x = 0, z = 0 }, { x = 0, z = 3 }, { x = 9, z = 3, r = 9, turn = \"ccw\" }, { x = 9, z = 0 }]\n\
        holder_outline = [{ x = 9, z = 0 }, { x = 9, z = 20 }, { x = 90, z = 20 }, { x = 90, z = 0 }]\n\
        [tools.2]\nkind = \"drilling\"\ndiameter_mm = 20\npoint_angle_deg = 118\n\
        [tools.3]\nkind = \"threading\"\nthread_angle_deg = 55\n\
        [[measure]]\nname = \"seat\"\nat = \"Z-32\"\ndiameter_mm = 30\ntolerance_mm = [0, -0.021]\n\
        [[measure]]\nfrom = \"Z0\"\nto = \"Z-32\"\nlength_mm = 32\ntolerance_mm = 0.1\n\
        [[measure]]\nat = \"Z-5\"\nbore_mm = 10.5\n[[measure]]\nat = \"Z-5\"\nwall_mm = 4\n\
        [[measure]]\nat = \"X25 Z-9\"\nwidth_mm = 4\n[[measure]]\nat = \"Z-5\"\nmajor_mm = 20\n\
        [[measure]]\nat = \"Z-5\"\nminor_mm = 18\n[[measure]]\nat = \"Z-5\"\nlead_mm = 1.5\n";

    /// A forging, which goes without the sizes of a bar.
    const FORGING: &str =
        "[stock]\nprofile = [{ x = 0, z = 0 }, { x = 40, z = 0 }, { x = 40, z = -60 }, { x = 0, z = -60 }]\n";

    #[test]
    fn what_is_in_and_around_the_chuck_is_written_and_read_back() {
        for text in [WHOLE, FORGING] {
            let setup = Setup::parse(text).unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
            for written in
                [setup.to_toml(), setup.to_commented_toml(&|_, key| vec![format!("{key}\nand more")])]
            {
                assert_eq!(Setup::parse(&written), Ok(setup.clone()), "{written}");
            }
        }
        let setup = Setup::parse(WHOLE).expect("a setup");
        let stations: Vec<_> = by_number(&setup.tools).into_iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(stations, ["1", "2", "3", "10"]);
        assert_eq!(setup.tools().expect("tools").len(), 4);
        assert!(setup.chuck_outlines().is_ok_and(|outlines| outlines.is_some()));
        assert!(setup.tailstock_outline().is_ok_and(|outline| outline.is_some()));
    }

    #[test]
    fn every_key_has_its_words_and_every_word_its_key() {
        let whole = Setup::parse(WHOLE).expect("a setup");
        let forging = Setup::parse(FORGING).expect("a setup");
        let mut used: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        let mut add = |section, lines: Vec<Line>| {
            used.entry(section).or_insert_with(|| vec![""]).extend(lines.iter().map(|line| line.0));
        };
        add("stock", stock_lines(whole.stock.as_ref().expect("stock")));
        add("stock", stock_lines(forging.stock.as_ref().expect("stock")));
        add("chuck", chuck_lines(whole.chuck.as_ref().expect("chuck")));
        add("bar", bar_lines(whole.bar.as_ref().expect("a bar")));
        add("tailstock", tailstock_lines(whole.tailstock.as_ref().expect("tailstock")));
        add("thread-repair", record_lines(whole.thread_repair.as_ref().expect("a record")));
        add("checks", check_lines(&whole.checks));
        whole.measure.iter().for_each(|entry| add("measure", measure_lines(entry)));
        whole.tools.values().for_each(|tool| add("tools", tool_lines(tool)));
        for (section, keys) in &mut used {
            keys.sort_unstable();
            keys.dedup();
            let known: Vec<&str> = KEYS[*section].keys().map(String::as_str).collect();
            assert_eq!(*keys, known, "{section}");
        }
        assert_eq!(used.len(), KEYS.len());
        let words = KEYS.values().flat_map(|keys| keys.values());
        assert!(
            words.clone().count() > 35
                && words.clone().all(|words| !words.en.is_empty() && !words.zh.is_empty())
        );
        assert_eq!(setup_key_words("stock", "length_mm", Language::Chinese), Some("前端面到后端面的长度。"));
    }

    #[test]
    fn faults_name_the_key_the_reason_and_the_line() {
        let fault = |text: &str| {
            let fault = Setup::parse(text).expect_err(text);
            (fault.line, fault.message)
        };
        let (line, message) = fault("[stock]\nlength_mm = 50\ndiameter_mm = 20\nbore_mm = 30\n");
        assert_eq!((line, message.starts_with("stock.bore_mm: ")), (4, true), "{message}");
        let (line, message) = fault("control = \"x\"\n\n[tools.3] # rough\nname = \"a\"\ntip = 12\n");
        assert_eq!((line, message.as_str()), (5, "tools.3.tip: the number of the tip is 0 to 9"));
        let (line, message) = fault("[tools]\n7.name = \"a\"\n8.diameter_mm = -1\n");
        assert_eq!(line, 1, "{message}");
        let (line, _) = fault("[tools.4]\nname = \"a\"\n");
        assert_eq!(line, 1);
        let (line, message) = fault("[stock]\ndiametr_mm = 50\n");
        assert!(line == 2 && message.ends_with("; did you mean diameter_mm?"), "{message}");
        let (_, message) = fault("[tools.1]\nkind = \"bohring\"\n");
        assert!(message.contains("unknown variant `bohring`"), "{message}");
        let (_, message) = fault("[tools.1]\nkind = \"groving\"\n");
        assert!(message.ends_with("; did you mean grooving?"), "{message}");
        assert!(fault("[tools.0]\ndiameter_mm = 5\n").1.contains("1 to 999"));
        assert!(fault("[tools.1]\ndiameter_mm = 5\n[tools.01]\ndiameter_mm = 5\n").1.contains("twice"));
        let (line, message) =
            fault("[[measure]]\nat = \"Z-1\"\nbore_mm = 1\n[[measure]]\nat = \"Z-1\"\nbore_mm = -1\n");
        assert_eq!((line, message.as_str()), (6, "measure.2.bore_mm: must be greater than zero"));
        let (line, message) = fault("[[measure]]\nat = \"Z-1\"\nboremm = 1\n");
        assert!(line == 3 && message.ends_with("; did you mean bore_mm?"), "{message}");
        let (line, message) = fault("[stock]\nmaterial = \"40Crr\"\n");
        assert!(line == 2 && message.contains("did you mean 40Cr?"), "{message}");
        assert!(fault("[chuck]\n").1.starts_with("chuck.jaw_z_mm: "));
        let (line, message) = fault("[thread-repair]\nz = -3\nangle_deg = 361\n");
        assert_eq!((line, message.as_str()), (3, "thread-repair.angle_deg: must be 0 to 360"));
        assert_eq!(fault("[thread-repair]\nangle_deg = 1\n").0, 1);
        assert_eq!(fault("[thread-repair]\nz = nan\nangle_deg = 1\n").0, 2);
    }
}
