//! A report as one HTML page.

use super::page::{Block, Page};
use std::fmt::Write as _;

/// Colours on a light ground: paper, text, quiet text, lines, links.
const LIGHT: [&str; 5] = ["#ffffff", "#1e2126", "#5c636d", "#8a919b", "#1c5496"];
/// The same on a dark ground.
const DARK: [&str; 5] = ["#14171b", "#eceef1", "#a3abb6", "#6b737e", "#82b4d7"];
/// What is not a colour.
const LAYOUT: &str = "\
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:70rem;margin:0 auto;padding:1rem 1.25rem 4rem}
h1{font-size:1.7rem;line-height:1.2}
h2{font-size:1.3rem;margin-top:2.5rem;border-bottom:1px solid var(--line)}
h3{font-size:1.1rem;margin-top:2rem}
a{color:var(--link)}
code{font-family:ui-monospace,monospace;font-size:.95em}
nav ul{columns:18rem;padding-left:1.2rem}
.table{overflow-x:auto;margin:1rem 0}
table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top;font-weight:400}
thead th{font-weight:600;border-bottom-width:2px}
.number{text-align:right;white-space:nowrap}
figure{margin:1.5rem 0;overflow-x:auto}
figure svg{max-width:100%;height:auto}
figcaption{color:var(--quiet);font-size:.9rem}
";
const PRINT: &str = "\
@media print{body{font-size:10pt}main{max-width:none;padding:0}nav{display:none}figure,tr{break-inside:avoid}
h1,h2,h3{break-after:avoid}.table,figure{overflow:visible}table{font-size:7.5pt}a{color:inherit}
figure svg .ink{fill:#1e2126}figure svg .muted{fill:#5c636d}figure svg .grid{fill:#d9dce0}figure svg .paper{fill:#ffffff}}
";

/// One page of one report or several.
pub(super) fn html(pages: &[Page]) -> String {
    let is_one = pages.len() == 1;
    let title = pages.first().and_then(title).filter(|_| is_one).unwrap_or("Results of studies");
    let mut body = String::new();
    // several reports stand one level below a common title
    let deeper = usize::from(!is_one);
    if !is_one {
        body.push_str("<h1>Results of studies</h1>\n");
    }
    let mut contents = String::new();
    let mut count = 0;
    for block in pages.iter().flat_map(|page| &page.blocks) {
        write(&mut body, block, deeper, &mut contents, &mut count);
    }
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<meta \
         http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
         <title>{}</title>\n<style>\n{}{LAYOUT}{PRINT}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
        words(title),
        colours(),
        with_contents(&body, &contents)
    )
}

fn colours() -> String {
    let set = |[paper, ink, quiet, line, link]: [&str; 5]| {
        format!(":root{{--paper:{paper};--ink:{ink};--quiet:{quiet};--line:{line};--link:{link}}}")
    };
    let (light, dark) = (set(LIGHT), set(DARK));
    format!("{light}\n@media screen and (prefers-color-scheme:dark){{{dark}}}\n")
}

/// The list of sections behind the first heading.
fn with_contents(body: &str, contents: &str) -> String {
    let (first, rest) = body.split_once("</h1>\n").unwrap_or((body, ""));
    format!("{first}</h1>\n<nav aria-label=\"Contents\"><ul>\n{contents}</ul></nav>\n{rest}")
}

fn title(page: &Page) -> Option<&str> {
    page.blocks.iter().find_map(|block| match block {
        Block::Heading(1, text) => Some(text.as_str()),
        _ => None,
    })
}

// writing to a string cannot fail
fn write(body: &mut String, block: &Block, deeper: usize, contents: &mut String, count: &mut usize) {
    let _ = match block {
        Block::Heading(level, text) => {
            *count += 1;
            let (level, text) = (level + deeper, words(text));
            if level == 2 {
                let _ = writeln!(contents, "<li><a href=\"#s{count}\">{text}</a></li>");
            }
            writeln!(body, "<h{level} id=\"s{count}\">{text}</h{level}>")
        }
        Block::Paragraph(text) => writeln!(body, "<p>{}</p>", words(text)),
        Block::List(items) => {
            let items: String = items.iter().map(|item| format!("<li>{}</li>\n", words(item))).collect();
            writeln!(body, "<ul>\n{items}</ul>")
        }
        Block::Table { head, numbers, rows } => {
            body.push_str(&table(head, *numbers, rows));
            Ok(())
        }
        Block::Figure { svg, caption } => {
            let caption = words(caption);
            writeln!(body, "<figure>\n{svg}<figcaption>{caption}</figcaption>\n</figure>")
        }
    };
}

fn table(head: &[String], numbers: usize, rows: &[Vec<String>]) -> String {
    let class = |column: usize| if column < numbers { "" } else { " class=\"number\"" };
    let names: String = head
        .iter()
        .enumerate()
        .map(|(column, name)| format!("<th scope=\"col\"{}>{}</th>", class(column), words(name)))
        .collect();
    let cell = |(column, text): (usize, &String)| match column {
        0 => format!("<th scope=\"row\">{}</th>", words(text)),
        _ => format!("<td{}>{}</td>", class(column), words(text)),
    };
    let rows: String = rows
        .iter()
        .map(|row| format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>()))
        .collect();
    // a table that is wider than the page scrolls, with the keyboard, too
    let label = head.first().map_or_else(String::new, |name| words(name));
    format!(
        "<div class=\"table\" role=\"region\" aria-label=\"Table by {label}\" tabindex=\"0\">\n<table>\n<thead>\n<tr>{names}</tr>\n\
         </thead>\n<tbody>\n{rows}</tbody>\n</table>\n</div>\n"
    )
}

/// The text of a block as HTML.
fn words(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    let (mut is_code, mut is_strong) = (false, false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '`' => {
                is_code = !is_code;
                html.push_str(if is_code { "<code>" } else { "</code>" });
            }
            '\\' if !is_code => html.push_str(&escaped(letters.next().unwrap_or('\\'))),
            '*' if !is_code && letters.next_if_eq(&'*').is_some() => {
                is_strong = !is_strong;
                html.push_str(if is_strong { "<strong>" } else { "</strong>" });
            }
            letter => html.push_str(&escaped(letter)),
        }
    }
    html
}

fn escaped(letter: char) -> String {
    match letter {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        other if other.is_control() => " ".to_owned(),
        other => other.to_string(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// Contrast of WCAG 2.
    fn contrast(a: &str, b: &str) -> f64 {
        let luminance = |colour: &str| {
            let channel = |at: usize| {
                let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
                if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn texts_and_lines_have_the_contrast_of_wcag_in_both_schemes() {
        for [paper, ink, quiet, line, link] in [LIGHT, DARK] {
            for text in [ink, quiet, link] {
                assert!(contrast(text, paper) >= 4.5, "{text} on {paper}: {}", contrast(text, paper));
            }
            assert!(contrast(line, paper) >= 3.0, "{line} on {paper}: {}", contrast(line, paper));
        }
        assert!((contrast("#000000", "#ffffff") - 21.0).abs() < 1e-9);
    }

    #[test]
    fn signs_become_tags_and_everything_else_stays_text() {
        assert_eq!(
            words("**a** `b_<c>` \\*\\*d <i>"),
            "<strong>a</strong> <code>b_&lt;c&gt;</code> **d &lt;i&gt;"
        );
        assert_eq!(words("1 * 2 \\\\ \"3\" & \u{7}"), "1 * 2 \\ &quot;3&quot; &amp;  ");
    }
}
