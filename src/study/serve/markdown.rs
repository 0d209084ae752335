//! Consent texts: Markdown to HTML, in which no HTML, image or script of the text takes effect.

use maud::{Markup, PreEscaped};
use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// Addresses that a link may lead to.
const SCHEMES: [&str; 3] = ["https://", "http://", "mailto:"];

/// A text made ready.
#[derive(Debug)]
pub(super) struct Rendered {
    /// As HTML.
    pub(super) markup: Markup,
    /// Its first heading of the first level, as plain text.
    pub(super) title: Option<String>,
}

/// Makes Markdown ready. HTML in it is shown as the text that it is.
pub(super) fn render(text: &str) -> Rendered {
    // of every link that is open, whether it is kept
    let mut kept = Vec::new();
    let parser = Parser::new_ext(text, Options::ENABLE_TABLES);
    let events: Vec<Event<'_>> = parser.filter_map(|event| tame(event, &mut kept)).collect();
    let title = title(&events);
    let mut markup = String::new();
    html::push_html(&mut markup, events.into_iter());
    Rendered { markup: PreEscaped(markup), title }
}

fn tame<'t>(event: Event<'t>, kept: &mut Vec<bool>) -> Option<Event<'t>> {
    match event {
        Event::Html(text) | Event::InlineHtml(text) => Some(Event::Text(text)),
        Event::Start(Tag::Link { ref dest_url, .. }) => {
            let is_kept = is_allowed(dest_url);
            kept.push(is_kept);
            is_kept.then_some(event)
        }
        Event::End(TagEnd::Link) => kept.pop().unwrap_or(false).then_some(event),
        Event::Start(Tag::Image { .. } | Tag::HtmlBlock) | Event::End(TagEnd::Image | TagEnd::HtmlBlock) => {
            None
        }
        other => Some(other),
    }
}

fn is_allowed(address: &str) -> bool {
    SCHEMES.iter().any(|scheme| address.get(..scheme.len()).is_some_and(|a| a.eq_ignore_ascii_case(scheme)))
}

fn title(events: &[Event<'_>]) -> Option<String> {
    let is_start =
        |event: &Event<'_>| matches!(event, Event::Start(Tag::Heading { level: HeadingLevel::H1, .. }));
    let start = events.iter().position(is_start)?;
    let inside =
        events[start + 1..].iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
    let texts = inside.filter_map(|event| match event {
        Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
        _ => None,
    });
    Some(texts.collect::<String>()).filter(|title| !title.trim().is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_becomes_html_and_html_stays_text() {
        let text = "# A *short* study\n\nYou <b>may</b> [write](mailto:lab@x.org).\n\n<script>alert(1)</script>\n\n\
                    [bad](javascript:alert(1)) ![pixel](https://x.org/a.png)";
        let rendered = render(text);
        let html = rendered.markup.into_string();
        assert_eq!(rendered.title.as_deref(), Some("A short study"));
        assert!(html.contains("<h1>A <em>short</em> study</h1>"), "{html}");
        assert!(html.contains(r#"<a href="mailto:lab@x.org">write</a>"#), "{html}");
        assert!(html.contains("&lt;b&gt;may&lt;/b&gt;") && html.contains("&lt;script&gt;"), "{html}");
        assert!(
            !html.contains("<script") && !html.contains("javascript:") && !html.contains("<img"),
            "{html}"
        );
        assert_eq!(render("no heading").title, None);
    }
}
