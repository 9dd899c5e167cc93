//! Any text as what a control punches out: it is taken or refused, and what was taken can be written out and is
//! taken again.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use turnwright_control::{Control, Setup, control_names};
use turnwright_interpreter::{export_offsets, export_work_zeros, import_data};

fuzz_target!(|bytes: &[u8]| {
    static CONTROLS: OnceLock<Vec<Control>> = OnceLock::new();
    let controls = CONTROLS.get_or_init(|| {
        control_names().into_iter().map(|name| Control::load(name).expect("a control of ours")).collect()
    });
    let Some((first, text)) = bytes.split_first() else { return };
    let control = &controls[usize::from(*first) % controls.len()];
    let mut setup = Setup::default();
    if import_data(control, &mut setup, text).is_err() {
        return;
    }
    Setup::parse(&setup.to_toml()).expect("a setup that was written can be read");
    for written in [export_offsets(control, &setup), export_work_zeros(control, &setup)].into_iter().flatten() {
        import_data(control, &mut Setup::default(), written.as_bytes()).expect("what was written can be taken");
    }
});
