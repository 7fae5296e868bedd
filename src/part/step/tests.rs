//! Small files against closed forms.

mod assemblies;
mod damage;
mod faces;
mod features;
mod lexer;
mod shapes;
mod splines;
mod writer;
