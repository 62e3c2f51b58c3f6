//! The exporters: the closed list of formats a report can be written in, which `--format` chooses from.
//!
//! A new format is one file in this folder and one line in [`EXPORTERS`].

mod csv;
mod json;
mod junit;
mod markdown;

pub use json::to_json;

use super::Report;
use super::html::{Imagery, to_html};

/// One format.
#[derive(Debug, Clone, Copy)]
pub struct Exporter {
    /// What `--format` calls it.
    pub name: &'static str,
    /// What its files end in, without the dot.
    pub extension: &'static str,
    /// Writes a whole report; the pixels of its runs are for the format that shows them.
    pub write: Write,
    /// Whether the format shows pixels; for the others an empty [`Imagery`] will do.
    pub shows_pixels: bool,
}

impl Exporter {
    /// The exporter of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        EXPORTERS.iter().find(|exporter| exporter.name == name)
    }
}

/// Every format.
pub const EXPORTERS: &[Exporter] = &[
    text("json", "json", |report, _| to_json(report)),
    text("csv", "csv", |report, _| csv::to_csv(report)),
    text("markdown", "md", |report, _| markdown::to_markdown(report)),
    text("junit", "xml", |report, _| junit::to_junit(report)),
    Exporter { name: "html", extension: "html", write: to_html, shows_pixels: true },
];

/// A format without pixels.
const fn text(name: &'static str, extension: &'static str, write: Write) -> Exporter {
    Exporter { name, extension, write, shows_pixels: false }
}

/// How a format writes a report.
type Write = fn(&Report, &Imagery) -> Result<Vec<u8>, ExportError>;

/// Why a report cannot be written in a format.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// JSON.
    #[error("the report cannot be written as JSON")]
    Json(#[from] serde_json::Error),
    /// CSV.
    #[error("the report cannot be written as CSV")]
    Csv(#[from] ::csv::Error),
    /// HTML.
    #[error("the report cannot be written as HTML")]
    Html(#[from] minijinja::Error),
    /// The pixels of the HTML report.
    #[error("the report's pixels cannot be compressed")]
    Packing(#[source] std::io::Error),
    /// JUnit XML.
    #[error("the report cannot be written as JUnit XML")]
    Junit(#[from] quick_junit::SerializeError),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::report;

    #[test]
    fn exporters_have_different_names_and_the_same_report_always_gives_the_same_bytes() {
        for exporter in EXPORTERS {
            assert_eq!(EXPORTERS.iter().filter(|other| other.name == exporter.name).count(), 1);
            assert_eq!(Exporter::named(exporter.name).unwrap().extension, exporter.extension);
            let bytes = (exporter.write)(&report(), &Imagery::default()).unwrap();
            assert_eq!(bytes, (exporter.write)(&report(), &Imagery::default()).unwrap(), "{}", exporter.name);
            assert_eq!(bytes.last(), Some(&b'\n'), "{}", exporter.name);
        }
        assert!(Exporter::named("xlsx").is_none());
    }

    #[test]
    fn another_report_gives_other_bytes() {
        let mut changed = report();
        changed.runs[0].typed = "map:size=1".to_owned();
        for exporter in EXPORTERS {
            let (before, after) = (
                (exporter.write)(&report(), &Imagery::default()).unwrap(),
                (exporter.write)(&changed, &Imagery::default()).unwrap(),
            );
            assert_ne!(before, after, "{}", exporter.name);
        }
    }
}
