//! Views of a crowd's state: numpy arrays over the memory that steps write.
#![allow(unsafe_code, reason = "arrays over memory of ours, one SAFETY comment per block")]

use crate::crowd::Crowd;
use crate::error::Result;
use numpy::ndarray::{ArrayView, Dimension, ShapeBuilder, StrideShape};
use numpy::npyffi::flags::NPY_ARRAY_WRITEABLE;
use numpy::{PyArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// A part of a crowd's memory: numbers that lie at equal distances.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numbers {
    first: *const f32,
    agents: usize,
    /// Numbers from one agent to the next.
    stride: usize,
}

impl Numbers {
    /// Of each element the numbers from `first(element)` on.
    fn of<T>(elements: &[T], agents: usize, first: impl Fn(&T) -> &f32) -> Self {
        let agents = agents.min(elements.len());
        // from the pointer to the whole list: one to the first number may reach that number alone
        let begin = elements.as_ptr();
        let offset =
            elements.first().map_or(0, |element| std::ptr::from_ref(first(element)).addr() - begin.addr());
        Self {
            first: begin.cast::<f32>().wrapping_byte_add(offset),
            agents,
            stride: size_of::<T>() / size_of::<f32>(),
        }
    }

    pub(crate) fn positions(crowd: &mut Crowd) -> Result<Self> {
        let (store, agents) = crowd.read()?;
        Ok(Self::of(&store.position, agents, |place| &place[0]))
    }

    pub(crate) fn velocities(crowd: &mut Crowd) -> Result<Self> {
        let (store, agents) = crowd.read()?;
        Ok(Self::of(&store.velocity, agents, |velocity| &velocity[0]))
    }

    pub(crate) fn headings(crowd: &mut Crowd) -> Result<Self> {
        let (store, agents) = crowd.read()?;
        Ok(Self::of(&store.heading, agents, |heading| heading))
    }

    pub(crate) fn elevations(crowd: &mut Crowd) -> Result<Self> {
        let (store, agents) = crowd.read()?;
        Ok(Self::of(&store.elevation, agents, |height| height))
    }

    pub(crate) fn emotions(crowd: &mut Crowd) -> Result<Self> {
        let agents = crowd.agents();
        Ok(Self::of(crowd.feelings()?, agents, |weights| &weights[0]))
    }

    /// One number an agent: `(agents,)`.
    pub(crate) fn column<'py>(self, owner: Bound<'py, PyAny>) -> Bound<'py, PyAny> {
        view(self.first, self.agents.strides(self.stride), owner)
    }

    /// Several numbers an agent: `(agents, width)`.
    pub(crate) fn rows<'py>(self, width: usize, owner: Bound<'py, PyAny>) -> Bound<'py, PyAny> {
        view(self.first, (self.agents, width).strides((self.stride, 1)), owner)
    }
}

/// A read-only array over memory of `owner`, which it keeps alive.
fn view<'py, D: Dimension>(
    first: *const f32,
    shape: impl Into<StrideShape<D>>,
    owner: Bound<'py, PyAny>,
) -> Bound<'py, PyAny> {
    // SAFETY: `first` and the shape come from a list in the crowd of `owner`, all of whose elements they stay within. The
    // crowd lives as long as `owner`, which the array keeps alive; nothing that `owner` can be asked for makes a list of the
    // state longer or another, and the simulation that holds it moves without its lists. The borrowed view ends here: what
    // stays is numpy's pointer, and numpy only reads, since the array is marked below before Python sees it.
    unsafe {
        let numbers = ArrayView::<f32, D>::from_shape_ptr(shape, first);
        let array = PyArray::borrow_from_array(&numbers, owner);
        (*array.as_array_ptr()).fields.flags &= !NPY_ARRAY_WRITEABLE;
        array.into_any()
    }
}
