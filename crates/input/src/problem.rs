//! Mistakes in a file, told to the person at the file: what is wrong, where,
//! what would be right.

use crate::units::UnitError;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text with its name, for excerpts.
#[derive(Debug, PartialEq)]
pub struct SourceText {
    /// Name of the file as the user knows it.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum Mistake {
    /// The file is not TOML.
    Syntax {
        /// What the TOML parser says.
        message: String,
    },
    /// A key or section that does not exist.
    UnknownKey {
        /// The section, empty at the top of the file.
        section: String,
        /// The key as written.
        key: String,
        /// The existing key closest to it.
        nearest: Option<String>,
        /// All keys of the section.
        allowed: Vec<String>,
    },
    /// A key or section that has to be there.
    Missing {
        /// The section, empty at the top of the file.
        section: String,
        /// The missing key.
        key: String,
        /// What it means.
        meaning: String,
        /// What could be written.
        example: String,
    },
    /// Text where a table is expected, and the like.
    WrongType {
        /// The key.
        key: String,
        /// What is expected.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A text that is not a quantity of the kind asked for.
    Quantity {
        /// The key.
        key: String,
        /// The text as written.
        text: String,
        /// The quantity asked for.
        wanted: &'static str,
        /// Units that are accepted.
        units: Vec<&'static str>,
        /// What is wrong with the text.
        error: UnitError,
    },
    /// A value outside its range.
    OutOfRange {
        /// The key.
        key: String,
        /// The value as written.
        text: String,
        /// Where it may lie.
        range: String,
    },
    /// A word that is none of the choices.
    NotAChoice {
        /// The key.
        key: String,
        /// The word as written.
        word: String,
        /// The choice closest to it.
        nearest: Option<String>,
        /// All choices.
        allowed: Vec<String>,
    },
    /// Statements that exclude each other.
    Contradiction {
        /// What excludes what.
        message: String,
        /// How to resolve it.
        help: String,
    },
    /// A file that cannot be used.
    File {
        /// The path as written.
        path: String,
        /// What is wrong with it.
        reason: String,
        /// What to do.
        help: String,
    },
    /// More than this program takes.
    TooLarge {
        /// What is too large.
        message: String,
        /// What to do.
        help: String,
    },
}

impl Mistake {
    /// One line without markup: what is wrong.
    #[must_use]
    pub fn message(&self) -> String {
        match self {
            Self::Syntax { message } => format!("this is not TOML: {message}"),
            Self::UnknownKey { section, key, .. } if section.is_empty() => {
                format!("unknown key or section `{key}`")
            }
            Self::UnknownKey { section, key, .. } => format!("unknown key `{key}` in [{section}]"),
            Self::Missing { section, key, meaning, .. } if section.is_empty() => {
                format!("`{key}` is missing: {meaning}")
            }
            Self::Missing { section, key, meaning, .. } => {
                format!("`{key}` is missing in [{section}]: {meaning}")
            }
            Self::WrongType { key, expected, found } => {
                format!("`{key}` must be {expected}, this is {found}")
            }
            Self::Quantity { key, text, wanted, error, .. } => {
                format!("`{key}` must be {}: `{text}`: {error}", article(wanted))
            }
            Self::OutOfRange { key, text, range } => {
                format!("`{key}` = {text} lies outside its range: {range}")
            }
            Self::NotAChoice { key, word, .. } => {
                format!("`{word}` is not a choice for `{key}`")
            }
            Self::Contradiction { message, .. } | Self::TooLarge { message, .. } => message.clone(),
            Self::File { path, reason, .. } => format!("cannot use the file `{path}`: {reason}"),
        }
    }

    /// A few words under the offending text.
    fn label(&self) -> String {
        match self {
            Self::Syntax { .. } | Self::Contradiction { .. } | Self::TooLarge { .. } => {
                String::new()
            }
            Self::UnknownKey { nearest: Some(near), .. }
            | Self::NotAChoice { nearest: Some(near), .. } => format!("did you mean `{near}`?"),
            Self::UnknownKey { .. } => "not known here".to_owned(),
            Self::NotAChoice { .. } => "not a choice".to_owned(),
            Self::Missing { key, .. } => format!("`{key}` is missing here"),
            Self::WrongType { expected, .. } => format!("expected {expected}"),
            Self::Quantity { error, .. } => error.to_string(),
            Self::OutOfRange { range, .. } => range.clone(),
            Self::File { reason, .. } => reason.clone(),
        }
    }

    /// What would be right.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::Syntax { message } if message.contains("must be quoted") => {
                "words and quantities stand in quotes: length = \"2.5 mm\"".to_owned()
            }
            Self::Syntax { .. } | Self::WrongType { .. } | Self::OutOfRange { .. } => String::new(),
            Self::UnknownKey { allowed, section, .. } if section.is_empty() => {
                format!("keys and sections of this file: {}", allowed.join(", "))
            }
            Self::UnknownKey { allowed, section, .. } => {
                format!("keys of [{section}]: {}", allowed.join(", "))
            }
            Self::Missing { example, .. } => format!("for example {example}"),
            Self::Quantity { units, error, .. } => quantity_help(units, error),
            Self::NotAChoice { key, allowed, .. } if key == "material" => format!(
                "a file beside the scenario, such as \"my_steel.toml\", or one of {}",
                allowed.join(", ")
            ),
            Self::NotAChoice { allowed, .. } => format!("choices: {}", allowed.join(", ")),
            Self::Contradiction { help, .. }
            | Self::File { help, .. }
            | Self::TooLarge { help, .. } => help.clone(),
        }
    }
}

fn quantity_help(units: &[&str], error: &UnitError) -> String {
    let listed = units.join(", ");
    match error {
        UnitError::UnknownUnit { nearest: Some(near), .. } => {
            format!("did you mean `{near}`? units for this: {listed}")
        }
        _ if units == ["%"] => {
            "write a plain number such as 0.25, or per cent as \"25 %\"".to_owned()
        }
        _ => format!("write a number and one of the units {listed}"),
    }
}

/// "a length", "an angle".
pub fn article(word: &str) -> String {
    let vowel = word.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {word}", if vowel { "an" } else { "a" })
}

/// A mistake at its place. `Display` shows the place, the line with the offending text
/// underlined, and what would be right.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// What is wrong.
    pub mistake: Mistake,
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    source: Arc<SourceText>,
    span: Range<usize>,
}

/// Whether text for a terminal carries colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colours {
    /// Text with escape sequences for a terminal.
    Terminal,
    /// Text alone.
    Plain,
}

impl Problem {
    /// A mistake at `span` of `source`.
    pub fn new(source: &Arc<SourceText>, span: Range<usize>, mistake: Mistake) -> Self {
        let span = inside(&source.text, span);
        let (line, column) = position(&source.text, span.start);
        Self { mistake, file: source.name.clone(), line, column, source: Arc::clone(source), span }
    }

    /// A problem with the file as a whole: it cannot be read.
    pub fn without_text(name: &str, mistake: Mistake) -> Self {
        let source = Arc::new(SourceText { name: name.to_owned(), text: String::new() });
        Self::new(&source, 0..0, mistake)
    }

    /// The problem as text of several lines, for people.
    #[must_use]
    pub fn render(&self, colours: Colours) -> String {
        let renderer = match colours {
            Colours::Terminal => Renderer::styled(),
            Colours::Plain => Renderer::plain(),
        };
        let (message, label, help) =
            (self.mistake.message(), self.mistake.label(), self.mistake.help());
        let title = Level::ERROR.primary_title(message.as_str());
        let text = visible(&self.source.text);
        let file = self.file.replace(char::is_control, "\u{b7}");
        let mut group = if text.is_empty() {
            title.element(annotate_snippets::Origin::path(file.as_str()))
        } else {
            let mark = AnnotationKind::Primary.span(self.span.clone());
            let mark = if label.is_empty() { mark } else { mark.label(label.as_str()) };
            title.element(Snippet::source(text.as_ref()).path(file.as_str()).annotation(mark))
        };
        if !help.is_empty() {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        renderer.render(&[group])
    }
}

/// Text without the control characters U+0080 to U+009F, which some terminals obey; those below
/// are replaced by the renderer. The stand-in has the same two bytes of UTF-8: places stay valid.
fn visible(text: &str) -> Cow<'_, str> {
    let obeyed = |c: char| ('\u{80}'..='\u{9f}').contains(&c);
    if text.contains(obeyed) {
        Cow::Owned(text.replace(obeyed, "\u{b7}"))
    } else {
        Cow::Borrowed(text)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(Colours::Plain))
    }
}

impl std::error::Error for Problem {}

/// The span cut to the text, moved to character boundaries and to one line.
fn inside(text: &str, span: Range<usize>) -> Range<usize> {
    let boundary = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = boundary(span.start);
    let end = boundary(span.end).max(start);
    let line_end = text[start..end].find('\n').map_or(end, |length| start + length);
    start..line_end
}

fn position(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..at];
    let line = before.matches('\n').count() + 1;
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (line, before[line_start..].chars().count() + 1)
}

/// Longest text of a user that is repeated in a message.
const LONGEST_QUOTE: usize = 60;

/// Text of a user as it may be repeated: short and without control characters.
pub fn shortened(text: &str) -> String {
    let mut quote: String = text
        .chars()
        .take(LONGEST_QUOTE)
        .map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c })
        .collect();
    if text.chars().nth(LONGEST_QUOTE).is_some() {
        quote.push_str("...");
    }
    quote
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_shows_line_column_and_the_text() {
        let text = "a = 1\nspeed = \"120 mm\"\n".to_owned();
        let source = Arc::new(SourceText { name: "cut.toml".to_owned(), text });
        let problem = Problem::new(
            &source,
            14..22,
            Mistake::Quantity {
                key: "speed".to_owned(),
                text: "120 mm".to_owned(),
                wanted: "speed",
                units: vec!["m/s", "m/min"],
                error: UnitError::WrongDimension { found: Some("length") },
            },
        );
        assert_eq!((problem.line, problem.column), (2, 9));
        let shown = problem.to_string();
        for part in ["cut.toml:2:9", "^^^^^^^^", "this is a length", "m/s, m/min"] {
            assert!(shown.contains(part), "{part} not in\n{shown}");
        }
    }

    #[test]
    fn spans_beyond_the_text_or_inside_a_character_are_cut() {
        assert_eq!(inside("ab", 5..9), 2..2);
        assert_eq!(inside("a\u{b5}b", 2..9), 1..4);
        assert_eq!(inside("ab\ncd", 0..5), 0..2);
    }
}
