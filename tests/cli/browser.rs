//! A real browser without a window, and a page in it.

use headless_chrome::browser::tab::point::Point;
use headless_chrome::protocol::cdp::Page::CaptureScreenshotFormatOption::Png;
use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::{Browser, LaunchOptions, Tab};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use std::{fs, thread};
use tempfile::TempDir;

/// As `setup/chromium.sh` installs it, talking to nobody.
const FLAGS: [&str; 7] = [
    "--disable-gpu",
    "--disable-quic",
    "--disable-component-update",
    "--disable-domain-reliability",
    "--no-proxy-server",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
];
/// How long anything may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

/// A page opened in a browser of its own. What the page complains about is kept.
pub(crate) struct Page {
    tab: Arc<Tab>,
    complaints: Arc<Mutex<Vec<String>>>,
    _browser: Browser,
    _profile: TempDir,
}

impl Page {
    /// Opens a file in a window of that size.
    pub(crate) fn open(file: &Path, size: (u32, u32)) -> Self {
        let profile = TempDir::new().unwrap();
        let options = LaunchOptions::default_builder()
            .sandbox(false)
            .window_size(Some(size))
            .user_data_dir(Some(profile.path().to_owned()))
            .args(FLAGS.iter().map(OsStr::new).collect())
            .build()
            .unwrap();
        let browser = Browser::new(options).unwrap();
        let tab = browser.new_tab().unwrap();
        let complaints = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&complaints);
        tab.add_event_listener(Arc::new(move |event: &Event| {
            let complaint = match event {
                Event::LogEntryAdded(entry) => Some(format!("{:?}", entry.params.entry.text)),
                Event::RuntimeExceptionThrown(thrown) => Some(format!("{:?}", thrown.params.exception_details)),
                Event::RuntimeConsoleAPICalled(call) => Some(format!("{:?}", call.params.args)),
                _ => None,
            };
            // What the tests themselves do to look at a canvas is no complaint about the page.
            let own = |complaint: &String| complaint.contains("Canvas2D: Multiple readback");
            kept.lock().unwrap().extend(complaint.filter(|complaint| !own(complaint)));
        }))
        .unwrap();
        tab.enable_log().unwrap();
        tab.enable_runtime().unwrap();
        let page = Self { tab, complaints, _browser: browser, _profile: profile };
        page.tab.navigate_to(&format!("file://{}", file.display())).unwrap();
        page
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&self, expression: &str) -> Value {
        let result = self.tab.evaluate(expression, true).unwrap_or_else(|error| panic!("{expression}: {error}"));
        result.value.unwrap_or(Value::Null)
    }

    /// The text of an element.
    pub(crate) fn text(&self, selector: &str) -> String {
        self.value(&format!("document.querySelector({selector:?}).textContent")).as_str().unwrap().to_owned()
    }

    /// Waits until an expression is true.
    pub(crate) fn wait_until(&self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != true {
            assert!(start.elapsed() < PATIENCE, "{expression} never came true; {:?}", self.complaints());
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Moves the pointer to where an expression says: `[x, y]` in the window.
    pub(crate) fn point_at(&self, expression: &str) {
        self.tab.move_mouse_to_point(self.point(expression)).unwrap();
    }

    /// Clicks where an expression says.
    pub(crate) fn click_at(&self, expression: &str) {
        self.tab.click_point(self.point(expression)).unwrap();
    }

    fn point(&self, expression: &str) -> Point {
        // Objects come back by reference, text by value.
        let text = self.value(&format!("JSON.stringify({expression})"));
        let [x, y]: [f64; 2] = serde_json::from_str(text.as_str().unwrap()).unwrap();
        Point { x, y }
    }

    /// Presses a key.
    pub(crate) fn press(&self, key: &str) {
        self.tab.press_key(key).unwrap();
    }

    /// What the page said on its console, and every error.
    pub(crate) fn complaints(&self) -> Vec<String> {
        self.complaints.lock().unwrap().clone()
    }

    /// Keeps a picture of the window.
    pub(crate) fn shoot(&self, file: &Path) {
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, self.tab.capture_screenshot(Png, None, None, true).unwrap()).unwrap();
    }
}

/// Where the middle of an element is in the window, as an expression.
pub(crate) fn middle_of(selector: &str) -> String {
    format!(
        "(b => [b.left + b.width / 2, b.top + b.height / 2])(document.querySelector({selector:?}).getBoundingClientRect())"
    )
}
