//! Trajectories on the way: who was where in each frame, as columns of Arrow.

use crate::error::{Fault, Result};
use crate::table::{Table, broken, column};
use arrow_array::types::Int8Type;
use arrow_array::{
    ArrayRef, DictionaryArray, Float32Array, Float64Array, Int8Array, RecordBatch, StringArray, UInt32Array,
};
use arrow_schema::{DataType, Schema, SchemaRef};
use gaitway::Emotion;
use gaitway::export::{AgentInfo, AgentKind};
use gaitway::low_level::ground::is_absent;
use gaitway::low_level::kernels::Store;
use std::sync::Arc;

/// Rows of a batch, from which on the next frame begins another.
const BATCH: usize = 1 << 16;

/// The kinds in the order of their keys.
const KINDS: [AgentKind; 3] = [AgentKind::Person, AgentKind::Robot, AgentKind::Vehicle];

/// Records frames of a crowd at equal times.
#[derive(Debug)]
pub(crate) struct Recorder {
    /// Steps between two frames.
    pub(crate) every: u32,
    /// Frames so far.
    frames: u32,
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
    rows: Rows,
}

/// The columns of the batch that is being filled.
#[derive(Debug, Default)]
struct Rows {
    frame: Vec<u32>,
    time: Vec<f64>,
    id: Vec<u32>,
    /// x, z, heading, velocity along x, along z.
    numbers: [Vec<f32>; 5],
    emotion: Vec<Option<i8>>,
    kind: Vec<i8>,
}

/// The names and units of the numbers of a row.
const NUMBERS: [(&str, &str); 5] =
    [("x_m", "m"), ("z_m", "m"), ("heading_rad", "rad"), ("vx_m_s", "m/s"), ("vz_m_s", "m/s")];

impl Recorder {
    /// Frames so many steps apart.
    pub(crate) fn new(every: u32) -> Self {
        let words = || DataType::Dictionary(Box::new(DataType::Int8), Box::new(DataType::Utf8));
        let mut fields = vec![
            column("frame", "", DataType::UInt32),
            column("time_s", "s", DataType::Float64),
            column("id", "", DataType::UInt32),
        ];
        fields.extend(NUMBERS.map(|(name, unit)| column(name, unit, DataType::Float32)));
        fields.push(column("emotion", "", words()).with_nullable(true));
        fields.push(column("kind", "", words()));
        let schema = Arc::new(Schema::new(fields));
        Self { every, frames: 0, schema, batches: Vec::new(), rows: Rows::default() }
    }

    /// Adds all who are present at `time`, s. `feelings` are the emotions now, by agent.
    pub(crate) fn frame(
        &mut self,
        store: &Store,
        feelings: &[[f32; 4]],
        agents: &[AgentInfo],
        time: f64,
    ) -> Result<()> {
        let rows = &mut self.rows;
        let count = store.step.agent_count as usize;
        let motion = store.position.iter().zip(&store.velocity).zip(&store.heading).take(count);
        for ((id, ((place, velocity), heading)), at) in (0_u32..).zip(motion).zip(0_usize..) {
            if is_absent(*place) {
                continue;
            }
            let agent = agents.get(at);
            let kind = agent.map_or(AgentKind::Person, |agent| agent.kind);
            rows.frame.push(self.frames);
            rows.time.push(time);
            rows.id.push(id);
            let numbers = [place[0], place[1], *heading, velocity[0], velocity[1]];
            rows.numbers.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
            // a robot feels nothing, whatever the crowd does
            let felt = feelings.get(at).filter(|_| kind == AgentKind::Person);
            rows.emotion.push(felt.map(|weights| key(&Emotion::ALL, Emotion::strongest(*weights))));
            rows.kind.push(key(&KINDS, kind));
        }
        self.frames += 1;
        if self.rows.id.len() >= BATCH {
            let batch = self.batch()?;
            self.batches.push(batch);
            self.rows = Rows::default();
        }
        Ok(())
    }

    /// Everything recorded so far.
    pub(crate) fn table(&self) -> Result<Table> {
        let mut batches = self.batches.clone();
        batches.push(self.batch()?);
        Ok(Table::new(self.schema.clone(), batches))
    }

    /// The batch that is being filled.
    fn batch(&self) -> Result<RecordBatch> {
        let Rows { frame, time, id, numbers, emotion, kind } = &self.rows;
        let mut columns: Vec<ArrayRef> = vec![
            Arc::new(UInt32Array::from(frame.clone())),
            Arc::new(Float64Array::from(time.clone())),
            Arc::new(UInt32Array::from(id.clone())),
        ];
        columns.extend(
            numbers.iter().map(|numbers| -> ArrayRef { Arc::new(Float32Array::from(numbers.clone())) }),
        );
        columns.push(words(emotion.clone().into(), &Emotion::ALL.map(Emotion::name))?);
        columns.push(words(kind.clone().into(), &KINDS.map(AgentKind::name))?);
        RecordBatch::try_new(self.schema.clone(), columns).map_err(broken)
    }
}

/// The place of a value among those there are.
fn key<T: PartialEq>(all: &[T], value: T) -> i8 {
    all.iter().position(|known| *known == value).and_then(|at| i8::try_from(at).ok()).unwrap_or(0)
}

/// Words by their keys.
fn words(keys: Int8Array, known: &[&'static str]) -> Result<ArrayRef> {
    let known = Arc::new(StringArray::from(known.to_vec()));
    Ok(Arc::new(DictionaryArray::<Int8Type>::try_new(keys, known).map_err(broken)?))
}

/// The table of the agents of a crowd.
pub(crate) fn agents(agents: &[AgentInfo]) -> std::result::Result<Table, Fault> {
    let text = |value: fn(&AgentInfo) -> Option<&str>| -> ArrayRef {
        Arc::new(agents.iter().map(value).collect::<StringArray>())
    };
    let number = |value: fn(&AgentInfo) -> Option<f32>| -> ArrayRef {
        Arc::new(agents.iter().map(value).collect::<Float32Array>())
    };
    let weight = |index: usize| -> ArrayRef {
        Arc::new(agents.iter().map(|agent| agent.emotion.map(|own| own[index])).collect::<Float32Array>())
    };
    let emotion: StringArray =
        agents.iter().map(|agent| agent.emotion.map(|own| Emotion::strongest(own).name())).collect();
    let led: Vec<bool> = agents.iter().map(|agent| agent.led).collect();
    let mut columns: Vec<(&str, &str, ArrayRef)> = vec![
        ("id", "", Arc::new(UInt32Array::from_iter_values((0..).take(agents.len())))),
        ("kind", "", text(|agent| Some(agent.kind.name()))),
        ("led", "", Arc::new(arrow_array::BooleanArray::from(led))),
        ("emotion", "", Arc::new(emotion)),
    ];
    columns.extend(Emotion::ALL.map(|emotion| (emotion.name(), "", weight(emotion.index()))));
    columns.extend([
        ("gait", "", text(|agent| agent.gait.as_deref())),
        ("avatar", "", text(|agent| agent.avatar.as_deref())),
        ("class", "", text(|agent| agent.class.as_deref())),
        ("group", "", Arc::new(agents.iter().map(|agent| agent.group).collect::<UInt32Array>()) as ArrayRef),
        ("radius_m", "m", number(|agent| agent.radius)),
        ("preferred_speed_m_s", "m/s", number(|agent| agent.preferred_speed)),
        ("age_years", "years", number(|agent| agent.age)),
        ("stature_m", "m", number(|agent| agent.stature)),
        ("weight_kg", "kg", number(|agent| agent.weight)),
    ]);
    Table::of_columns(columns)
}
