//! Rust source with comments and string contents told apart from code: enough
//! of a lexer to look for words without being fooled by text.

/// A string literal and the line it starts in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Literal {
    /// Line, counted from 1.
    pub line: usize,
    /// What stands between the quotes, escapes as written.
    pub text: String,
}

/// A source file, divided.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The code with comments and literal contents blanked; the same number of lines.
    pub code: String,
    /// The string literals.
    pub literals: Vec<Literal>,
}

impl Source {
    /// Divides `text`.
    pub fn new(text: &str) -> Self {
        let mut lexer = Lexer {
            characters: text.chars().collect(),
            position: 0,
            line: 1,
            source: Self { code: String::with_capacity(text.len()), literals: Vec::new() },
        };
        while lexer.position < lexer.characters.len() {
            lexer.advance();
        }
        lexer.source
    }

    /// The lines of the code with their numbers, counted from 1.
    pub fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.code.lines().enumerate().map(|(index, line)| (index + 1, line))
    }
}

struct Lexer {
    characters: Vec<char>,
    position: usize,
    line: usize,
    source: Source,
}

impl Lexer {
    fn peek(&self, ahead: usize) -> char {
        self.characters.get(self.position + ahead).copied().unwrap_or('\0')
    }

    /// Takes the next character over into the code.
    fn keep(&mut self) {
        let character = self.peek(0);
        self.line += usize::from(character == '\n');
        self.source.code.push(character);
        self.position += 1;
    }

    /// Replaces the next character by a blank; line breaks stay.
    fn blank(&mut self) {
        let character = self.peek(0);
        self.line += usize::from(character == '\n');
        self.source.code.push(if character == '\n' { '\n' } else { ' ' });
        self.position += 1;
    }

    fn at_end(&self) -> bool {
        self.position >= self.characters.len()
    }

    fn advance(&mut self) {
        match (self.peek(0), self.peek(1)) {
            ('/', '/') => self.line_comment(),
            ('/', '*') => self.block_comment(),
            ('"', _) => self.string(),
            ('r', '"' | '#') if self.starts_raw_string() => self.raw_string(),
            ('\'', _) if self.is_character_literal() => self.character(),
            _ => self.keep(),
        }
    }

    fn line_comment(&mut self) {
        while !self.at_end() && self.peek(0) != '\n' {
            self.blank();
        }
    }

    fn block_comment(&mut self) {
        let mut depth = 0_usize;
        while !self.at_end() {
            match (self.peek(0), self.peek(1)) {
                ('/', '*') => depth += 1,
                ('*', '/') => depth -= 1,
                _ => {
                    self.blank();
                    continue;
                }
            }
            self.blank();
            self.blank();
            if depth == 0 {
                break;
            }
        }
    }

    fn string(&mut self) {
        let (line, mut text) = (self.line, String::new());
        self.keep();
        while !self.at_end() && self.peek(0) != '"' {
            if self.peek(0) == '\\' {
                text.push(self.peek(0));
                self.blank();
            }
            text.push(self.peek(0));
            self.blank();
        }
        self.keep();
        self.source.literals.push(Literal { line, text });
    }

    /// `r"` or `r#...#"`, and not the end of an identifier such as `for`.
    fn starts_raw_string(&self) -> bool {
        let before = self.position.checked_sub(1).map(|index| self.characters[index]);
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') && before != Some('b') {
            return false;
        }
        let hashes = (1..).take_while(|ahead| self.peek(*ahead) == '#').count();
        self.peek(1 + hashes) == '"'
    }

    fn raw_string(&mut self) {
        let (line, mut text) = (self.line, String::new());
        self.keep();
        let mut hashes = 0;
        while self.peek(0) == '#' {
            hashes += 1;
            self.keep();
        }
        self.keep();
        while !self.at_end() && !self.closes_raw_string(hashes) {
            text.push(self.peek(0));
            self.blank();
        }
        for _ in 0..=hashes {
            self.keep();
        }
        self.source.literals.push(Literal { line, text });
    }

    fn closes_raw_string(&self, hashes: usize) -> bool {
        self.peek(0) == '"' && (1..=hashes).all(|ahead| self.peek(ahead) == '#')
    }

    /// `'a'` or `'\n'`, in contrast to the lifetime `'a`.
    fn is_character_literal(&self) -> bool {
        self.peek(1) == '\\' || self.peek(2) == '\''
    }

    fn character(&mut self) {
        self.keep();
        if self.peek(0) == '\\' {
            self.blank();
        }
        self.blank();
        while !self.at_end() && self.peek(0) != '\'' {
            self.blank();
        }
        self.keep();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_strings_are_no_code() {
        let source = Source::new("let a = \"todo!\"; // todo!\n/* todo! /* x */ y */ let b;\n");
        assert!(!source.code.contains("todo!"));
        assert!(source.code.contains("let b;"));
        assert_eq!(source.literals, [Literal { line: 1, text: "todo!".to_owned() }]);
        assert_eq!(source.lines().count(), 2);
    }

    #[test]
    fn quotes_inside_literals_do_not_end_the_world() {
        let source = Source::new("f('\"', '\\'', \"a\\\"b\", r#\"c\"d\"#); x<'a>(y: &'a str)");
        let texts: Vec<&str> = source.literals.iter().map(|l| l.text.as_str()).collect();
        assert_eq!(texts, ["a\\\"b", "c\"d"]);
        assert!(source.code.ends_with("x<'a>(y: &'a str)"));
    }

    #[test]
    fn an_identifier_that_ends_in_r_starts_no_raw_string() {
        let source = Source::new("for\"x\"");
        assert_eq!(source.literals.len(), 1);
        assert!(source.code.starts_with("for\""));
    }

    #[test]
    fn lines_keep_their_numbers() {
        let source = Source::new("a\n\"b\nc\"\nd\"e\"");
        assert_eq!(source.literals[1].line, 4);
        assert_eq!(source.code.lines().count(), 4);
    }
}
