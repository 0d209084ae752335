//! What hinders people on a page, by axe-core.

use super::driver::Browser;
use serde::Deserialize;
use serde_json::json;

/// One element that breaks one of axe-core's rules.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(crate) struct Violation {
    /// Id of the rule, as `image-alt`.
    pub(crate) rule: String,
    /// `minor`, `moderate`, `serious` or `critical`.
    pub(crate) impact: String,
    /// CSS selector of the element.
    pub(crate) element: String,
    /// What would mend it.
    pub(crate) help: String,
}

const RUN: &str = "
const done = arguments[0];
axe.run(document, { resultTypes: ['violations'] }).then(
    found => done({ violations: found.violations.flatMap(rule => rule.nodes.map(node => ({
        rule: rule.id, impact: rule.impact, element: node.target.flat().join(' '), help: rule.help,
    }))), passes: found.passes.length }),
    error => done({ error: String(error) }));
";

impl Browser {
    /// Every violation on the page of now, with the rules that axe-core has on by itself.
    pub(crate) fn violations(&self) -> Vec<Violation> {
        // the page stays as it is without scripts: what it did not run when it was loaded does not run now
        self.let_scripts_run(true);
        if self.run("return typeof axe", &[]) == json!("undefined") {
            let source = std::fs::read_to_string(self.folder.join("axe.min.js")).unwrap();
            self.run(&source, &[]);
        }
        let mut found = self.run_async(RUN, &[]);
        self.let_scripts_run(self.options.scripts);
        // a page on which no rule had anything to look at was not looked at
        assert!(found["passes"].as_u64() > Some(0), "axe-core looked at nothing: {found}");
        serde_json::from_value(found["violations"].take()).unwrap()
    }
}
