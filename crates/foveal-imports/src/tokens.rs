//! Source text as tokens: identifiers and single punctuation characters. Comments, strings and
//! lifetimes are left out.

/// One token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Token {
    /// An identifier or keyword.
    Ident(String),
    /// One character of punctuation.
    Punct(char),
    /// `::`.
    Colons,
    /// A string literal's text, which `#[path = ".."]` needs.
    Text(String),
}

impl Token {
    pub(crate) fn is_ident(&self, name: &str) -> bool {
        matches!(self, Self::Ident(i) if i == name)
    }

    pub(crate) fn is(&self, c: char) -> bool {
        *self == Self::Punct(c)
    }
}

/// Splits source text into tokens.
pub(crate) fn tokens(source: &str) -> Vec<Token> {
    let text: Vec<char> = source.chars().collect();
    let mut out = Vec::new();
    let mut i = 0;
    while i < text.len() {
        let (c, next) = (text[i], text.get(i + 1).copied());
        if c == '/' && next == Some('/') {
            i = end_of(&text, i, |t, i| t[i] == '\n');
        } else if c == '/' && next == Some('*') {
            i = after_comment(&text, i);
        } else if let Some(end) = raw_string(&text, i) {
            i = end;
        } else if c == '"' {
            let end = after_string(&text, i + 1);
            out.push(Token::Text(
                text[i + 1..end.saturating_sub(1).max(i + 1)]
                    .iter()
                    .collect(),
            ));
            i = end;
        } else if c == '\'' {
            i = after_quote(&text, i);
        } else if c == '_' || c.is_alphabetic() {
            let end = end_of(&text, i, |t, i| t[i] != '_' && !t[i].is_alphanumeric());
            out.push(Token::Ident(text[i..end].iter().collect()));
            i = end;
        } else if c == ':' && next == Some(':') {
            out.push(Token::Colons);
            i += 2;
        } else {
            if !c.is_whitespace() {
                out.push(Token::Punct(c));
            }
            i += 1;
        }
    }
    out
}

fn end_of(text: &[char], from: usize, is_end: impl Fn(&[char], usize) -> bool) -> usize {
    (from..text.len())
        .find(|&i| is_end(text, i))
        .unwrap_or(text.len())
}

/// The position after a block comment, which may hold others.
fn after_comment(text: &[char], from: usize) -> usize {
    let (mut depth, mut i) = (0, from);
    while i < text.len() {
        match (text[i], text.get(i + 1)) {
            ('/', Some('*')) => (depth, i) = (depth + 1, i + 2),
            ('*', Some('/')) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

/// The position after a string whose text begins at `i`.
fn after_string(text: &[char], mut i: usize) -> usize {
    while i < text.len() && text[i] != '"' {
        i += if text[i] == '\\' { 2 } else { 1 };
    }
    (i + 1).min(text.len())
}

/// The position after a raw string that begins at `i`, if one does.
fn raw_string(text: &[char], i: usize) -> Option<usize> {
    let begins = i == 0 || !(text[i - 1] == '_' || text[i - 1].is_alphanumeric());
    let at = match (text[i], text.get(i + 1)) {
        ('r', _) => i + 1,
        ('b', Some('r')) => i + 2,
        _ => return None,
    };
    let hashes = text.get(at..)?.iter().take_while(|&&c| c == '#').count();
    if !begins || text.get(at + hashes) != Some(&'"') {
        return None;
    }
    let is_end = |i: usize| text[i] == '"' && (1..=hashes).all(|k| text.get(i + k) == Some(&'#'));
    let end = (at + hashes + 1..text.len()).find(|&i| is_end(i));
    Some(end.map_or(text.len(), |end| end + 1 + hashes))
}

/// The position after a character literal, or after a lifetime's name.
fn after_quote(text: &[char], i: usize) -> usize {
    if text.get(i + 1) == Some(&'\\') {
        return end_of(text, i + 3, |t, i| t[i] == '\'') + 1;
    }
    if text.get(i + 2) == Some(&'\'') {
        return i + 3;
    }
    end_of(text, i + 1, |t, i| t[i] != '_' && !t[i].is_alphanumeric())
}
