//! The exporters: the closed list of formats a report can be written in, which `--format` chooses from.
//!
//! A new format is one file in this folder and one line in [`EXPORTERS`].

mod csv;
mod json;
mod junit;
mod markdown;

pub use json::to_json;

use super::Report;

/// One format.
#[derive(Debug, Clone, Copy)]
pub struct Exporter {
    /// What `--format` calls it.
    pub name: &'static str,
    /// What its files end in, without the dot.
    pub extension: &'static str,
    /// Writes a whole report.
    pub write: fn(&Report) -> Result<Vec<u8>, ExportError>,
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
    Exporter { name: "json", extension: "json", write: to_json },
    Exporter { name: "csv", extension: "csv", write: csv::to_csv },
    Exporter { name: "markdown", extension: "md", write: markdown::to_markdown },
    Exporter { name: "junit", extension: "xml", write: junit::to_junit },
];

/// Why a report cannot be written in a format.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// JSON.
    #[error("the report cannot be written as JSON")]
    Json(#[from] serde_json::Error),
    /// CSV.
    #[error("the report cannot be written as CSV")]
    Csv(#[from] ::csv::Error),
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
            let bytes = (exporter.write)(&report()).unwrap();
            assert_eq!(bytes, (exporter.write)(&report()).unwrap(), "{}", exporter.name);
            assert_eq!(bytes.last(), Some(&b'\n'), "{}", exporter.name);
        }
        assert!(Exporter::named("xlsx").is_none());
    }

    #[test]
    fn another_report_gives_other_bytes() {
        let mut changed = report();
        changed.runs[0].typed = "map:size=1".to_owned();
        for exporter in EXPORTERS {
            let (before, after) = ((exporter.write)(&report()).unwrap(), (exporter.write)(&changed).unwrap());
            assert_ne!(before, after, "{}", exporter.name);
        }
    }
}
