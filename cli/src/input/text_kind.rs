//! [`TextKind`]: what a text is that was given in place of another one.

/// Markup that is recognised by its beginning. A setup is none of these.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum TextKind {
    Json,
    Xml,
    Yaml,
}

impl TextKind {
    pub(crate) fn of(text: &str) -> Option<Self> {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let is_list = |rest: &str| rest.trim_start().starts_with(['{', '"']);
        if text.starts_with('{') || text.strip_prefix('[').is_some_and(is_list) {
            Some(Self::Json)
        } else if text.starts_with('<') {
            Some(Self::Xml)
        } else {
            is_yaml(text).then_some(Self::Yaml)
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Json => "JSON",
            Self::Xml => "XML",
            Self::Yaml => "YAML",
        }
    }
}

/// By the first line that is no comment: a directive, the start of a document, or `key:`.
fn is_yaml(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| {
        let key = line.split_once(':').map(|(key, rest)| (key, rest.chars().next().is_none_or(char::is_whitespace)));
        let is_key = |key: &str| !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-./ ".contains(c));
        line.starts_with("%YAML") || line == "---" || key.is_some_and(|(key, ends)| ends && is_key(key))
    })
}
