//! `turnwright measure`: the caliper on the part that a program cuts.
//!
//! In: one program, and perhaps a target. Out: what it measures at places, or all its sizes, whether those of the setup file
//! are in tolerance, and how far the part is off its target.

use std::io::Write;

use serde_json::{Value, json};
use turnwright_control::Material;
use turnwright_diagnostics::{Diagnostic, Severity};
use turnwright_export::formats::overlay_svg::write_overlay_svg;
use turnwright_export::formats::part_svg::mm;
use turnwright_stock::machining::ThreadHand;
use turnwright_verify::Inference;
use turnwright_verify::measuring::{self, Found, Groove, Judged, Opening, Ring, Sizes, Thread};
use turnwright_verify::part::Part;

use super::plot::write_picture;
use super::target::{self, Held};
use crate::arguments::{LookupFormat, Measure};
use crate::environment::ProgramText;
use crate::execution::Execution;
use crate::fault::{Fault, Status};
use crate::finding::Finding;
use crate::part;
use crate::render::Printer;
use crate::report;
use crate::report::sizes::{judged_json, judged_text, z_text};
use crate::session::Session;
use crate::speech::Speech;
use crate::table::{Side, Table, facts, heading};

/// Warnings and notes without which sizes would mislead.
const OF_THE_PART: [&str; 5] =
    ["rapid-into-stock", "part-not-turned", "part-cut-off", "tool-without-shape", "part-incomplete"];

/// Measures the part.
pub(crate) fn run(options: &Measure, printer: &Printer) -> Result<Status, Fault> {
    let speech = printer.speech;
    let text = ProgramText::open(&options.file, speech)?;
    let session = Session::choose(&text, &options.machine, speech)?;
    let aim = target::aim(options, speech)?;
    let mut execution = Execution::new(&text, &session, &options.machine)?;
    let mut inference = Inference::new(execution.interpreter().position());
    while let Some(command) = execution.next_command() {
        inference.add(&command);
    }
    let inferred = inference.finish(&session.setup);
    let mut look = |_: &Execution<'_>, _: &mut report::Measure| Ok(());
    let mut part =
        part::machined(&text, &session, &options.machine, &inferred, aim.as_ref(), None, &mut look)?;
    let judged = part::judged(part.as_ref(), &session.setup, execution.alarm());
    if let Some(part) = &mut part {
        part.findings.drain(..).for_each(|finding| execution.warn(finding));
    }
    part::out_of_tolerance(&judged).for_each(|finding| execution.warn(finding));
    let judgement = part.as_mut().and_then(target::judgement);
    let held =
        judgement.as_ref().map(|(judgement, _)| Held { judgement, given: &session.setup, options, speech });
    match &held {
        Some(held) => held.findings().into_iter().for_each(|finding| execution.warn(finding)),
        None if aim.is_some() => execution.warn(Diagnostic::error("target-without-figure")),
        None => {}
    }
    if let (Some(held), Some((_, shown)), Some(output)) = (&held, &judgement, &options.output) {
        let title = text.name.rsplit('/').next().unwrap_or(&text.name).to_string();
        write_picture(output, &write_overlay_svg(&held.overlay(shown, title)), speech)?;
    }
    let mut findings = execution.findings();
    // What is only worth a look has its place in `check`; that the part is another one than shown matters here.
    findings.retain(|finding| {
        let Diagnostic { severity, key, .. } = *finding.diagnostic;
        matches!(severity, Severity::Alarm | Severity::Error) || OF_THE_PART.contains(&key)
    });
    let sizes = part.as_ref().and_then(|part| Sizes::new(&part.section, &part.threads));
    let measured = Measured {
        part: part.as_ref().zip(sizes),
        judged,
        held,
        // A material that is not known was refused when the setup was read.
        material: session.setup.material().unwrap_or_default(),
        options,
        speech,
    };
    let mut out = printer.standard_output();
    match options.format {
        LookupFormat::Human => {
            printer.findings(&findings, &text);
            out.write_all(measured.human().as_bytes())?;
        }
        LookupFormat::Json => {
            let mut answer = measured.json();
            let told = findings.iter().map(|finding| {
                finding.to_json(speech.messages(), speech.language, finding.spot(Some(&text)).as_ref())
            });
            answer["file"] = json!(text.name);
            answer["control"] = json!(session.control.name);
            answer["diagnostics"] = Value::Array(told.collect());
            writeln!(out, "{answer}")?;
        }
    }
    out.flush()?;
    Ok(findings.iter().map(Finding::status).max().unwrap_or(Status::Clean))
}

struct Measured<'a> {
    part: Option<(&'a Part, Sizes)>,
    judged: Vec<Judged>,
    held: Option<Held<'a>>,
    material: Option<&'static Material>,
    options: &'a Measure,
    speech: Speech,
}

impl Measured<'_> {
    fn found(&self) -> Vec<Found> {
        let Some((part, _)) = &self.part else { return Vec::new() };
        let places = self.options.at.iter();
        places.flat_map(|place| measuring::at(&part.section, &part.threads, place)).collect()
    }

    /// Grams.
    fn mass_g(&self, sizes: &Sizes) -> Option<f64> {
        self.material.map(|material| sizes.volume_mm3 / 1000.0 * material.density_g_per_cm3)
    }

    fn human(&self) -> String {
        let speech = self.speech;
        let Some((_, sizes)) = &self.part else { return format!("{}\n", speech.get("measure-no-part")) };
        let mut out = String::new();
        if let Some(held) = &self.held {
            out.push_str(&held.human());
        }
        if self.options.at.is_empty() && self.options.target.is_none() {
            let volume = mm(sizes.volume_mm3 / 1000.0);
            let whole = [("d", mm(sizes.diameter_mm)), ("l", mm(sizes.length_mm())), ("v", volume)];
            out.push_str(&heading(&filled(speech, "measure-whole", &whole)));
            if let (Some(mass), Some(material)) = (self.mass_g(sizes), self.material) {
                let values = [
                    ("mass", mm((mass * 10.0).round() / 10.0)),
                    ("material", material.name.clone()),
                    ("title", material.title(speech.language).to_string()),
                ];
                out.push_str(&format!(
                    "{}{}",
                    speech.get("list-comma"),
                    filled(speech, "measure-mass", &values)
                ));
            }
            out.push('\n');
            out.push_str(&table(sizes, speech));
        } else if !self.options.at.is_empty() {
            let rows: Vec<(String, String)> =
                self.found().iter().map(|found| found_text(found, speech)).collect();
            out.push_str(&facts(&rows));
        }
        if !self.judged.is_empty() {
            out.push_str(&format!("\n{}\n", heading(speech.get("part-sizes"))));
            for line in judged_text(&self.judged, speech).lines() {
                out.push_str(&format!("  {line}\n"));
            }
        }
        out
    }

    fn json(&self) -> Value {
        let mut answer = json!({ "turnwright": "measure", "version": 1 });
        let sizes = self.part.as_ref().map(|(_, sizes)| sizes);
        answer["sizes"] = sizes.map_or(Value::Null, |sizes| {
            let mut value = sizes_json(sizes);
            value["mass_g"] = json!(self.mass_g(sizes));
            value
        });
        answer["material"] = json!(self.material.map(|material| &material.name));
        answer["at"] = self.found().iter().map(found_json).collect();
        answer["target"] = self.held.as_ref().map_or(Value::Null, Held::json);
        answer["measures"] = Value::Array(judged_json(&self.judged));
        answer
    }
}

fn filled(speech: Speech, key: &str, values: &[(&str, String)]) -> String {
    let values: Vec<(&str, &str)> = values.iter().map(|(name, value)| (*name, value.as_str())).collect();
    speech.fill(key, &values)
}

/// All sizes, from the front within their kind.
fn table(sizes: &Sizes, speech: Speech) -> String {
    use Side::{Left, Right};
    let mut table = Table::new(&[Left, Left, Right, Right, Right, Left]);
    let columns = ["what", "size", "from", "to", "length", "more"];
    table.row(columns.map(|key| speech.find(&format!("column-{key}")).to_string()));
    let mut row = |kind: &str, size: String, z: (f64, f64), more: String| {
        let length = if z.0 == z.1 { String::new() } else { mm(z.0 - z.1) };
        let to = if z.0 == z.1 { String::new() } else { z_text(z.1) };
        let kind = speech.find(&format!("measure-kind-{kind}"));
        table.row([kind.to_string(), size, z_text(z.0), to, length, more]);
    };
    for one in &sizes.cylinders {
        let kind = if one.is_inside { "bore" } else { "cylinder" };
        row(kind, format!("⌀{}", mm(one.diameter_mm)), one.z_mm, String::new());
    }
    for one in &sizes.tapers {
        let kind = if one.is_inside { "taper-inside" } else { "taper" };
        let angle = mm((one.angle_deg() * 100.0).round() / 100.0);
        row(kind, diameters(one.diameters_mm), one.z_mm, speech.fill("measure-taper", &[("angle", &angle)]));
    }
    for one in &sizes.radii {
        row("radius", format!("R{}", mm(one.radius_mm)), one.z_mm, diameters(one.diameters_mm));
    }
    for z in &sizes.faces_mm {
        row("face", String::new(), (*z, *z), String::new());
    }
    for one in &sizes.grooves {
        let (kind, size) = match one.opening {
            Opening::Outside => ("groove-outside", format!("⌀{}", mm(one.bottom_mm))),
            Opening::Inside => ("groove-inside", format!("⌀{}", mm(one.bottom_mm))),
            Opening::Front => ("groove-front", z_text(one.bottom_mm)),
            Opening::Back => ("groove-back", z_text(one.bottom_mm)),
        };
        let more = groove_text(one, speech);
        match one.opening {
            Opening::Outside | Opening::Inside => row(kind, size, one.from_to_mm, more),
            Opening::Front | Opening::Back => {
                row(kind, diameters(one.from_to_mm), (one.bottom_mm, one.bottom_mm), more);
            }
        }
    }
    for one in &sizes.threads {
        let kind = if one.is_inside { "thread-inside" } else { "thread" };
        row(kind, format!("⌀{}", mm(one.major_mm)), one.z_mm, thread_text(one, speech));
    }
    table.text(0, true)
}

fn diameters((front, back): (f64, f64)) -> String {
    format!("⌀{}…⌀{}", mm(front), mm(back))
}

fn groove_text(groove: &Groove, speech: Speech) -> String {
    let values = [
        ("width", mm(groove.width_mm())),
        ("depth", mm(groove.depth_mm)),
        ("bottom", mm(groove.bottom_width_mm)),
    ];
    filled(speech, "measure-groove", &values)
}

fn thread_text(thread: &Thread, speech: Speech) -> String {
    let starts = match thread.starts {
        1 => speech.get("measure-start").to_string(),
        count => speech.fill("measure-starts", &[("n", &count.to_string())]),
    };
    let values = [
        ("lead", mm(thread.lead_mm)),
        ("starts", starts),
        ("minor", mm(thread.minor_mm)),
        ("length", mm(thread.length_mm())),
    ];
    let text = filled(speech, "measure-thread", &values);
    match hand_word(thread.hand) {
        Some(word) => {
            format!("{text}{}{}", speech.get("list-comma"), speech.find(&format!("measure-hand-{word}")))
        }
        None => text,
    }
}

const fn hand_word(hand: ThreadHand) -> Option<&'static str> {
    match hand {
        ThreadHand::Right => Some("right"),
        ThreadHand::Left => Some("left"),
        ThreadHand::Unknown => None,
    }
}

/// A place and what is found there.
fn found_text(found: &Found, speech: Speech) -> (String, String) {
    match found {
        Found::AtZ { z_mm, behind, in_front, thread } => {
            let rings = |rings: &[Ring]| {
                let one = |ring: &Ring| {
                    let values =
                        [("d", mm(ring.diameter_mm)), ("b", mm(ring.bore_mm)), ("w", mm(ring.wall_mm()))];
                    let key = if ring.bore_mm > 0.0 { "measure-ring-bored" } else { "measure-ring" };
                    filled(speech, key, &values)
                };
                if rings.is_empty() {
                    return speech.get("measure-air").to_string();
                }
                rings.iter().map(one).collect::<Vec<_>>().join(" | ")
            };
            let mut lines = if is_face(behind, in_front) {
                let colon = speech.get("colon");
                vec![
                    format!("{}{colon}{}", speech.get("measure-at-face"), rings(behind)),
                    format!("{}{colon}{}", speech.get("measure-at-face-front"), rings(in_front)),
                ]
            } else {
                vec![rings(behind)]
            };
            if let Some(thread) = thread {
                let kind = if thread.is_inside { "thread-inside" } else { "thread" };
                let kind = speech.find(&format!("measure-kind-{kind}"));
                lines.push(format!("{kind} ⌀{}, {}", mm(thread.major_mm), thread_text(thread, speech)));
            }
            (z_text(*z_mm), lines.join("\n"))
        }
        Found::AtDiameter { diameter_mm, material, gaps } => {
            let stretch = |key: &'static str, z: &(f64, f64)| {
                let values = [("z1", mm(z.0)), ("z2", mm(z.1)), ("l", mm(z.0 - z.1))];
                (z.0, filled(speech, key, &values))
            };
            let mut lines: Vec<(f64, String)> =
                material.iter().map(|z| stretch("measure-material", z)).collect();
            lines.extend(gaps.iter().map(|z| stretch("measure-gap", z)));
            lines.sort_by(|a, b| b.0.total_cmp(&a.0));
            let text: Vec<String> = lines.into_iter().map(|(_, text)| text).collect();
            let text = if text.is_empty() { speech.get("measure-air").to_string() } else { text.join("\n") };
            (format!("X{}", mm(*diameter_mm)), text)
        }
    }
}

/// Whether the two sides of a Z differ by more than rounding.
fn is_face(behind: &[Ring], in_front: &[Ring]) -> bool {
    let same = |a: &Ring, b: &Ring| {
        (a.diameter_mm - b.diameter_mm).abs() < 1e-6 && (a.bore_mm - b.bore_mm).abs() < 1e-6
    };
    behind.len() != in_front.len() || !behind.iter().zip(in_front).all(|(a, b)| same(a, b))
}

fn found_json(found: &Found) -> Value {
    match found {
        Found::AtZ { z_mm, behind, in_front, thread } => {
            let rings = |rings: &[Ring]| {
                let one = |ring: &Ring| json!({ "bore": ring.bore_mm, "diameter": ring.diameter_mm, "wall": ring.wall_mm() });
                rings.iter().map(one).collect::<Vec<_>>()
            };
            json!({
                "z": z_mm,
                "is_face": is_face(behind, in_front),
                "behind": rings(behind),
                "in_front": rings(in_front),
                "thread": thread.as_ref().map(thread_json),
            })
        }
        Found::AtDiameter { diameter_mm, material, gaps } => {
            let stretch =
                |(high, low): &(f64, f64)| json!({ "z_max": high, "z_min": low, "length": high - low });
            json!({
                "diameter": diameter_mm,
                "material": material.iter().map(stretch).collect::<Vec<_>>(),
                "gaps": gaps.iter().map(stretch).collect::<Vec<_>>(),
            })
        }
    }
}

fn thread_json(thread: &Thread) -> Value {
    json!({
        "inside": thread.is_inside,
        "major": thread.major_mm,
        "minor": thread.minor_mm,
        "lead": thread.lead_mm,
        "starts": thread.starts,
        "hand": hand_word(thread.hand),
        "z_max": thread.z_mm.0,
        "z_min": thread.z_mm.1,
        "length": thread.length_mm(),
    })
}

fn sizes_json(sizes: &Sizes) -> Value {
    let cylinders = sizes.cylinders.iter().map(|one| {
        json!({ "diameter": one.diameter_mm, "z_max": one.z_mm.0, "z_min": one.z_mm.1, "inside": one.is_inside })
    });
    let tapers = sizes.tapers.iter().map(|one| {
        json!({
            "diameter_front": one.diameters_mm.0, "diameter_back": one.diameters_mm.1,
            "z_max": one.z_mm.0, "z_min": one.z_mm.1, "angle_deg": one.angle_deg(), "inside": one.is_inside,
        })
    });
    let radii = sizes.radii.iter().map(|one| {
        json!({
            "radius": one.radius_mm, "diameter_front": one.diameters_mm.0, "diameter_back": one.diameters_mm.1,
            "z_max": one.z_mm.0, "z_min": one.z_mm.1, "convex": one.is_convex,
        })
    });
    let grooves = sizes.grooves.iter().map(|one| {
        let opening = match one.opening {
            Opening::Outside => "outside",
            Opening::Inside => "inside",
            Opening::Front => "front",
            Opening::Back => "back",
        };
        json!({
            "opening": opening, "bottom": one.bottom_mm, "depth": one.depth_mm, "width": one.width_mm(),
            "bottom_width": one.bottom_width_mm, "from": one.from_to_mm.0, "to": one.from_to_mm.1,
        })
    });
    json!({
        "diameter": sizes.diameter_mm,
        "z_max": sizes.z_mm.0,
        "z_min": sizes.z_mm.1,
        "length": sizes.length_mm(),
        "volume_mm3": sizes.volume_mm3,
        "cylinders": cylinders.collect::<Vec<_>>(),
        "tapers": tapers.collect::<Vec<_>>(),
        "radii": radii.collect::<Vec<_>>(),
        "faces": sizes.faces_mm,
        "grooves": grooves.collect::<Vec<_>>(),
        "threads": sizes.threads.iter().map(thread_json).collect::<Vec<_>>(),
    })
}
