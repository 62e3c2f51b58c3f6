//! Technique specifications as anybody might type them: no text makes the parser panic, and what it accepts has one
//! canonical spelling.

use gnomon::technique::{Spec, registry};
use proptest::prelude::*;
use proptest::strategy::ValueTree;

fn keys() -> Vec<&'static str> {
    registry().iter().flat_map(|technique| technique.params()).map(|param| param.name).collect()
}

/// A value that some parameter takes, or nearly.
fn value() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<i32>().prop_map(|number| number.to_string()),
        any::<f64>().prop_map(|number| number.to_string()),
        (0.0..2.0_f64).prop_map(|number| number.to_string()),
        (1..64_u32).prop_map(|number| format!("pcf-box{number}")),
        prop::collection::vec(0.0..9.0_f64, 1..4).prop_map(|list| list
            .iter()
            .map(f64::to_string)
            .collect::<Vec<_>>()
            .join("/")),
        prop::sample::select(vec!["auto", "none", "slope", "nearest", "manual", "", "-0", "pcf-box", "depth16unorm"])
            .prop_map(str::to_owned),
    ]
}

/// `family:key=value,…` with real families and keys.
fn likely() -> impl Strategy<Value = String> {
    let family = prop::sample::select(registry().iter().map(|technique| technique.id()).collect::<Vec<_>>());
    let part = (prop::sample::select(keys()), value()).prop_map(|(key, value)| format!("{key}={value}"));
    (family, prop::collection::vec(part, 0..4)).prop_map(|(family, parts)| format!("{family}:{}", parts.join(",")))
}

fn assert_canonical(typed: &str) {
    let Ok(spec) = Spec::parse(typed) else { return };
    let canonical = spec.to_string();
    for spelling in [canonical.as_str(), spec.short().as_str(), spec.typed.as_str()] {
        let again = Spec::parse(spelling).unwrap_or_else(|error| panic!("'{spelling}' of '{typed}': {error}"));
        assert_eq!(again, spec, "'{spelling}' of '{typed}'");
    }
    assert_eq!(Spec::parse(&canonical).unwrap().to_string(), canonical, "of '{typed}'");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_or_refused(typed in "\\PC*") {
        assert_canonical(&typed);
    }

    #[test]
    fn text_of_the_right_characters_is_read_or_refused(typed in "map[:,=()/a-z0-9.+-]{0,40}") {
        assert_canonical(&typed);
    }

    #[test]
    fn likely_specifications_are_read_or_refused(typed in likely()) {
        assert_canonical(&typed);
    }
}

#[test]
fn likely_specifications_are_often_right() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let typed = prop::collection::vec(likely(), 500).new_tree(&mut runner).unwrap().current();
    let read = typed.iter().filter(|typed| Spec::parse(typed).is_ok()).count();
    assert!((50..450).contains(&read), "{read} of 500 test both sides");
}
