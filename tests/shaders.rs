//! Every shader module parses and validates without a device, and every WGSL file is part of one.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::gpu::shader::{GBUFFER, Wgsl, concatenated};
use gnomon::technique::shader_modules;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::collections::BTreeSet;
use std::path::Path;
use support::files::files_below;

/// Every module gnomon can build, as label and files.
fn modules() -> Vec<(String, Vec<Wgsl>)> {
    std::iter::once(("gbuffer".to_owned(), vec![GBUFFER])).chain(shader_modules()).collect()
}

/// Parses and validates one module as WebGPU without optional features would.
fn validated(text: &str) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    // The one optional feature is asked for by name.
    let is_of_rays = text.contains("enable wgpu_ray_query;");
    let capabilities = if is_of_rays { Capabilities::RAY_QUERY } else { Capabilities::empty() };
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    validator.validate(&module).map_err(|error| error.emit_to_string(text))?;
    Ok(module)
}

#[test]
fn every_module_validates_and_can_be_run() {
    for (label, files) in modules() {
        let module = validated(&concatenated(&files)).unwrap_or_else(|error| panic!("{label}: {error}"));
        assert!(!module.entry_points.is_empty(), "{label} has no entry point");
    }
}

#[test]
fn a_broken_module_does_not() {
    for (label, files) in modules() {
        let text = concatenated(&files);
        assert!(
            validated(&text.replacen("vec4f", "vec5f", 1).replacen("vec2u", "vec5u", 1).replacen("vec3u", "vec5u", 1))
                .is_err(),
            "{label}"
        );
    }
    // Valid grammar, wrong types: only the validator sees it.
    assert!(validated("fn f() -> u32 { return 1u; } @fragment fn main() -> @location(0) u32 { return f(); }").is_ok());
    assert!(
        validated("fn f() -> u32 { return 1.0; } @fragment fn main() -> @location(0) u32 { return f(); }").is_err()
    );
    // A lookup without its filter, or with two.
    let lookup = modules().into_iter().find(|(label, _)| label.starts_with("map lookup")).unwrap().1;
    let (filter, shared) = lookup.split_last().unwrap();
    assert!(validated(&concatenated(shared)).is_err());
    assert!(validated(&concatenated(&[shared, &[*filter, *filter]].concat())).is_err());
}

#[test]
fn every_file_is_part_of_a_module_and_every_part_is_that_file() {
    let used: BTreeSet<(String, String)> = modules()
        .into_iter()
        .flat_map(|(_, files)| files)
        .map(|file| (file.path.to_owned(), file.text.to_owned()))
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let on_disk: BTreeSet<(String, String)> = files_below(&folder, "wgsl").into_iter().collect();
    assert_eq!(used, on_disk);
    assert!(on_disk.len() >= 7, "the search itself works");
}
