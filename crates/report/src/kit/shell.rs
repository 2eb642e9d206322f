//! The shell of a page: head, title, footer, notes and figures. A page loads nothing.

use super::text::indexed;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

const STYLE: &str = include_str!("style.css");
/// Values under the pointer, and the animation; without it a page still shows everything else.
const SCRIPT: &str = include_str!("script.js");

/// A page around its content.
pub(crate) struct Shell<'a> {
    /// What the browser shows in its tab.
    pub tab: String,
    /// Headline.
    pub title: &'a str,
    /// The sentence below it.
    pub lead: Markup,
    /// Version of the program.
    pub version: &'a str,
    pub body: Markup,
}

impl Shell<'_> {
    /// The text of the file.
    pub fn render(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content={ "sphcut " (self.version) };
                    // No request for an icon.
                    link rel="icon" href="data:,";
                    title { (self.tab) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    main {
                        header { h1 { (self.title) } p.lead { (self.lead) } }
                        (self.body)
                        footer { "Written by sphcut " (self.version) "." }
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }
}

/// The tab of a page without a subject of its own.
pub(crate) fn tab(title: &str) -> String {
    format!("{title} \u{2013} sphcut")
}

/// Sentences in a box under a heading.
pub(crate) fn note(heading: &str, sentences: impl IntoIterator<Item = Markup>) -> Markup {
    html! {
        section.warnings role="note" {
            h2 { (heading) }
            ul { @for sentence in sentences { li { (sentence) } } }
        }
    }
}

/// The answer of a page as a heading with what belongs to it below, in the colours of an alarm or not.
pub(crate) fn verdict(
    alarm: bool,
    sentences: &[String],
    render: impl Fn(&str) -> Markup,
) -> Markup {
    verdict_above(alarm, sentences, render, &html! {})
}

/// The same with a table or list between the answer and what belongs to it.
pub(crate) fn verdict_above(
    alarm: bool,
    sentences: &[String],
    render: impl Fn(&str) -> Markup,
    detail: &Markup,
) -> Markup {
    html! {
        section.warnings[alarm].clean[!alarm] role="note" {
            @if let [first, rest @ ..] = sentences {
                h2 { (first) }
                (detail)
                ul { @for sentence in rest { li { (render(sentence)) } } }
            }
        }
    }
}

/// A section that opens with a click, and that a link to its name opens.
pub(crate) fn folded(name: &str, heading: &str, content: &Markup) -> Markup {
    html! {
        details.section {
            summary { h2 { (heading) } }
            span.place id=(name) {}
            (content)
        }
    }
}

/// Links to the sections of a page: names and headings.
pub(crate) fn contents(sections: &[(&str, &str)]) -> Markup {
    html! {
        nav.contents aria-label="Contents" {
            @for (name, heading) in sections { a href={ "#" (name) } { (heading) } " " }
        }
    }
}

/// What can be done next: commands, and what they are for.
pub(crate) fn next(steps: &[(&str, &str)]) -> Markup {
    html! {
        section {
            h2 { "Next" }
            dl.next { @for (command, purpose) in steps { dt { code { (command) } } dd { (purpose) } } }
        }
    }
}

/// A sentence as it is.
pub(crate) fn plain(sentence: &str) -> Markup {
    html! { (sentence) }
}

/// A chart with its caption; nothing without a chart.
pub(crate) fn figure(svg: Option<String>, caption: impl Render) -> Markup {
    html! { @if let Some(svg) = svg { figure { (PreEscaped(svg)) figcaption { (caption) } } } }
}

/// A plot with its caption, in which the letter after an underscore is an index.
pub(crate) fn plotted(svg: &str, caption: &str) -> Markup {
    html! { figure { (PreEscaped(svg)) figcaption { (indexed(caption)) } } }
}

/// A file as part of the page.
pub(crate) fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", BASE64_STANDARD.encode(bytes))
}
