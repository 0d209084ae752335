//! Events as rows: everything that happened to a participant, written and read back.

use super::super::plan::{Plan, Role, Stimulus, Trial};
use super::super::protocol::{Answer, Entry, Event, Exposure};
use rusqlite::types::ToSql;
use rusqlite::{Connection, Result, Row, params};
use serde_json::{Map, Value};

/// The field that names an event's kind.
const KIND: &str = "event";

/// Writes what happened to a participant as number `seq` of all that happened.
pub(super) fn write(
    connection: &Connection,
    plan: &Plan,
    (seq, participant): (i64, i64),
    Entry { at, event }: &Entry,
) -> Result<()> {
    let run = |sql: &str, values: &[&dyn ToSql]| connection.prepare_cached(sql)?.execute(values).map(drop);
    match event {
        // the row of the participant says it
        Event::Arrived { .. } => Ok(()),
        Event::Answer(Answer { page, question, value, text, first_ms, ms, key }) => run(
            "INSERT INTO answer VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
            params![seq, participant, page, question, value, text, first_ms, ms, key, at],
        ),
        Event::Shown { page, exposure } => {
            let Exposure { started, seconds_visible, plays, frames, late_frames, longest_ms } = exposure;
            run(
                "INSERT INTO exposure VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
                params![
                    seq,
                    participant,
                    page,
                    at,
                    started,
                    seconds_visible,
                    plays,
                    frames,
                    late_frames,
                    longest_ms
                ],
            )
        }
        Event::Placed { place, trials } => {
            trials.iter().try_for_each(|trial| write_trial(connection, plan, participant, trial))?;
            let detail = serde_json::json!({ "place": place }).to_string();
            write_event(connection, seq, participant, *at, "placed", &detail)
        }
        other => {
            let (kind, detail) = split(other);
            write_event(connection, seq, participant, *at, &kind, &detail)
        }
    }
}

fn write_event(
    connection: &Connection,
    seq: i64,
    participant: i64,
    at: i64,
    kind: &str,
    detail: &str,
) -> Result<()> {
    let mut statement = connection.prepare_cached("INSERT INTO event VALUES (?1, ?2, ?3, ?4, ?5)")?;
    statement.execute(params![seq, participant, at, kind, detail]).map(drop)
}

/// Kind and fields of an event.
fn split(event: &Event) -> (String, String) {
    let mut fields = match serde_json::to_value(event) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    let kind = fields.remove(KIND).and_then(|kind| kind.as_str().map(str::to_owned)).unwrap_or_default();
    (kind, Value::Object(fields).to_string())
}

fn write_trial(connection: &Connection, plan: &Plan, participant: i64, trial: &Trial) -> Result<()> {
    let (role, again, wanted) = match trial.role {
        Role::Ordinary => ("ordinary", None, None),
        Role::Repeat { of } => ("repeat", Some(of), None),
        Role::Catch { answer } => ("catch", None, Some(answer)),
    };
    let stimuli = plan.trials_of(&trial.part).map(|step| step.stimuli.as_slice()).unwrap_or_default();
    let (mut gait, mut emotion, mut body) = (None, None, None);
    let stimulus = trial.item.and_then(|item| stimuli.get(item as usize));
    match stimulus {
        Some(Stimulus::Gait { gait: name }) => gait = Some(name),
        Some(Stimulus::Agent { emotion: of, body: with, .. }) => (emotion, body) = (Some(of), Some(with)),
        Some(Stimulus::Scene { .. }) | None => {}
    }
    let scene = stimulus.and_then(Stimulus::scene);
    let condition = stimulus.and_then(Stimulus::condition);
    // below 2^63, as the plan promises
    let seed = i64::try_from(trial.seed).unwrap_or(i64::MAX);
    let mut statement = connection.prepare_cached(
        "INSERT INTO trial VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
    )?;
    let Trial { part, position, item, block, row, .. } = trial;
    let values = params![
        participant,
        part,
        position,
        item,
        gait,
        scene,
        condition,
        emotion,
        body,
        block,
        row,
        seed,
        role,
        again,
        wanted
    ];
    statement.execute(values).map(drop)
}

/// All that happened, oldest first, with the participants it happened to; `Arrived` is left out.
pub(super) fn read(connection: &Connection) -> Result<Vec<(i64, i64, Entry)>> {
    let mut all = Vec::new();
    let mut answers = connection
        .prepare("SELECT seq, participant, at, page, question, value, text, first_ms, ms, key FROM answer")?;
    let answer = |row: &Row<'_>| {
        let event = Event::Answer(Answer {
            page: row.get(3)?,
            question: row.get(4)?,
            value: row.get(5)?,
            text: row.get(6)?,
            first_ms: row.get(7)?,
            ms: row.get(8)?,
            key: row.get(9)?,
        });
        Ok((row.get(0)?, row.get(1)?, Entry { at: row.get(2)?, event }))
    };
    all.extend(answers.query_map([], answer)?.collect::<Result<Vec<_>>>()?);
    let mut exposures = connection.prepare(
        "SELECT seq, participant, at, page, started, seconds_visible, plays, frames, late_frames, longest_ms FROM exposure",
    )?;
    let exposure = |row: &Row<'_>| {
        let exposure = Exposure {
            started: row.get(4)?,
            seconds_visible: row.get(5)?,
            plays: row.get(6)?,
            frames: row.get(7)?,
            late_frames: row.get(8)?,
            longest_ms: row.get(9)?,
        };
        let event = Event::Shown { page: row.get(3)?, exposure };
        Ok((row.get(0)?, row.get(1)?, Entry { at: row.get(2)?, event }))
    };
    all.extend(exposures.query_map([], exposure)?.collect::<Result<Vec<_>>>()?);
    let mut events = connection.prepare("SELECT seq, participant, at, kind, detail FROM event")?;
    let mut rows = events.query([])?;
    while let Some(row) = rows.next()? {
        let (participant, kind): (i64, String) = (row.get(1)?, row.get(3)?);
        let trials = if kind == "placed" { read_trials(connection, participant)? } else { Vec::new() };
        let event = join(&kind, &row.get::<_, String>(4)?, trials)?;
        all.push((row.get(0)?, participant, Entry { at: row.get(2)?, event }));
    }
    all.sort_by_key(|(seq, ..)| *seq);
    Ok(all)
}

/// An event from its kind and its fields.
fn join(kind: &str, detail: &str, trials: Vec<Trial>) -> Result<Event> {
    let unreadable = |error: serde_json::Error| {
        rusqlite::Error::FromSqlConversionFailure(4, rusqlite::types::Type::Text, error.into())
    };
    let mut fields: Map<String, Value> = serde_json::from_str(detail).map_err(unreadable)?;
    fields.insert(KIND.to_owned(), kind.into());
    if kind == "placed" {
        fields.insert("trials".to_owned(), serde_json::to_value(trials).map_err(unreadable)?);
    }
    serde_json::from_value(Value::Object(fields)).map_err(unreadable)
}

/// The stimulus of a trial as its place was given.
pub(super) fn placed_item(connection: &Connection, participant: i64, trial: &Trial) -> Result<Option<u32>> {
    let sql = "SELECT item FROM trial WHERE participant = ?1 AND part = ?2 AND position = ?3";
    connection.query_row(sql, params![participant, trial.part, trial.position], |row| row.get(0))
}

fn read_trials(connection: &Connection, participant: i64) -> Result<Vec<Trial>> {
    let mut statement = connection.prepare_cached(
        "SELECT part, position, item, block, row, seed, role, again, wanted FROM trial WHERE participant = ?1 \
         ORDER BY rowid",
    )?;
    let trial = |row: &Row<'_>| {
        let role: String = row.get(6)?;
        Ok(Trial {
            part: row.get(0)?,
            position: row.get(1)?,
            item: row.get(2)?,
            block: row.get(3)?,
            row: row.get(4)?,
            seed: u64::try_from(row.get::<_, i64>(5)?).unwrap_or(0),
            role: match role.as_str() {
                "repeat" => Role::Repeat { of: row.get(7)? },
                "catch" => Role::Catch { answer: row.get(8)? },
                _ => Role::Ordinary,
            },
        })
    };
    statement.query_map([participant], trial)?.collect()
}
