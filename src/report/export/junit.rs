//! JUnit XML: one suite per scene and one case per run, for build servers.
//!
//! An exceeded budget is a failure, a run that failed is an error, one that does not apply or asks nothing is skipped. The library
//! escapes names and drops characters that XML cannot hold.

use super::ExportError;
use crate::report::Report;
use crate::report::format::percent;
use crate::report::model::{Run, Status};
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};

/// The report as JUnit XML, without times: they are no test durations.
pub(super) fn to_junit(report: &Report) -> Result<Vec<u8>, ExportError> {
    let mut suites = quick_junit::Report::new(&report.tool.name);
    for runs in report.runs.chunk_by(|a, b| a.scene == b.scene) {
        let mut suite = TestSuite::new(valid_in_xml(&runs[0].scene));
        suite.add_test_cases(runs.iter().map(case));
        suites.add_test_suite(suite);
    }
    let mut bytes = Vec::new();
    suites.serialize(&mut bytes)?;
    Ok(bytes)
}

fn case(run: &Run) -> TestCase {
    let mut case = TestCase::new(valid_in_xml(&run.typed), status(run));
    case.set_classname(valid_in_xml(&format!("{}.{}", run.scene, run.light)));
    case.set_system_out(valid_in_xml(&run.command));
    case
}

fn status(run: &Run) -> TestCaseStatus {
    let why = valid_in_xml(run.why.as_deref().unwrap_or_default());
    let (mut status, kind, message) = match run.status {
        Status::Failed => (TestCaseStatus::non_success(NonSuccessKind::Error), "failed", why),
        Status::Unsupported => (TestCaseStatus::skipped(), "unsupported", why),
        Status::Ok if run.is_unchecked() => {
            (TestCaseStatus::skipped(), "unchecked", "no pixel was asked: the budget checks nothing".to_owned())
        }
        Status::Ok => match exceeded(run) {
            Some(message) => (TestCaseStatus::non_success(NonSuccessKind::Failure), "budget", message),
            None => return TestCaseStatus::success(),
        },
    };
    status.set_type(kind).set_message(message);
    status
}

/// How a run exceeds its budget; `None` if it does not.
fn exceeded(run: &Run) -> Option<String> {
    let (budget, error) = (run.budget.filter(|budget| !budget.met)?, run.error?);
    let wrong = error
        .wrong_fraction
        .zip(budget.wrong_fraction)
        .map(|(is, may)| format!("{} of the asked pixels are wrong, the budget is {}", percent(is), percent(may)));
    let mean = error
        .mean_abs
        .zip(budget.mean_abs)
        .map(|(is, may)| format!("the mean absolute error is {is}, the budget is {may}"));
    Some([wrong, mean].into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Without the two characters of the basic plane that no XML document may hold and the library lets through.
fn valid_in_xml(text: &str) -> String {
    text.replace(['\u{FFFE}', '\u{FFFF}'], "\u{FFFD}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::tests::{HOSTILE, report, report_of};

    fn xml(report: &Report) -> String {
        String::from_utf8(to_junit(report).unwrap()).unwrap()
    }

    #[test]
    fn runs_become_cases_by_how_they_ended() {
        let xml = xml(&report());
        assert!(xml.contains(r#"tests="3" skipped="1" failures="1" errors="1""#), "{xml}");
        assert!(xml.contains(r#"<testcase name="map:size=512" classname="kitchen.lamp">"#), "{xml}");
        assert!(xml.contains("42.9 % of the asked pixels are wrong, the budget is 0.1 %"), "{xml}");
        assert!(xml.contains(r#"<skipped message="open mesh, 12 edges" type="unsupported"/>"#), "{xml}");
        assert!(xml.contains(r#"<error message="device lost" type="failed"/>"#), "{xml}");
    }

    #[test]
    fn a_budget_that_nothing_was_held_against_is_skipped() {
        let mut unchecked = report();
        unchecked.runs[0].pixels.as_mut().unwrap().asked = 0;
        let xml = xml(&unchecked);
        assert!(xml.contains(r#"tests="3" skipped="2" failures="0" errors="1""#), "{xml}");
        assert!(xml.contains("the budget checks nothing"), "{xml}");
    }

    #[test]
    fn a_budget_that_is_met_or_absent_is_a_success() {
        let mut met = report();
        met.runs.truncate(1);
        met.runs[0].budget.as_mut().unwrap().met = true;
        assert!(xml(&met).contains(r#"failures="0""#));
        met.runs[0].budget = None;
        assert!(xml(&met).contains(r#"failures="0""#));
    }

    #[test]
    fn scenes_become_suites() {
        let mut two = report();
        two.runs.extend(report_of("torus").runs);
        assert_eq!(xml(&two).matches("<testsuite ").count(), 2);
    }

    #[test]
    fn hostile_names_cannot_leave_their_attribute() {
        let hostile = format!("{HOSTILE}\u{FFFF}");
        let xml = xml(&report_of(&hostile));
        assert!(!xml.contains("<script>") && !xml.contains('\u{FFFF}') && !xml.contains('\u{1}'));
        let mut reader = quick_junit::Report::deserialize_from_str(&xml).unwrap();
        let suite = reader.test_suites.remove(0);
        assert!(suite.name.as_str().starts_with("a\"b'<script>alert(1)</script>&amp;,;|`"), "{:?}", suite.name);
        assert_eq!(suite.test_cases.len(), 3);
    }
}
