//! The structure that ARCHITECTURE.md promises: who names whom, one file per registry line, and documentation that says
//! what the code says. Every search is tried on a text that breaks its rule.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod support;

use gnomon::cause::Cause;
use gnomon::technique::map::{bias, filter, projection};
use gnomon::technique::param::Param;
use gnomon::technique::registry;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use support::files::files_below;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Path below src/ and text of every Rust file.
fn sources() -> Vec<(String, String)> {
    files_below(&root().join("src"), "rs")
}

fn doc(name: &str) -> String {
    std::fs::read_to_string(root().join("docs").join(name)).unwrap()
}

/// A Rust text without its comments (and what follows `//` in strings, which no rule here looks for).
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// Whether a text holds `word` on its own.
fn names(text: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part))
}

/// The module of src/ that a file belongs to.
fn module_of(path: &str) -> &str {
    path.split('/').next().unwrap().trim_end_matches(".rs")
}

fn files_that_name<'f>(files: &'f [(String, String)], modules: &[&str], word: &str) -> Vec<&'f str> {
    let in_modules = files.iter().filter(|(path, _)| modules.contains(&module_of(path)));
    in_modules.filter(|(_, text)| names(&code(text), word)).map(|(path, _)| path.as_str()).collect()
}

#[test]
fn only_gpu_and_technique_name_wgpu_and_only_the_command_line_names_anyhow() {
    const WITHOUT_WGPU: [&str; 13] = [
        "scene", "inspect", "cast", "mask", "receiver", "cause", "truth", "shade", "verdict", "report", "evaluate",
        "watch", "cli",
    ];
    let files = sources();
    assert_eq!(files_that_name(&files, &WITHOUT_WGPU, "wgpu"), [""; 0]);
    let modules: BTreeSet<&str> = files.iter().map(|(path, _)| module_of(path)).collect();
    let library: Vec<&str> = modules.iter().copied().filter(|module| !["cli", "main"].contains(module)).collect();
    assert_eq!(files_that_name(&files, &library, "anyhow"), [""; 0]);

    // Control: the search finds those who may, and every module it is told to look at exists.
    assert!(files_that_name(&files, &["gpu"], "wgpu").len() > 3);
    assert!(files_that_name(&files, &["cli"], "anyhow").len() > 3);
    assert!(WITHOUT_WGPU.iter().all(|module| modules.contains(module)));
    let broken = [("truth/mod.rs".to_owned(), "/// not wgpu\nuse wgpu::Device;".to_owned())];
    assert_eq!(files_that_name(&broken, &["truth"], "wgpu"), ["truth/mod.rs"]);
    assert!(!names(&code("// wgpu\nlet wgpu_like = 1;"), "wgpu"));
}

/// The modules in the order in which the library's documentation draws them: each may use those above it.
fn flow(lib: &str) -> Vec<&str> {
    let drawing = lib.split("```").nth(1).unwrap();
    drawing.lines().skip(1).filter_map(|line| line.strip_prefix("//! ")?.split_whitespace().next()).collect()
}

/// Uses of a module that does not stand above the user, as (file, module).
fn against_the_flow(files: &[(String, String)], flow: &[&str]) -> Vec<(String, String)> {
    let rank = |module: &str| flow.iter().position(|known| *known == module);
    let mut found = Vec::new();
    for (path, text) in files {
        let Some(own) = rank(module_of(path)) else { continue };
        let text = code(text);
        let used = text.match_indices("crate::").map(|(at, word)| &text[at + word.len()..]);
        let used = used.map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or(""));
        let below = used.filter(|module| rank(module).is_some_and(|rank| rank > own));
        found.extend(below.map(|module| (path.clone(), module.to_owned())));
    }
    found
}

#[test]
fn a_module_uses_only_what_stands_above_it() {
    let files = sources();
    let lib = &files.iter().find(|(path, _)| path == "lib.rs").unwrap().1;
    let flow = flow(lib);
    let declared: BTreeSet<&str> =
        lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert_eq!(flow.iter().copied().collect::<BTreeSet<&str>>(), declared, "every module is drawn");
    assert_eq!(against_the_flow(&files, &flow), []);
    // Control: upside down, the same files break the rule everywhere.
    let reversed: Vec<&str> = flow.iter().copied().rev().collect();
    assert!(against_the_flow(&files, &reversed).len() > 30);
}

/// File stems (a folder's name for its mod.rs) below a folder of src/ whose code implements a trait.
fn implementors(folder: &str, of_trait: &str) -> BTreeSet<String> {
    let implements = format!("impl {of_trait} for ");
    let found = files_below(&root().join("src").join(folder), "rs").into_iter();
    let found = found.filter(|(_, text)| code(text).contains(&implements));
    let stem = |path: String| path.trim_end_matches(".rs").trim_end_matches("/mod").to_owned();
    found.map(|(path, _)| stem(path)).collect()
}

fn stems<'n>(names: impl IntoIterator<Item = &'n str>) -> BTreeSet<String> {
    names.into_iter().map(|name| name.replace('-', "_")).collect()
}

#[test]
fn registries_and_files_match_one_to_one() {
    assert_eq!(implementors("technique", "Technique"), stems(registry().iter().map(|t| t.id())));
    let map = |axis: &str, of_trait: &str| implementors(&format!("technique/map/{axis}"), of_trait);
    let filters = stems(filter::registry().iter().map(|f| f.choice().name));
    // Whatever has moments is a filter, by one implementation for all of them.
    let implemented: BTreeSet<String> = &map("filter", "Filter") | &map("filter", "Moments");
    assert_eq!(implemented, filters);
    assert_eq!(map("bias", "Bias"), stems(bias::registry().iter().map(|b| b.name())));
    assert_eq!(map("projection", "Projection"), stems(projection::registry().iter().map(|p| p.name())));

    let shaders = files_below(&root().join("shaders/map/filter"), "wgsl").into_iter();
    let shaders: BTreeSet<String> = shaders.map(|(path, _)| path.trim_end_matches(".wgsl").to_owned()).collect();
    assert_eq!(shaders, filters, "one WGSL file per filter, of the same stem");
    for filter in filter::registry() {
        let stem = filter.choice().name.replace('-', "_");
        assert_eq!(filter.shader().path, format!("map/filter/{stem}.wgsl"));
    }
    // A projection with one view selects nothing and shares its file.
    let shaders = files_below(&root().join("shaders/map/projection"), "wgsl").into_iter();
    let shaders: BTreeSet<String> = shaders.map(|(path, _)| format!("map/projection/{path}")).collect();
    let named = projection::registry().iter().map(|projection| projection.shader().path.to_owned());
    assert_eq!(shaders, named.collect());
    for projection in projection::registry() {
        let own = format!("map/projection/{}.wgsl", projection.name().replace('-', "_"));
        assert!([own.as_str(), "map/projection/one_view.wgsl"].contains(&projection.shader().path));
    }
    // Control: a file that nobody registered would be one more.
    assert_ne!(map("filter", "Bias"), filters);
    assert!(filters.len() > 1);
}

/// Headings of a document at this level, with their lines' `#` and spaces gone.
fn headings<'t>(text: &'t str, level: &str) -> Vec<&'t str> {
    text.lines().filter_map(|line| line.strip_prefix(level)?.strip_prefix(' ')).map(str::trim).collect()
}

#[test]
fn every_cause_has_a_section_and_every_section_a_cause() {
    let causes: BTreeSet<&str> = Cause::ALL.iter().map(|cause| cause.name()).collect();
    let sections = |page: &str| headings(page, "##").into_iter().map(str::to_owned).collect::<Vec<String>>();
    let agrees = |sections: &[String]| {
        sections.len() == causes.len() && sections.iter().all(|section| causes.contains(section.as_str()))
    };
    let page = doc("causes.md");
    assert!(agrees(&sections(&page)), "{:?}", sections(&page));
    // Controls: one missing, one too many.
    assert!(!agrees(&sections(&page.replace("## acne", "### acne"))));
    assert!(!agrees(&sections(&format!("{page}\n## bad-luck\n"))));
}

/// A parameter's row in its technique's page.
fn row(param: &Param) -> String {
    let values = param.range().replace(" | ", ", ");
    format!("| `{}` | {} | {} | {values} | {} |", param.name, param.unit, param.default, param.help)
}

#[test]
fn a_techniques_page_lists_its_parameters_as_declared() {
    for technique in registry() {
        let page = doc(&format!("{}.md", technique.id().replace('-', "_")));
        let table = page.split("## Parameters").nth(1).unwrap();
        let found: Vec<&str> = table.lines().filter(|line| line.starts_with("| `")).collect();
        let declared: Vec<String> = technique.params().iter().map(row).collect();
        assert_eq!(found, declared, "the table of {}'s page should read\n{}", technique.id(), declared.join("\n"));
    }
}

#[test]
fn every_value_of_the_map_axes_is_explained() {
    let page = doc("map.md");
    let explained = |name: &str| page.contains(&format!("- `{name}`")) || page.contains(&format!("\n| `{name}` |"));
    let filters = filter::registry().iter().map(|f| f.choice().name);
    let projections = projection::registry().iter().map(|p| p.name());
    for name in filters.chain(bias::registry().iter().map(|b| b.name())).chain(projections) {
        assert!(explained(name), "docs/map.md does not explain {name}");
    }
    assert!(!explained("median"));
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || *c == '-' || *c == '_').collect()
}

/// References `name.md` or `name.md#anchor` behind every `prefix` in a text.
fn references<'t>(text: &'t str, prefix: &str) -> Vec<(&'t str, Option<&'t str>)> {
    let is_part = |c: char| c.is_alphanumeric() || "-_./#".contains(c);
    let after = text.match_indices(prefix).map(|(at, _)| &text[at + prefix.len()..]);
    let cited = after.map(|rest| rest.split(|c| !is_part(c)).next().unwrap_or("").trim_end_matches('.'));
    let split = |cited: &'t str| cited.split_once('#').map_or((cited, None), |(file, anchor)| (file, Some(anchor)));
    cited.map(split).filter(|(file, _)| file.ends_with(".md") && !file.contains('/')).collect()
}

fn is_broken((file, cited): (&str, Option<&str>)) -> bool {
    let Ok(text) = std::fs::read_to_string(root().join("docs").join(file)) else { return true };
    let headings = ["#", "##", "###"].map(|level| headings(&text, level)).concat();
    let is_there = |cited: &str| {
        headings.iter().any(|heading| anchor(heading) == cited) || text.contains(&format!("<a id=\"{cited}\">"))
    };
    cited.is_some_and(|cited| !is_there(cited))
}

#[test]
fn every_formula_that_is_cited_exists() {
    let shaders = files_below(&root().join("shaders"), "wgsl");
    let pages = files_below(&root().join("docs"), "md");
    let front = ["README.md", "ARCHITECTURE.md"];
    let front = front.map(|name| (name.to_owned(), std::fs::read_to_string(root().join(name)).unwrap()));
    let in_code = sources().into_iter().chain(shaders).chain(front).map(|(path, text)| (path, text, "docs/"));
    let in_pages = pages.into_iter().map(|(path, text)| (path, text, "]("));
    let mut seen = 0;
    for (path, text, prefix) in in_code.chain(in_pages) {
        for reference in references(&text, prefix) {
            assert!(!is_broken(reference), "{path} cites {reference:?}");
            seen += 1;
        }
    }
    assert!(seen > 20, "the search itself works: {seen}");
    assert_eq!(references("see docs/map.md#bias, docs/x.md.", "docs/"), [("map.md", Some("bias")), ("x.md", None)]);
    assert!(!is_broken(("map.md", Some("bias"))) && is_broken(("map.md", Some("bia"))) && is_broken(("x.md", None)));
}

#[test]
fn every_file_opens_with_its_idea_and_stays_short() {
    /// Lines beyond which a file holds more than one idea.
    const LONGEST: usize = 500;
    for (path, text) in sources() {
        assert!(text.starts_with("//! "), "src/{path} does not say what it is for");
        assert!(text.lines().count() <= LONGEST, "src/{path} is too long");
    }
    for (path, text) in files_below(Path::new(&root().join("shaders")), "wgsl") {
        assert!(text.starts_with("// "), "shaders/{path} does not say what it is for");
    }
}
