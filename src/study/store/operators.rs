//! Who may see and change what.

use super::desk::Desk;
use super::request::Trouble;
use rusqlite::{OptionalExtension as _, params};

/// What an operator may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Sees the live page.
    Watch,
    /// Also pauses, excludes, and closes admission.
    Run,
    /// Also names operators and takes the data.
    Own,
}

/// A person who runs the study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Operator {
    /// The name.
    pub name: String,
    /// What they may do.
    pub role: Role,
    /// The password's hash (argon2id, PHC format).
    pub hash: String,
}

impl Role {
    /// All roles and their names, from the least to the greatest.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Watch, "watch"), (Self::Run, "run"), (Self::Own, "own")];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(role, _)| *role == self).map_or("", |(_, name)| name)
    }

    /// The role of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, own)| *own == name).map(|(role, _)| *role)
    }
}

impl Desk {
    /// The operator of a name.
    pub(super) fn operator(&self, name: &str) -> Result<Option<Operator>, Trouble> {
        let sql = "SELECT name, hash, role FROM operator WHERE name = ?1";
        let row = |row: &rusqlite::Row<'_>| {
            let role: String = row.get(2)?;
            let role = Role::named(&role).unwrap_or(Role::Watch);
            Ok(Operator { name: row.get(0)?, hash: row.get(1)?, role })
        };
        Ok(self.connection.prepare_cached(sql)?.query_row([name], row).optional()?)
    }

    /// How many operators there are.
    pub(super) fn operators(&self) -> Result<usize, Trouble> {
        let count: i64 = self.connection.query_row("SELECT count(*) FROM operator", [], |row| row.get(0))?;
        Ok(usize::try_from(count).unwrap_or(0))
    }

    /// Names an operator, or gives one a new password or role.
    pub(super) fn set_operator(&mut self, by: &str, operator: &Operator) -> Result<(), Trouble> {
        self.audit(by, "set operator", &operator.name)?;
        let sql = "INSERT OR REPLACE INTO operator VALUES (?1, ?2, ?3)";
        let Operator { name, hash, role } = operator;
        self.connection.prepare_cached(sql)?.execute(params![name, hash, role.name()])?;
        Ok(())
    }
}
