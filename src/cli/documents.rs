//! Commands that documents show are commands that there are.

use super::command_line;
use std::path::Path;

/// The commands of a document's shell blocks, a line each, with what continues them and without comments.
fn commands(document: &str) -> Vec<String> {
    let blocks = document.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    let lines =
        blocks.flat_map(|block| block.replace("\\\n", " ").lines().map(str::to_owned).collect::<Vec<_>>());
    let commands = lines.map(|line| line.split(" #").next().unwrap_or_default().trim().to_owned());
    commands.filter(|line| line.starts_with("gaitway ")).collect()
}

/// The words of a command up to a pipe or a redirection.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    for letter in command.chars().chain([' ']) {
        match (quote, letter) {
            (None, '\'' | '"') => quote = Some(letter),
            (Some(open), close) if open == close => quote = None,
            (None, ' ') if word.is_empty() => {}
            (None, ' ') => words.push(std::mem::take(&mut word)),
            (None, '|' | '>' | '<') => break,
            _ => word.push(letter),
        }
    }
    words
}

#[test]
fn every_command_of_the_documents_is_understood() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut found = 0;
    for path in docs.chain(["README.md", "CONTRIBUTING.md"].map(|name| root.join(name))) {
        let Ok(document) = std::fs::read_to_string(&path) else { continue };
        for command in commands(&document) {
            found += 1;
            if let Err(error) = command_line().try_get_matches_from(words(&command)) {
                let is_asked = matches!(
                    error.kind(),
                    clap::error::ErrorKind::DisplayHelp | clap::error::ErrorKind::DisplayVersion
                );
                assert!(is_asked, "{}: {command}\n{error}", path.display());
            }
        }
    }
    assert!(found > 60, "{found}");
    assert_eq!(words("gaitway a 'b c' --d=\"e\" > f"), ["gaitway", "a", "b c", "--d=e"]);
    assert!(command_line().try_get_matches_from(words("gaitway study dance mine/")).is_err());
}
