//! Writes small STEP files.

use std::fmt::Write;

use toolpathd_core::budget::Budget;

use crate::fault::Unreadable;
use crate::step::{Model, read};

/// The instances of a file that is being written.
pub struct Writer {
    data: String,
    last: usize,
}

/// The unit of length of a file, as its instances state it. `#1` is the unit.
#[derive(Clone, Copy)]
pub enum Length {
    Millimetre,
    Metre,
    Inch,
    None,
}

pub const UP: [f64; 3] = [0.0, 0.0, 1.0];

impl Writer {
    /// A file whose representation has the units of instance 9.
    pub fn new(length: Length) -> Self {
        let mut writer = Self { data: String::new(), last: 9 };
        let unit = match length {
            Length::Millimetre | Length::None => "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))",
            Length::Metre => "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))",
            Length::Inch => "(CONVERSION_BASED_UNIT('INCH',#4)LENGTH_UNIT()NAMED_UNIT(#5))",
        };
        let assigned = if matches!(length, Length::None) { "#2" } else { "#1,#2" };
        let _ = write!(
            writer.data,
            "#1={unit};\n#2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n\
             #4=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#6);\n\
             #5=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n\
             #6=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
             #9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT(({assigned}))\
             REPRESENTATION_CONTEXT('',''));\n"
        );
        writer
    }

    pub fn copy(&self) -> Self {
        Self { data: self.data.clone(), last: self.last }
    }

    /// Adds an instance, and returns its number.
    pub fn add(&mut self, text: impl AsRef<str>) -> usize {
        self.last += 1;
        let _ = writeln!(self.data, "#{}={};", self.last, text.as_ref());
        self.last
    }

    pub fn point(&mut self, p: [f64; 3]) -> usize {
        self.add(format!("CARTESIAN_POINT('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }

    pub fn direction(&mut self, d: [f64; 3]) -> usize {
        self.add(format!("DIRECTION('',({:?},{:?},{:?}))", d[0], d[1], d[2]))
    }

    pub fn vertex(&mut self, p: [f64; 3]) -> usize {
        let point = self.point(p);
        self.add(format!("VERTEX_POINT('',#{point})"))
    }

    /// A placement by its origin, its z and its x.
    pub fn frame(&mut self, origin: [f64; 3], z: [f64; 3], x: [f64; 3]) -> usize {
        let (origin, z, x) = (self.point(origin), self.direction(z), self.direction(x));
        self.add(format!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }

    /// A placement with x along the x axis.
    pub fn upright(&mut self, origin: [f64; 3]) -> usize {
        self.frame(origin, UP, [1.0, 0.0, 0.0])
    }

    pub fn line(&mut self, from: [f64; 3], to: [f64; 3]) -> usize {
        let along = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        let (point, along) = (self.point(from), self.direction(along));
        let vector = self.add(format!("VECTOR('',#{along},1.)"));
        self.add(format!("LINE('',#{point},#{vector})"))
    }

    /// An edge between two vertices on a curve.
    pub fn edge(&mut self, ends: [usize; 2], curve: usize) -> usize {
        self.add(format!("EDGE_CURVE('',#{},#{},#{curve},.T.)", ends[0], ends[1]))
    }

    /// A whole circle about a placement that begins at its x.
    pub fn circle(&mut self, frame: usize, radius: f64, start: [f64; 3]) -> usize {
        let (curve, vertex) = (self.add(format!("CIRCLE('',#{frame},{radius:?})")), self.vertex(start));
        self.edge([vertex, vertex], curve)
    }

    /// A bound of edges, each with whether it is passed forwards.
    pub fn bound(&mut self, edges: &[(usize, bool)]) -> usize {
        let oriented: Vec<String> = edges
            .iter()
            .map(|(edge, forward)| {
                let sense = if *forward { "T" } else { "F" };
                format!("#{}", self.add(format!("ORIENTED_EDGE('',*,*,#{edge},.{sense}.)")))
            })
            .collect();
        let edges = self.add(format!("EDGE_LOOP('',({}))", oriented.join(",")));
        self.add(format!("FACE_BOUND('',#{edges},.T.)"))
    }

    /// A bound that is a point.
    pub fn point_bound(&mut self, p: [f64; 3]) -> usize {
        let vertex = self.vertex(p);
        let point = self.add(format!("VERTEX_LOOP('',#{vertex})"));
        self.add(format!("FACE_BOUND('',#{point},.T.)"))
    }

    /// The bound of straight edges through points.
    pub fn polygon(&mut self, points: &[[f64; 3]]) -> usize {
        let vertices: Vec<usize> = points.iter().map(|p| self.vertex(*p)).collect();
        let n = points.len();
        let edges: Vec<(usize, bool)> = (0..n)
            .map(|k| {
                let line = self.line(points[k], points[(k + 1) % n]);
                (self.edge([vertices[k], vertices[(k + 1) % n]], line), true)
            })
            .collect();
        self.bound(&edges)
    }

    pub fn face(&mut self, bounds: &[usize], surface: usize, same_sense: bool) -> usize {
        let bounds: Vec<String> = bounds.iter().map(|bound| format!("#{bound}")).collect();
        let sense = if same_sense { "T" } else { "F" };
        self.add(format!("ADVANCED_FACE('',({}),#{surface},.{sense}.)", bounds.join(",")))
    }

    /// A solid of faces. Nothing checks that they close it.
    pub fn solid(&mut self, faces: &[usize]) -> usize {
        let faces: Vec<String> = faces.iter().map(|face| format!("#{face}")).collect();
        let shell = self.add(format!("CLOSED_SHELL('',({}))", faces.join(",")));
        self.add(format!("MANIFOLD_SOLID_BREP('part',#{shell})"))
    }

    /// A representation of items.
    pub fn representation(&mut self, items: &[usize]) -> usize {
        let items: Vec<String> = items.iter().map(|item| format!("#{item}")).collect();
        self.add(format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',({}),#9)", items.join(",")))
    }

    pub fn text(&self) -> String {
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\n\
             END-ISO-10303-21;\n",
            self.data
        )
    }

    /// The file with one solid of these faces.
    pub fn of_faces(mut self, faces: &[usize]) -> String {
        let solid = self.solid(faces);
        self.representation(&[solid]);
        self.text()
    }

    /// The model of one solid of these faces.
    pub fn model(self, faces: &[usize]) -> Model {
        let text = self.of_faces(faces);
        read_text(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

pub fn read_text(text: &str) -> Result<Model, Unreadable> {
    read(text.as_bytes(), &Budget::unlimited())
}
