//! YAML, JSON and OpenCV's XML as one kind of tree: maps, lists, numbers and texts.

use anyhow::{Context, Result, anyhow, bail, ensure};
use serde_json::{Map, Number, Value};

use super::text_kind::TextKind;

/// The only document of a text.
pub(crate) fn parse(text: &str) -> Result<Value> {
    let text = text.trim_start_matches('\u{feff}');
    ensure!(!text.trim().is_empty(), "the file is empty");
    match TextKind::of(text) {
        Some(TextKind::Json) => serde_json::from_str(text).map_err(|error| anyhow!("no sound JSON: {error}")),
        Some(TextKind::Xml) => xml(text),
        _ => yaml(text),
    }
}

/// Where OpenCV 4 writes `%YAML:1.0`, OpenCV 5 has `%YAML 1.2`.
const YAML_HEADERS: [&str; 4] = ["%YAML:1.0", "%YAML 1.0", "%YAML 1.1", "%YAML 1.2"];

fn yaml(text: &str) -> Result<Value> {
    if let Some(header) = text.lines().next().map(str::trim).filter(|line| line.starts_with("%YAML")) {
        let expected = YAML_HEADERS.map(|header| format!("`{header}`")).join(", ");
        ensure!(YAML_HEADERS.contains(&header), "the file begins with `{header}`, but must with one of {expected}");
    }
    let documents: Vec<Value> = serde_saphyr::from_multiple(text).map_err(|error| {
        let at = error.location().map_or_else(String::new, |location| format!("line {}: ", location.line()));
        let message = error.without_snippet().to_string();
        anyhow!("{at}no sound YAML: {}", message.lines().next().unwrap_or_default())
    })?;
    match <[Value; 1]>::try_from(documents) {
        Ok([document]) => Ok(document),
        Err(documents) => bail!("the file has {} documents, but must have one", documents.len()),
    }
}

/// The nodes of OpenCV's file storage. A text of numbers is a number or a list of them.
fn xml(text: &str) -> Result<Value> {
    let document = roxmltree::Document::parse(text).map_err(|error| anyhow!("no sound XML: {error}"))?;
    let root = document.root_element();
    let name = root.tag_name().name();
    ensure!(name == "opencv_storage", "the root of the XML is <{name}>, but must be <opencv_storage>");
    Ok(xml_node(root))
}

fn xml_node(node: roxmltree::Node<'_, '_>) -> Value {
    let children: Map<String, Value> = node
        .children()
        .filter(roxmltree::Node::is_element)
        .map(|child| (child.tag_name().name().to_string(), xml_node(child)))
        .collect();
    if children.is_empty() { xml_text(node.text().unwrap_or_default()) } else { Value::Object(children) }
}

fn xml_text(text: &str) -> Value {
    let words: Vec<_> = text.split_whitespace().collect();
    let number = |word: &&str| word.parse().ok().and_then(Number::from_f64).map(Value::Number);
    let numbers: Option<Vec<_>> = words.iter().map(number).collect();
    match numbers {
        Some(numbers) if numbers.len() == 1 => numbers.into_iter().next().unwrap_or_default(),
        Some(numbers) if numbers.len() > 1 => Value::Array(numbers),
        _ => Value::String(text.trim().to_string()),
    }
}

/// A map of the tree, with the names that lead to it.
#[derive(Clone)]
pub(crate) struct Node<'a> {
    path: String,
    map: &'a Map<String, Value>,
}

impl<'a> Node<'a> {
    pub(crate) fn root(tree: &'a Value) -> Result<Self> {
        let map = tree.as_object().context("the file must have names with values, such as `camera_matrix: …`")?;
        Ok(Self { path: String::new(), map })
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &'a str> {
        self.map.keys().map(String::as_str)
    }

    /// A value that is there, and not null.
    pub(crate) fn value(&self, name: &str) -> Option<&'a Value> {
        self.map.get(name).filter(|value| !value.is_null())
    }

    /// Which of the names is there.
    pub(crate) fn first_of<'n>(&self, names: &[&'n str]) -> Option<&'n str> {
        names.iter().copied().find(|name| self.map.contains_key(*name))
    }

    pub(crate) fn inner(&self, name: &str) -> Option<Self> {
        let map = self.value(name)?.as_object()?;
        Some(Self { path: self.at(name), map })
    }

    pub(crate) fn at(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_string() } else { format!("{}.{name}", self.path) }
    }

    pub(crate) fn missing(&self, name: &str, what: &str) -> anyhow::Error {
        anyhow!("`{}` is missing: it must be {what}", self.at(name))
    }

    pub(crate) fn refuse(&self, name: &str, expected: &str) -> anyhow::Error {
        let value = self.map.get(name).unwrap_or(&Value::Null);
        anyhow!("`{}` is {value}, but must be {expected}", self.at(name))
    }

    pub(crate) fn text(&self, name: &str) -> Result<Option<&'a str>> {
        let text = |value: &'a Value| value.as_str().ok_or_else(|| self.refuse(name, "a text"));
        self.value(name).map(text).transpose()
    }

    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>> {
        let number = |value: &Value| value.as_f64().ok_or_else(|| self.refuse(name, "a finite number"));
        self.value(name).map(number).transpose()
    }

    /// All numbers of a matrix: a list, a list of rows, or a node with `rows`, `cols` and `data`.
    pub(crate) fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>> {
        let Some(value) = self.map.get(name) else { return Ok(None) };
        let Some(matrix) = self.inner(name) else { return flat(value, &self.at(name)).map(Some) };
        let data = matrix.map.get("data").ok_or_else(|| matrix.missing("data", "a list of numbers"))?;
        let numbers = flat(data, &matrix.at("data"))?;
        if let (Some(rows), Some(columns)) = (matrix.number("rows")?, matrix.number("cols")?) {
            let (found, at) = (numbers.len(), matrix.at("data"));
            let is_whole = rows * columns == found as f64;
            ensure!(is_whole, "`{at}` has {found} numbers, but must have {rows} × {columns}, its `rows` × `cols`");
        }
        Ok(Some(numbers))
    }
}

fn flat(value: &Value, at: &str) -> Result<Vec<f64>> {
    if let Some(elements) = value.as_array() {
        let parts = elements.iter().enumerate().map(|(index, element)| flat(element, &format!("{at}[{index}]")));
        return Ok(parts.collect::<Result<Vec<_>>>()?.concat());
    }
    let number = value.as_f64().with_context(|| format!("`{at}` is {value}, but must be a finite number"))?;
    Ok(vec![number])
}
