//! The dataset's README and list of changes.

use super::describe;
use super::notes::Note;
use super::sheet::Sheet;
use crate::study::analyse::Analysis;
use crate::study::file::StudyFile;
use std::fmt::Write as _;

// writing to a string cannot fail
pub(super) fn readme(study: &StudyFile, analysis: &Analysis, sheets: &[Sheet], notes: &[Note]) -> String {
    let title = if analysis.title.is_empty() { &analysis.study } else { &analysis.title };
    let mut text =
        format!("# {title}\n\nAnswers to the study `{}`, version {}. ", analysis.study, analysis.version);
    let all = &analysis.participants;
    let _ = writeln!(
        text,
        "{} participants arrived ({}), {} got a place, {} have answers that count and are not excluded.\n",
        all.arrived,
        describe::fronts(all.fronts.keys()),
        all.placed,
        all.analysed
    );
    for note in notes {
        let _ = writeln!(text, "Note: {note}.\n");
    }
    text.push_str("| file | one row |\n| --- | --- |\n");
    for sheet in sheets {
        let _ = writeln!(text, "| `data/{}` | {} |", sheet.file, sheet.row);
    }
    text.push_str(
        "\n`dataset_description.json` explains every column. `materials/` has the study file and the consent texts that were at \
         hand. `analysis/` has the results of the planned analysis, and `models.R`, mixed models of the same questions: `Rscript \
         models.R` in that folder, with the packages `ordinal` and `lme4`.\n\n",
    );
    if study.analysis.ratings.is_some() {
        text.push_str(
            "`analysis/ratings.csv` is what `gaitway gait ratings` reads: the excluded are not in it.\n\n",
        );
    }
    text.push_str(
        "The column `excluded` marks participants whom the rules of the study file exclude. Participants that withdrew are left \
         out, unless the study keeps their answers. A text that begins with ' would be computed by a spreadsheet without it.\n",
    );
    text
}

pub(super) fn changes(study: &StudyFile) -> String {
    format!(
        "# Changes\n\n## 1\n\nFirst export, by gaitway {}, of the study `{}`, version {} of its file.\n",
        env!("CARGO_PKG_VERSION"),
        study.study.id,
        study.study.version
    )
}
