//! Small files against closed forms.

mod assemblies;
mod damage;
mod faces;
mod features;
mod lexer;
mod outlines;
mod shapes;
mod splines;
mod tessellated_curves;
mod tessellation;
mod triangles;
mod writer;
