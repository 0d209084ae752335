//! A study over real HTTP: pages, forms, guards, operators.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests: a failure is a panic that prints"
)]

mod admin;
mod client;
mod clips;
mod flow;
mod guards;
mod headset;
mod lab;
mod leaks;
mod links;
mod pages;
mod proxies;
