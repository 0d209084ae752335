//! An analysis as a page: Markdown, or one HTML file with figures.

mod beside_paper;
mod figures;
mod html;
mod page;
mod people;
mod planned;
mod questionnaires;
mod ratings;

use super::Analysis;
use page::{Page, both, plain};

/// The page as Markdown: who took part, exclusions, the tests without and with the excluded, ratings, questionnaires, remarks.
pub fn markdown(analysis: &Analysis) -> String {
    page(analysis).markdown()
}

/// One HTML page of one analysis or several, with figures as SVG. It needs no other file, runs no script and asks no network.
pub fn html(analyses: &[&Analysis]) -> String {
    let pages: Vec<Page> = analyses.iter().map(|analysis| page(analysis)).collect();
    html::html(&pages)
}

fn page(analysis: &Analysis) -> Page {
    let mut page = Page::default();
    let title = if analysis.title.is_empty() { &analysis.study } else { &analysis.title };
    page.heading(1, plain(title));
    page.paragraph(format!("Study `{}`, version {}.", analysis.study, analysis.version));
    if analysis.participants.is_simulated {
        page.paragraph("**All participants are simulated.** These numbers describe a model, not people.");
    }
    if analysis.is_short {
        page.paragraph("**The data fall short of the plan.** The remarks say where.");
    }
    people::participants(&mut page, analysis);
    people::exclusions(&mut page, analysis);
    figures::answers(&mut page, analysis);
    for test in &analysis.tests {
        planned::test(&mut page, test);
    }
    if let Some(sides) = &analysis.ratings {
        both(&mut page, sides, &format!("Ratings of gaits, part `{}`", sides.kept.part), ratings::block);
    }
    if !analysis.questionnaires.kept.is_empty() {
        both(&mut page, &analysis.questionnaires, "Questionnaires", |page, all| {
            all.iter().for_each(|one| questionnaires::block(page, one));
        });
    }
    beside_paper::section(&mut page, analysis);
    people::remarks(&mut page, analysis);
    page
}
