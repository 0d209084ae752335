//! One key of a scenario file, set from outside: `population.agents=200`.

use std::fmt;
use std::str::FromStr;
use toml::{Table, Value};

/// A key of a scenario file and its value, as TOML would have them: `navigation.patience=1.0`, `walkers=[]`,
/// `obstacles.0.high=2` (the element of number 0). A value that is no TOML is a word, such as `rvo`.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    text: String,
    /// Keys and numbers of elements, outermost first.
    path: Vec<String>,
    value: Value,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Text that is no [`Setting`], or one that has no place in a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingError {
    /// There is no `=`.
    #[error("use KEY=VALUE, such as population.agents=200 or navigation.model=rvo")]
    NoValue,
    /// What stands before the `=` is no key.
    #[error("{key:?} is no key; use names with dots, such as navigation.patience or obstacles.0.high")]
    Key {
        /// What stands there.
        key: String,
    },
    /// What stands behind the `=` is no value.
    #[error(
        "{value:?} is no value; use a number, true, false, a word, \"text\", [a, list] or {{ a = table }}"
    )]
    Value {
        /// What stands there.
        value: String,
    },
    /// The file has no such list.
    #[error("there is no {list} in the file, so none of number {number}")]
    NoList {
        /// Key of the list.
        list: String,
        /// The element asked for.
        number: String,
    },
    /// The list is empty.
    #[error("{list} is empty")]
    Empty {
        /// Key of the list.
        list: String,
    },
    /// The list is shorter.
    #[error("{list} has elements 0 to {last}, not {found:?}")]
    NoElement {
        /// Key of the list.
        list: String,
        /// Number of its last element.
        last: usize,
        /// The element asked for.
        found: String,
    },
    /// What the file has there is neither a table nor a list.
    #[error("{key} is {kind}, in which there is no {name:?}")]
    NoTable {
        /// Its key.
        key: String,
        /// What it is.
        kind: &'static str,
        /// What was looked for in it.
        name: String,
    },
}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let (key, value) = text.split_once('=').ok_or(SettingError::NoValue)?;
        let path = path(key).ok_or_else(|| SettingError::Key { key: key.to_owned() })?;
        Ok(Self { text: text.to_owned(), path, value: self::value(value.trim())? })
    }
}

impl Setting {
    /// Whether `key`, as messages write it (`obstacles[0].high`), is what is set or lies in it.
    pub fn holds(&self, key: &str) -> bool {
        let own = self.path.join(".");
        let other = key.replace('[', ".").replace(']', "");
        other == own || other.strip_prefix(&own).is_some_and(|rest| rest.starts_with('.'))
    }

    /// Sets the value in a document; tables on the way to it are made, elements of arrays are not.
    ///
    /// # Errors
    /// What stands in the way.
    pub(super) fn apply(&self, document: &mut Table) -> Result<(), SettingError> {
        let [first, rest @ ..] = self.path.as_slice() else { return Ok(()) };
        let empty = || Value::Table(Table::new());
        if rest.is_empty() {
            document.insert(first.clone(), self.value.clone());
            return Ok(());
        }
        let mut at = document.entry(first.clone()).or_insert_with(empty);
        for (depth, name) in rest.iter().enumerate() {
            let so_far = self.path[..=depth].join(".");
            let is_number = name.bytes().all(|byte| byte.is_ascii_digit());
            at = match at {
                Value::Table(table) if is_number && table.is_empty() => {
                    return Err(SettingError::NoList { list: so_far, number: name.clone() });
                }
                Value::Table(table) => table.entry(name.clone()).or_insert_with(empty),
                Value::Array(items) => {
                    let count = items.len();
                    let item = name.parse::<usize>().ok().and_then(|number| items.get_mut(number));
                    item.ok_or_else(|| match count {
                        0 => SettingError::Empty { list: so_far },
                        _ => SettingError::NoElement { list: so_far, last: count - 1, found: name.clone() },
                    })?
                }
                other => {
                    let (kind, name) = (other.type_str(), name.clone());
                    return Err(SettingError::NoTable { key: so_far, kind, name });
                }
            };
        }
        *at = self.value.clone();
        Ok(())
    }
}

/// Names and numbers of a dotted key; `a[0].b` is `a.0.b`.
fn path(key: &str) -> Option<Vec<String>> {
    let dotted = key.trim().replace('[', ".").replace(']', "");
    let mut table = toml::from_str::<Table>(&format!("{dotted} = 0")).ok()?;
    let mut path = Vec::new();
    loop {
        let mut keys = std::mem::take(&mut table).into_iter();
        let (Some((key, value)), None) = (keys.next(), keys.next()) else { return None };
        path.push(key);
        match value {
            Value::Table(inner) => table = inner,
            _ => return Some(path),
        }
    }
}

/// A value as TOML has it, or else a word.
fn value(text: &str) -> Result<Value, SettingError> {
    let parsed = toml::from_str::<Table>(&format!("value = {text}"));
    if let Ok(mut table) = parsed
        && table.len() == 1
        && let Some(value) = table.remove("value")
    {
        return Ok(value);
    }
    if text.is_empty() || text.contains(['[', ']', '{', '}', '"', '\'', '\n']) {
        return Err(SettingError::Value { value: text.to_owned() });
    }
    Ok(Value::String(text.to_owned()))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    fn set(document: &str, settings: &[&str]) -> Result<Table, SettingError> {
        let mut table: Table = toml::from_str(document).unwrap();
        for setting in settings {
            setting.parse::<Setting>()?.apply(&mut table)?;
        }
        Ok(table)
    }

    #[test]
    fn a_setting_is_the_same_as_the_line_in_the_file() {
        let file = "a = 1\nlist = [{ x = 1 }, { x = 2 }]\n[b]\nc = 1.5\n";
        let same = |settings: &[&str], edited: &str| {
            assert_eq!(
                set(file, settings).unwrap(),
                toml::from_str::<Table>(edited).unwrap(),
                "{settings:?}"
            );
        };
        same(&["a=2"], "a = 2\nlist = [{ x = 1 }, { x = 2 }]\nb.c = 1.5\n");
        same(&["list=[]", "b.c = -1e3"], "a = 1\nlist = []\nb.c = -1e3\n");
        same(
            &["list.1.x=7", "list[0].y=word"],
            "a = 1\nlist = [{ x = 1, y = \"word\" }, { x = 7 }]\nb.c = 1.5\n",
        );
        same(
            &["new.table.key=[1, 2]"],
            "a = 1\nlist = [{ x = 1 }, { x = 2 }]\nb.c = 1.5\nnew.table.key = [1, 2]\n",
        );
        same(&["b={ d = true }", "a=\"1=2\""], "a = \"1=2\"\nlist = [{ x = 1 }, { x = 2 }]\nb.d = true\n");
    }

    #[test]
    fn what_cannot_be_set_is_named() {
        let file = "a = 1\nlist = [{ x = 1 }]\nnone = []\n";
        for (setting, want) in [
            ("a", "KEY=VALUE"),
            ("=1", "is no key"),
            ("a..b=1", "is no key"),
            ("a\nb=1", "is no key"),
            ("a=[1, 2", "is no value"),
            ("a=", "is no value"),
            ("a=1\nb = 2", "is no value"),
            ("a.b=1", "a is integer"),
            ("list.1.x=1", "elements 0 to 0, not \"1\""),
            ("list.x=1", "not \"x\""),
            ("none.0=1", "none is empty"),
            ("absent.0.x=1", "there is no absent"),
        ] {
            let error = set(file, &[setting]).unwrap_err().to_string();
            assert!(error.contains(want), "{setting}: {error}");
        }
    }

    #[test]
    fn a_setting_knows_the_keys_that_it_holds() {
        let setting: Setting = "obstacles.0={ polygon = [] }".parse().unwrap();
        for (key, is_in) in [
            ("obstacles[0].polygon", true),
            ("obstacles[0]", true),
            ("obstacles", false),
            ("obstacles[01]", false),
        ] {
            assert_eq!(setting.holds(key), is_in, "{key}");
        }
    }
}
