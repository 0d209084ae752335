//! What a test does on a page: goes to it, clicks, presses keys, reads, looks.

use super::driver::{Browser, PATIENCE};
use fantoccini::Locator;
use fantoccini::actions::{InputSource as _, KeyAction, KeyActions};
use fantoccini::elements::Element;
use fantoccini::error::{CmdError, ErrorStatus};
use fantoccini::key::Key;
use fantoccini::wd::WindowHandle;
use serde_json::Value;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Between two looks for what is not there yet.
const PAUSE: Duration = Duration::from_millis(20);

/// A tab of the browser.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tab(WindowHandle);

impl Browser {
    /// Loads a page and waits until it is there.
    ///
    /// # Errors
    ///
    /// The browser's words, where there is no page: the server is gone, or the browser offline.
    pub(crate) fn try_go(&self, address: &str) -> Result<(), CmdError> {
        self.wait(|client| async move { client.goto(address).await })
    }

    pub(crate) fn go(&self, address: &str) {
        self.try_go(address).unwrap_or_else(|error| panic!("{address}: {error}"));
    }

    pub(crate) fn reload(&self) {
        self.wait(|client| async move { client.refresh().await }).unwrap();
    }

    pub(crate) fn back(&self) {
        self.wait(|client| async move { client.back().await }).unwrap();
    }

    pub(crate) fn address(&self) -> String {
        self.wait(|client| async move { client.current_url().await }).unwrap().into()
    }

    pub(crate) fn title(&self) -> String {
        self.wait(|client| async move { client.title().await }).unwrap()
    }

    /// Commands go to the first frame of the page from now on, until the page is left.
    pub(crate) fn enter_frame(&self) {
        self.wait(|client| async move { client.enter_frame(0).await }).unwrap();
    }

    /// Commands go to the page around the frame again.
    pub(crate) fn leave_frame(&self) {
        self.wait(|client| async move { client.enter_parent_frame().await }).unwrap();
    }

    /// The tab that commands go to.
    pub(crate) fn tab(&self) -> Tab {
        Tab(self.wait(|client| async move { client.window().await }).unwrap())
    }

    /// Opens an empty tab; commands go to it from now on.
    pub(crate) fn open_tab(&self) -> Tab {
        let handle = self.wait(|client| async move { client.new_window(true).await }).unwrap().handle;
        let tab = Tab(handle);
        self.switch_to(&tab);
        self.set_up_tab();
        tab
    }

    pub(crate) fn switch_to(&self, tab: &Tab) {
        let handle = tab.0.clone();
        self.wait(|client| async move { client.switch_to_window(handle).await }).unwrap();
    }

    /// Closes the tab of now; commands go to the other one.
    pub(crate) fn close_tab(&self, next: &Tab) {
        self.wait(|client| async move { client.close_window().await }).unwrap();
        self.switch_to(next);
    }

    /// Waits until a look finds what it is for. `what` names it, in the words of a failure.
    pub(crate) fn until<T>(&self, what: &str, mut look: impl FnMut(&Self) -> Option<T>) -> T {
        let begin = Instant::now();
        loop {
            if let Some(found) = look(self) {
                return found;
            }
            assert!(
                begin.elapsed() < PATIENCE,
                "after {PATIENCE:?}: {what}; {} shows: {}",
                self.address(),
                self.text("body")
            );
            std::thread::sleep(PAUSE);
        }
    }

    /// Does something with an element, by its CSS selector. Waits where there is none yet, or where the page is just replaced.
    fn with<T, F>(&self, css: &str, act: impl Fn(Element) -> F) -> T
    where
        F: Future<Output = Result<T, CmdError>>,
    {
        let begin = Instant::now();
        loop {
            let done = self.wait(|client| async {
                let client = client;
                act(client.find(Locator::Css(css)).await?).await
            });
            match done {
                Ok(done) => return done,
                Err(error) if is_too_early(&error) && begin.elapsed() < PATIENCE => std::thread::sleep(PAUSE),
                Err(error) => panic!("{css} on {}: {error}", self.address()),
            }
        }
    }

    /// Clicks with the mouse, in the middle of the element, once it is there and not covered.
    pub(crate) fn click(&self, css: &str) {
        self.with(css, |element| async move { element.click().await });
    }

    /// Text of the element, as far as it is to be seen.
    pub(crate) fn text(&self, css: &str) -> String {
        self.with(css, |element| async move { element.text().await })
    }

    /// Waits until the element shows this text.
    pub(crate) fn wait_for_text(&self, css: &str, text: &str) {
        let what = format!("{css} does not say {text:?}");
        self.until(&what, |browser| (browser.text(css) == text).then_some(()));
    }

    /// A property of the element, as scripts see it: `value`, `checked`.
    pub(crate) fn property(&self, css: &str, name: &str) -> Option<String> {
        self.with(css, |element| async move { element.prop(name).await })
    }

    /// The computed style.
    pub(crate) fn style(&self, css: &str, name: &str) -> String {
        self.with(css, |element| async move { element.css_value(name).await })
    }

    /// How many elements there are now.
    pub(crate) fn count(&self, css: &str) -> usize {
        self.wait(|client| async move { client.find_all(Locator::Css(css)).await }).unwrap().len()
    }

    /// Presses and releases a key of the keyboard; where it goes, the focus says.
    pub(crate) fn press(&self, key: Key) {
        self.press_all([char::from(key)]);
    }

    /// Types a text, key by key.
    pub(crate) fn type_text(&self, text: &str) {
        self.press_all(text.chars());
    }

    fn press_all(&self, keys: impl IntoIterator<Item = char>) {
        let start = KeyActions::new("keyboard".to_owned());
        let actions = keys.into_iter().fold(start, |actions, value| {
            actions.then(KeyAction::Down { value }).then(KeyAction::Up { value })
        });
        self.wait(|client| async move { client.perform_actions(actions).await }).unwrap();
    }

    /// The CSS `id` of the element that has the focus; empty where it has none.
    pub(crate) fn focus(&self) -> String {
        self.run("return document.activeElement.id", &[]).as_str().unwrap().to_owned()
    }

    /// Runs the body of a function with these `arguments`, and gives what it returns. No policy of a page hinders it.
    pub(crate) fn run(&self, script: &str, arguments: &[Value]) -> Value {
        let arguments = arguments.to_vec();
        self.wait(|client| async move { client.execute(script, arguments).await }).unwrap()
    }

    /// The same for what takes its time: the last argument is a function that the script calls with the result.
    pub(crate) fn run_async(&self, script: &str, arguments: &[Value]) -> Value {
        let arguments = arguments.to_vec();
        self.wait(|client| async move { client.execute_async(script, arguments).await }).unwrap()
    }

    /// The page as it is seen, as a PNG. `GAITWAY_SHOTS` keeps it under this name.
    pub(crate) fn shot(&self, name: &str) -> Vec<u8> {
        let png = self.wait(|client| async move { client.screenshot().await }).unwrap();
        keep(name, &png);
        png
    }

    /// One element as it is seen, as a PNG.
    pub(crate) fn shot_of(&self, css: &str, name: &str) -> Vec<u8> {
        let png = self.with(css, |element| async move { element.screenshot().await });
        keep(name, &png);
        png
    }

    /// What the page showed when a test failed.
    pub(super) fn keep_last_sight(&self) {
        if let Ok(png) = self.wait(|client| async move { client.screenshot().await }) {
            let test = std::thread::current().name().unwrap_or("test").replace("::", "-");
            keep(&format!("failed-{test}"), &png);
        }
    }
}

fn keep(name: &str, png: &[u8]) {
    if let Some(folder) = std::env::var_os("GAITWAY_SHOTS").map(PathBuf::from) {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), png).unwrap();
    }
}

/// Whether a page that is not ready yet explains the error.
fn is_too_early(error: &CmdError) -> bool {
    let CmdError::Standard(error) = error else { return false };
    // an element of a page that is just replaced, in chromedriver's words for what the standard calls stale
    let is_of_another_page = error.message.contains("does not belong to the document");
    is_of_another_page
        || matches!(
            error.error,
            ErrorStatus::NoSuchElement
                | ErrorStatus::StaleElementReference
                | ErrorStatus::ElementNotInteractable
                | ErrorStatus::ElementClickIntercepted
        )
}
