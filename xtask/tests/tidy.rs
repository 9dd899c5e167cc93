//! The rules of the house as a plain test, so that `cargo test` covers them.

#[test]
fn the_house_is_tidy() {
    let faults: Vec<String> = xtask::tidy::faults(&xtask::root()).iter().map(ToString::to_string).collect();
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}
