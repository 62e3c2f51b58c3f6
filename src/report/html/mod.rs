//! report.html: the whole report as one file to be read in a browser, without network.
//!
//! Tables are written here; pictures are painted by the page itself from the exact numbers of each pixel ([`Imagery`]), so
//! that it can show them, swap them and name the value under the pointer. Names of scenes, lights and meshes are strangers'
//! text: the template escapes them, data blocks hold no `<`, scripts only ever set text, and the page's own policy (CSP)
//! runs the one script whose hash it names.

mod imagery;
mod plane;
mod rows;

pub use imagery::{Imagery, QuestionImages, RunImages};

use super::export::ExportError;
use super::model::{Report, Status};
use super::picture::page_colours;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::Environment;
use minijinja::value::Serde;
use serde::Serialize;
use sha2::{Digest, Sha256};

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// The page's script: each file uses only those before it.
const SCRIPT: [&str; 6] = [
    include_str!("page/data.js"),
    include_str!("page/layers.js"),
    include_str!("page/viewport.js"),
    include_str!("page/inspector.js"),
    include_str!("page/plot.js"),
    include_str!("page/main.js"),
];

/// What the template is filled with.
#[derive(Debug, Serialize)]
struct Page<'a> {
    title: String,
    headline: String,
    style: &'a str,
    style_hash: String,
    script: &'a str,
    script_hash: String,
    report: &'a Report,
    rows: Vec<rows::SummaryRow>,
    costs: Vec<rows::CostRow>,
    notes: Vec<String>,
    details: Vec<String>,
    report_json: String,
    palette_json: String,
    question_blocks: Vec<String>,
    run_blocks: Vec<RunBlock>,
}

/// The pixels of a run as a data block.
#[derive(Debug, Serialize)]
struct RunBlock {
    index: usize,
    json: String,
}

/// The report as one HTML file. Runs without an entry in `imagery` have rows but no pictures.
///
/// # Errors
/// None that a report of this type can cause; those of the template and JSON libraries are passed on.
pub(super) fn to_html(report: &Report, imagery: &Imagery) -> Result<Vec<u8>, ExportError> {
    let mut environment = Environment::new();
    environment.add_template("report.html", TEMPLATE)?;
    let script = SCRIPT.concat();
    let runs = imagery.runs.iter().enumerate().filter_map(|(index, run)| Some((index, run.as_ref()?)));
    let run_blocks: Vec<RunBlock> =
        runs.map(|(index, run)| Ok(RunBlock { index, json: data_block(run)? })).collect::<Result<_, ExportError>>()?;
    let has_pictures = |index: usize| run_blocks.iter().any(|block| block.index == index);
    let page = Page {
        title: title(report),
        headline: headline(report),
        style: STYLE,
        style_hash: hash_source(STYLE),
        script_hash: hash_source(&script),
        script: &script,
        report,
        rows: rows::summary_rows(report, has_pictures),
        costs: rows::cost_rows(report),
        notes: rows::notes(report),
        details: rows::details(report),
        report_json: data_block(report)?,
        palette_json: data_block(&page_colours())?,
        question_blocks: imagery.questions.iter().map(data_block).collect::<Result<_, _>>()?,
        run_blocks,
    };
    let mut html = environment.get_template("report.html")?.render(Serde(&page))?;
    html.push('\n');
    Ok(html.into_bytes())
}

/// JSON that can stand in a script element: `<` is spelled in another way, so that no name ends the element.
fn data_block(value: &impl Serialize) -> Result<String, ExportError> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

/// An inline script or style as the page's policy names it: letters, digits, `+`, `/`, `=` and `-`, so it stands unescaped.
fn hash_source(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

fn title(report: &Report) -> String {
    let mut scenes: Vec<&str> = report.runs.iter().map(|run| run.scene.as_str()).collect();
    scenes.dedup();
    format!("Shadow report: {}", scenes.join(", "))
}

/// How many runs there are, and how they ended.
fn headline(report: &Report) -> String {
    let count =
        |what: &str, is: &dyn Fn(&super::model::Run) -> bool| match report.runs.iter().filter(|run| is(run)).count() {
            0 => None,
            n => Some(format!("{n} {what}")),
        };
    let parts = [
        count("over budget", &|run| run.budget.is_some_and(|budget| !budget.met)),
        count("within budget", &|run| run.budget.is_some_and(|budget| budget.met)),
        count("without a budget", &|run| run.status == Status::Ok && run.budget.is_none()),
        count("not applicable", &|run| run.status == Status::Unsupported),
        count("failed", &|run| run.status == Status::Failed),
    ];
    let runs = if report.runs.len() == 1 { "run" } else { "runs" };
    format!("{} {runs}: {}", report.runs.len(), parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, report, report_of};

    fn page(report: &Report) -> String {
        String::from_utf8(to_html(report, &Imagery::default()).unwrap()).unwrap()
    }

    /// Opening tags of a kind.
    fn tags(page: &str, name: &str) -> usize {
        page.matches(&format!("<{name}")).count()
    }

    #[test]
    fn a_name_of_markup_adds_no_element() {
        let (plain, hostile) = (page(&report()), page(&report_of(HOSTILE)));
        for name in ["script", "img", "td", "a ", "code"] {
            assert_eq!(tags(&plain, name), tags(&hostile, name), "{name}");
        }
        assert!(!hostile.contains("<script>alert"));
        assert!(hostile.contains("&lt;script&gt;alert"), "the name is still there to be read");
        // Control: unescaped, the same name would have added one.
        assert_eq!(tags(&format!("{plain}{HOSTILE}"), "script"), tags(&plain, "script") + 1);
    }

    #[test]
    fn the_page_asks_nobody_for_anything() {
        let page = page(&report());
        for word in ["http://", "https://", "//cdn", "@import", "url("] {
            let found = page.replace("http://www.w3.org/2000/svg", "").contains(word);
            assert!(!found, "{word}");
        }
        assert!(page.contains("default-src 'none'"));
    }

    #[test]
    fn the_policy_names_the_script_and_style_that_are_there() {
        let page = page(&report());
        let between = |from: &str, to: &str| page.split(from).nth(1).unwrap().split(to).next().unwrap().to_owned();
        assert_eq!(between("script-src '", "'"), hash_source(&between("<script>", "</script>")));
        assert_eq!(between("style-src '", "'"), hash_source(&between("<style>", "</style>")));
    }

    #[test]
    fn the_headline_counts_how_runs_ended() {
        assert_eq!(headline(&report()), "3 runs: 1 over budget, 1 not applicable, 1 failed");
        assert_eq!(title(&report()), "Shadow report: kitchen");
    }
}
