//! What the front watches beside the stage: the operator, the recording, the world that is made ahead.

use super::parties::{Operator, Typed};
use crate::kernels::Store;
use crate::scene::Scene;
use crate::study::lab::Order;
use crate::study::protocol::PageQuestion;
use crate::study::theatre::{Showing, Theatre};
use crate::xr::{Observer, Recorder, UserState, World};
use std::fs::File;
use std::thread::{self, JoinHandle};

/// The operator, as the stage's observer; records steps while there is a recording.
pub(super) struct Beside<'a> {
    operator: &'a mut dyn Operator,
    recorder: Option<Recorder<File>>,
    order: Option<Order>,
    /// The question that the operator types the answer to.
    awaited: Option<PageQuestion>,
    typed: Option<Typed>,
}

impl<'a> Beside<'a> {
    pub(super) fn new(operator: &'a mut dyn Operator) -> Self {
        Self { operator, recorder: None, order: None, awaited: None, typed: None }
    }

    pub(super) fn operator(&mut self) -> &mut dyn Operator {
        self.operator
    }

    /// Records steps from now on.
    pub(super) fn record(&mut self, recorder: Recorder<File>) {
        self.recorder = Some(recorder);
    }

    pub(super) fn take_recorder(&mut self) -> Option<Recorder<File>> {
        self.recorder.take()
    }

    /// What the operator wants; given once.
    pub(super) fn take_order(&mut self) -> Option<Order> {
        self.order.take()
    }

    /// From now on what the operator types answers this question.
    pub(super) fn wait_for(&mut self, page: &str, question: &PageQuestion) {
        self.operator.asks(page, question);
        (self.awaited, self.typed) = (Some(question.clone()), None);
    }

    /// What was typed; nothing is awaited any more.
    pub(super) fn take_typed(&mut self) -> Option<Typed> {
        self.awaited = None;
        self.typed.take()
    }
}

impl Observer for Beside<'_> {
    fn note(&mut self, line: &str) {
        self.operator.note(line);
    }

    fn step(&mut self, user: &UserState, crowd: &Store) -> Result<(), crate::Error> {
        match &mut self.recorder {
            Some(recorder) => recorder.step(user, crowd).map_err(|error| crate::Error::Usage {
                message: error.to_string(),
                hint: "make room on the disk".to_owned(),
            }),
            None => Ok(()),
        }
    }

    fn is_cut(&mut self) -> bool {
        if self.order.is_none() {
            self.order = self.operator.order();
        }
        if let (Some(question), None) = (&self.awaited, &self.typed) {
            self.typed = Some(self.operator.typed(question)).filter(|typed| *typed != Typed::Waiting);
        }
        self.order.is_some() || self.typed.is_some()
    }
}

type Making = JoinHandle<Result<(Scene, World), crate::Error>>;

/// A world that is made on a thread of its own.
pub(super) struct Ahead {
    showing: Showing,
    making: Option<Making>,
    made: Option<(Scene, World)>,
}

impl Ahead {
    pub(super) fn begin(theatre: &Theatre, showing: Showing) -> Result<Self, crate::Error> {
        let (theatre, shown) = (theatre.clone(), showing.clone());
        let make = move || {
            let scene = theatre.scene(&shown)?;
            let world = World::new(&scene)?;
            Ok((scene, world))
        };
        let making = thread::Builder::new().name("next trial".to_owned()).spawn(make);
        let making = making.map_err(|error| crate::Error::Usage {
            message: format!("no thread for the next trial: {error}"),
            hint: "close other programs, then try again".to_owned(),
        })?;
        Ok(Self { showing, making: Some(making), made: None })
    }

    /// Whether it is of this trial, with the same stimulus.
    pub(super) fn is_of(&self, showing: &Showing) -> bool {
        self.showing == *showing
    }

    /// The world, once it is made.
    pub(super) fn look(&mut self) -> Result<Option<&World>, crate::Error> {
        if let Some(making) = self.making.take_if(|making| making.is_finished()) {
            self.made = Some(join(making)?);
        }
        Ok(self.made.as_ref().map(|(_, world)| world))
    }

    /// Gives the world away; none if it is not made yet.
    pub(super) fn world(self) -> Option<(Scene, World)> {
        self.made
    }
}

fn join(making: Making) -> Result<(Scene, World), crate::Error> {
    making.join().unwrap_or_else(|_| {
        Err(crate::Error::Usage {
            message: "the thread that makes the next trial panicked".to_owned(),
            hint: "this is a fault of the program: report it with what stands above".to_owned(),
        })
    })
}
