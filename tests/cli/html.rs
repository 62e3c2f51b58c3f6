//! report.html in a real browser: what the page shows is what report.json and `explain` say, whatever scenes are called.

use crate::browser::{Page, middle_of};
use crate::support::{MODEL, SCENE, gnomon_in, report, shell};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A name that runs if anybody takes it for HTML.
const HOSTILE: &str = "<img src=x onerror=hacked=1><script>hacked=2<script>";
/// Sums of some thousand f64 errors, added in another order.
const SUM_TOLERANCE: f64 = 1e-9;

/// A folder with the report of a scene whose every name is hostile: `out/report.html`.
fn reported(techniques: &[&str]) -> TempDir {
    let folder = TempDir::new().unwrap();
    let scene = folder.path().join(HOSTILE);
    fs::create_dir_all(&scene).unwrap();
    let light = "lamp' onload=hacked=3 &amp;";
    fs::write(scene.join("scene.toml"), SCENE.replace("\"lamp\"", &format!("{light:?}"))).unwrap();
    fs::write(scene.join("model.obj"), MODEL.replace("o Tetra", "o <svg/onload=hacked=4>")).unwrap();
    let mut args = vec!["check", HOSTILE, "--out", "out", "--format", "html,junit,markdown,csv,json"];
    techniques.iter().for_each(|technique| args.extend(["-t", technique]));
    gnomon_in(folder.path(), &args).returns(0);
    folder
}

fn opened(folder: &TempDir) -> Page {
    let page = Page::open(&folder.path().join("out/report.html"), (1400, 1000));
    page.wait_until(
        "document.readyState === 'complete' && document.querySelector('#viewer').dataset.ready !== undefined",
    );
    page
}

/// Where results of tests that people look at are kept.
fn artefact(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("out/html-report").join(name)
}

/// The run that the page shows.
fn shown_run(page: &Page, folder: &TempDir) -> Value {
    let index = page.value("state.run").as_u64().unwrap();
    report(&folder.path().join("out"))["runs"][index as usize].clone()
}

/// Asserts that what the page counts over its pixels is what a run of report.json says.
fn assert_same_figures(page: &Page, run: &Value) {
    let count = |what: &str| page.value(&format!("[...pixels.class.keys()].filter(i => {what}).length"));
    let error = "(pixels.technique[i] - pixels.truth[i])";
    let figures = [
        ("total", "true".to_owned()),
        ("background", "pixels.class[i] === 0".to_owned()),
        ("facing_away", "pixels.class[i] === 1".to_owned()),
        ("not_lit", "pixels.class[i] === 2".to_owned()),
        ("undecided", "pixels.class[i] === 3".to_owned()),
        ("asked", "pixels.class[i] === 4".to_owned()),
        ("wrong", format!("Math.abs{error} > pixels.wrongAbove")),
        ("false_shadow", format!("{error} < -pixels.wrongAbove")),
        ("false_light", format!("{error} > pixels.wrongAbove")),
        ("differing", format!("Math.abs{error} > palette.differing_above")),
    ];
    for (name, what) in figures {
        assert_eq!(count(&what), run["pixels"][name], "{name}");
    }
    for (name, cause) in run["causes"].as_object().unwrap() {
        let named = format!("palette.causes[pixels.cause[i] - 1]?.name === {name:?}");
        assert_eq!(count(&format!("{named} && Math.abs{error} > pixels.wrongAbove")), cause["pixels"], "{name}");
        if cause["pixels"] != 0 {
            let row = format!("document.querySelector('[data-cause={name}]').closest('label').textContent");
            assert_eq!(page.value(&row), format!("{name}{} px", cause["pixels"]));
        }
    }
    let sum = page.value(&format!("[...pixels.class.keys()].reduce((sum, i) => sum + ({error} || 0), 0)"));
    let mean = run["error"]["signed"].as_f64().unwrap() * run["pixels"]["asked"].as_f64().unwrap();
    assert!((sum.as_f64().unwrap() - mean).abs() < SUM_TOLERANCE);
}

#[test]
fn the_page_shows_the_numbers_of_the_report_and_runs_nothing_that_a_name_holds() {
    let folder = reported(&["map:size=64,bias=none", "map:size=32,filter=pcf-box3", "volume"]);
    let page = opened(&folder);
    let run = shown_run(&page, &folder);
    assert!(run["pixels"]["wrong"].as_u64() > Some(0), "the worst run comes first");
    assert_same_figures(&page, &run);
    // Every judged run opens and agrees.
    for index in 0..report(&folder.path().join("out"))["runs"].as_array().unwrap().len() {
        page.value(&format!("document.querySelector('tr[data-run=\"{index}\"] a').click()"));
        page.wait_until(&format!("document.querySelector('#viewer').dataset.ready === '{index}'"));
        assert_same_figures(&page, &shown_run(&page, &folder));
    }
    assert_eq!(page.value("typeof hacked"), "undefined");
    assert_eq!(page.value("document.querySelectorAll('img, script:not([type])').length"), 1, "only our own script");
    assert!(page.text("#summary-table").contains(HOSTILE));
    assert_eq!(page.complaints(), [""; 0]);
    // Control: the browser does tell when something goes wrong, and when a policy is broken.
    page.value("setTimeout(() => nobody.knows())");
    page.value("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=hacked=5>')");
    page.wait_until("document.images.length === 1 && document.images[0].complete");
    assert_eq!(page.value("typeof hacked"), "undefined", "the policy holds even for markup that got in");
    assert!(page.complaints().len() >= 2, "{:?}", page.complaints());
}

#[test]
#[should_panic(expected = "false_light")]
fn another_number_is_noticed() {
    let folder = reported(&["map:size=32"]);
    let page = opened(&folder);
    let mut run = shown_run(&page, &folder);
    run["pixels"]["false_light"] = 999_999.into();
    assert_same_figures(&page, &run);
}

#[test]
fn the_inspector_says_what_explain_says() {
    let folder = reported(&["map:size=64,bias=none"]);
    let page = opened(&folder);
    let wrong = "[...pixels.class.keys()].filter(i => Math.abs(pixels.technique[i] - pixels.truth[i]) > 0.5)";
    page.value(&format!(
        "var wanted = {wrong}[3]; wanted = [wanted % pixels.width, Math.floor(wanted / pixels.width)]"
    ));
    page.value("document.querySelector('#panes').scrollIntoView()");
    let on_screen = "(b => wanted.map((v, k) => (v + 0.5 - [viewport.left, viewport.top][k]) * viewport.zoom + [b.left, b.top][k]))\
                     (document.querySelector('#panes canvas').getBoundingClientRect())";
    page.point_at(on_screen);
    page.wait_until("document.querySelector('#pixel-at').textContent === wanted.join(', ')");
    let explained = shell(folder.path(), &page.text("#pixel-command")).returns(0);
    let fact = |name: &str| page.text(&format!("[data-fact={name}]"));
    assert_eq!(fact("truth"), explained.after("truth "));
    assert_eq!(fact("technique"), explained.after("technique "));
    let verdict = explained.after("verdict: wrong by").to_owned();
    assert_eq!(fact("error").parse::<f64>().unwrap(), verdict.split(':').next().unwrap().parse::<f64>().unwrap());
    assert!(verdict.ends_with(&fact("cause")), "{verdict}");
    let occluder = fact("occluder").replace(" of ", " of mesh '");
    assert!(explained.after("occluder").starts_with(&occluder.replace("none", "nothing")), "{occluder}");
    // Every stage of explain is a row with its value; the values are rounded there.
    let rows = page.value("[...document.querySelectorAll('#pixel-stages tbody tr')].map(r => [...r.cells].map(c => c.textContent).join('\\t')).join('\\n')");
    let rows: Vec<&str> = rows.as_str().unwrap().lines().collect();
    assert!(rows.len() > 3);
    for row in rows {
        let cells: Vec<&str> = row.split('\t').collect();
        let line: Vec<&str> = explained.after(&format!("{} ", cells[0])).split_whitespace().collect();
        let (shown, said): (f64, f64) = (cells[1].parse().unwrap(), line[0].parse().unwrap());
        assert!((shown - said).abs() < 1e-4, "{row}: {line:?}");
        assert_eq!(cells[3], line.get(2).copied().unwrap_or_default(), "{row}: {line:?}");
    }
    // A click pins the pixel: the pointer may leave, and the arrow keys go on from there.
    page.click_at(on_screen);
    page.point_at(&middle_of("h2"));
    assert_eq!(page.text("#pixel-at"), page.value("wanted.join(', ')").as_str().unwrap());
    page.value("document.querySelector('#panes').focus({ preventScroll: true })");
    page.press("ArrowRight");
    assert_eq!(page.text("#pixel-at"), page.value("[wanted[0] + 1, wanted[1]].join(', ')").as_str().unwrap());
    assert_eq!(page.complaints(), [""; 0]);
}

#[test]
fn layers_swap_slide_and_zoom_in_place() {
    let folder = reported(&["map:size=64,bias=none"]);
    let page = opened(&folder);
    page.value("document.querySelector('#viewer').scrollIntoView()");
    let shows = || page.value("document.querySelector('#panes figure').dataset.shows");
    // The colour of a picture's pixel on the screen is that of the layer.
    page.value(
        "var wanted = [...pixels.class.keys()].find(i => pixels.technique[i] - pixels.truth[i] === -1);\
         var seen = () => { const c = document.querySelector('#panes canvas'), x = wanted % pixels.width, y = Math.floor(wanted / pixels.width);\
           return [...c.getContext('2d').getImageData((x + 0.5 - viewport.left) * viewport.zoom, (y + 0.5 - viewport.top) * viewport.zoom, 1, 1).data.slice(0, 3)].join(); }",
    );
    let falsely_dark = page.value("palette.false_shadow.join()");
    assert_eq!((shows(), page.value("seen()")), ("error".into(), falsely_dark.clone()));
    page.point_at(&middle_of("#layers [data-value=truth]"));
    page.wait_until("document.querySelector('#panes figure').dataset.shows === 'truth'");
    assert_eq!(page.value("seen()"), "255,255,255");
    page.point_at(&middle_of("#run-name"));
    page.wait_until("document.querySelector('#panes figure').dataset.shows === 'error'");
    assert_eq!(page.value("seen()"), falsely_dark);
    // The slider: left of the divider the truth, right of it the layer.
    page.press("s");
    page.value("document.querySelector('#slider').focus()");
    page.press("End");
    assert_eq!((page.value("state.divider"), page.value("seen()")), (1.into(), "255,255,255".into()));
    page.press("Home");
    assert_eq!((page.value("state.divider"), page.value("seen()")), (0.into(), falsely_dark.clone()));
    // All side by side, zoomed together.
    page.value("document.activeElement.blur()");
    page.press("g");
    assert_eq!(page.value("document.querySelectorAll('#panes canvas').length"), 5);
    page.shoot(&artefact("grid.png"));
    let zoom = page.value("viewport.zoom").as_f64().unwrap();
    page.press("+");
    assert_eq!(page.value("viewport.zoom").as_f64().unwrap(), 2.0 * zoom);
    page.press("o");
    page.value("viewport.zoomBy(40 / viewport.zoom, [0, 0]); viewport.left = wanted % 64 - 2; viewport.top = Math.floor(wanted / 64) - 2; draw()");
    // A pixel is a square of one colour: nothing is smoothed.
    let colours = "new Set(Array.from({ length: 30 }, (_, k) => [...document.querySelector('#panes canvas').getContext('2d')\
                   .getImageData(2 * 40 + 5 + k, 2 * 40 + 5 + k, 1, 1).data].join())).size";
    assert_eq!(page.value(colours), 1);
    page.shoot(&artefact("zoomed.png"));
    // Taking a cause's colour off the cause layer leaves the dimmed truth.
    page.value("viewport.fit()");
    page.press("4");
    let (named, dimmed) = (page.value("seen()"), page.value("palette.dim_lit.join()"));
    assert_eq!(named, page.value("palette.causes[pixels.cause[wanted] - 1].colour.join()"));
    page.value("document.querySelector(`[data-cause=${palette.causes[pixels.cause[wanted] - 1].name}]`).click()");
    assert_eq!(page.value("seen()"), dimmed);
    // A point of the plot opens its run.
    page.value("var plotted = document.querySelector('#plot a'), run = plotted.getAttribute('href').slice(5)");
    page.value("document.querySelector(`tr[data-run='${1 - run}'] a`).click()");
    page.wait_until("document.querySelector('#viewer').dataset.ready === String(1 - run)");
    page.value("plotted.dispatchEvent(new MouseEvent('click', { bubbles: true }))");
    page.wait_until("document.querySelector('#viewer').dataset.ready === run");
    page.value("scrollTo(0, 0)");
    page.shoot(&artefact("report.png"));
    assert_eq!(page.complaints(), [""; 0]);
}
