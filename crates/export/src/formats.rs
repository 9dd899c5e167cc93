//! One file a format. A new format is a new file here and nothing else.

pub mod crash_svg;
pub mod cutting_svg;
pub mod dxf;
pub mod glb;
pub mod html;
pub mod jsonl;
pub mod overlay_svg;
pub mod parquet;
pub mod part_svg;
#[cfg(feature = "png")]
pub mod png;
pub mod step;
pub mod stl;
pub mod svg;
pub mod time_svg;
pub mod times_csv;
