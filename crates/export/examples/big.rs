//! temp
#![allow(clippy::disallowed_methods)]
use turnwright_canon::*;
use turnwright_export::formats::{html::*, svg::*};
use turnwright_export::path::PathRecorder;
use turnwright_units::*;
fn main() {
    let at = |d: i64, z: i64| {
        Position::<WorkTip>::new(Radius(Length::from_nm(d * 500)), Length::from_nm(z * 1000))
    };
    let mut p = PathRecorder::new(at(200000, 150000), 8000., 12000.);
    let mut lines = vec![];
    let f = Feed::PerRevolution(FeedPerRevolution(Length::from_nm(200000)));
    for i in 0..100000i64 {
        lines.push(format!("N{} G01 X{} Z{}", i, i, i));
        let k = i / 10;
        let (d, z) = (10000 + (k * 37) % 80000, -((i % 10) * 7000) - (k * 13) % 3000);
        let action = if i % 10 == 0 {
            Action::Rapid { to: at(d + 2000, 2000), path: RapidPath::EachAxis }
        } else {
            Action::Feed { to: at(d, z), shape: Shape::Line, feed: f }
        };
        p.add(&Command { action, origin: Origin::line(i as u32 + 1) }, 0.1);
    }
    let t = std::time::Instant::now();
    let r = Report { title: "big".into(), program_lines: lines, ..Report::default() };
    std::fs::write("/tmp/demo/big.html", write_html(&p, &r)).unwrap();
    eprintln!("html {:?}", t.elapsed());
    let t = std::time::Instant::now();
    std::fs::write("/tmp/demo/big.svg", write_svg(&p, &PictureOptions::default())).unwrap();
    eprintln!("svg {:?}", t.elapsed());
}
